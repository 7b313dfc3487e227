//! A texture that the bake encodes and does not change. Its mips are means of linear light, which diffuse light that
//! bumps lose may darken.
//!
//! Colours under an alpha are means weighted by alpha (premultiplied), so that texels that nobody sees do not bleed
//! into those that are seen. They are stored without the alpha in them, as glTF asks for.

use std::sync::LazyLock;

use crate::gltf::plain_textures::{AlphaUse, Meaning};
use crate::image::{Image, Rgba, linear_to_srgb, srgb_to_linear};
use crate::material::coverage::{coverage, scale_for_coverage};
use crate::material::diffuse_light::DiffuseLight;
use crate::material::product::Product;
use crate::mip::{LinearResampled, MipTail, TexelRows, Wrap, level_sizes};

/// A plain texture on a grid of texels, with all its levels.
pub struct PlainTexture<'a> {
    image: &'a Image,
    size: (u32, u32),
    levels: Levels<'a>,
    /// Multiplies linear light; none if mips stay means.
    diffuse_light: Option<DiffuseLight<'a>>,
}

/// The levels of a plain texture.
enum Levels<'a> {
    /// Linear values or colours without alpha.
    Opaque { level_0: LinearResampled<Opaque<'a>>, tail: MipTail<[f32; 3]>, is_srgb: bool },
    /// Colours with alpha, which is multiplied by the number of its level.
    Alpha { level_0: LinearResampled<Premultiplied<'a>>, tail: MipTail<[f32; 7]>, scales: Vec<f32> },
}

impl<'a> PlainTexture<'a> {
    /// Puts `image` on a grid of `size` texels, as a sampler with the modes `wrap` magnifies it.
    pub fn new(image: &'a Image, meaning: Meaning, size: (u32, u32), wrap: [Wrap; 2]) -> Self {
        let (width, height) = size;
        let levels = match meaning {
            Meaning::Colour(alpha) if alpha != AlphaUse::Opaque && image.channels == 4 => {
                let level_0 = LinearResampled::new(Premultiplied { image }, width, height, wrap);
                let tail = MipTail::new(&level_0);
                let scales = scales(&level_0, &tail, alpha);
                Levels::Alpha { level_0, tail, scales }
            }
            _ => {
                let is_srgb = meaning != Meaning::Linear;
                let level_0 = LinearResampled::new(Opaque { image, is_srgb }, width, height, wrap);
                Levels::Opaque { tail: MipTail::new(&level_0), level_0, is_srgb }
            }
        };
        Self { image, size, levels, diffuse_light: None }
    }

    /// Multiplies the colours of all levels, which must be on the grid of the texture, by the factors of
    /// `diffuse_light`.
    #[must_use]
    pub fn darkened_by(self, diffuse_light: Option<DiffuseLight<'a>>) -> Self {
        Self { diffuse_light, ..self }
    }

    /// Returns the factors of linear light of row `y` of `level`, which has `width` texels.
    fn factors(&self, level: usize, y: u32, width: usize) -> Vec<f32> {
        self.diffuse_light.as_ref().map_or_else(|| vec![1.0; width], |light| light.row(level, y))
    }

    /// Returns whether texels have alpha.
    pub fn has_alpha(&self) -> bool {
        matches!(self.levels, Levels::Alpha { .. })
    }

    /// Returns whether a level is the image as it is.
    fn is_image(&self, level: usize) -> bool {
        level == 0 && self.size == (self.image.width, self.image.height)
    }
}

impl Product for PlainTexture<'_> {
    fn sizes(&self) -> Vec<(u32, u32)> {
        level_sizes(self.size.0, self.size.1)
    }

    fn row(&self, level: usize, y: u32, out: &mut [[f32; 4]]) {
        if self.is_image(level) {
            return Rgba(self.image).row(y, out);
        }
        let factors = self.factors(level, y, out.len());
        match &self.levels {
            Levels::Opaque { level_0, tail, is_srgb } => {
                let store = |value: f32| if *is_srgb { linear_to_srgb(value) } else { value };
                let mut texels = vec![[0.0; 3]; out.len()];
                tail.row(level_0, level, y, &mut texels);
                for ((out, texel), factor) in out.iter_mut().zip(texels).zip(factors) {
                    let [red, green, blue] = texel.map(|value| store(factor * value));
                    *out = [red, green, blue, 1.0];
                }
            }
            Levels::Alpha { level_0, tail, scales } => {
                let mut texels = vec![[0.0; 7]; out.len()];
                tail.row(level_0, level, y, &mut texels);
                for ((out, texel), factor) in out.iter_mut().zip(texels).zip(factors) {
                    *out = straight(texel, factor, scales[level]);
                }
            }
        }
    }
}

/// Returns the sRGB colour and the alpha of a texel whose light is multiplied by `factor`, and its alpha by `scale`. A
/// texel without any alpha has the mean of its colours.
fn straight([red, green, blue, alpha, plain @ ..]: [f32; 7], factor: f32, scale: f32) -> [f32; 4] {
    let colour = if alpha > 0.0 { [red, green, blue].map(|light| light / alpha) } else { plain };
    let [red, green, blue] = colour.map(|light| linear_to_srgb((factor * light).clamp(0.0, 1.0)));
    [red, green, blue, (scale * alpha).min(1.0)]
}

/// Returns the factor of alpha of each level. Level 0 keeps its alphas.
fn scales(level_0: &LinearResampled<Premultiplied<'_>>, tail: &MipTail<[f32; 7]>, alpha: AlphaUse) -> Vec<f32> {
    let sizes = level_sizes(level_0.width(), level_0.height());
    let AlphaUse::Mask(cutoff) = alpha else { return vec![1.0; sizes.len()] };
    let alphas = |level: usize| {
        let (width, height) = sizes[level];
        let mut row = vec![[0.0; 7]; width as usize];
        let mut alphas = Vec::with_capacity(width as usize * height as usize);
        for y in 0..height {
            tail.row(level_0, level, y, &mut row);
            alphas.extend(row.iter().map(|texel| texel[3]));
        }
        alphas
    };
    let share = coverage(&alphas(0), cutoff);
    let coarser = (1..sizes.len()).map(|level| scale_for_coverage(alphas(level), cutoff, share));
    [1.0].into_iter().chain(coarser).collect()
}

/// Returns the linear value of an sRGB value. Values of 8 bits are read from a table.
fn linear(value: f32) -> f32 {
    static LINEAR: LazyLock<[f32; 256]> =
        LazyLock::new(|| std::array::from_fn(|code| srgb_to_linear(code as f64 / 255.0) as f32));
    let code = (255.0 * value.clamp(0.0, 1.0)).round();
    match LINEAR.get(code as usize).filter(|_| code / 255.0 == value) {
        Some(linear) => *linear,
        None => srgb_to_linear(f64::from(value.clamp(0.0, 1.0))) as f32,
    }
}

/// An image as linear values of three channels.
#[derive(Clone, Copy)]
struct Opaque<'a> {
    image: &'a Image,
    is_srgb: bool,
}

impl TexelRows for Opaque<'_> {
    type Texel = [f32; 3];

    fn width(&self) -> u32 {
        self.image.width
    }

    fn height(&self) -> u32 {
        self.image.height
    }

    fn row(&self, y: u32, out: &mut [[f32; 3]]) {
        let mut texels = vec![[0.0; 4]; out.len()];
        Rgba(self.image).row(y, &mut texels);
        for (out, [red, green, blue, _]) in out.iter_mut().zip(texels) {
            let values = [red, green, blue];
            *out = if self.is_srgb { values.map(linear) } else { values };
        }
    }
}

/// An image as linear light times alpha, alpha, and linear light.
#[derive(Clone, Copy)]
struct Premultiplied<'a> {
    image: &'a Image,
}

impl TexelRows for Premultiplied<'_> {
    type Texel = [f32; 7];

    fn width(&self) -> u32 {
        self.image.width
    }

    fn height(&self) -> u32 {
        self.image.height
    }

    fn row(&self, y: u32, out: &mut [[f32; 7]]) {
        let mut texels = vec![[0.0; 4]; out.len()];
        Rgba(self.image).row(y, &mut texels);
        for (out, [red, green, blue, alpha]) in out.iter_mut().zip(texels) {
            let [red, green, blue] = [red, green, blue].map(linear);
            let alpha = alpha.clamp(0.0, 1.0);
            *out = [red * alpha, green * alpha, blue * alpha, alpha, red, green, blue];
        }
    }
}

#[cfg(test)]
mod tests;

//! The specular reflectance of the base lobe, texel by texel: the weight of level-0 texels where lobes are merged and
//! where their mixture is the reference.

use crate::image::{ChannelSum, Image, srgb_to_linear};
use crate::lobe::reflectance::{DIELECTRIC_F0, LUMINANCE, MaterialTexel};
use crate::mip::{LinearResampled, TexelRows, Wrap};

/// The metalness of a base lobe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Metalness {
    /// All texels have the same metalness.
    Constant(f32),
    /// Blue of the roughness texture, times this factor.
    Texture(f32),
}

/// The largest difference of metalness that counts as none: seven steps of 8 bits, as JPEG compression makes them.
const METALNESS_NOISE: f32 = 1.0 / 32.0;

impl Metalness {
    /// Returns the metalness of the roughness texture, if there is one, with `metallicFactor`.
    pub fn new(roughness: Option<&Image>, factor: f32) -> Self {
        let Some(image) = roughness.filter(|_| factor > 0.0) else { return Self::Constant(factor.clamp(0.0, 1.0)) };
        let [_, _, blue] = image.colour_ranges();
        let [least, largest] = blue.map(|blue| factor * blue);
        if largest <= METALNESS_NOISE {
            Self::Constant(0.0)
        } else if largest - least <= METALNESS_NOISE {
            Self::Constant((0.5 * (least + largest)).clamp(0.0, 1.0))
        } else {
            Self::Texture(factor)
        }
    }

    /// Returns whether the base colour decides on the reflectance of a texel.
    pub fn needs_base_colour(self) -> bool {
        self != Self::Constant(0.0)
    }
}

/// A texture and the factor that multiplies it.
#[derive(Clone, Copy)]
pub struct Factored<'a, F> {
    /// The texture; constant 1 without one.
    pub image: Option<&'a Image>,
    /// Multiplies the texture.
    pub factor: F,
}

/// The textures and factors that decide on the reflectance of a base lobe.
#[derive(Clone, Copy)]
pub struct ReflectanceSource<'a> {
    /// The texture whose blue is metalness.
    pub roughness: Option<&'a Image>,
    /// The metalness.
    pub metalness: Metalness,
    /// Base colour: sRGB in the texture, linear in the factor.
    pub base_colour: Factored<'a, [f32; 3]>,
    /// Alpha is `specularTexture` of `KHR_materials_specular`.
    pub specular: Factored<'a, f32>,
    /// `specularColorTexture`: sRGB in the texture, linear in the factor.
    pub specular_colour: Factored<'a, [f32; 3]>,
}

/// Level 0 of a reflectance that varies, on a grid of texels.
#[derive(Clone)]
pub struct ReflectanceRows<'a> {
    metalness: Number<'a>,
    metal_f0: Number<'a>,
    dielectric_f0: Number<'a>,
    specular: Number<'a>,
}

impl<'a> ReflectanceRows<'a> {
    /// Puts the reflectance on a grid of `size` texels, as samplers magnify textures. Returns `None` if the reflectance
    /// is constant.
    pub fn new(source: &ReflectanceSource<'a>, size: (u32, u32), wrap: [Wrap; 2]) -> Option<Self> {
        let specular = channel(3, source.specular.factor);
        let rows = Self {
            metalness: Number::of_metalness(source.metalness, source.roughness, size, wrap),
            metal_f0: Number::of_luminance(source.base_colour, 1.0, size, wrap),
            dielectric_f0: Number::of_luminance(source.specular_colour, DIELECTRIC_F0, size, wrap),
            specular: Number::new(source.specular.image, &specular, size, wrap),
        };
        (!rows.is_constant()).then_some(rows)
    }

    fn is_constant(&self) -> bool {
        let is_dielectric_constant = self.dielectric_f0.is_constant() && self.specular.is_constant();
        match self.metalness {
            Number::Texture(_) => false,
            Number::Constant(0.0) => is_dielectric_constant,
            Number::Constant(1.0) => self.metal_f0.is_constant(),
            Number::Constant(_) => is_dielectric_constant && self.metal_f0.is_constant(),
        }
    }

    /// Returns whether both the metalness and the base colour vary, so that bright and dark texels can differ in
    /// metalness.
    pub fn metalness_varies_with_colour(&self) -> bool {
        !self.metalness.is_constant() && !self.metal_f0.is_constant()
    }

    /// Returns the luminances of the base colour of row `y`, which has `width` texels, in [0, 1].
    pub fn colour_row(&self, y: u32, width: usize) -> Vec<[f32; 1]> {
        self.metal_f0.row(y, width)
    }

    /// Writes the reflectance of row `y` to `out`.
    pub fn row(&self, y: u32, out: &mut [f32]) {
        let numbers = [&self.metalness, &self.metal_f0, &self.dielectric_f0, &self.specular];
        let [metalness, metal_f0, dielectric_f0, specular] = numbers.map(|number| number.row(y, out.len()));
        for (x, out) in out.iter_mut().enumerate() {
            let texel = MaterialTexel {
                metalness: metalness[x][0],
                metal_f0: metal_f0[x][0],
                dielectric_f0: dielectric_f0[x][0],
                specular: specular[x][0],
            };
            *out = texel.reflectance();
        }
    }
}

/// Returns the function of one channel that multiplies it by `factor`.
fn channel(of: usize, factor: f32) -> impl Fn(usize, f64) -> f64 {
    move |channel, value| if channel == of { f64::from(factor) * value } else { 0.0 }
}

/// Returns the functions of channels whose sum is the luminance of an sRGB colour times `factor` and `scale`. No
/// channel of the product exceeds 1.
fn luminance(factor: [f32; 3], scale: f32) -> impl Fn(usize, f64) -> f64 {
    move |channel, value| match factor.get(channel) {
        Some(factor) => {
            let linear = f64::from(scale) * f64::from(*factor) * srgb_to_linear(value);
            f64::from(LUMINANCE[channel]) * linear.clamp(0.0, 1.0)
        }
        None => 0.0,
    }
}

/// A number of each texel.
#[derive(Clone)]
pub(super) enum Number<'a> {
    Constant(f32),
    Texture(LinearResampled<ChannelSum<'a>>),
}

impl<'a> Number<'a> {
    /// Puts the sum of `function(channel, value)` over the channels of `image` on a grid of `size` texels. All channels
    /// are 1 without an image.
    fn new(
        image: Option<&'a Image>,
        function: &dyn Fn(usize, f64) -> f64,
        (width, height): (u32, u32),
        wrap: [Wrap; 2],
    ) -> Self {
        let Some(image) = image else {
            return Self::Constant((0..4).map(|channel| function(channel, 1.0)).sum::<f64>() as f32);
        };
        let sum = ChannelSum::new(image, function);
        match sum.constant() {
            Some(constant) => Self::Constant(constant),
            None => Self::Texture(LinearResampled::new(sum, width, height, wrap)),
        }
    }

    /// Puts the metalness, which is blue of `roughness` if it is a texture, on a grid of `size` texels.
    pub(super) fn of_metalness(
        metalness: Metalness,
        roughness: Option<&'a Image>,
        size: (u32, u32),
        wrap: [Wrap; 2],
    ) -> Self {
        match (metalness, roughness) {
            (Metalness::Texture(factor), Some(image)) => Self::new(Some(image), &channel(2, factor), size, wrap),
            (Metalness::Constant(factor) | Metalness::Texture(factor), _) => Self::Constant(factor),
        }
    }

    /// Puts the luminance of an sRGB colour times `scale` on a grid of `size` texels.
    pub(super) fn of_luminance(
        Factored { image, factor }: Factored<'a, [f32; 3]>,
        scale: f32,
        size: (u32, u32),
        wrap: [Wrap; 2],
    ) -> Self {
        Self::new(image, &luminance(factor, scale), size, wrap)
    }

    fn is_constant(&self) -> bool {
        matches!(self, Self::Constant(_))
    }

    /// Returns the numbers of row `y`, which has `width` texels.
    pub(super) fn row(&self, y: u32, width: usize) -> Vec<[f32; 1]> {
        match self {
            Self::Constant(number) => vec![[*number]; width],
            Self::Texture(rows) => {
                let mut row = vec![[0.0]; width];
                rows.row(y, &mut row);
                row
            }
        }
    }
}

#[cfg(test)]
mod tests;

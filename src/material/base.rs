//! The material's own roughness: what its textures and factors say before any bump is lost.

use crate::image::Rgba;
use crate::lobe::{Anisotropy, Roughness, SquaredAlpha};
use crate::mip::{Linear, MipTail, Rows, Wrap, level_sizes};

/// A texel of the material's own lobe: A (uu, uv, vv), then the red and blue channels, which are only averaged.
pub type BaseTexel = [f32; 5];

/// The anisotropy that a material has already (`KHR_materials_anisotropy`).
pub struct BaseAnisotropy<'a> {
    /// Direction in red and green, strength in blue; constant (1, 1/2, 1) when absent.
    pub texture: Option<Rgba<'a>>,
    /// Multiplies the texture's strength.
    pub strength: f32,
    /// Cosine and sine of the rotation of the direction, counter-clockwise.
    pub rotation: [f32; 2],
}

/// Roughness and anisotropy of a material on one grid.
#[derive(Clone)]
pub struct BaseRows<'a> {
    width: u32,
    height: u32,
    roughness_factor: f32,
    roughness: Option<Linear<Rgba<'a>>>,
    strength: f32,
    rotation: [f32; 2],
    direction: Option<Linear<Rgba<'a>>>,
}

impl<'a> BaseRows<'a> {
    /// On a grid of `width` x `height` texels; coarser textures are magnified as a sampler does. The roughness is the
    /// green channel of `roughness` times `roughness_factor`; `wrap` is the sampler's mode across and down.
    pub fn new(
        width: u32,
        height: u32,
        roughness: Option<Rgba<'a>>,
        roughness_factor: f32,
        anisotropy: Option<BaseAnisotropy<'a>>,
        wrap: [Wrap; 2],
    ) -> Self {
        let on_grid = |rows| Linear::new(rows, width, height, wrap);
        let (strength, rotation, direction) = match anisotropy {
            None => (0.0, [1.0, 0.0], None),
            Some(a) => (a.strength, a.rotation, a.texture.map(on_grid)),
        };
        Self { width, height, roughness_factor, roughness: roughness.map(on_grid), strength, rotation, direction }
    }
}

impl BaseRows<'_> {
    /// Whether the material is anisotropic by itself.
    pub fn is_anisotropic(&self) -> bool {
        self.strength > 0.0
    }

    /// Writes the red, green, blue and alpha of row `y` of the roughness texture to `out`; 1 without one.
    fn surface(&self, y: u32, out: &mut [[f32; 4]]) {
        match &self.roughness {
            Some(rows) => rows.row(y, out),
            None => out.fill([1.0; 4]),
        }
    }

    /// Writes the green alone of that row to `out`.
    pub fn green(&self, y: u32, out: &mut [f32]) {
        match self.roughness.as_ref().map(Linear::unchanged) {
            None => out.fill(1.0),
            Some(Some(texels)) => texels.green(y, out),
            Some(None) => {
                let mut surface = vec![[0.0; 4]; out.len()];
                self.surface(y, &mut surface);
                out.iter_mut().zip(surface).for_each(|(green, texel)| *green = texel[1]);
            }
        }
    }

    /// Writes row `y` of the texture that holds these lobes, which are round, to `out`: roughness in green, red and blue as they are.
    pub fn isotropic_row(&self, y: u32, out: &mut [[f32; 4]]) {
        self.surface(y, out);
        out.iter_mut().for_each(|texel| texel[1] = self.roughness(texel[1]).0);
    }

    #[inline(always)]
    fn roughness(&self, green: f32) -> Roughness {
        Roughness((green * self.roughness_factor).clamp(0.0, 1.0))
    }

    /// Of a round lobe.
    #[inline(always)]
    pub fn squared_alpha(&self, green: f32) -> f32 {
        SquaredAlpha::isotropic(self.roughness(green).into()).0.uu
    }

    /// Red and blue of the roughness texture, where they are the same everywhere.
    fn common_red_blue(&self) -> Option<[f32; 2]> {
        self.roughness.as_ref().map_or(Some([1.0; 2]), |rows| rows.source().common_red_blue())
    }
}

impl Rows for BaseRows<'_> {
    type Texel = BaseTexel;

    fn width(&self) -> u32 {
        self.width
    }

    fn height(&self) -> u32 {
        self.height
    }

    fn row(&self, y: u32, out: &mut [BaseTexel]) {
        let mut surface = vec![[0.0; 4]; out.len()];
        self.surface(y, &mut surface);
        if !self.is_anisotropic() {
            for (texel, [red, green, blue, _]) in out.iter_mut().zip(surface) {
                *texel = whole_texel([self.squared_alpha(green), red, blue]);
            }
            return;
        }
        // The texel that glTF defines for a material without an anisotropy texture.
        let mut direction = vec![[1.0, 0.5, 1.0, 1.0]; out.len()];
        if let Some(rows) = &self.direction {
            rows.row(y, &mut direction);
        }
        for ((texel, [red, green, blue, _]), axis) in out.iter_mut().zip(surface).zip(direction) {
            let lobe = Anisotropy {
                roughness: self.roughness(green),
                strength: (axis[2] * self.strength).clamp(0.0, 1.0),
                direction: rotated([2.0 * axis[0] - 1.0, 2.0 * axis[1] - 1.0], self.rotation),
            };
            let a = lobe.squared_alpha().0;
            *texel = [a.uu, a.uv, a.vv, red, blue];
        }
    }
}

/// Of a texel whose lobe is round: its squared alpha, red and blue.
type IsotropicTexel = [f32; 3];

/// The texel with all its numbers.
fn whole_texel([squared_alpha, red, blue]: IsotropicTexel) -> BaseTexel {
    [squared_alpha, 0.0, squared_alpha, red, blue]
}

/// The rows of a material whose lobes are round.
struct IsotropicRows<'r, 'a>(&'r BaseRows<'a>);

impl Rows for IsotropicRows<'_, '_> {
    type Texel = IsotropicTexel;

    fn width(&self) -> u32 {
        self.0.width
    }

    fn height(&self) -> u32 {
        self.0.height
    }

    fn row(&self, y: u32, out: &mut [IsotropicTexel]) {
        let mut surface = vec![[0.0; 4]; out.len()];
        self.0.surface(y, &mut surface);
        for (texel, [red, green, blue, _]) in out.iter_mut().zip(surface) {
            *texel = [self.0.squared_alpha(green), red, blue];
        }
    }
}

/// The rows of a material whose lobes are round, without red and blue: squared alphas.
struct PlainRows<'r, 'a>(&'r BaseRows<'a>);

impl Rows for PlainRows<'_, '_> {
    type Texel = [f32; 1];

    fn width(&self) -> u32 {
        self.0.width
    }

    fn height(&self) -> u32 {
        self.0.height
    }

    fn row(&self, y: u32, out: &mut [[f32; 1]]) {
        self.0.green(y, out.as_flattened_mut());
        out.iter_mut().for_each(|[texel]| *texel = self.0.squared_alpha(*texel));
    }
}

/// Levels 1 and coarser of a material's own lobe.
pub enum BaseLevels {
    /// Without textures all texels are the same.
    Same,
    /// Round lobes beside one red and blue.
    Plain {
        /// Their squared alphas.
        tail: MipTail<[f32; 1]>,
        /// Red and blue.
        red_blue: [f32; 2],
    },
    /// Round lobes, of three numbers instead of five.
    Isotropic(MipTail<IsotropicTexel>),
    /// Lobes that are ellipses.
    Anisotropic(MipTail<BaseTexel>),
}

impl BaseLevels {
    /// Those over `rows`.
    pub fn new(rows: &BaseRows<'_>) -> Self {
        if rows.roughness.is_none() && rows.direction.is_none() {
            Self::Same
        } else if rows.is_anisotropic() {
            Self::Anisotropic(MipTail::new(rows))
        } else if let Some(red_blue) = rows.common_red_blue() {
            Self::Plain { tail: MipTail::new(&PlainRows(rows)), red_blue }
        } else {
            Self::Isotropic(MipTail::new(&IsotropicRows(rows)))
        }
    }
}

/// A material's own lobe with all its levels.
pub struct Base<'a> {
    rows: BaseRows<'a>,
    tail: BaseLevels,
}

impl<'a> Base<'a> {
    /// All levels over `rows`.
    pub fn new(rows: BaseRows<'a>) -> Self {
        let tail = BaseLevels::new(&rows);
        Self { rows, tail }
    }

    /// The same, where `coarser` has been made of `rows` before.
    pub fn with_levels(rows: BaseRows<'a>, tail: BaseLevels) -> Self {
        Self { rows, tail }
    }

    /// Level 0.
    pub fn finest(&self) -> &BaseRows<'a> {
        &self.rows
    }

    /// Whether red and blue of the roughness texture are the same everywhere.
    pub fn is_plain(&self) -> bool {
        match self.tail {
            BaseLevels::Same | BaseLevels::Plain { .. } => true,
            BaseLevels::Isotropic(_) => false,
            BaseLevels::Anisotropic(_) => self.rows.common_red_blue().is_some(),
        }
    }

    /// Sizes of all levels, level 0 first.
    pub fn sizes(&self) -> Vec<(u32, u32)> {
        level_sizes(self.rows.width, self.rows.height)
    }

    /// Writes row `y` of `level` to `out`.
    pub fn row(&self, level: usize, y: u32, out: &mut [BaseTexel]) {
        match &self.tail {
            BaseLevels::Same => self.rows.row(0, out),
            BaseLevels::Plain { .. } | BaseLevels::Isotropic(_) if level == 0 => self.rows.row(y, out),
            BaseLevels::Plain { tail, red_blue: [red, blue] } => {
                tail.with_row(&PlainRows(&self.rows), level, y, |row| {
                    out.iter_mut().zip(row).for_each(|(texel, [alpha])| *texel = whole_texel([*alpha, *red, *blue]));
                });
            }
            BaseLevels::Isotropic(tail) => {
                tail.with_row(&IsotropicRows(&self.rows), level, y, |row| {
                    out.iter_mut().zip(row).for_each(|(texel, round)| *texel = whole_texel(*round));
                });
            }
            BaseLevels::Anisotropic(tail) => tail.row(&self.rows, level, y, out),
        }
    }

    /// Writes the red and blue of row `y` of `level` to `out`.
    pub fn red_blue(&self, level: usize, y: u32, out: &mut [[f32; 2]]) {
        match &self.tail {
            BaseLevels::Plain { red_blue, .. } => out.fill(*red_blue),
            BaseLevels::Isotropic(_) | BaseLevels::Anisotropic(_) if level == 0 => {
                let mut surface = vec![[0.0; 4]; out.len()];
                self.rows.surface(y, &mut surface);
                out.iter_mut().zip(surface).for_each(|(red_blue, [red, _, blue, _])| *red_blue = [red, blue]);
            }
            _ => {
                let mut texels = vec![BaseTexel::default(); out.len()];
                self.row(level, y, &mut texels);
                out.iter_mut().zip(texels).for_each(|(red_blue, [.., red, blue])| *red_blue = [red, blue]);
            }
        }
    }

    /// The average of all texels.
    pub fn whole(&self) -> BaseTexel {
        let mut texel = [BaseTexel::default()];
        self.row(self.sizes().len() - 1, 0, &mut texel);
        texel[0]
    }
}

/// `direction` made a unit vector and turned; (1, 0) turned when it has no length.
fn rotated([x, y]: [f32; 2], [cos, sin]: [f32; 2]) -> [f32; 2] {
    let length = (x * x + y * y).sqrt();
    let (x, y) = if length > 0.0 { (x / length, y / length) } else { (1.0, 0.0) };
    [x * cos - y * sin, x * sin + y * cos]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Image, Samples};

    /// Of `channels` channels whose red and blue are the same everywhere, but for the last texel's red, if `is_plain` is false.
    fn surface(width: u32, height: u32, channels: u32, is_plain: bool) -> Image {
        let texel = |i: u32| [51, (i * 37 % 251) as u8, 102, 9];
        let mut bytes: Vec<u8> =
            (0..width * height).flat_map(|i| texel(i).into_iter().take(channels as usize)).collect();
        if !is_plain {
            let last = bytes.len() - channels as usize;
            bytes[last] = 52;
        }
        Image { width, height, channels, samples: Samples::U8(bytes) }
    }

    #[test]
    fn one_red_and_blue_make_no_other_lobes() {
        for (image, size) in
            [(surface(16, 8, 3, true), (16, 8)), (surface(7, 5, 4, true), (7, 5)), (surface(4, 4, 3, true), (16, 8))]
        {
            let rows = || BaseRows::new(size.0, size.1, Some(Rgba(&image)), 0.7, None, [Wrap::Repeat; 2]);
            let plain = Base::new(rows());
            assert!(matches!(plain.tail, BaseLevels::Plain { red_blue: [0.2, 0.4], .. }) && plain.is_plain());
            let round = Base::with_levels(rows(), BaseLevels::Isotropic(MipTail::new(&IsotropicRows(&rows()))));
            for (level, (width, height)) in plain.sizes().into_iter().enumerate() {
                for y in 0..height {
                    let texels = [&plain, &round].map(|base| {
                        let mut texels = vec![BaseTexel::default(); width as usize];
                        base.row(level, y, &mut texels);
                        texels
                    });
                    let red_blue = [&plain, &round].map(|base| {
                        let mut red_blue = vec![[0.0; 2]; width as usize];
                        base.red_blue(level, y, &mut red_blue);
                        red_blue
                    });
                    for x in 0..width as usize {
                        let [a, b] = [texels[0][x], texels[1][x]];
                        assert_eq!(a[..3], b[..3], "level {level}, texel {x}, {y}");
                        let is_near = |(a, b): (&f32, &f32)| (a - b).abs() < 1e-6;
                        assert!(
                            a.iter().zip(&b).all(is_near) && red_blue[0][x].iter().zip(&red_blue[1][x]).all(is_near)
                        );
                        assert!(red_blue[1][x].iter().zip(&b[3..]).all(is_near));
                    }
                }
            }
        }
    }

    #[test]
    fn another_red_anywhere_is_not_plain() {
        let image = surface(16, 8, 3, false);
        let base = Base::new(BaseRows::new(16, 8, Some(Rgba(&image)), 1.0, None, [Wrap::Repeat; 2]));
        assert!(matches!(base.tail, BaseLevels::Isotropic(_)) && !base.is_plain());
        let ellipse = || Some(BaseAnisotropy { texture: None, strength: 0.5, rotation: [1.0, 0.0] });
        for is_plain in [true, false] {
            let image = surface(16, 8, 3, is_plain);
            let rows = BaseRows::new(16, 8, Some(Rgba(&image)), 1.0, ellipse(), [Wrap::Repeat; 2]);
            assert_eq!(Base::new(rows).is_plain(), is_plain);
        }
        assert!(Base::new(BaseRows::new(4, 4, None, 1.0, None, [Wrap::Repeat; 2])).is_plain());
    }
}

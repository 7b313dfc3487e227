//! The material's own roughness: what its textures and factors say before any bump is lost.

use crate::image::Rgba;
use crate::lobe::{Anisotropy, Roughness, SquaredAlpha};
use crate::mip::{Coarser, Linear, Rows, Wrap, level_sizes};

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
    pub fn is_elliptical(&self) -> bool {
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
    pub fn greens(&self, y: u32, out: &mut [f32]) {
        match self.roughness.as_ref().map(Linear::unchanged) {
            None => out.fill(1.0),
            Some(Some(texels)) => texels.greens(y, out),
            Some(None) => {
                let mut surface = vec![[0.0; 4]; out.len()];
                self.surface(y, &mut surface);
                out.iter_mut().zip(surface).for_each(|(green, texel)| *green = texel[1]);
            }
        }
    }

    /// Writes row `y` of the texture that holds these lobes, which are round, to `out`: roughness in green, red and blue as they are.
    pub fn round_row(&self, y: u32, out: &mut [[f32; 4]]) {
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
    fn common_sides(&self) -> Option<[f32; 2]> {
        self.roughness.as_ref().map_or(Some([1.0; 2]), |rows| rows.source().common_sides())
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
        if !self.is_elliptical() {
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
type RoundTexel = [f32; 3];

/// The texel with all its numbers.
fn whole_texel([squared_alpha, red, blue]: RoundTexel) -> BaseTexel {
    [squared_alpha, 0.0, squared_alpha, red, blue]
}

/// The rows of a material whose lobes are round.
struct RoundRows<'r, 'a>(&'r BaseRows<'a>);

impl Rows for RoundRows<'_, '_> {
    type Texel = RoundTexel;

    fn width(&self) -> u32 {
        self.0.width
    }

    fn height(&self) -> u32 {
        self.0.height
    }

    fn row(&self, y: u32, out: &mut [RoundTexel]) {
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
        self.0.greens(y, out.as_flattened_mut());
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
        coarser: Coarser<[f32; 1]>,
        /// Red and blue.
        sides: [f32; 2],
    },
    /// Round lobes, of three numbers instead of five.
    Round(Coarser<RoundTexel>),
    /// Lobes that are ellipses.
    Elliptical(Coarser<BaseTexel>),
}

impl BaseLevels {
    /// Those over `rows`.
    pub fn new(rows: &BaseRows<'_>) -> Self {
        if rows.roughness.is_none() && rows.direction.is_none() {
            Self::Same
        } else if rows.is_elliptical() {
            Self::Elliptical(Coarser::new(rows))
        } else if let Some(sides) = rows.common_sides() {
            Self::Plain { coarser: Coarser::new(&PlainRows(rows)), sides }
        } else {
            Self::Round(Coarser::new(&RoundRows(rows)))
        }
    }
}

/// A material's own lobe with all its levels.
pub struct Base<'a> {
    rows: BaseRows<'a>,
    coarser: BaseLevels,
}

impl<'a> Base<'a> {
    /// All levels over `rows`.
    pub fn new(rows: BaseRows<'a>) -> Self {
        let coarser = BaseLevels::new(&rows);
        Self { rows, coarser }
    }

    /// The same, where `coarser` has been made of `rows` before.
    pub fn with_levels(rows: BaseRows<'a>, coarser: BaseLevels) -> Self {
        Self { rows, coarser }
    }

    /// Level 0.
    pub fn finest(&self) -> &BaseRows<'a> {
        &self.rows
    }

    /// Whether red and blue of the roughness texture are the same everywhere.
    pub fn is_plain(&self) -> bool {
        match self.coarser {
            BaseLevels::Same | BaseLevels::Plain { .. } => true,
            BaseLevels::Round(_) => false,
            BaseLevels::Elliptical(_) => self.rows.common_sides().is_some(),
        }
    }

    /// Sizes of all levels, level 0 first.
    pub fn sizes(&self) -> Vec<(u32, u32)> {
        level_sizes(self.rows.width, self.rows.height)
    }

    /// Writes row `y` of `level` to `out`.
    pub fn row(&self, level: usize, y: u32, out: &mut [BaseTexel]) {
        match &self.coarser {
            BaseLevels::Same => self.rows.row(0, out),
            BaseLevels::Plain { .. } | BaseLevels::Round(_) if level == 0 => self.rows.row(y, out),
            BaseLevels::Plain { coarser, sides: [red, blue] } => {
                coarser.with_row(&PlainRows(&self.rows), level, y, |row| {
                    out.iter_mut().zip(row).for_each(|(texel, [alpha])| *texel = whole_texel([*alpha, *red, *blue]));
                });
            }
            BaseLevels::Round(coarser) => {
                coarser.with_row(&RoundRows(&self.rows), level, y, |row| {
                    out.iter_mut().zip(row).for_each(|(texel, round)| *texel = whole_texel(*round));
                });
            }
            BaseLevels::Elliptical(coarser) => coarser.row(&self.rows, level, y, out),
        }
    }

    /// Writes the red and blue of row `y` of `level` to `out`.
    pub fn sides(&self, level: usize, y: u32, out: &mut [[f32; 2]]) {
        match &self.coarser {
            BaseLevels::Plain { sides, .. } => out.fill(*sides),
            BaseLevels::Round(_) | BaseLevels::Elliptical(_) if level == 0 => {
                let mut surface = vec![[0.0; 4]; out.len()];
                self.rows.surface(y, &mut surface);
                out.iter_mut().zip(surface).for_each(|(sides, [red, _, blue, _])| *sides = [red, blue]);
            }
            _ => {
                let mut texels = vec![BaseTexel::default(); out.len()];
                self.row(level, y, &mut texels);
                out.iter_mut().zip(texels).for_each(|(sides, [.., red, blue])| *sides = [red, blue]);
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
            assert!(matches!(plain.coarser, BaseLevels::Plain { sides: [0.2, 0.4], .. }) && plain.is_plain());
            let round = Base::with_levels(rows(), BaseLevels::Round(Coarser::new(&RoundRows(&rows()))));
            for (level, (width, height)) in plain.sizes().into_iter().enumerate() {
                for y in 0..height {
                    let texels = [&plain, &round].map(|base| {
                        let mut texels = vec![BaseTexel::default(); width as usize];
                        base.row(level, y, &mut texels);
                        texels
                    });
                    let sides = [&plain, &round].map(|base| {
                        let mut sides = vec![[0.0; 2]; width as usize];
                        base.sides(level, y, &mut sides);
                        sides
                    });
                    for x in 0..width as usize {
                        let [a, b] = [texels[0][x], texels[1][x]];
                        assert_eq!(a[..3], b[..3], "level {level}, texel {x}, {y}");
                        let is_near = |(a, b): (&f32, &f32)| (a - b).abs() < 1e-6;
                        assert!(a.iter().zip(&b).all(is_near) && sides[0][x].iter().zip(&sides[1][x]).all(is_near));
                        assert!(sides[1][x].iter().zip(&b[3..]).all(is_near));
                    }
                }
            }
        }
    }

    #[test]
    fn another_red_anywhere_is_not_plain() {
        let image = surface(16, 8, 3, false);
        let base = Base::new(BaseRows::new(16, 8, Some(Rgba(&image)), 1.0, None, [Wrap::Repeat; 2]));
        assert!(matches!(base.coarser, BaseLevels::Round(_)) && !base.is_plain());
        let ellipse = || Some(BaseAnisotropy { texture: None, strength: 0.5, rotation: [1.0, 0.0] });
        for is_plain in [true, false] {
            let image = surface(16, 8, 3, is_plain);
            let rows = BaseRows::new(16, 8, Some(Rgba(&image)), 1.0, ellipse(), [Wrap::Repeat; 2]);
            assert_eq!(Base::new(rows).is_plain(), is_plain);
        }
        assert!(Base::new(BaseRows::new(4, 4, None, 1.0, None, [Wrap::Repeat; 2])).is_plain());
    }
}

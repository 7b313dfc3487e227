//! The material's own roughness: what its textures and factors say before any bump is lost.

use rayon::prelude::*;

use crate::bump::Wrap;
use crate::lobe::{Anisotropy, Roughness, SquaredAlpha};
use crate::map::Rgba;
use crate::pyramid::{Coarser, Linear, Rows, level_sizes};

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

    /// Whether red and blue of the roughness texture are the same everywhere.
    pub fn is_plain(&self) -> bool {
        let Some(rows) = &self.roughness else { return true };
        let row = |y: u32| {
            let mut row = vec![[0.0; 4]; self.width as usize];
            rows.row(y, &mut row);
            row
        };
        let sides = |texel: &[f32; 4]| [texel[0], texel[2]];
        let first = row(0).first().map(sides);
        (0..self.height).into_par_iter().all(|y| row(y).iter().all(|texel| Some(sides(texel)) == first))
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

/// Levels 1 and coarser of a material's own lobe.
pub enum BaseLevels {
    /// Without textures all texels are the same.
    Same,
    /// Round lobes, of three numbers instead of five.
    Round(Coarser<RoundTexel>),
    /// Lobes that are ellipses.
    Elliptical(Coarser<BaseTexel>),
}

impl BaseLevels {
    /// Those over `rows`.
    pub fn new(rows: &BaseRows<'_>) -> Self {
        match (rows.roughness.is_some() || rows.direction.is_some(), rows.is_elliptical()) {
            (false, _) => Self::Same,
            (true, false) => Self::Round(Coarser::new(&RoundRows(rows))),
            (true, true) => Self::Elliptical(Coarser::new(rows)),
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

    /// Sizes of all levels, level 0 first.
    pub fn sizes(&self) -> Vec<(u32, u32)> {
        level_sizes(self.rows.width, self.rows.height)
    }

    /// Writes row `y` of `level` to `out`.
    pub fn row(&self, level: usize, y: u32, out: &mut [BaseTexel]) {
        match &self.coarser {
            BaseLevels::Same => self.rows.row(0, out),
            BaseLevels::Round(_) if level == 0 => self.rows.row(y, out),
            BaseLevels::Round(coarser) => {
                coarser.with_row(&RoundRows(&self.rows), level, y, |row| {
                    out.iter_mut().zip(row).for_each(|(texel, round)| *texel = whole_texel(*round));
                });
            }
            BaseLevels::Elliptical(coarser) => coarser.row(&self.rows, level, y, out),
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

//! The base lobe: the roughness and anisotropy that a material's textures and factors give it before any bump is lost.

use crate::image::Rgba;
use crate::lobe::{Anisotropy, Roughness, SquaredAlpha};
use crate::material::metalness::{ColouredRows, MetalnessLevels};
use crate::material::reflectance::ReflectanceRows;
use crate::math::symmetric::Symmetric2;
use crate::mip::{LinearResampled, MipTail, TexelRows, Wrap, level_sizes};

/// A texel of the base lobe: A (uu, uv, vv), then the red and blue channels of the roughness texture. Mips of isotropic
/// lobes have the mean roughness, as mips of the material's own texture have it, and mips of anisotropic lobes the mean
/// A. Where metalness and base colour both vary, the mean of blue, the metalness, is weighted by base colour.
pub type BaseTexel = [f32; 5];

/// Returns the base lobe of a texel.
pub fn base_lobe(texel: &BaseTexel) -> SquaredAlpha {
    SquaredAlpha(Symmetric2::new(texel[0], texel[1], texel[2]))
}

/// The anisotropy of the base lobe (`KHR_materials_anisotropy`).
pub struct BaseAnisotropy<'a> {
    /// Direction in red and green, strength in blue; constant (1, 1/2, 1) when absent.
    pub texture: Option<Rgba<'a>>,
    /// Multiplies the texture's strength.
    pub strength: f32,
    /// Cosine and sine of the rotation of the direction, counter-clockwise.
    pub rotation: [f32; 2],
}

/// Level 0 of the base lobe on a grid of texels.
#[derive(Clone)]
pub struct BaseRows<'a> {
    width: u32,
    height: u32,
    roughness_factor: f32,
    roughness: Option<LinearResampled<Rgba<'a>>>,
    strength: f32,
    rotation: [f32; 2],
    direction: Option<LinearResampled<Rgba<'a>>>,
    reflectance: Option<ReflectanceRows<'a>>,
}

impl<'a> BaseRows<'a> {
    /// Puts the base lobe on a grid of `width` x `height` texels. Smaller textures are magnified as a sampler does. The
    /// roughness is the green channel of `roughness` times `roughness_factor`; `wrap` is the sampler's mode across and
    /// down.
    pub fn new(
        width: u32,
        height: u32,
        roughness: Option<Rgba<'a>>,
        roughness_factor: f32,
        anisotropy: Option<BaseAnisotropy<'a>>,
        wrap: [Wrap; 2],
    ) -> Self {
        let on_grid = |rows| LinearResampled::new(rows, width, height, wrap);
        let (strength, rotation, direction) = match anisotropy {
            None => (0.0, [1.0, 0.0], None),
            Some(a) => (a.strength, a.rotation, a.texture.map(on_grid)),
        };
        let roughness = roughness.map(on_grid);
        Self { width, height, roughness_factor, roughness, strength, rotation, direction, reflectance: None }
    }

    /// Adds the reflectance, which is on the grid of the base lobe; `None` if the reflectance is constant.
    pub fn with_reflectance(self, reflectance: Option<ReflectanceRows<'a>>) -> Self {
        Self { reflectance, ..self }
    }
}

impl BaseRows<'_> {
    /// Returns whether the base lobe is anisotropic.
    pub fn is_anisotropic(&self) -> bool {
        self.strength > 0.0
    }

    /// Returns whether all texels have the same reflectance.
    pub fn is_reflectance_constant(&self) -> bool {
        self.reflectance.is_none()
    }

    /// Writes the reflectance of row `y` to `out`, in [0, 1]; 1 if the reflectance is constant.
    pub fn reflectance_row(&self, y: u32, out: &mut [f32]) {
        match &self.reflectance {
            Some(rows) => rows.row(y, out),
            None => out.fill(1.0),
        }
    }

    /// Writes the texels of row `y` of the roughness texture to `out`; 1 in every channel without a texture.
    fn texture_row(&self, y: u32, out: &mut [[f32; 4]]) {
        match &self.roughness {
            Some(rows) => rows.row(y, out),
            None => out.fill([1.0; 4]),
        }
    }

    /// Writes the green channel of row `y` of the roughness texture to `out`; 1 without a texture.
    pub fn green_row(&self, y: u32, out: &mut [f32]) {
        match self.roughness.as_ref().map(LinearResampled::unchanged) {
            None => out.fill(1.0),
            Some(Some(image)) => image.green(y, out),
            Some(None) => {
                let mut texels = vec![[0.0; 4]; out.len()];
                self.texture_row(y, &mut texels);
                out.iter_mut().zip(texels).for_each(|(green, texel)| *green = texel[1]);
            }
        }
    }

    /// Writes row `y` of the roughness texture of isotropic base lobes to `out`: the roughness with its factor in
    /// green, red and blue unchanged.
    pub fn isotropic_row(&self, y: u32, out: &mut [[f32; 4]]) {
        self.texture_row(y, out);
        out.iter_mut().for_each(|texel| texel[1] = self.roughness(texel[1]).0);
    }

    #[inline(always)]
    fn roughness(&self, green: f32) -> Roughness {
        Roughness((green * self.roughness_factor).clamp(0.0, 1.0))
    }

    /// Returns the squared alpha of an isotropic base lobe whose texture has `green`.
    #[inline(always)]
    pub fn squared_alpha(&self, green: f32) -> f32 {
        SquaredAlpha::isotropic(self.roughness(green).into()).0.uu
    }

    /// Returns columns and rows of the material's own roughness texture.
    pub fn texture_size(&self) -> Option<(u32, u32)> {
        self.roughness.as_ref().map(|rows| (rows.source().width(), rows.source().height()))
    }

    /// Returns whether a texture varies the roughness, or a metalness that counts by base colour.
    pub fn has_varying_texture(&self) -> bool {
        let varies = |rows: &LinearResampled<Rgba<'_>>| rows.source().common_green().is_none();
        self.roughness.as_ref().is_some_and(varies) || self.coloured().is_some()
    }

    /// Returns the metalness with the base colour by which it counts, if both vary.
    fn coloured(&self) -> Option<ColouredRows<'_, '_>> {
        ColouredRows::new(self.roughness.as_ref()?, self.reflectance.as_ref()?)
    }

    /// Returns red and blue of the roughness texture if they are constant.
    fn constant_red_blue(&self) -> Option<[f32; 2]> {
        self.roughness.as_ref().map_or(Some([1.0; 2]), |rows| rows.source().common_red_blue())
    }
}

impl TexelRows for BaseRows<'_> {
    type Texel = BaseTexel;

    fn width(&self) -> u32 {
        self.width
    }

    fn height(&self) -> u32 {
        self.height
    }

    fn row(&self, y: u32, out: &mut [BaseTexel]) {
        let mut texels = vec![[0.0; 4]; out.len()];
        self.texture_row(y, &mut texels);
        if !self.is_anisotropic() {
            for (texel, [red, green, blue, _]) in out.iter_mut().zip(texels) {
                *texel = base_texel([self.roughness(green).0, red, blue]);
            }
            return;
        }
        // The texel that glTF defines for a material without an anisotropy texture.
        let mut direction = vec![[1.0, 0.5, 1.0, 1.0]; out.len()];
        if let Some(rows) = &self.direction {
            rows.row(y, &mut direction);
        }
        for ((texel, [red, green, blue, _]), axis) in out.iter_mut().zip(texels).zip(direction) {
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

/// A texel of an isotropic base lobe: roughness, red and blue.
type IsotropicTexel = [f32; 3];

/// Returns an isotropic texel as a [`BaseTexel`].
fn base_texel([roughness, red, blue]: IsotropicTexel) -> BaseTexel {
    let SquaredAlpha(a) = SquaredAlpha::isotropic(Roughness(roughness).into());
    [a.uu, 0.0, a.vv, red, blue]
}

/// Level 0 of isotropic base lobes.
struct IsotropicRows<'r, 'a>(&'r BaseRows<'a>);

impl TexelRows for IsotropicRows<'_, '_> {
    type Texel = IsotropicTexel;

    fn width(&self) -> u32 {
        self.0.width
    }

    fn height(&self) -> u32 {
        self.0.height
    }

    fn row(&self, y: u32, out: &mut [IsotropicTexel]) {
        let mut texels = vec![[0.0; 4]; out.len()];
        self.0.texture_row(y, &mut texels);
        for (texel, [red, green, blue, _]) in out.iter_mut().zip(texels) {
            *texel = [self.0.roughness(green).0, red, blue];
        }
    }
}

/// Level 0 of isotropic base lobes without red and blue: roughness alone.
struct RoughnessRows<'r, 'a>(&'r BaseRows<'a>);

impl TexelRows for RoughnessRows<'_, '_> {
    type Texel = [f32; 1];

    fn width(&self) -> u32 {
        self.0.width
    }

    fn height(&self) -> u32 {
        self.0.height
    }

    fn row(&self, y: u32, out: &mut [[f32; 1]]) {
        self.0.green_row(y, out.as_flattened_mut());
        out.iter_mut().for_each(|[texel]| *texel = self.0.roughness(*texel).0);
    }
}

/// Levels 1 and coarser of the base lobe.
pub struct BaseLevels {
    texels: TexelLevels,
    /// Blue, where it counts by base colour.
    metalness: Option<MetalnessLevels>,
}

impl BaseLevels {
    /// Builds the levels over `rows`.
    pub fn new(rows: &BaseRows<'_>) -> Self {
        let metalness = rows.coloured().map(|rows| MetalnessLevels::new(&rows));
        Self { texels: TexelLevels::new(rows), metalness }
    }
}

/// Levels 1 and coarser, with as few numbers for each texel as the lobe needs.
enum TexelLevels {
    /// Without textures all texels are equal.
    Uniform,
    /// Isotropic lobes, where red and blue of the roughness texture are constant.
    ConstantRedBlue {
        /// Roughness.
        tail: MipTail<[f32; 1]>,
        /// Red and blue.
        red_blue: [f32; 2],
    },
    /// Isotropic lobes: three numbers for a texel instead of five.
    Isotropic(MipTail<IsotropicTexel>),
    /// Anisotropic lobes.
    Anisotropic(MipTail<BaseTexel>),
}

impl TexelLevels {
    fn new(rows: &BaseRows<'_>) -> Self {
        if rows.roughness.is_none() && rows.direction.is_none() {
            Self::Uniform
        } else if rows.is_anisotropic() {
            Self::Anisotropic(MipTail::new(rows))
        } else if let Some(red_blue) = rows.constant_red_blue() {
            Self::ConstantRedBlue { tail: MipTail::new(&RoughnessRows(rows)), red_blue }
        } else {
            Self::Isotropic(MipTail::new(&IsotropicRows(rows)))
        }
    }
}

/// The base lobe with all its levels.
pub struct Base<'a> {
    rows: BaseRows<'a>,
    levels: BaseLevels,
}

impl<'a> Base<'a> {
    /// Builds all levels over `rows`.
    pub fn new(rows: BaseRows<'a>) -> Self {
        let levels = BaseLevels::new(&rows);
        Self { rows, levels }
    }

    /// Joins `rows` with `levels`, which were built of equal rows before.
    pub fn with_levels(rows: BaseRows<'a>, levels: BaseLevels) -> Self {
        Self { rows, levels }
    }

    /// Returns level 0.
    pub fn level_0(&self) -> &BaseRows<'a> {
        &self.rows
    }

    /// Returns whether red and blue of the roughness texture are constant.
    pub fn has_constant_red_blue(&self) -> bool {
        match self.levels.texels {
            TexelLevels::Uniform | TexelLevels::ConstantRedBlue { .. } => true,
            TexelLevels::Isotropic(_) => false,
            TexelLevels::Anisotropic(_) => self.rows.constant_red_blue().is_some(),
        }
    }

    /// Returns whether mips have the mean A, and not the mean roughness.
    pub fn has_mean_squared_alphas(&self) -> bool {
        matches!(self.levels.texels, TexelLevels::Uniform | TexelLevels::Anisotropic(_))
    }

    /// Returns the sizes of all levels, level 0 first.
    pub fn sizes(&self) -> Vec<(u32, u32)> {
        level_sizes(self.rows.width, self.rows.height)
    }

    /// Writes row `y` of `level` to `out`.
    pub fn row(&self, level: usize, y: u32, out: &mut [BaseTexel]) {
        match &self.levels.texels {
            TexelLevels::Uniform => self.rows.row(0, out),
            TexelLevels::ConstantRedBlue { .. } | TexelLevels::Isotropic(_) if level == 0 => self.rows.row(y, out),
            TexelLevels::ConstantRedBlue { tail, red_blue: [red, blue] } => {
                tail.with_row(&RoughnessRows(&self.rows), level, y, |row| {
                    out.iter_mut()
                        .zip(row)
                        .for_each(|(texel, [roughness])| *texel = base_texel([*roughness, *red, *blue]));
                });
            }
            TexelLevels::Isotropic(tail) => {
                tail.with_row(&IsotropicRows(&self.rows), level, y, |row| {
                    out.iter_mut().zip(row).for_each(|(texel, isotropic)| *texel = base_texel(*isotropic));
                });
            }
            TexelLevels::Anisotropic(tail) => tail.row(&self.rows, level, y, out),
        }
        if let (Some(levels), Some(rows), 1..) = (&self.levels.metalness, self.rows.coloured(), level) {
            levels.row(&rows, level, y, |x, metalness| out[x][4] = metalness);
        }
    }

    /// Writes the red and blue of row `y` of `level` to `out`.
    pub fn red_blue(&self, level: usize, y: u32, out: &mut [[f32; 2]]) {
        match &self.levels.texels {
            TexelLevels::ConstantRedBlue { red_blue, .. } => out.fill(*red_blue),
            TexelLevels::Isotropic(_) | TexelLevels::Anisotropic(_) if level == 0 => {
                let mut texels = vec![[0.0; 4]; out.len()];
                self.rows.texture_row(y, &mut texels);
                out.iter_mut().zip(texels).for_each(|(red_blue, [red, _, blue, _])| *red_blue = [red, blue]);
            }
            _ => {
                let mut texels = vec![BaseTexel::default(); out.len()];
                self.row(level, y, &mut texels);
                out.iter_mut().zip(texels).for_each(|(red_blue, [.., red, blue])| *red_blue = [red, blue]);
            }
        }
    }

    /// Returns the texel of the coarsest level.
    pub fn coarsest(&self) -> BaseTexel {
        let mut texel = [BaseTexel::default()];
        self.row(self.sizes().len() - 1, 0, &mut texel);
        texel[0]
    }
}

/// Normalises and rotates a direction. A direction without length counts as (1, 0).
fn rotated([x, y]: [f32; 2], [cos, sin]: [f32; 2]) -> [f32; 2] {
    let length = (x * x + y * y).sqrt();
    let (x, y) = if length > 0.0 { (x / length, y / length) } else { (1.0, 0.0) };
    [x * cos - y * sin, x * sin + y * cos]
}

#[cfg(test)]
mod tests;

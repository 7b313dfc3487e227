//! The base lobe together with the lobes that its bumps roughen it to, texel by texel. `lobes.rs` does the roughening.

use crate::bump::Moments;
use crate::lobe::SquaredAlpha;
use crate::material::base::{Base, BaseTexel, base_lobe};
use crate::material::bump_map::BumpMap;
use crate::material::bumps::Bumps;
use crate::material::lobes::Lobes;
use crate::math::symmetric::Symmetric2;
use crate::mip::{AreaResampled, MipTail, Sampler};
use crate::settings::Settings;

/// The largest ratio of the trace of K to the variance of the bumps, where the base lobe varies. If all parts of a
/// footprint have one base lobe, bumps do not widen a lobe more (`crates/pipeline/src/check/pyramid_levels.rs` has the
/// proof). Parts with different roughness may.
const MOST_VARIANCE: f32 = 1.5;

/// A lobe that the pyramid profile adds K to.
pub struct PyramidBase {
    /// The lobe.
    pub lobe: SquaredAlpha,
    /// The most that the trace of K may be; infinite where the material's own texture has the lobe.
    pub most_variance: f32,
}

/// A base lobe and the lobes that its bumps roughen it to.
pub struct Roughening<'a> {
    base: Base<'a>,
    lobes: Lobes<'a>,
    /// Levels at which [`Self::roughened_row`] returns the base lobes.
    base_levels: Vec<usize>,
    /// Moments of the bumps, if the pyramid profile needs a texture of the base lobe ([`Self::needs_base_texture`]).
    moments: Option<(AreaResampled<&'a BumpMap>, MipTail<Moments>)>,
}

impl<'a> Roughening<'a> {
    /// Roughens `base` by `bumps` on the same grid. `slope_scale` multiplies offsets (`normalTexture.scale`), and
    /// `sampler` says how engines read level 0.
    pub fn new<'b: 'a>(
        base: Base<'a>,
        bumps: &Bumps<'b>,
        slope_scale: f32,
        sampler: Sampler,
        settings: &Settings,
    ) -> Self {
        let lobes = Lobes::new(&base, bumps, slope_scale, sampler, settings);
        let is_isotropic = !base.level_0().is_anisotropic();
        let needs_base_texture = settings.profile.has_pyramid() && is_isotropic && base.level_0().has_varying_texture();
        let moments = needs_base_texture.then(|| (bumps.rows, MipTail::new(&bumps.rows)));
        Self { base, lobes, base_levels: Vec::new(), moments }
    }

    /// Keeps the base lobe at `levels`.
    pub fn with_base_levels(self, levels: &[usize]) -> Self {
        Self { base_levels: levels.to_vec(), ..self }
    }

    /// Returns whether the roughened lobes of `level` are the base lobes.
    pub fn is_base(&self, level: usize) -> bool {
        self.lobes.are_base(level) || self.base_levels.contains(&level)
    }

    /// Frees the memory on two threads. The system takes memory back page by page, for 30 ms after 4096 x 4096.
    pub fn free(self) {
        rayon::join(|| drop(self.base), || drop(self.lobes));
    }

    /// Returns the base lobe of all levels.
    pub fn base(&self) -> &Base<'a> {
        &self.base
    }

    /// Returns the roughened lobes of all levels.
    pub fn lobes(&self) -> &Lobes<'a> {
        &self.lobes
    }

    /// Returns the sizes of all levels, level 0 first.
    pub fn sizes(&self) -> Vec<(u32, u32)> {
        self.base.sizes()
    }

    /// Returns whether the base lobe is anisotropic.
    pub fn is_anisotropic(&self) -> bool {
        self.base.level_0().is_anisotropic()
    }

    /// Returns the axis of the lobe of the whole map. The signs of all stored directions agree with it.
    pub fn reference_axis(&self) -> [f32; 2] {
        self.lobes.coarsest().squared_alpha.0.eigen().axis
    }

    /// Returns the roughened lobes of row `y` of `level`, which has `width` texels.
    pub fn roughened_row(&self, level: usize, y: u32, width: usize) -> Vec<SquaredAlpha> {
        if self.is_base(level) {
            return self.base_row(level, y, width);
        }
        let mut lobes = vec![SquaredAlpha::default(); width];
        self.lobes.squared_alphas(level, y, &mut lobes);
        lobes
    }

    /// Returns whether the pyramid profile needs a texture of the base lobe: its mips then are not those of the
    /// material's own texture. An anisotropic base lobe keeps its textures.
    pub fn needs_base_texture(&self) -> bool {
        self.moments.is_some()
    }

    /// Returns the lobes that the pyramid profile adds K to, in row `y` of `level`. `roughened` are the roughened lobes
    /// of that row.
    ///
    /// They can be narrower than the base lobe of the mean roughness, since texels count by reflectance, and since one
    /// of two parts of a footprint can decide the lobe. K cannot be negative, so that the base lobe then has the
    /// smaller squared alpha of the roughened lobe. They can also be wider than the bumps make them. The base lobe then
    /// has what is left: plugins take K for facets of the base lobe.
    pub fn pyramid_base_row(&self, level: usize, y: u32, roughened: &[SquaredAlpha]) -> Vec<PyramidBase> {
        let base = self.base_row(level, y, roughened.len());
        let Some((level_0, tail)) = self.moments.as_ref().filter(|_| level > 0) else {
            return base.into_iter().map(|lobe| PyramidBase { lobe, most_variance: f32::INFINITY }).collect();
        };
        let mut bumps = vec![Moments::default(); roughened.len()];
        tail.row(level_0, level, y, &mut bumps);
        let scale = self.lobes.slope_scale() * self.lobes.slope_scale();
        let of_texel =
            |((SquaredAlpha(base), SquaredAlpha(roughened)), bumps): ((SquaredAlpha, &SquaredAlpha), Moments)| {
                let smaller = roughened.eigen().minor.clamp(0.0, 1.0);
                // The squared alpha of the closest isotropic lobe, without what bumps can add to it.
                let isotropic = roughened.determinant().max(0.0).sqrt().min(1.0);
                let without_bumps = isotropic - 2.0 * scale * bumps.covariance.eigen().major;
                let squared = base.uu.min(smaller).max(without_bumps);
                let lobe = SquaredAlpha(Symmetric2::diagonal(squared, squared));
                PyramidBase { lobe, most_variance: MOST_VARIANCE * scale * bumps.covariance.trace() }
            };
        base.into_iter().zip(roughened).zip(bumps).map(of_texel).collect()
    }

    /// Returns the base lobes of row `y` of `level`, which has `width` texels.
    pub fn base_row(&self, level: usize, y: u32, width: usize) -> Vec<SquaredAlpha> {
        let mut texels = vec![BaseTexel::default(); width];
        self.base.row(level, y, &mut texels);
        texels.iter().map(base_lobe).collect()
    }
}

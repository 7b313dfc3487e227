//! Step 5: the lobes of every level of a layer.

use std::borrow::Cow;

use crate::bake::offsets::{MapOffsets, size_of};
use crate::bake::reflectance::ReflectanceInput;
use crate::image::{Image, Rgba};
use crate::lobe::{Alpha, Roughness};
use crate::material::{
    Base, BaseAnisotropy, BaseLevels, BaseRows, BumpMap, Bumps, GridError, LobeLevels, Roughening, base_lobe, grid,
    lost_variance_of_lobes,
};
use crate::metric::MIN_ALPHA;
use crate::mip::Wrap;
use crate::note::Note;
use crate::settings::{Model, Settings};

/// The textures and factors of a base lobe.
pub struct BaseInput<'a> {
    /// Green is roughness; constant 1 without a texture.
    pub roughness: Option<Cow<'a, Image>>,
    /// Multiplies the roughness.
    pub roughness_factor: f32,
    /// The anisotropy, if there is any.
    pub anisotropy: Option<AnisotropyInput>,
    /// The reflectance; none if it is constant.
    pub reflectance: Option<ReflectanceInput>,
    /// The sampler's mode, across and down.
    pub wrap: [Wrap; 2],
}

/// The texture and factors of the anisotropy of a base lobe.
pub struct AnisotropyInput {
    /// Direction in red and green, strength in blue.
    pub texture: Option<Image>,
    /// Multiplies the strength.
    pub strength: f32,
    /// Angle that is added to the direction, in radians.
    pub rotation: f32,
}

impl BaseInput<'_> {
    /// Returns the smallest grid that holds the textures of the base lobe and `bump_map`.
    pub fn grid(&self, settings: &Settings, bump_map: Option<&BumpMap>) -> Result<(u32, u32), GridError> {
        let anisotropy = self.anisotropy.as_ref().and_then(|anisotropy| anisotropy.texture.as_ref());
        let images = [self.roughness.as_deref(), anisotropy].into_iter().flatten();
        grid(settings, images.map(|image| (image.width, image.height)).chain(bump_map.map(size_of)))
    }

    /// Returns the mean alpha, at least [`MIN_ALPHA`]. For anisotropic lobes it is the alpha of the narrower axis.
    pub fn mean_alpha(&self) -> f64 {
        let alpha = |green: f32| f64::from(Alpha::from(Roughness((green * self.roughness_factor).clamp(0.0, 1.0))).0);
        let mean = match self.roughness.as_deref() {
            None => alpha(1.0),
            Some(image) => {
                let mut greens = vec![0.0; image.width as usize];
                let sums = (0..image.height).map(|y| {
                    Rgba(image).green(y, &mut greens);
                    greens.iter().map(|green| alpha(*green)).sum::<f64>()
                });
                sums.sum::<f64>() / (f64::from(image.width) * f64::from(image.height))
            }
        };
        mean.max(MIN_ALPHA)
    }

    /// Puts the base lobe and its reflectance on a grid of `width` x `height` texels.
    pub fn rows(&self, size: (u32, u32)) -> BaseRows<'_> {
        let (width, height) = size;
        let anisotropy = self.anisotropy.as_ref().map(|anisotropy| {
            let rotation = f64::from(anisotropy.rotation);
            BaseAnisotropy {
                texture: anisotropy.texture.as_ref().map(Rgba),
                strength: anisotropy.strength,
                rotation: [libm::cos(rotation) as f32, libm::sin(rotation) as f32],
            }
        });
        let roughness = self.roughness.as_deref();
        let reflectance = self.reflectance.as_ref().and_then(|input| input.rows(size, self.wrap, roughness));
        let rgba = roughness.map(Rgba);
        BaseRows::new(width, height, rgba, self.roughness_factor, anisotropy, self.wrap).with_reflectance(reflectance)
    }
}

/// A base lobe with levels that were built while the bump map was decoded.
pub struct PreparedBase<'a> {
    /// The textures and factors.
    pub input: BaseInput<'a>,
    /// Levels on the grid of the base lobe's own textures, with the size of that grid.
    pub levels: Option<((u32, u32), BaseLevels)>,
    /// Why the reflectance is taken to be constant, if an image of it cannot be decoded.
    pub note: Option<Note>,
}

impl<'a> PreparedBase<'a> {
    /// Builds the levels on the grid of the base lobe's own textures. Mostly the bumps are on that grid, too.
    pub fn with_levels(self, settings: &Settings) -> Result<Self, GridError> {
        let size = self.input.grid(settings, None)?;
        let levels = BaseLevels::new(&self.input.rows(size));
        Ok(Self { levels: Some((size, levels)), ..self })
    }
}

/// A layer of a material, or several layers that share their lobes.
pub struct LayerInput<'a> {
    /// The base lobe.
    pub base: PreparedBase<'a>,
    /// The grid of the lobes.
    pub size: (u32, u32),
    /// Whether bumps can be added to the base lobe texel by texel.
    pub can_be_roughened: bool,
    /// Whether the core material keeps its lobe.
    pub keeps_core_lobe: bool,
    /// Multiplies offsets.
    pub slope_scale: f32,
    /// Whether the pyramid profile describes the layer.
    pub is_in_pyramid: bool,
    /// The model with the most parameters that the layer can have.
    pub max_model: Model,
    /// The finest level that can be sampled.
    pub finest: usize,
    /// The finest level that is written.
    pub first: usize,
}

/// The lobes of a layer.
pub struct LayerLobes<'a> {
    /// The base lobe and the roughened lobes, if bumps can be added to the base lobe.
    pub roughening: Option<Roughening<'a>>,
    /// The sum over levels 1 and coarser of the mean trace of the K that the lobes need, for the pyramid profile.
    pub needed_variance: Option<f64>,
    /// Whether the lobes are on the grid of the bump map and have bumps.
    can_decide: bool,
}

impl<'a> LayerLobes<'a> {
    /// Roughens the base lobe of `layer` by the bumps of `map`. `levels` are those of the base lobe, on a grid of their
    /// size.
    pub fn new<'m: 'a>(
        map: &MapOffsets<'m>,
        layer: &'a LayerInput<'_>,
        levels: Option<((u32, u32), BaseLevels)>,
    ) -> Self {
        let (settings, slope_scale) = (map.settings, layer.slope_scale);
        let rows = layer.base.input.rows(layer.size);
        let base = match levels {
            Some((size, levels)) if size == layer.size => Base::with_levels(rows, levels),
            _ => Base::new(rows),
        };
        let is_in_pyramid = settings.profile.has_pyramid() && layer.is_in_pyramid;
        let is_roughened = layer.can_be_roughened && (settings.profile.is_portable() || layer.is_in_pyramid);
        let can_decide = is_roughened && map.can_be_decided_by(layer.size, slope_scale);
        let needed = (is_in_pyramid && !can_decide)
            .then(|| map.bumps.corrected_variance(slope_scale, settings, base_lobe(&base.coarsest())));
        let roughening = is_roughened.then(|| {
            let resampled = (layer.size != map.bumps.size()).then(|| Bumps::new(map.bump_map, layer.size));
            Roughening::new(base, resampled.as_ref().unwrap_or(&map.bumps), slope_scale, map.sampler, settings)
        });
        let of_lobes = roughening.as_ref().filter(|_| is_in_pyramid && can_decide).map(lost_variance_of_lobes);
        Self { roughening, needed_variance: needed.or(of_lobes), can_decide }
    }

    /// Keeps the base lobe at `levels`. [`LobeLevels::with_base_levels`] does the same to the levels of the pyramid
    /// profile.
    pub fn with_base_levels(self, levels: &[usize]) -> Self {
        // Summing up the variance takes time.
        if levels.is_empty() {
            return self;
        }
        let roughening = self.roughening.map(|roughening| roughening.with_base_levels(levels));
        let lobes = Self { roughening, ..self };
        let of_lobes = |needed| lobes.deciding().map_or(needed, lost_variance_of_lobes);
        Self { needed_variance: lobes.needed_variance.map(of_lobes), ..lobes }
    }

    /// Returns the lobes if they can decide the directions of the bump map's texels: if they are on its grid.
    pub fn deciding(&self) -> Option<&Roughening<'a>> {
        self.roughening.as_ref().filter(|_| self.can_decide)
    }

    /// Returns the lobes if the pyramid profile needs a texture of the base lobe.
    pub fn with_base_texture(&self) -> Option<&Roughening<'a>> {
        self.needed_variance?;
        self.deciding().filter(|roughening| roughening.needs_base_texture())
    }

    /// Returns the levels of the pyramid profile that these lobes decide.
    pub fn pyramid_levels<'m>(&self, map: &MapOffsets<'m>) -> Option<LobeLevels<'m>> {
        self.needed_variance?;
        self.deciding().map(|roughening| LobeLevels::new(&map.bumps, roughening))
    }
}

//! The candidates for the roughness data of a layer, with their costs.

use crate::codec::PayloadFormat;
use crate::material::{Encoding, Normals, PyramidLevels, Roughening};
use crate::mip::{Wrap, level_sizes};
use crate::settings::{Model, Settings};

/// A layer whose model is to be chosen, and what limits the choice.
pub struct CandidateSet<'a, 'f> {
    /// The base lobe and the bumps that roughen it.
    pub roughening: &'a Roughening<'f>,
    /// The error bound, the requested model and the target.
    pub settings: &'a Settings,
    /// The normal texture of the portable profile, if that profile is written.
    pub normals: Option<&'a Normals<'a>>,
    /// What the pyramid profile stores, if that profile is written.
    pub pyramid: Option<PyramidData<'a>>,
    /// The sampler's mode, across and down.
    pub wrap: [Wrap; 2],
    /// The model with the most parameters that the layer can have.
    pub max_model: Model,
    /// The finest level that can be sampled.
    pub finest: usize,
    /// The finest level that is written.
    pub first: usize,
}

/// What the pyramid profile stores of a layer.
pub struct PyramidData<'a> {
    /// Offsets and K.
    pub levels: &'a dyn PyramidLevels,
    /// The correction factor c.
    pub correction: f32,
    /// Whether a texture has the base lobes that K is added to. Otherwise the material's own texture has them.
    pub has_base_texture: bool,
    /// Whether K may be 0 at some levels, which then keep the base lobe: K is made of the lobes of this layer, and no
    /// other layer uses it.
    pub may_keep_base: bool,
}

impl CandidateSet<'_, '_> {
    /// Returns the models of all candidates, in the order of rising shader cost.
    pub(super) fn models(&self) -> impl Iterator<Item = Model> {
        [Model::None, Model::Isotropic, Model::Anisotropic].into_iter().filter(|model| self.offers(*model))
    }

    /// Returns whether an isotropic roughness texture of `bytes` takes the place of one of the material that takes as
    /// much memory on the GPU, as RGBA with 8 bits and mips.
    pub(super) fn replaces_texture(&self, bytes: u64) -> bool {
        let texture = self.roughening.base().level_0().texture_size();
        let replaced = texture.map_or(0, |(width, height)| 4 * mip_texels(width, height));
        self.pyramid.is_none() && bytes <= replaced
    }

    fn offers(&self, model: Model) -> bool {
        match model {
            // An anisotropic base lobe stays anisotropic unless the isotropic model is requested.
            Model::Isotropic => {
                !self.roughening.is_anisotropic()
                    || self.max_model == Model::Isotropic
                    || self.settings.model == Model::Isotropic
            }
            model => model <= self.max_model,
        }
    }

    /// Returns the levels that may become level 0 of the roughness data, coarsest first: quarter, half and full size.
    pub(super) fn first_levels(&self, model: Model, sizes: &[(u32, u32)]) -> Vec<usize> {
        let encoding = Encoding::of(self.settings, 3);
        let fits = |first: usize| {
            first == self.first || first < sizes.len() && encoding.starting_at(first).first(sizes) == first
        };
        let may_shrink = model != Model::None
            && self.settings.model == Model::Auto
            && self.roughening.base().has_constant_red_blue();
        let last = self.first + if may_shrink { 2 } else { 0 };
        (self.first..=last).rev().filter(|first| fits(*first)).collect()
    }

    /// Returns the bytes of the roughness data on the GPU.
    pub(super) fn bytes(&self, model: Model, first: usize, sizes: &[(u32, u32)]) -> u64 {
        let target = self.settings.target;
        let of = |format: PayloadFormat, first: usize| {
            sizes[first..].iter().map(|s| format.level_bytes(s.0, s.1) as u64).sum::<u64>()
        };
        let portable = match model {
            Model::Isotropic => of(target.format(3), first),
            Model::Anisotropic => 2 * of(target.format(3), first),
            _ => 0,
        };
        let pyramid = match (&self.pyramid, model) {
            (None, _) | (_, Model::None | Model::Auto) => 0,
            (Some(pyramid), model) => {
                let base = if pyramid.has_base_texture { of(target.format(3), self.first) } else { 0 };
                base + of(target.format(if model == Model::Isotropic { 1 } else { 3 }), first)
            }
        };
        u64::from(self.normals.is_some()) * portable + pyramid
    }
}

/// Returns the texels of all levels of a texture.
fn mip_texels(width: u32, height: u32) -> u64 {
    level_sizes(width, height).into_iter().map(|(width, height)| u64::from(width) * u64::from(height)).sum()
}

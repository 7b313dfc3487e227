//! Step 6: the model of a layer's roughness data is chosen.

use crate::bake::lobes::{LayerInput, LayerLobes};
use crate::bake::offsets::MapOffsets;
use crate::material::{LobeLevels, Normals, PyramidLevels, correction_factor, lost_variance};
use crate::report::Choice;
use crate::select::{CandidateSet, PyramidData};
use crate::settings::{Model, Settings};

/// The chosen model of a layer.
pub struct LayerModel {
    /// What is modelled of the lost bumps.
    pub model: Model,
    /// The level that becomes level 0 of the roughness data.
    pub first: usize,
    /// The candidates and their errors, if the base lobe is known texel by texel.
    pub choice: Option<Choice>,
}

/// Returns the candidates of a layer; none if the bumps cannot be added to the base lobe. `normals` is the normal
/// texture of the portable profile, and `pyramid` are the levels of the pyramid profile. `owns_pyramid` says whether
/// these levels are for this layer alone.
pub fn candidates<'a, 'f>(
    map: &'a MapOffsets<'_>,
    layer: &LayerInput<'_>,
    lobes: &'a LayerLobes<'f>,
    normals: Option<&'a Normals<'a>>,
    pyramid: Option<&'a LobeLevels<'_>>,
    owns_pyramid: bool,
) -> Option<CandidateSet<'a, 'f>> {
    let pyramid = lobes.needed_variance.map(|needed| {
        let levels: &dyn PyramidLevels = match pyramid {
            Some(levels) => levels,
            None => map.bumps.moments(),
        };
        let correction = correction_factor(needed, lost_variance(levels));
        let has_base_texture = lobes.with_base_texture().is_some();
        PyramidData { levels, correction, has_base_texture, may_keep_base: owns_pyramid }
    });
    lobes.roughening.as_ref().map(|roughening| CandidateSet {
        roughening,
        settings: map.settings,
        normals,
        pyramid,
        wrap: map.sampler.wrap,
        max_model: layer.max_model,
        finest: layer.finest,
        first: layer.first,
    })
}

impl LayerModel {
    /// Takes the candidate of `choice`. Without a choice the requested model is taken. [`Model::Auto`] then stands for
    /// the model with the most parameters, since the share of the lost bumps that stays visible is not known.
    pub fn new(choice: Option<Choice>, layer: &LayerInput<'_>, settings: &Settings) -> Self {
        let (model, first) = match (choice.as_ref().and_then(Choice::taken), settings.model) {
            (Some(taken), _) => (taken.model, taken.first),
            (None, Model::Auto) => (layer.max_model, layer.first),
            (None, requested) => (requested.min(layer.max_model), layer.first),
        };
        Self { model, first, choice }
    }

    /// Returns the levels at which the chosen candidate keeps the base lobe.
    pub fn base_levels(&self) -> &[usize] {
        self.choice.as_ref().and_then(Choice::taken).map_or(&[], |taken| &taken.base_levels)
    }

    /// Returns the lobe errors of the chosen candidate, level by level; empty without a choice.
    pub fn lobe_errors(&self) -> Vec<f32> {
        self.choice.as_ref().and_then(Choice::taken).map(|taken| taken.errors.clone()).unwrap_or_default()
    }
}

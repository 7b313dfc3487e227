//! Why a level exceeds the error bound, by measurement.

use serde::{Deserialize, Serialize};

use crate::codec::uastc::Effort;
use crate::settings::{Model, Settings};

/// What was measured at a level that exceeds the error bound. Errors are means over the sampled texels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evidence {
    /// Error of the chosen candidate if nothing were lost to encoding.
    pub unencoded: f64,
    /// Error of the chosen candidate if also alphas above 1 could be shown.
    pub unclamped: f64,
    /// Error of the chosen candidate if also its lobe were anisotropic; `None` unless the candidate is isotropic
    /// because the layer cannot be anisotropic.
    pub anisotropic: Option<f64>,
    /// Error of the best single lobe.
    pub oracle: f64,
    /// Share of footprints whose normals have two peaks.
    pub two_peaked: f64,
    /// Share of the area whose slopes are beyond the clamp.
    pub steep: f64,
}

/// Why a level exceeds the error bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
#[non_exhaustive]
pub enum Reason {
    /// Blocks cannot store texels that differ so much.
    Encoding,
    /// The best lobe is wider than an engine can show.
    AlphaAboveOne,
    /// The layer cannot have an anisotropic lobe.
    Isotropic,
    /// Normals point in two directions: a single lobe covers the gap between them.
    TwoPeaked,
    /// Much of the area has slopes beyond the clamp.
    Steep,
    /// No single lobe has the shape of these bumps.
    NoSingleLobe,
    /// A single lobe within the bound exists, but the fit did not find it.
    Fit,
}

impl Evidence {
    /// Returns what explains an error above `max_error`: the first cause without which the error would be within the
    /// bound, or the reason why every lobe exceeds it.
    pub fn reason(&self, max_error: f64) -> Reason {
        let is_within = |error: f64| error <= max_error;
        if is_within(self.unencoded) {
            Reason::Encoding
        } else if is_within(self.unclamped) {
            Reason::AlphaAboveOne
        } else if self.anisotropic.is_some_and(is_within) {
            Reason::Isotropic
        } else if is_within(self.oracle) {
            Reason::Fit
        } else if self.steep > max_error {
            Reason::Steep
        } else if self.two_peaked > 0.5 {
            Reason::TwoPeaked
        } else {
            Reason::NoSingleLobe
        }
    }
}

impl Reason {
    /// Returns what comes closer to the bound, as the object of "use"; `None` if nothing is left to try. `closer` is a
    /// model that the layer can have and that is closer than the requested model. For the other reasons the best lobe
    /// exceeds the bound, too, or no engine can show that lobe, or glTF has no finer encoding: `--target float` is for
    /// other programs.
    pub(super) fn remedy(self, settings: &Settings, closer: Option<Model>) -> Option<String> {
        match self {
            Self::Isotropic => (settings.model_limit() == Model::Anisotropic)
                .then(|| "the base layer for these bumps, since only that layer can be anisotropic".to_owned()),
            Self::Fit => match closer {
                Some(model) => Some(format!("--model {} if the engine shows it correctly", model.name())),
                None => (settings.quality != Effort::Best).then(|| "--quality best".to_owned()),
            },
            Self::Encoding | Self::AlphaAboveOne | Self::TwoPeaked | Self::Steep | Self::NoSingleLobe => None,
        }
    }

    /// Returns the reason as part of a sentence.
    pub fn text(self) -> &'static str {
        match self {
            Self::Encoding => "lost in encoding",
            Self::AlphaAboveOne => "alpha would have to be above 1",
            Self::Isotropic => "the lobe is isotropic, and these bumps need an anisotropic one",
            Self::TwoPeaked => "the bumps reflect in two directions, which one lobe cannot show",
            Self::Steep => "slopes beyond the clamp",
            Self::NoSingleLobe => "no single lobe has this shape",
            Self::Fit => "the fit does not reach the best lobe",
        }
    }
}

#[cfg(test)]
mod tests;

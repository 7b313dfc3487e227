//! Why an error bound is missed, by measurement.

use serde::{Deserialize, Serialize};

/// What was measured where a bound is missed; errors are means over the texels that were looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evidence {
    /// Error of the chosen candidate if nothing were lost to encoding.
    pub unencoded: f64,
    /// The same if alphas above 1 could be shown.
    pub unclamped: f64,
    /// The same with an ellipse in a circle's place, where the candidate has circles and the layer can have no ellipse.
    pub anisotropic: Option<f64>,
    /// Error of the best single lobe.
    pub oracle: f64,
    /// Share of footprints with two peaks.
    pub two_peaked: f64,
    /// Share of the area that is steeper than the clamp.
    pub steep: f64,
}

/// Why an error bound is missed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub enum Reason {
    /// Blocks cannot hold texels that differ so much.
    Encoding,
    /// The best lobe is wider than an engine can show.
    AlphaAboveOne,
    /// The layer cannot have an ellipse.
    Isotropic,
    /// Normals point in two directions: a single lobe covers the gap between them.
    TwoPeaked,
    /// Much of the area is steeper than slopes can be.
    Steep,
    /// No single lobe has the shape of these bumps.
    NoSingleLobe,
    /// Some lobe would do, but not the one that the bumps were folded to.
    Fit,
}

impl Evidence {
    /// What explains the miss of `max_error`: the first thing without which it would be met, else what makes any lobe miss
    /// it.
    pub fn reason(&self, max_error: f64) -> Reason {
        let without = |error: f64| error <= max_error;
        if without(self.unencoded) {
            Reason::Encoding
        } else if without(self.unclamped) {
            Reason::AlphaAboveOne
        } else if self.anisotropic.is_some_and(without) {
            Reason::Isotropic
        } else if without(self.oracle) {
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
    /// As in a sentence.
    pub fn text(self) -> &'static str {
        match self {
            Self::Encoding => "lost in encoding",
            Self::AlphaAboveOne => "alpha would have to be above 1",
            Self::Isotropic => "a circle in an ellipse's place",
            Self::TwoPeaked => "two peaks, one lobe",
            Self::Steep => "slopes beyond the clamp",
            Self::NoSingleLobe => "no single lobe has this shape",
            Self::Fit => "the lobe is not the best one that there is",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reasons_follow_the_evidence() {
        let all =
            Evidence { unencoded: 0.3, unclamped: 0.3, anisotropic: None, oracle: 0.2, two_peaked: 0.0, steep: 0.0 };
        let cases = [
            (Evidence { unencoded: 0.05, ..all }, Reason::Encoding),
            (Evidence { unclamped: 0.05, ..all }, Reason::AlphaAboveOne),
            (Evidence { anisotropic: Some(0.05), oracle: 0.05, ..all }, Reason::Isotropic),
            (Evidence { oracle: 0.05, two_peaked: 1.0, ..all }, Reason::Fit),
            (Evidence { two_peaked: 0.8, ..all }, Reason::TwoPeaked),
            (Evidence { two_peaked: 0.8, steep: 0.4, ..all }, Reason::Steep),
            (all, Reason::NoSingleLobe),
        ];
        for (evidence, reason) in cases {
            assert_eq!(evidence.reason(0.1), reason, "{evidence:?}");
        }
    }
}

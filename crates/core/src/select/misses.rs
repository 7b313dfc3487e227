//! The levels at which the chosen candidate exceeds the error bound, and why.

use rayon::prelude::*;

use crate::bump::MAX_SLOPE;
use crate::codec::EncodeError;
use crate::lobe::Family;
use crate::metric::{Lobe, Reference, Site, is_two_peaked, oracle};
use crate::report::{Candidate, Evidence, Miss};
use crate::select::candidate_set::CandidateSet;
use crate::select::shown::{Errors, Shown};
use crate::settings::{Model, Settings};

/// Sample points of a level for which the best lobe is sought if the level misses the bound.
const ORACLE_POINTS: usize = 8;
/// Half-vectors for each of these sample points, by which the best lobe is sought.
const ORACLE_SAMPLES: usize = 256;
/// Half-vectors for each of these sample points, by which the best lobe is measured. The errors of a level have few
/// half-vectors for each of many points.
const MEASURE_SAMPLES: usize = 1024;

/// Returns the levels at which `chosen` misses the bound, with the reasons, from measurements at `sites`.
///
/// # Errors
/// [`EncodeError`] if the blocks at the sample points cannot be encoded.
pub(super) fn misses(
    set: &CandidateSet<'_, '_>,
    sites: &[Site],
    chosen: &Candidate,
    finest: usize,
) -> Result<Vec<Miss>, EncodeError> {
    let Settings { max_error, .. } = *set.settings;
    let missed: Vec<(usize, f32)> =
        (finest..).zip(chosen.errors.iter().copied()).filter(|(_, e)| *e > max_error).collect();
    let is_missed = |site: &Site| missed.iter().any(|(level, _)| *level == site.level);
    let measurements = Measurements::new(set, sites.iter().filter(|site| is_missed(site)).collect(), chosen)?;
    let miss = |(level, error): (usize, f32)| {
        let evidence = measurements.evidence(level, error);
        Miss { level, error, oracle: rounded(evidence.oracle), reason: evidence.reason(f64::from(max_error)) }
    };
    Ok(missed.into_iter().map(miss).collect())
}

/// What is measured at the sample points of all levels that miss the bound.
struct Measurements<'s> {
    family: Family,
    sites: Vec<&'s Site>,
    /// Errors of the chosen candidate without encoding.
    unencoded: Errors,
    /// Errors of the chosen candidate without encoding and without a limit on alpha.
    unclamped: Errors,
    /// Errors of the anisotropic model without encoding, if the layer can only be isotropic.
    anisotropic: Option<Errors>,
    /// The lobes of the chosen candidate without encoding.
    lobes: Vec<Vec<Lobe>>,
}

impl<'s> Measurements<'s> {
    fn new(set: &CandidateSet<'_, '_>, sites: Vec<&'s Site>, chosen: &Candidate) -> Result<Self, EncodeError> {
        let (model, first) = (chosen.model, chosen.first);
        let shown = Shown::new(set, sites.iter().copied(), false)?;
        let anisotropic = (model == Model::Isotropic && set.max_model == Model::Isotropic)
            .then(|| shown.errors(&sites, Model::Anisotropic, first))
            .transpose()?;
        Ok(Self {
            family: set.settings.lobe,
            unencoded: shown.errors(&sites, model, first)?,
            unclamped: shown.unclamped_errors(&sites, model, first)?,
            anisotropic,
            lobes: shown.lobes(model, first)?,
            sites,
        })
    }

    /// Returns the means over the sample points of `level`, where the chosen candidate has the mean `error`.
    fn evidence(&self, level: usize, error: f32) -> Evidence {
        let of: Vec<usize> = (0..self.sites.len()).filter(|i| self.sites[*i].level == level).collect();
        let mean = |of: &[usize], value: &dyn Fn(usize) -> f64| {
            of.iter().map(|i| value(*i)).sum::<f64>() / of.len().max(1) as f64
        };
        // Neighbours in the list may lie in one row.
        let few: Vec<usize> =
            of.iter().copied().step_by(of.len().div_ceil(ORACLE_POINTS).max(1)).take(ORACLE_POINTS).collect();
        let is_two_peaked = |i: usize| is_two_peaked(self.family, &self.sites[i].footprint);
        let unencoded = mean(&of, &|i| self.unencoded[i]);
        Evidence {
            unencoded,
            unclamped: mean(&of, &|i| self.unclamped[i]),
            anisotropic: self.anisotropic.as_ref().map(|errors| mean(&of, &|i| errors[i])),
            oracle: (unencoded - self.mean_gain(&few)).clamp(0.0, f64::from(error)),
            two_peaked: mean(&few, &|i| f64::from(u8::from(is_two_peaked(i)))),
            steep: mean(&of, &|i| steep_share(self.sites[i])),
        }
    }

    /// Returns by how much the best lobe is better than the chosen candidate without encoding, as a mean over some
    /// sample points.
    fn mean_gain(&self, points: &[usize]) -> f64 {
        let gain = |i: &usize| gain_of_best(self.sites[*i], &self.lobes[*i]);
        points.par_iter().map(gain).collect::<Vec<_>>().iter().sum::<f64>() / points.len().max(1) as f64
    }
}

/// Returns by how much the best lobe has a smaller error at `site` than the worst of `lobes`. The best lobe is sought
/// with half-vectors of its own: the half-vectors that measure its error would favour it.
fn gain_of_best(site: &Site, lobes: &[Lobe]) -> f64 {
    let reference = |samples| Reference::new(site.reference.family(), &site.footprint, samples);
    let (best, _) = oracle(&reference(ORACLE_SAMPLES), lobes);
    let measure = reference(MEASURE_SAMPLES);
    let errors: Vec<f64> = lobes.iter().map(|lobe| measure.error(lobe)).collect();
    let smallest = errors.iter().copied().fold(measure.error(&best), f64::min);
    errors.into_iter().fold(0.0, f64::max) - smallest
}

/// Rounds to four decimals: further decimals are noise that would only fill reports.
pub(super) fn rounded(error: f64) -> f32 {
    ((error * 1e4).round() / 1e4) as f32
}

/// Returns the share of a sample point's area whose slope is at the limit.
fn steep_share(site: &Site) -> f64 {
    let is_steep = |[x, y, z]: &[f64; 3]| (x * x + y * y).sqrt() >= 0.99 * f64::from(MAX_SLOPE) * z;
    site.footprint.parts().iter().filter(|p| is_steep(&p.normal)).map(|p| p.weight).sum()
}

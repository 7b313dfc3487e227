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
/// Half-vectors for each of these sample points.
const ORACLE_SAMPLES: usize = 256;

/// Returns the levels at which `chosen` misses the bound, with the reasons. `errors` holds its errors at `sites`.
///
/// # Errors
/// [`EncodeError`] if the blocks at the sample points cannot be encoded.
pub(super) fn misses(
    set: &CandidateSet<'_, '_>,
    sites: &[Site],
    chosen: &Candidate,
    errors: &Errors,
    finest: usize,
) -> Result<Vec<Miss>, EncodeError> {
    let Settings { max_error, .. } = *set.settings;
    let missed: Vec<(usize, f32)> =
        (finest..).zip(chosen.errors.iter().copied()).filter(|(_, e)| *e > max_error).collect();
    let is_missed = |site: &Site| missed.iter().any(|(level, _)| *level == site.level);
    let (sites, errors): (Vec<&Site>, Vec<f64>) = sites.iter().zip(errors).filter(|(site, _)| is_missed(site)).unzip();
    let measurements = Measurements::new(set, sites, errors, chosen)?;
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
    /// Errors of the chosen candidate.
    errors: Errors,
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
    fn new(
        set: &CandidateSet<'_, '_>,
        sites: Vec<&'s Site>,
        errors: Errors,
        chosen: &Candidate,
    ) -> Result<Self, EncodeError> {
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
            errors,
        })
    }

    /// Returns the means over the sample points of `level`, where the chosen candidate has the mean `error`.
    fn evidence(&self, level: usize, error: f32) -> Evidence {
        let of: Vec<usize> = (0..self.sites.len()).filter(|i| self.sites[*i].level == level).collect();
        let mean = |of: &[usize], value: &dyn Fn(usize) -> f64| {
            of.iter().map(|i| value(*i)).sum::<f64>() / of.len().max(1) as f64
        };
        // The first sample points are spread over the level as evenly as all of them.
        let few = &of[..of.len().min(ORACLE_POINTS)];
        let is_two_peaked = |i: usize| is_two_peaked(self.family, &self.sites[i].footprint);
        Evidence {
            unencoded: mean(&of, &|i| self.unencoded[i]),
            unclamped: mean(&of, &|i| self.unclamped[i]),
            anisotropic: self.anisotropic.as_ref().map(|errors| mean(&of, &|i| errors[i])),
            oracle: (f64::from(error) - self.mean_gain(few).max(0.0)).max(0.0),
            two_peaked: mean(few, &|i| f64::from(u8::from(is_two_peaked(i)))),
            steep: mean(&of, &|i| steep_share(self.sites[i])),
        }
    }

    /// Returns by how much the best lobe is better than the chosen candidate, as a mean over some sample points.
    fn mean_gain(&self, points: &[usize]) -> f64 {
        let gain = |i: &usize| self.errors[*i] - best_error(self.sites[*i], &self.lobes[*i]);
        points.par_iter().map(gain).collect::<Vec<_>>().iter().sum::<f64>() / points.len().max(1) as f64
    }
}

/// Returns the error at `site` of the best lobe. The best lobe is sought with half-vectors of its own: the half-vectors
/// that measure its error would favour it.
fn best_error(site: &Site, starts: &[Lobe]) -> f64 {
    let (best, _) = oracle(&Reference::new(site.reference.family(), &site.footprint, ORACLE_SAMPLES), starts);
    starts.iter().chain([&best]).map(|lobe| site.reference.error(lobe)).fold(f64::INFINITY, f64::min)
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

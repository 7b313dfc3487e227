//! The evaluation of candidates at sample points, and the choice among them.

use crate::codec::EncodeError;
use crate::lobe::{OrientedLobe, ReflectingLobe};
use crate::memory::{self, OutOfMemory};
use crate::metric::{Precision, Site, sample_bytes, sample_sites};
use crate::report::{Candidate, Choice};
use crate::select::candidate_set::CandidateSet;
use crate::select::misses::{misses, rounded};
use crate::select::rule::{choose, is_closer};
use crate::select::shown::{Errors, Shown};
use crate::settings::Model;

/// How much larger than the error of the base lobe the error of a level may be: in the pyramid profile, or up to the
/// first level of a smaller texture.
const MAX_LOSS: f32 = 0.005;

/// A candidate that has been evaluated.
struct Evaluated {
    candidate: Candidate,
    /// Whether the base lobe is better by more than [`MAX_LOSS`] at the first level of its smaller texture, or at one
    /// that this texture lacks.
    is_worse_than_base: bool,
}

/// The sample points of all levels from `finest` on.
struct Samples {
    sizes: Vec<(u32, u32)>,
    finest: usize,
    sites: Vec<Site>,
}

impl CandidateSet<'_, '_> {
    /// Evaluates all candidates and chooses one. Under a fixed model, all models are evaluated in full size, so that
    /// the report shows their errors.
    ///
    /// # Errors
    /// [`EncodeError`] if the blocks at the sample points cannot be encoded, or if memory is too small for the samples.
    pub fn choose(&self) -> Result<Choice, EncodeError> {
        self.choose_with(Precision::QUICK)
    }

    fn choose_with(&self, precision: Precision) -> Result<Choice, EncodeError> {
        let samples = self.samples(precision)?;
        let shown = Shown::new(self, samples.sites.iter(), true)?;
        let none = shown.errors(&samples.sites.iter().collect::<Vec<_>>(), Model::None, self.first)?;
        let mut evaluated = Vec::new();
        for model in self.models() {
            evaluated.extend(self.evaluate(model, &samples, &shown, &none)?);
        }
        let chosen = self.index_of_choice(&evaluated);
        let misses = misses(self, &samples.sites, &evaluated[chosen].candidate, samples.finest)?;
        let candidates = evaluated.into_iter().map(|evaluated| evaluated.candidate).collect();
        Ok(Choice { finest: samples.finest, candidates, chosen, misses })
    }

    fn samples(&self, precision: Precision) -> Result<Samples, OutOfMemory> {
        let sizes = self.roughening.sizes();
        let finest = self.finest.min(sizes.len() - 1);
        memory::check(sample_bytes(&sizes, finest..sizes.len(), precision))?;
        let lobes = self.roughening.lobes();
        let family = self.settings.lobe;
        // Level 0 is compared with its own texels.
        let width = sizes[0].0 as usize;
        let texels = |first, out: &mut [OrientedLobe]| {
            (first..).zip(out.chunks_exact_mut(width)).for_each(|(y, row)| lobes.row(0, y, row));
        };
        let mut sites = sample_sites(&sizes, finest..1, family, precision, &texels);
        let coarser = finest.max(1)..sizes.len();
        sites.extend(if lobes.is_reflectance_constant() {
            let rows = |first, out: &mut [OrientedLobe]| lobes.magnified_rows(first, out);
            sample_sites(&sizes, coarser, family, precision, &rows)
        } else {
            let rows = |first, out: &mut [ReflectingLobe]| lobes.reflecting_rows(first, out);
            sample_sites(&sizes, coarser, family, precision, &rows)
        });
        Ok(Samples { sizes, finest, sites })
    }

    /// Evaluates `model` in each of its sizes, smallest first. `none` are the errors of the base lobe, which a level
    /// keeps where the model has a larger error.
    fn evaluate(
        &self,
        model: Model,
        samples: &Samples,
        shown: &Shown<'_, '_>,
        none: &Errors,
    ) -> Result<Vec<Evaluated>, EncodeError> {
        let Samples { sizes, finest, sites } = samples;
        let base_errors = by_level(sites, none, *finest, sizes.len());
        let full = shown.errors(&sites.iter().collect::<Vec<_>>(), model, self.first)?;
        let evaluated = |first: usize| {
            let mut errors = self.errors_of_size(&full, model, first, sites, shown)?;
            let own_errors = by_level(sites, &errors, *finest, sizes.len());
            let levels = (*finest..).zip(own_errors.iter().zip(&base_errors));
            // The levels that a smaller texture lacks are magnified from its first level, which thus keeps its lobes.
            let is_smaller = first > self.first;
            let loses = |(level, (own, base)): (usize, (&f32, &f32))| level <= first && *own > base + MAX_LOSS;
            let is_worse_than_base = is_smaller && levels.clone().any(loses);
            // K is 0 at level 0 anyway.
            let may_be_0 = |level| self.pyramid.as_ref().is_none_or(|pyramid| pyramid.may_keep_base && level > 0);
            let may_keep = |level| level >= first + usize::from(is_smaller) && may_be_0(level);
            // A level without K looks unlike its neighbours, so that a small gain is not worth it.
            let margin = if self.pyramid.is_some() { MAX_LOSS } else { 0.0 };
            let is_worse = |(level, (own, base)): &(usize, (&f32, &f32))| **own > *base + margin && may_keep(*level);
            let base_levels: Vec<usize> = levels.filter(is_worse).map(|(level, _)| level).collect();
            for i in (0..sites.len()).filter(|i| base_levels.contains(&sites[*i].level)) {
                errors[i] = none[i];
            }
            let candidate = Candidate {
                model,
                first,
                bytes: self.bytes(model, first, sizes),
                errors: by_level(sites, &errors, *finest, sizes.len()),
                base_levels,
            };
            Ok(Evaluated { candidate, is_worse_than_base })
        };
        self.first_levels(model, sizes).into_iter().map(evaluated).collect()
    }

    /// Returns the errors of textures that begin with level `first`, given the errors of the `full` size. At levels
    /// that a smaller texture has, it holds the blocks of the full size; levels that it lacks are magnified.
    fn errors_of_size(
        &self,
        full: &Errors,
        model: Model,
        first: usize,
        sites: &[Site],
        shown: &Shown<'_, '_>,
    ) -> Result<Errors, EncodeError> {
        let mut errors = full.clone();
        let lacking: Vec<usize> = (0..sites.len()).filter(|i| sites[*i].level < first).collect();
        if first > self.first && !lacking.is_empty() {
            let part: Vec<&Site> = lacking.iter().map(|i| &sites[*i]).collect();
            let magnified = shown.subset(&lacking).errors(&part, model, first)?;
            lacking.iter().zip(magnified).for_each(|(i, error)| errors[*i] = error);
        }
        Ok(errors)
    }

    /// Returns the rank of a candidate by rising cost; candidates of one rank are in the order of [`Self::models`].
    /// `none` is the candidate of the base lobe, for which the material keeps its textures. A roughness texture that
    /// replaces one of them costs nothing, but is not preferred if it hardly lowers the error.
    fn cost_rank(&self, candidate: &Candidate, none: &Candidate) -> u8 {
        let Candidate { model, bytes, errors, .. } = candidate;
        match model {
            Model::Isotropic if self.replaces_texture(*bytes) && is_closer(errors, &none.errors) => 0,
            Model::None => 1,
            _ => 2,
        }
    }

    fn index_of_choice(&self, evaluated: &[Evaluated]) -> usize {
        let chosen = match self.settings.model {
            Model::Auto => {
                let mut kept: Vec<usize> = (0..evaluated.len()).filter(|i| !evaluated[*i].is_worse_than_base).collect();
                kept.sort_by_key(|i| self.cost_rank(&evaluated[*i].candidate, &evaluated[0].candidate));
                let errors: Vec<Vec<f32>> = kept.iter().map(|i| evaluated[*i].candidate.errors.clone()).collect();
                choose(&errors, self.settings.max_error).map(|chosen| kept[chosen])
            }
            requested => evaluated.iter().position(|e| e.candidate.model == requested.min(self.max_model)),
        };
        chosen.unwrap_or(0)
    }
}

/// Returns the mean errors of the levels from `finest` on.
fn by_level(sites: &[Site], errors: &Errors, finest: usize, levels: usize) -> Vec<f32> {
    let mean = |level: usize| {
        let of: Vec<f64> = sites.iter().zip(errors).filter(|(s, _)| s.level == level).map(|(_, e)| *e).collect();
        rounded(of.iter().sum::<f64>() / of.len().max(1) as f64)
    };
    (finest..levels).map(mean).collect()
}

#[cfg(test)]
mod tests;

//! Candidates for a material's roughness data, judged before one of them is made (DESIGN, sections 4 and 6).

mod scene;

use rayon::prelude::*;

use crate::bump::MAX_SLOPE;
use crate::codec::{EncodeError, Format};
use crate::lobe::OrientedLobe;
use crate::material::Encoding;
use crate::metric::{Lobe, Precision, Reference, Site, is_two_peaked, oracle, survey};
use crate::report::{Candidate, Choice, Evidence, Miss};
use crate::select::candidates::scene::Scene;
use crate::select::case::{Candidates, Errors};
use crate::select::choose;
use crate::select::sampled::SamplePoint;
use crate::settings::{Model, Settings};

/// Texels of a level for which the best lobe is sought where the bound is missed.
const WITNESSES: usize = 8;
/// Half-vectors for each of them.
const WITNESS_SAMPLES: usize = 256;

impl Candidates<'_, '_, '_> {
    /// Judges what the settings allow and chooses. Under a fixed model all models are judged in full size, so that the
    /// report tells what they would have done.
    pub fn run(&self) -> Result<Choice, EncodeError> {
        let sizes = self.roughening.sizes();
        let finest = self.finest.min(sizes.len() - 1);
        let lobes = self.roughening.lobes();
        let row = |y, out: &mut [OrientedLobe]| lobes.row(0, y, out);
        let sites = survey(&sizes, finest..sizes.len(), self.settings.family, Precision::QUICK, &row);
        let scene = Scene::new(self, sites.iter().map(point).collect(), true)?;
        let (mut candidates, mut by_site) = (Vec::new(), Vec::new());
        for model in [Model::None, Model::Isotropic, Model::Anisotropic] {
            if !self.offers(model) {
                continue;
            }
            let full = scene.errors(&sites, model, self.first)?;
            for first in self.firsts(model, &sizes) {
                // Where the level is there, a smaller texture holds the same blocks.
                let lacking: Vec<usize> = (0..sites.len()).filter(|i| sites[*i].level < first).collect();
                let mut errors = full.clone();
                if first > self.first && !lacking.is_empty() {
                    let part: Vec<&Site> = lacking.iter().map(|i| &sites[*i]).collect();
                    let magnified = scene.part(&lacking).errors_of(&part, model, first)?;
                    lacking.iter().zip(magnified).for_each(|(i, e)| errors[*i] = e);
                }
                candidates.push(Candidate {
                    model,
                    first,
                    bytes: self.bytes(model, first, &sizes),
                    errors: by_level(&sites, &errors, finest, sizes.len()),
                });
                by_site.push(errors);
            }
        }
        let errors: Vec<Vec<f32>> = candidates.iter().map(|c| c.errors.clone()).collect();
        let chosen = match self.settings.model {
            Model::Auto => choose(&errors, self.settings.max_error),
            asked => candidates.iter().position(|c| c.model == asked.min(self.widest)),
        };
        let chosen = chosen.unwrap_or(0);
        let misses = self.misses(&sites, &candidates[chosen], &by_site[chosen], finest)?;
        Ok(Choice { finest, candidates, chosen, misses })
    }

    fn offers(&self, model: Model) -> bool {
        match model {
            // A lobe that is elliptical already stays so, unless a circle is asked for.
            Model::Isotropic => {
                !self.roughening.is_anisotropic()
                    || self.widest == Model::Isotropic
                    || self.settings.model == Model::Isotropic
            }
            model => model <= self.widest,
        }
    }

    /// The levels with which the roughness data may begin, coarsest first: full, half and quarter size.
    fn firsts(&self, model: Model, sizes: &[(u32, u32)]) -> Vec<usize> {
        let encoding = Encoding::of(self.settings, 3);
        let fits = |first: usize| {
            first == self.first || first < sizes.len() && encoding.starting_at(first).first(sizes) == first
        };
        let may_shrink = model != Model::None && self.settings.model == Model::Auto && self.roughening.is_plain();
        let last = self.first + if may_shrink { 2 } else { 0 };
        (self.first..=last).rev().filter(|first| fits(*first)).collect()
    }

    /// Bytes of the roughness data on the GPU.
    fn bytes(&self, model: Model, first: usize, sizes: &[(u32, u32)]) -> u64 {
        let target = self.settings.target;
        let of = |format: Format| sizes[first..].iter().map(|s| format.level_bytes(s.0, s.1) as u64).sum::<u64>();
        let portable = match model {
            Model::Isotropic => of(target.format(3)),
            Model::Anisotropic => 2 * of(target.format(3)),
            _ => 0,
        };
        let pyramid = match model {
            Model::Isotropic => of(target.format(1)),
            Model::Anisotropic => of(target.format(3)),
            _ => 0,
        };
        u64::from(self.normals.is_some()) * portable + u64::from(self.pyramid.is_some()) * pyramid
    }

    /// The levels at which `chosen`, with the errors `seen` by site, misses the bound, and why.
    fn misses(
        &self,
        sites: &[Site],
        chosen: &Candidate,
        seen: &Errors,
        finest: usize,
    ) -> Result<Vec<Miss>, EncodeError> {
        let Settings { max_error, family, .. } = *self.settings;
        let missed: Vec<(usize, f32)> =
            (finest..).zip(chosen.errors.iter().copied()).filter(|(_, e)| *e > max_error).collect();
        let is_missed = |site: &Site| missed.iter().any(|(level, _)| *level == site.level);
        let (of_missed, seen): (Vec<&Site>, Vec<f64>) =
            sites.iter().zip(seen).filter(|(site, _)| is_missed(site)).unzip();
        let ideal = Scene::new(self, of_missed.iter().map(|s| point(s)).collect(), false)?;
        let (model, first) = (chosen.model, chosen.first);
        let unencoded = ideal.errors_of(&of_missed, model, first)?;
        let unclamped = ideal.unclamped(&of_missed, model, first)?;
        let anisotropic = (model == Model::Isotropic && self.widest == Model::Isotropic)
            .then(|| ideal.errors_of(&of_missed, Model::Anisotropic, first))
            .transpose()?;
        let lobes = ideal.lobes(model, first)?;
        let miss = |(level, error): (usize, f32)| {
            let of: Vec<usize> = (0..of_missed.len()).filter(|i| of_missed[*i].level == level).collect();
            let mean = |of: &[usize], value: &dyn Fn(usize) -> f64| {
                of.iter().map(|i| value(*i)).sum::<f64>() / of.len().max(1) as f64
            };
            // Sites are spread evenly from the first on.
            let witnesses = &of[..of.len().min(WITNESSES)];
            let gained: f64 = witnesses
                .par_iter()
                .map(|i| seen[*i] - best_error(of_missed[*i], &lobes[*i]))
                .collect::<Vec<_>>()
                .iter()
                .sum::<f64>()
                / witnesses.len().max(1) as f64;
            let best = (f64::from(error) - gained.max(0.0)).max(0.0);
            let evidence = Evidence {
                unencoded: mean(&of, &|i| unencoded[i]),
                unclamped: mean(&of, &|i| unclamped[i]),
                anisotropic: anisotropic.as_ref().map(|errors| mean(&of, &|i| errors[i])),
                oracle: best,
                two_peaked: mean(witnesses, &|i| f64::from(u8::from(is_two_peaked(family, &of_missed[i].footprint)))),
                steep: mean(&of, &|i| steep_share(of_missed[i])),
            };
            Miss { level, error, oracle: rounded(best), reason: evidence.reason(f64::from(max_error)) }
        };
        Ok(missed.into_iter().map(miss).collect())
    }
}

/// The error at `site` of the best lobe: sought with half-vectors of its own, or those that it is judged by would flatter
/// it.
fn best_error(site: &Site, starts: &[Lobe]) -> f64 {
    let (best, _) = oracle(&Reference::new(site.reference.family(), &site.footprint, WITNESS_SAMPLES), starts);
    starts.iter().chain([&best]).map(|lobe| site.reference.error(lobe)).fold(f64::INFINITY, f64::min)
}

fn point(site: &Site) -> SamplePoint {
    (site.level, site.texel.0, site.texel.1)
}

/// Mean errors of the levels from `finest` on.
fn by_level(sites: &[Site], errors: &Errors, finest: usize, levels: usize) -> Vec<f32> {
    let mean = |level: usize| {
        let of: Vec<f64> = sites.iter().zip(errors).filter(|(s, _)| s.level == level).map(|(_, e)| *e).collect();
        rounded(of.iter().sum::<f64>() / of.len().max(1) as f64)
    };
    (finest..levels).map(mean).collect()
}

/// To four places: beyond them is noise that would only fill reports.
fn rounded(error: f64) -> f32 {
    ((error * 1e4).round() / 1e4) as f32
}

/// Share of a site's area that is as steep as slopes can be.
fn steep_share(site: &Site) -> f64 {
    let is_steep = |[x, y, z]: &[f64; 3]| (x * x + y * y).sqrt() >= 0.99 * f64::from(MAX_SLOPE) * z;
    site.footprint.parts().iter().filter(|p| is_steep(&p.normal)).map(|p| p.weight).sum()
}

#[cfg(test)]
mod tests;

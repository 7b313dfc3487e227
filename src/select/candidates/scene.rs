//! What engines see of a candidate at the judged texels.

use rayon::prelude::*;

use crate::codec::{EncodeError, Format};
use crate::lobe::SquaredAlpha;
use crate::material::{Encoding, LevelRow, Quantity, quantity_rows, range_of};
use crate::math::symmetric::Symmetric2;
use crate::metric::{Lobe, Site, shown_lobe, shown_normal, with_z};
use crate::select::case::{Candidates, Errors};
use crate::select::sampled::{SamplePoint, Sampled};
use crate::settings::Model;

/// What the sites of a trial see of it.
pub(super) struct Scene<'t, 'f, 'r> {
    candidates: &'t Candidates<'t, 'f, 'r>,
    sizes: Vec<(u32, u32)>,
    points: Vec<SamplePoint>,
    /// By profile and site; empty for a profile that is not written.
    normals: [Vec<[f64; 3]>; 2],
    encoded: bool,
}

impl<'t, 'f, 'r> Scene<'t, 'f, 'r> {
    pub(super) fn new(
        candidates: &'t Candidates<'t, 'f, 'r>,
        points: Vec<SamplePoint>,
        encoded: bool,
    ) -> Result<Self, EncodeError> {
        let mut scene = Self {
            candidates,
            sizes: candidates.roughening.sizes(),
            points,
            normals: [Vec::new(), Vec::new()],
            encoded,
        };
        let scale = candidates.roughening.lobes().slope_scale();
        if let Some(normals) = candidates.normals {
            let encoding = Encoding::of_normals(candidates.settings);
            let row = |level: usize, y: u32, out: &mut [[f32; 4]]| normals.row(level, y, out);
            let texels = scene.read(&normals.sizes(), candidates.first, encoding, &row)?;
            let has_z = !encoded || encoding.format != Format::Bc5;
            let normal = |[x, y, z, _]: [f32; 4]| shown_normal(if has_z { [x, y, z] } else { with_z([x, y]) }, scale);
            scene.normals[0] = texels.into_iter().map(normal).collect();
        }
        if let Some((moments, _)) = candidates.pyramid {
            let encoding = Encoding::of(candidates.settings, 2).starting_at(candidates.first);
            let range = range_of(moments, Quantity::Offset, encoding);
            let rows = quantity_rows(moments, Quantity::Offset, &range);
            let texels = scene.read(&moments.sizes(), candidates.first, encoding, &rows)?;
            let normal = |texel: [f32; 4]| {
                let [u, v] = range.values(texel).map(|f: f32| f64::from(f * scale));
                [-u, -v, 1.0]
            };
            scene.normals[1] = texels.into_iter().map(normal).collect();
        }
        Ok(scene)
    }

    /// Some of the sites.
    pub(super) fn part(&self, sites: &[usize]) -> Self {
        let of = |normals: &Vec<[f64; 3]>| sites.iter().filter_map(|i| normals.get(*i).copied()).collect();
        Self {
            candidates: self.candidates,
            sizes: self.sizes.clone(),
            points: sites.iter().map(|i| self.points[*i]).collect(),
            normals: [of(&self.normals[0]), of(&self.normals[1])],
            encoded: self.encoded,
        }
    }

    fn read(
        &self,
        sizes: &[(u32, u32)],
        first: usize,
        encoding: Encoding,
        row: &LevelRow<'_>,
    ) -> Result<Vec<[f32; 4]>, EncodeError> {
        let encoding = self.encoded.then_some(encoding);
        Sampled { sizes, first, encoding, row, wrap: self.candidates.wrap }.at(&self.sizes, &self.points)
    }

    pub(super) fn errors(&self, sites: &[Site], model: Model, first: usize) -> Result<Errors, EncodeError> {
        self.errors_of(&sites.iter().collect::<Vec<_>>(), model, first)
    }

    /// The larger error of the profiles, site by site.
    pub(super) fn errors_of(&self, sites: &[&Site], model: Model, first: usize) -> Result<Errors, EncodeError> {
        Ok(worst(sites, self.lobes(model, first)?))
    }

    /// The same for lobes of any width.
    pub(super) fn unclamped(&self, sites: &[&Site], model: Model, first: usize) -> Result<Errors, EncodeError> {
        let encoding = Encoding::of(self.candidates.settings, 3);
        let wide =
            self.read(&self.sizes, first, encoding, &self.candidates.roughening.lobe_rows(model != Model::None))?;
        let lobe = |i: usize| {
            let [uu, uv, vv, _] = wide[i];
            let a = SquaredAlpha(Symmetric2::new(uu, uv, vv));
            let a = if model == Model::Isotropic { SquaredAlpha::isotropic(a.closest_isotropic()) } else { a };
            let normals = self.normals.iter().filter_map(|n| n.get(i));
            normals
                .map(|n| Lobe::new(self.candidates.settings.family, *n, [a.0.uu, a.0.uv, a.0.vv].map(f64::from)))
                .collect()
        };
        Ok(worst(sites, (0..sites.len()).map(lobe).collect()))
    }

    /// The lobes of each profile that is written, site by site.
    pub(super) fn lobes(&self, model: Model, first: usize) -> Result<Vec<Vec<Lobe>>, EncodeError> {
        let mut lobes: Vec<Vec<Lobe>> = self.points.iter().map(|_| Vec::new()).collect();
        let shapes = [
            if self.candidates.normals.is_some() { self.portable(model, first)? } else { Vec::new() },
            self.pyramid(model, first)?,
        ];
        for (normals, shapes) in self.normals.iter().zip(shapes) {
            for ((lobes, normal), a) in lobes.iter_mut().zip(normals).zip(shapes) {
                lobes.push(Lobe::new(self.candidates.settings.family, *normal, a));
            }
        }
        Ok(lobes)
    }

    /// Squared alphas that glTF's textures hold.
    fn portable(&self, model: Model, first: usize) -> Result<Vec<[f64; 3]>, EncodeError> {
        let roughening = self.candidates.roughening;
        if model == Model::None {
            return self.own();
        }
        let encoding = Encoding::of(self.candidates.settings, 3);
        let roughness = self.read(&self.sizes, first, encoding.of_surface(), &roughening.roughness_rows(model))?;
        let axes = match model {
            Model::Anisotropic => Some(self.read(&self.sizes, first, encoding, &roughening.anisotropy_rows())?),
            _ => None,
        };
        let lobe =
            |i: usize| shown_lobe(roughness[i][1], axes.as_ref().map(|axes| [axes[i][0], axes[i][1], axes[i][2]]));
        Ok((0..roughness.len()).map(lobe).collect())
    }

    /// Squared alphas that a plugin makes of D or lambda_1: A + 2 c K.
    fn pyramid(&self, model: Model, first: usize) -> Result<Vec<[f64; 3]>, EncodeError> {
        let Some((moments, correction)) = self.candidates.pyramid else { return Ok(Vec::new()) };
        let own = self.own()?;
        let quantity = match model {
            Model::Isotropic => Quantity::Lambda1,
            Model::Anisotropic => Quantity::Factor,
            _ => return Ok(own),
        };
        let scale = self.candidates.roughening.lobes().slope_scale();
        let encoding = Encoding::of(self.candidates.settings, quantity.channels() as u32).starting_at(first);
        let range = range_of(moments, quantity, encoding);
        let texels = self.read(&moments.sizes(), first, encoding, &quantity_rows(moments, quantity, &range))?;
        let weight = 2.0 * f64::from(correction * scale * scale);
        let roughened = |([uu, uv, vv], texel): ([f64; 3], [f32; 4])| {
            let d = range.values::<3>(texel).map(f64::from);
            let [ku, kv, kw] = match quantity {
                Quantity::Factor => [d[0] * d[0] + d[1] * d[1], d[1] * d[2], d[2] * d[2]],
                _ => [d[0] * d[0], 0.0, d[0] * d[0]],
            };
            [uu + weight * ku, uv + weight * kv, vv + weight * kw]
        };
        Ok(own.into_iter().zip(texels).map(roughened).collect())
    }

    /// Squared alphas of the material's own lobe, which no bake encodes.
    fn own(&self) -> Result<Vec<[f64; 3]>, EncodeError> {
        let rows = self.candidates.roughening.lobe_rows(false);
        let own = Sampled { sizes: &self.sizes, first: 0, encoding: None, row: &rows, wrap: self.candidates.wrap };
        Ok(own.at(&self.sizes, &self.points)?.into_iter().map(|[uu, uv, vv, _]| [uu, uv, vv].map(f64::from)).collect())
    }
}

/// The largest error of each site's lobes.
fn worst(sites: &[&Site], lobes: Vec<Vec<Lobe>>) -> Errors {
    let error = |(site, lobes): (&&Site, &Vec<Lobe>)| lobes.iter().map(|l| site.reference.error(l)).fold(0.0, f64::max);
    sites.par_iter().zip(&lobes).map(error).collect()
}

//! What an engine shows of a candidate at the sample points.

use rayon::prelude::*;

use crate::codec::EncodeError;
use crate::lobe::SquaredAlpha;
use crate::material::{
    AnisotropyTexture, BaseRoughnessTexture, Encoding, LevelRows, OffsetTexture, Product, Quantity, QuantityTexture,
    RoughnessTexture, slopes_of_texel, with_rows,
};
use crate::math::symmetric::Symmetric2;
use crate::metric::{Lobe, Site, shown_lobe, shown_normal, with_z};
use crate::select::candidate_set::{CandidateSet, PyramidData};
use crate::select::texture_samples::{LevelTexel, TextureSampler};
use crate::settings::Model;

/// Errors of one candidate, by sample point.
pub(super) type Errors = Vec<f64>;

/// The textures of all candidates, read at the sample points as engines read them.
pub(super) struct Shown<'t, 'f> {
    set: &'t CandidateSet<'t, 'f>,
    sizes: Vec<(u32, u32)>,
    texels: Vec<LevelTexel>,
    /// Normals of the portable and of the pyramid profile, by sample point; empty for a profile that is not written.
    normals: [Vec<[f64; 3]>; 2],
    is_encoded: bool,
}

impl<'t, 'f> Shown<'t, 'f> {
    /// Reads the normals at `sites`. Textures are read encoded, or as the values before encoding.
    pub(super) fn new<'s>(
        set: &'t CandidateSet<'t, 'f>,
        sites: impl Iterator<Item = &'s Site>,
        is_encoded: bool,
    ) -> Result<Self, EncodeError> {
        let texels = sites.map(|site| LevelTexel { level: site.level, x: site.texel.0, y: site.texel.1 }).collect();
        let sizes = set.roughening.sizes();
        let mut shown = Self { set, sizes, texels, normals: [Vec::new(), Vec::new()], is_encoded };
        shown.normals = [shown.portable_normals()?, shown.pyramid_normals()?];
        Ok(shown)
    }

    fn portable_normals(&self) -> Result<Vec<[f64; 3]>, EncodeError> {
        let Some(normals) = self.set.normals else { return Ok(Vec::new()) };
        let scale = normals.scale() * self.set.roughening.lobes().slope_scale();
        let encoding = Encoding::of_normals(self.set.settings);
        let texels = self.read(normals, self.set.first, encoding)?;
        let has_z = !self.is_encoded || encoding.format.has_z();
        let normal = |[x, y, z, _]: [f32; 4]| shown_normal(if has_z { [x, y, z] } else { with_z([x, y]) }, scale);
        Ok(texels.into_iter().map(normal).collect())
    }

    fn pyramid_normals(&self) -> Result<Vec<[f64; 3]>, EncodeError> {
        let Some(PyramidData { levels, .. }) = self.set.pyramid else { return Ok(Vec::new()) };
        let encoding = Encoding::of_normals(self.set.settings).starting_at(self.set.first);
        let texture = OffsetTexture::new(levels, encoding);
        let scale = f64::from(texture.scale * self.set.roughening.lobes().slope_scale());
        let texels = self.read(&texture, self.set.first, encoding)?;
        let has_z = !self.is_encoded || encoding.format.has_z();
        let normal = |[x, y, z, _]: [f32; 4]| {
            let texel = if has_z { [x, y, z] } else { with_z([x, y]) };
            let [u, v] = slopes_of_texel(texel.map(f64::from)).map(|f| scale * f);
            [-u, -v, 1.0]
        };
        Ok(texels.into_iter().map(normal).collect())
    }

    /// Returns what engines show at some of the sample points.
    pub(super) fn subset(&self, points: &[usize]) -> Self {
        let of = |normals: &Vec<[f64; 3]>| points.iter().filter_map(|i| normals.get(*i).copied()).collect();
        Self {
            set: self.set,
            sizes: self.sizes.clone(),
            texels: points.iter().map(|i| self.texels[*i]).collect(),
            normals: [of(&self.normals[0]), of(&self.normals[1])],
            is_encoded: self.is_encoded,
        }
    }

    /// Returns the larger error of the profiles at each sample point.
    pub(super) fn errors(&self, sites: &[&Site], model: Model, first: usize) -> Result<Errors, EncodeError> {
        Ok(largest(sites, self.lobes(model, first)?))
    }

    /// Returns the larger error of the profiles at each sample point for lobes whose alphas may exceed 1.
    pub(super) fn unclamped_errors(&self, sites: &[&Site], model: Model, first: usize) -> Result<Errors, EncodeError> {
        let encoding = Encoding::of(self.set.settings, 3);
        let row = |level, y, out: &mut [[f32; 4]]| {
            let lobes = match model {
                Model::None => self.set.roughening.base_row(level, y, out.len()),
                _ => self.set.roughening.roughened_row(level, y, out.len()),
            };
            store_alphas(lobes, out);
        };
        let lobes = self.read_rows(&self.sizes, first, encoding, LevelRows { values: &row, lobes: None })?;
        let lobe = |i: usize| {
            let [uu, uv, vv, _] = lobes[i];
            let a = SquaredAlpha(Symmetric2::new(uu, uv, vv));
            let a = if model == Model::Isotropic { SquaredAlpha::isotropic(a.closest_isotropic()) } else { a };
            let normals = self.normals.iter().filter_map(|n| n.get(i));
            normals.map(|n| Lobe::new(self.set.settings.lobe, *n, [a.0.uu, a.0.uv, a.0.vv].map(f64::from))).collect()
        };
        Ok(largest(sites, (0..sites.len()).map(lobe).collect()))
    }

    /// Returns the lobes of each profile that is written, by sample point.
    pub(super) fn lobes(&self, model: Model, first: usize) -> Result<Vec<Vec<Lobe>>, EncodeError> {
        let mut lobes: Vec<Vec<Lobe>> = self.texels.iter().map(|_| Vec::new()).collect();
        let squared_alphas = [self.portable_alphas(model, first)?, self.pyramid_alphas(model, first)?];
        for (normals, squared_alphas) in self.normals.iter().zip(squared_alphas) {
            for ((lobes, normal), a) in lobes.iter_mut().zip(normals).zip(squared_alphas) {
                lobes.push(Lobe::new(self.set.settings.lobe, *normal, a));
            }
        }
        Ok(lobes)
    }

    /// Returns the squared alphas in glTF's textures.
    fn portable_alphas(&self, model: Model, first: usize) -> Result<Vec<[f64; 3]>, EncodeError> {
        if self.set.normals.is_none() {
            return Ok(Vec::new());
        }
        if model == Model::None {
            return self.base_alphas();
        }
        let roughening = self.set.roughening;
        let encoding = Encoding::of(self.set.settings, 3);
        let roughness = self.read(&RoughnessTexture::new(roughening, model), first, encoding.with_orm_metric())?;
        let anisotropy = match model {
            Model::Anisotropic => Some(self.read(&AnisotropyTexture::new(roughening), first, encoding)?),
            _ => None,
        };
        let lobe = |i: usize| {
            let anisotropy = anisotropy.as_ref().map(|texels| [texels[i][0], texels[i][1], texels[i][2]]);
            shown_lobe(roughness[i][1], anisotropy)
        };
        Ok((0..roughness.len()).map(lobe).collect())
    }

    /// Returns the squared alphas A + 2 c K that a plugin computes from D or lambda_1.
    fn pyramid_alphas(&self, model: Model, first: usize) -> Result<Vec<[f64; 3]>, EncodeError> {
        let Some(pyramid) = &self.set.pyramid else { return Ok(Vec::new()) };
        let quantity = match model {
            Model::Isotropic => Quantity::Lambda1,
            Model::Anisotropic => Quantity::Factor,
            _ => return self.base_alphas(),
        };
        let base = if pyramid.has_base_texture { self.pyramid_base_alphas()? } else { self.base_alphas()? };
        let scale = self.set.roughening.lobes().slope_scale();
        let encoding = Encoding::of(self.set.settings, quantity.channels() as u32).starting_at(first);
        let texture = QuantityTexture::new(pyramid.levels, quantity, encoding);
        let texels = self.read(&texture, first, encoding)?;
        let weight = 2.0 * f64::from(pyramid.correction * scale * scale);
        let roughened = |([uu, uv, vv], texel): ([f64; 3], [f32; 4])| {
            let d = texture.range.values::<3>(texel).map(f64::from);
            let [ku, kv, kw] = match quantity {
                Quantity::Factor => [d[0] * d[0] + d[1] * d[1], d[1] * d[2], d[2] * d[2]],
                _ => [d[0] * d[0], 0.0, d[0] * d[0]],
            };
            [uu + weight * ku, uv + weight * kv, vv + weight * kw]
        };
        Ok(base.into_iter().zip(texels).map(roughened).collect())
    }

    /// Returns the squared alphas of the base lobes that K is added to.
    fn pyramid_base_alphas(&self) -> Result<Vec<[f64; 3]>, EncodeError> {
        let set = self.set;
        let encoding = Encoding::of(set.settings, 3).with_orm_metric();
        let roughness = self.read(&BaseRoughnessTexture(set.roughening), set.first, encoding)?;
        Ok(roughness.into_iter().map(|[_, roughness, ..]| shown_lobe(roughness, None)).collect())
    }

    /// Returns the squared alphas of the base lobe as the material's own textures have it.
    fn base_alphas(&self) -> Result<Vec<[f64; 3]>, EncodeError> {
        let row = |level, y, out: &mut [[f32; 4]]| {
            store_alphas(self.set.roughening.base_row(level, y, out.len()), out);
        };
        let rows = LevelRows { values: &row, lobes: None };
        let base = TextureSampler { sizes: &self.sizes, first: 0, encoding: None, rows, wrap: self.set.wrap };
        let texels = base.at(&self.sizes, &self.texels)?;
        Ok(texels.into_iter().map(|[uu, uv, vv, _]| [uu, uv, vv].map(f64::from)).collect())
    }

    fn read(&self, product: &dyn Product, first: usize, encoding: Encoding) -> Result<Vec<[f32; 4]>, EncodeError> {
        with_rows(product, |rows| self.read_rows(&product.sizes(), first, encoding, rows))
    }

    /// Reads a texture of `sizes`, whose finest level is `first`, at all sample points.
    fn read_rows(
        &self,
        sizes: &[(u32, u32)],
        first: usize,
        encoding: Encoding,
        rows: LevelRows<'_>,
    ) -> Result<Vec<[f32; 4]>, EncodeError> {
        let encoding = self.is_encoded.then_some(encoding);
        TextureSampler { sizes, first, encoding, rows, wrap: self.set.wrap }.at(&self.sizes, &self.texels)
    }
}

/// Stores squared alphas (uu, uv, vv) as texels.
fn store_alphas(lobes: Vec<SquaredAlpha>, out: &mut [[f32; 4]]) {
    out.iter_mut().zip(lobes).for_each(|(texel, SquaredAlpha(a))| *texel = [a.uu, a.uv, a.vv, 0.0]);
}

/// Returns the largest error of the lobes of each sample point.
fn largest(sites: &[&Site], lobes: Vec<Vec<Lobe>>) -> Errors {
    let error = |(site, lobes): (&&Site, &Vec<Lobe>)| lobes.iter().map(|l| site.reference.error(l)).fold(0.0, f64::max);
    sites.par_iter().zip(&lobes).map(error).collect()
}

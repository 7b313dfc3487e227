//! The footprint of a texel: the level-0 texels that it covers, from which references are made.

use crate::bump::NormalMap;
use crate::lobe::{OrientedLobe, SquaredAlpha};
use crate::math::symmetric::Symmetric2;
use crate::math::vector::{Vector, dot, normalised};

/// Level 0 of a bumpy surface: the normals that an engine decodes, each with the material's base lobe.
pub struct Surface {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) normals: Vec<Vector>,
    pub(super) base: Vec<[f64; 3]>,
}

/// A level-0 texel that a texel of a coarser level covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// Share of the coarser texel's area, or of its area x reflectance. The shares of a footprint sum to 1.
    pub weight: f64,
    /// Unit normal in (T, B, N).
    pub normal: Vector,
    /// Squared alphas of the base lobe: uu, uv, vv.
    pub base: [f64; 3],
}

impl Part {
    /// Returns the lobe of a part, whose weight is its share.
    pub(super) fn of(weight: f64, lobe: &OrientedLobe) -> Self {
        let a = lobe.squared_alpha.0;
        Self { weight, normal: lobe.normal.map(f64::from), base: [a.uu, a.uv, a.vv].map(f64::from) }
    }

    /// Returns the lobe in single precision.
    pub(super) fn lobe(&self) -> OrientedLobe {
        let [uu, uv, vv] = self.base.map(|a| a as f32);
        OrientedLobe { normal: self.normal.map(|c| c as f32), squared_alpha: SquaredAlpha(Symmetric2::new(uu, uv, vv)) }
    }
}

/// All level-0 texels that a texel of a coarser level covers: at least one.
#[derive(Clone, Debug, PartialEq)]
pub struct Footprint {
    parts: Vec<Part>,
}

/// The moments of a footprint, from which [`Peer`](crate::metric::Peer)s make their lobes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FootprintMoments {
    /// Mean of the unit normals. The more they differ, the shorter it is.
    pub mean_normal: Vector,
    /// Mean slopes (f_u, f_v).
    pub mean: [f64; 2],
    /// E\[f_u^2\], E\[f_u f_v\], E\[f_v^2\].
    pub second: [f64; 3],
    /// Covariance of the slopes, computed about their mean rather than as a difference of moments: uu, uv, vv.
    pub covariance: [f64; 3],
    /// The base lobe that mips of a roughness texture have, whose roughness is the mean: squared alphas uu, uv, vv.
    pub base: [f64; 3],
}

/// Returns a lobe's squared alphas, scaled so that they are linear in the roughness: a mean of them belongs to the mean
/// roughness. That of an anisotropic lobe is the fourth root of its mean squared alpha.
pub fn roughness_of_base([uu, uv, vv]: [f64; 3]) -> [f64; 3] {
    let roughness = (0.5 * (uu + vv)).max(0.0).sqrt().sqrt();
    let cube = roughness * roughness * roughness;
    if cube > 0.0 { [uu, uv, vv].map(|a| a / cube) } else { [0.0; 3] }
}

/// Returns the squared alphas of which [`roughness_of_base`] returns `scaled`.
pub fn base_of_roughness([uu, uv, vv]: [f64; 3]) -> [f64; 3] {
    let roughness = 0.5 * (uu + vv);
    [uu, uv, vv].map(|a| a * roughness * roughness * roughness)
}

impl Surface {
    /// Returns a surface of `width` x `height` texels, rows from the top. Normals are in (T, B, N) and may have any
    /// length. Returns `None` unless both lists have `width * height` entries, and at least one.
    pub fn new(width: u32, height: u32, normals: &[Vector], base: &[SquaredAlpha]) -> Option<Self> {
        let count = usize::try_from(u64::from(width) * u64::from(height)).ok()?;
        if count == 0 || normals.len() != count || base.len() != count {
            return None;
        }
        let normals = normals.iter().map(|n| normalised(*n)).collect();
        let base = base.iter().map(|a| [a.0.uu, a.0.uv, a.0.vv].map(f64::from)).collect();
        Some(Self { width, height, normals, base })
    }

    /// Returns the surface of a normal map whose material has the base lobe `base` everywhere.
    pub fn of_map(map: &NormalMap, base: SquaredAlpha) -> Self {
        let (width, height) = (map.width(), map.height());
        let mut normals = Vec::with_capacity(width as usize * height as usize);
        let mut row = vec![[0.0; 3]; width as usize];
        for y in 0..height {
            map.row(y, &mut row);
            normals.extend(row.iter().map(|n| normalised(n.map(f64::from))));
        }
        let base = vec![[base.0.uu, base.0.uv, base.0.vv].map(f64::from); normals.len()];
        Self { width, height, normals, base }
    }

    /// Returns the number of columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Returns the number of rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Returns the footprint of texel (`x`, `y`) of a level of `size` texels. Level-0 texels are weighted by the area
    /// that they share with the texel, whatever filter made the level. Coordinates outside the level are clamped to it.
    pub fn footprint(&self, size: (u32, u32), (x, y): (u32, u32)) -> Footprint {
        let across = overlaps(self.width, size.0, x);
        let down = overlaps(self.height, size.1, y);
        let mut parts = Vec::with_capacity(across.len() * down.len());
        for &(row, share_y) in &down {
            for &(column, share_x) in &across {
                let texel = row as usize * self.width as usize + column as usize;
                parts.push(Part { weight: share_x * share_y, normal: self.normals[texel], base: self.base[texel] });
            }
        }
        Footprint { parts }
    }
}

/// Returns the texels of an axis of length `old` that texel `i` of an axis of length `new` covers, with their shares.
pub(crate) fn overlaps(old: u32, new: u32, i: u32) -> Vec<(u32, f64)> {
    let (old, new) = (u64::from(old), u64::from(new.max(1)));
    let i = u64::from(i).min(new - 1);
    // In units of 1/(old * new) of the axis, all texel borders are integers.
    let (start, end) = (i * old, (i + 1) * old);
    let share = |texel: u64| end.min((texel + 1) * new) - start.max(texel * new);
    (start / new..end.div_ceil(new)).map(|texel| (texel as u32, share(texel) as f64 / old as f64)).collect()
}

impl Footprint {
    /// Returns a footprint of `parts`, whose weights are scaled to sum to 1. Returns `None` if a weight is negative, or
    /// if none is positive.
    pub fn new(mut parts: Vec<Part>) -> Option<Self> {
        let total: f64 = parts.iter().map(|p| p.weight).sum();
        if !(total > 0.0 && total.is_finite()) || parts.iter().any(|p| p.weight < 0.0) {
            return None;
        }
        for part in &mut parts {
            part.weight /= total;
            part.normal = normalised(part.normal);
        }
        Some(Self { parts })
    }

    /// Returns the level-0 texels.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// Returns the first and second moments. Slopes are bounded as if z were at least 0.001, also below the surface.
    pub fn moments(&self) -> FootprintMoments {
        let slopes = || self.parts.iter().map(|p| (p.weight, slope(p.normal)));
        let mut sums = FootprintMoments {
            mean_normal: [0.0; 3],
            mean: [0.0; 2],
            second: [0.0; 3],
            covariance: [0.0; 3],
            base: [0.0; 3],
        };
        for part in &self.parts {
            for i in 0..3 {
                sums.mean_normal[i] += part.weight * part.normal[i];
            }
            for (sum, value) in sums.base.iter_mut().zip(roughness_of_base(part.base)) {
                *sum += part.weight * value;
            }
        }
        sums.base = base_of_roughness(sums.base);
        for (weight, [u, v]) in slopes() {
            sums.mean = [sums.mean[0] + weight * u, sums.mean[1] + weight * v];
            add_products(&mut sums.second, weight, [u, v]);
        }
        for (weight, [u, v]) in slopes() {
            add_products(&mut sums.covariance, weight, [u - sums.mean[0], v - sums.mean[1]]);
        }
        sums
    }
}

pub(super) fn add_products(sums: &mut [f64; 3], weight: f64, [u, v]: [f64; 2]) {
    for (sum, product) in sums.iter_mut().zip([u * u, u * v, v * v]) {
        *sum += weight * product;
    }
}

/// Returns the slopes (f_u, f_v) = (-x/z, -y/z) of a normal, with z at least 0.001.
pub(super) fn slope([x, y, z]: Vector) -> [f64; 2] {
    let z = z.max(1e-3);
    [-x / z, -y / z]
}

impl FootprintMoments {
    /// Returns the unit mean normal.
    pub fn normal(&self) -> Vector {
        normalised(self.mean_normal)
    }

    /// Returns the length of the mean normal, in [0, 1].
    pub fn length(&self) -> f64 {
        dot(self.mean_normal, self.mean_normal).sqrt().min(1.0)
    }

    /// Returns the unit normal of the mean slopes.
    pub fn slope_normal(&self) -> Vector {
        normalised([-self.mean[0], -self.mean[1], 1.0])
    }
}

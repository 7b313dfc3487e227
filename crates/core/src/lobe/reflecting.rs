//! A lobe with its reflectance, for materials whose reflectance varies: parts of a merge count by area x reflectance.

use super::OrientedLobe;
use crate::mip::{MAX_PARTS, Merge};
use crate::simd::Real;

/// A texel with a lobe, and its weight beside other texels of equal area.
pub trait LobeTexel: Merge {
    /// Returns the lobe.
    fn lobe(&self) -> &OrientedLobe;

    /// Replaces the lobe.
    fn set_lobe(&mut self, lobe: OrientedLobe);

    /// Returns the reflectance, in (0, 1].
    fn reflectance(&self) -> f32;
}

/// A material of constant reflectance: texels of equal area have equal weights.
impl LobeTexel for OrientedLobe {
    fn lobe(&self) -> &OrientedLobe {
        self
    }

    fn set_lobe(&mut self, lobe: OrientedLobe) {
        *self = lobe;
    }

    fn reflectance(&self) -> f32 {
        1.0
    }
}

/// A lobe and its reflectance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReflectingLobe {
    /// The lobe.
    pub lobe: OrientedLobe,
    /// Directional average of the reflectance, in (0, 1]. The reflectance of a coarser texel is the mean over its area.
    pub reflectance: f32,
}

impl LobeTexel for ReflectingLobe {
    fn lobe(&self) -> &OrientedLobe {
        &self.lobe
    }

    fn set_lobe(&mut self, lobe: OrientedLobe) {
        self.lobe = lobe;
    }

    fn reflectance(&self) -> f32 {
        self.reflectance
    }
}

impl Merge for ReflectingLobe {
    type Numbers<F: Copy> = [F; 7];

    #[inline(always)]
    fn numbers(&self) -> [f32; 7] {
        let [x, y, z, uu, uv, vv] = self.lobe.numbers();
        [x, y, z, uu, uv, vv, self.reflectance]
    }

    #[inline(always)]
    fn of([x, y, z, uu, uv, vv, reflectance]: [f32; 7]) -> Self {
        Self { lobe: OrientedLobe::of([x, y, z, uu, uv, vv]), reflectance }
    }

    #[inline(always)]
    fn merged<F: Real, const MOST: usize>(weights: &[F], parts: &[[F; 7]]) -> [F; 7] {
        let zero = weights[0].splat_like(0.0);
        let (mut shares, mut lobes, mut total) = ([zero; MOST], [[zero; 6]; MOST], zero);
        for (i, (weight, [x, y, z, uu, uv, vv, reflectance])) in weights.iter().zip(parts).enumerate() {
            lobes[i] = [*x, *y, *z, *uu, *uv, *vv];
            shares[i] = *weight * *reflectance;
            total = total + shares[i];
        }
        for share in &mut shares[..parts.len()] {
            *share = *share / total;
        }
        let [x, y, z, uu, uv, vv] = OrientedLobe::merged::<F, MOST>(&shares[..parts.len()], &lobes[..parts.len()]);
        [x, y, z, uu, uv, vv, total]
    }

    fn merge(weights: &[f32], parts: &[Self]) -> Self {
        if parts.len() <= MAX_PARTS {
            let mut numbers = [[0.0; 7]; MAX_PARTS];
            numbers.iter_mut().zip(parts).for_each(|(numbers, part)| *numbers = part.numbers());
            return Self::of(Self::merged::<_, MAX_PARTS>(weights, &numbers[..parts.len()]));
        }
        let weights: Vec<f32> = weights.iter().zip(parts).map(|(weight, part)| weight * part.reflectance).collect();
        let reflectance = weights.iter().sum::<f32>();
        let shares: Vec<f32> = weights.iter().map(|weight| weight / reflectance).collect();
        let lobes: Vec<OrientedLobe> = parts.iter().map(|part| part.lobe).collect();
        Self { lobe: OrientedLobe::merge(&shares, &lobes), reflectance }
    }
}

#[cfg(test)]
mod tests;

//! Merging texels: what a coarser texel holds, given the finer ones that it covers.

use crate::bump::Offset;
use crate::symmetric::Symmetric2;

/// A value that can be merged over an area.
pub trait Merge: Copy + Default + Send + Sync {
    /// The merged value of `parts`. `weights` has the same length, is not negative and sums to 1.
    fn merge(weights: &[f32], parts: &[Self]) -> Self;
}

/// Mean and covariance of the offsets in the area of one texel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// Mean offset: what the bump pyramid stores.
    pub mean: Offset,
    /// Covariance K of the offsets about `mean`: what the roughness pyramid stores. Positive semidefinite.
    pub covariance: Symmetric2,
}

impl Moments {
    /// The moments of a texel in which the offset does not vary.
    pub fn flat(mean: Offset) -> Self {
        Self { mean, covariance: Symmetric2::ZERO }
    }
}

impl Merge for Moments {
    /// m = sum w m_i, K = sum w (K_i + (m_i - m)(m_i - m)^T): the paper's recursion ("The roughness pyramid", last
    /// formula) for any weights. Central moments throughout: `E[x^2] - E[x]^2` cancels (test
    /// `moment_subtraction_cancels_and_the_recursion_does_not`).
    #[inline]
    fn merge(weights: &[f32], parts: &[Self]) -> Self {
        let mut mean = Offset::default();
        for (w, part) in weights.iter().zip(parts) {
            mean.u += w * part.mean.u;
            mean.v += w * part.mean.v;
        }
        let mut covariance = Symmetric2::ZERO;
        for (w, part) in weights.iter().zip(parts) {
            let from_mean = [part.mean.u - mean.u, part.mean.v - mean.v];
            covariance = covariance + *w * (part.covariance + Symmetric2::outer(from_mean));
        }
        Self { mean, covariance }
    }
}

/// Plain averages, for channels whose variance no one needs.
impl<const N: usize> Merge for [f32; N]
where
    [f32; N]: Default,
{
    #[inline]
    fn merge(weights: &[f32], parts: &[Self]) -> Self {
        let mut sum = [0.0; N];
        for (w, part) in weights.iter().zip(parts) {
            for (s, p) in sum.iter_mut().zip(part) {
                *s += w * p;
            }
        }
        sum
    }
}

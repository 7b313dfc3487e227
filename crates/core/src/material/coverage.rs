//! The share of texels that an alpha test passes, which mips of masked materials keep.
//!
//! I. Castano, "Computing Alpha Mipmaps" (2010): averages move towards the mean alpha, so that a mask grows or vanishes
//! with the distance. The alphas of each level are therefore multiplied by a number that keeps the share. The number is
//! read off the sorted alphas, where the paper bisects.

/// Returns the share of `alphas` that pass a test against `cutoff`.
pub fn coverage(alphas: &[f32], cutoff: f32) -> f64 {
    let passing = alphas.iter().filter(|alpha| **alpha >= cutoff).count();
    passing as f64 / alphas.len().max(1) as f64
}

/// Returns the factor of `alphas` with which their share that passes a test against `cutoff`, above 0, is as close to
/// `coverage` as equal alphas allow. The factor puts the cutoff half way between the last alpha that passes and the
/// first that fails, so that rounding and encoding change neither.
pub fn scale_for_coverage(mut alphas: Vec<f32>, cutoff: f32, coverage: f64) -> f32 {
    let wanted = (coverage * alphas.len() as f64).round() as usize;
    alphas.sort_unstable_by(|a, b| b.total_cmp(a));
    let last = wanted.checked_sub(1).and_then(|last| alphas.get(last)).copied().unwrap_or(f32::INFINITY);
    // Equal alphas pass or fail together, and alphas of 0 always fail.
    let fewer = alphas.partition_point(|alpha| *alpha > last);
    let more = alphas.partition_point(|alpha| *alpha >= last && *alpha > 0.0);
    let passing = if wanted - fewer < more.saturating_sub(wanted) { fewer } else { more };
    let first_to_fail = alphas.get(passing).copied().unwrap_or(0.0);
    match passing.checked_sub(1).map(|last| alphas[last]) {
        Some(last) => cutoff / (0.5 * (last + first_to_fail)),
        // All alphas fail: the largest of them stays well below the cutoff.
        None => (0.5 * cutoff / first_to_fail.max(f32::MIN_POSITIVE)).min(1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scaled_alphas_keep_the_share_of_texels_that_pass() {
        for count in [1, 2, 16, 1000] {
            let alphas: Vec<f32> = (0..count).map(|i| ((i * 7919) % count) as f32 / count as f32).collect();
            for share in [0.0, 0.1, 0.5, 0.9, 1.0] {
                for cutoff in [0.1, 0.5, 1.0] {
                    let scale = scale_for_coverage(alphas.clone(), cutoff, share);
                    let scaled: Vec<f32> = alphas.iter().map(|alpha| alpha * scale).collect();
                    let most = alphas.iter().filter(|alpha| **alpha > 0.0).count() as f64 / count as f64;
                    let expected = ((share * count as f64).round() / count as f64).min(most);
                    assert_eq!(coverage(&scaled, cutoff), expected, "{count} {share} {cutoff}");
                }
            }
        }
    }

    #[test]
    fn equal_alphas_pass_together() {
        for (share, expected) in [(0.4, 0.0), (0.6, 1.0)] {
            let scale = scale_for_coverage(vec![0.25; 16], 0.5, share);
            assert_eq!(coverage(&[0.25 * scale; 16], 0.5), expected);
        }
        assert_eq!(scale_for_coverage(vec![0.0; 4], 0.5, 0.5), 1.0);
    }
}

//! The cheapest of several candidates that stays within the error bound, and why a bound cannot be met.

mod candidates;
mod case;
mod sampled;

pub use case::Candidates;

/// Differences between mean errors that a quick judgement cannot tell apart.
pub const NOISE: f32 = 0.01;

/// Which candidate to take. `errors` holds, in the order of rising cost, the error of each at every level that can be
/// sampled; all have as many. `None` when there is no candidate.
///
/// The most accurate candidate is the one that exceeds `max_error` least, summed over levels. Taken is the cheapest that
/// stays within `max_error` where the most accurate one does and is as accurate as it elsewhere, up to [`NOISE`]. So where
/// a bound can be met it is met by the least that does; where it cannot, nothing is saved that could be seen.
pub fn choose(errors: &[Vec<f32>], max_error: f32) -> Option<usize> {
    let excess = |errors: &Vec<f32>| errors.iter().map(|e| f64::from((e - max_error).max(0.0))).sum::<f64>();
    let best = errors.iter().min_by(|a, b| excess(a).total_cmp(&excess(b)))?;
    let bound = |best: &f32| if *best <= max_error { max_error } else { best + NOISE };
    errors.iter().position(|errors| errors.iter().zip(best).all(|(e, best)| *e <= bound(best)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cheapest_within_the_bound() {
        let errors = [vec![0.0, 0.3], vec![0.02, 0.09], vec![0.0, 0.01]];
        assert_eq!(choose(&errors, 0.1), Some(1));
        assert_eq!(choose(&errors, 0.3), Some(0));
        assert_eq!(choose(&errors, 0.05), Some(2));
        assert_eq!(choose(&[], 0.1), None);
        assert_eq!(choose(&[vec![], vec![]], 0.1), Some(0), "nothing can be sampled");
    }

    #[test]
    fn a_bound_that_none_meets_is_no_licence() {
        // No one meets 0.1 at level 2; at levels 0 and 1 the second is beyond it where the third is not.
        let errors = [vec![0.0, 0.5, 0.6], vec![0.12, 0.09, 0.3], vec![0.0, 0.09, 0.3]];
        assert_eq!(choose(&errors, 0.1), Some(2));
        // Within the bound it need not be as good as the best.
        let errors = [vec![0.09, 0.08, 0.305], vec![0.0, 0.01, 0.3]];
        assert_eq!(choose(&errors, 0.1), Some(0));
        let errors = [vec![0.09, 0.08, 0.32], vec![0.0, 0.01, 0.3]];
        assert_eq!(choose(&errors, 0.1), Some(1));
    }

    /// The bound itself has no margin: what meets it exactly is taken, what exceeds it a little is not.
    #[test]
    fn noise_does_not_widen_the_bound() {
        assert_eq!(choose(&[vec![0.105], vec![0.05]], 0.1), Some(1));
        assert_eq!(choose(&[vec![0.1], vec![0.05]], 0.1), Some(0));
    }
}

//! The rule by which one of several candidates is taken.

/// Differences between mean errors that samples of few texels cannot tell apart.
const NOISE: f32 = 0.01;

/// Returns the index of the candidate to take; `None` if there is no candidate. `errors` holds, in the order of rising
/// cost, the error of each candidate at every level that can be sampled.
///
/// The most accurate candidate is the one with the smallest sum of excesses over `max_error`. Taken is the cheapest
/// candidate that passes two tests: at levels where the most accurate candidate meets `max_error`, it meets `max_error`
/// too; at other levels it is as accurate as the most accurate candidate, up to `NOISE`. So a bound that can be met
/// is met at the least cost, and a bound that cannot be met is no reason to save anything visible.
pub fn choose(errors: &[Vec<f32>], max_error: f32) -> Option<usize> {
    let excess = |errors: &Vec<f32>| errors.iter().map(|e| f64::from((e - max_error).max(0.0))).sum::<f64>();
    let best = errors.iter().min_by(|a, b| excess(a).total_cmp(&excess(b)))?;
    let bound = |best: &f32| if *best <= max_error { max_error } else { best + NOISE };
    errors.iter().position(|errors| errors.iter().zip(best).all(|(e, best)| *e <= bound(best)))
}

#[cfg(test)]
mod tests;

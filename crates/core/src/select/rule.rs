//! The rule by which one of several candidates is taken.

/// Differences between mean errors that samples of few texels cannot tell apart.
const NOISE: f32 = 0.01;

/// The mean error over the screen that may be lost for a cheaper candidate.
const NEGLIGIBLE: f64 = 0.001;

/// The mean error over the screen that another texture of no more memory has to gain.
const SEEN: f64 = 0.0005;

/// Returns the index of the candidate to take; `None` if there is no candidate. `errors` holds, in the order of rising
/// cost, the error of each candidate at every level that can be sampled.
///
/// The most accurate candidate is the one with the smallest mean excess over `max_error`. Taken is the cheapest
/// candidate that is as accurate: at each level it is allowed `max_error` where the most accurate candidate meets
/// `max_error`, and elsewhere the error of that candidate plus `NOISE`. Its mean excess over these bounds is below
/// `NEGLIGIBLE`, and no level exceeds its bound by more than `NOISE`, because an object far away shows coarse levels
/// only. So a bound that can be met is met at the least cost, and a bound that cannot be met is no reason to save
/// anything visible.
pub fn choose(errors: &[Vec<f32>], max_error: f32) -> Option<usize> {
    let excess = |errors: &[f32]| mean(errors, |_, e| (e - max_error).max(0.0));
    let best = errors.iter().min_by(|a, b| excess(a).total_cmp(&excess(b)))?;
    let bound = |level: usize| if best[level] <= max_error { max_error } else { best[level] + NOISE };
    let above_bound = |level: usize, e: f32| (e - bound(level)).max(0.0);
    errors.iter().position(|errors| {
        errors.iter().enumerate().all(|(level, e)| above_bound(level, *e) <= NOISE)
            && mean(errors, above_bound) < NEGLIGIBLE
    })
}

/// Returns whether the mean error over the screen of one candidate is less than that of `other` by enough to be seen.
pub fn is_closer(errors: &[f32], other: &[f32]) -> bool {
    mean(other, |_, e| e) - mean(errors, |_, e| e) >= SEEN
}

/// Returns the mean of `of(level, error)` over the screen. A plane that reaches to the horizon shows each level on half
/// as much of the screen as the next finer level.
fn mean(errors: &[f32], of: impl Fn(usize, f32) -> f32) -> f64 {
    let (mut total, mut sum) = (0.0, 0.0);
    for (level, error) in errors.iter().enumerate() {
        let share = 0.5_f64.powi(level as i32);
        total += share;
        sum += share * f64::from(of(level, *error));
    }
    if total > 0.0 { sum / total } else { 0.0 }
}

#[cfg(test)]
mod tests;

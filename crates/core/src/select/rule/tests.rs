use super::*;

#[test]
fn takes_the_cheapest_within_the_bound() {
    let errors = [vec![0.0, 0.3], vec![0.02, 0.09], vec![0.0, 0.01]];
    assert_eq!(choose(&errors, 0.1), Some(1));
    assert_eq!(choose(&errors, 0.3), Some(0));
    assert_eq!(choose(&errors, 0.05), Some(2));
    assert_eq!(choose(&[], 0.1), None);
    assert_eq!(choose(&[vec![], vec![]], 0.1), Some(0), "nothing can be sampled");
}

#[test]
fn takes_an_accurate_candidate_where_none_meets_the_bound() {
    // No candidate meets 0.1 at level 2. At level 0 the second exceeds 0.1 and the third does not.
    let errors = [vec![0.0, 0.5, 0.6], vec![0.12, 0.09, 0.3], vec![0.0, 0.09, 0.3]];
    assert_eq!(choose(&errors, 0.1), Some(2));
    // Levels within the bound need not be as accurate as those of the most accurate candidate.
    let errors = [vec![0.09, 0.08, 0.305], vec![0.0, 0.01, 0.3]];
    assert_eq!(choose(&errors, 0.1), Some(0));
    let errors = [vec![0.09, 0.08, 0.32], vec![0.0, 0.01, 0.3]];
    assert_eq!(choose(&errors, 0.1), Some(1));
}

/// The bound itself has no margin: a candidate that meets the bound exactly is taken, and a slightly larger error is
/// not.
#[test]
fn noise_does_not_widen_the_bound() {
    assert_eq!(choose(&[vec![0.105], vec![0.05]], 0.1), Some(1));
    assert_eq!(choose(&[vec![0.1], vec![0.05]], 0.1), Some(0));
}

/// Coarse levels have a small share of the mean. They are all that an object far away shows.
#[test]
fn coarse_levels_keep_to_the_bound_as_well() {
    let coarse = |error: f32| {
        let mut errors = vec![0.05; 9];
        errors.extend([error; 2]);
        errors
    };
    assert_eq!(choose(&[coarse(0.3), coarse(0.08)], 0.1), Some(1));
    assert_eq!(choose(&[coarse(0.105), coarse(0.08)], 0.1), Some(0), "samples cannot tell this from the bound");
}

/// A gain counts by the share of the screen that shows the level.
#[test]
fn a_closer_candidate_gains_where_it_is_seen() {
    let none = [0.05; 8];
    let with = |level: usize, gain: f32| {
        let mut errors = none;
        errors[level] -= gain;
        errors
    };
    assert!(is_closer(&with(1, 0.0025), &none), "a quarter of the screen shows level 1");
    assert!(!is_closer(&with(1, 0.0015), &none) && !is_closer(&with(7, 0.04), &none) && !is_closer(&none, &none));
}

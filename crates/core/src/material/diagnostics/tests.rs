use std::collections::BTreeSet;

use super::*;

#[test]
fn sampled_rows_meet_every_phase_of_a_pattern() {
    for height in [128, 512, 1024, 2048, 4096] {
        for period in [2, 8, 32, 64] {
            let phases: BTreeSet<u32> = sampled_rows(height).map(|y| y % period).collect();
            assert_eq!(phases.len() as u32, period, "{height} rows");
        }
    }
    assert_eq!(sampled_rows(20).collect::<Vec<_>>(), (0..20).collect::<Vec<_>>());
}

use std::collections::BTreeSet;
use std::path::PathBuf;

use proptest::prelude::*;

use super::*;
use crate::digest::{Digest, digest};

fn job(number: u64, cost: u64) -> Job {
    Job {
        id: digest(&number.to_le_bytes()),
        source: PathBuf::new(),
        output: PathBuf::new(),
        name: None,
        settings: crate::project::Values::default(),
        inputs: Vec::new(),
        outputs: Vec::new(),
        cost,
        command: Vec::new(),
    }
}

fn grouped(jobs: &[Job]) -> Vec<Vec<Digest>> {
    let jobs: Vec<(usize, &Job)> = jobs.iter().enumerate().collect();
    groups(&jobs).into_iter().map(|group| group.into_iter().map(|(_, job)| job.id).collect()).collect()
}

proptest! {
    #[test]
    fn each_job_is_in_one_group_within_the_bounds(costs in prop::collection::vec(0..2 * SMALL, 0..300)) {
        let jobs: Vec<Job> = (0..).zip(&costs).map(|(number, cost)| job(number, *cost)).collect();
        let indexed: Vec<(usize, &Job)> = jobs.iter().enumerate().collect();
        let groups = groups(&indexed);
        let mut seen: Vec<usize> = groups.iter().flatten().map(|(index, _)| *index).collect();
        seen.sort_unstable();
        prop_assert_eq!(seen, (0..jobs.len()).collect::<Vec<_>>());
        for group in &groups {
            let cost: u64 = group.iter().map(|(_, job)| job.cost).sum();
            prop_assert!(group.len() == 1 || (cost <= MAX_COST && group.len() <= MAX_JOBS));
            prop_assert!(group.len() == 1 || group.iter().all(|(_, job)| job.cost < SMALL));
        }
        let firsts: Vec<_> = groups.iter().map(|group| group.iter().map(|(index, _)| *index).min()).collect();
        prop_assert!(firsts.is_sorted());
    }
}

#[test]
fn a_new_job_changes_one_group() {
    let jobs: Vec<Job> = (0..1000).map(|number| job(number, 1000)).collect();
    let before: BTreeSet<Vec<Digest>> = grouped(&jobs).into_iter().collect();
    assert!((30..100).contains(&before.len()), "{}", before.len());
    let mut all_changed = 0;
    for number in 1000..1100 {
        let new = job(number, 1000);
        let all: Vec<Job> = jobs.iter().chain([&new]).cloned().collect();
        let after: BTreeSet<Vec<Digest>> = grouped(&all).into_iter().collect();
        let changed = before.iter().filter(|group| !after.contains(*group)).count();
        // Two groups change where a bound ends a group.
        assert!(changed <= 2, "{changed}");
        all_changed += changed;
    }
    assert!(all_changed <= 110, "{all_changed}");
}

//! Which jobs share an action: alone what takes long, together what would take less time than an action costs.

use crate::run::Job;

/// Jobs below this many bytes of input are grouped: about half a second of a core. Measured: three real assets bake at 1.6, 1.6
/// and 4.4 MB of input per second of a core, the fixtures at 0.2 to 0.5 (docs/remote.md has the command).
const SMALL: u64 = 512 << 10;

/// The most that a group may cost: the same four times over.
const MOST: u64 = 4 * SMALL;

/// The most jobs in a group, however small.
const MANY: usize = 64;

/// Jobs that share an action, each with its index.
pub type Group<'a> = Vec<(usize, &'a Job)>;

/// Groups of `jobs`, each in the order of ids, themselves in the order of their first jobs.
///
/// Small jobs are sorted by id and cut after each id that ends in zero, so that one more or one less changes the group that
/// it is in, and no other (unless the bounds cut first, and then up to the next such id).
pub fn groups<'a>(jobs: &[(usize, &'a Job)]) -> Vec<Group<'a>> {
    let (large, mut small): (Vec<_>, Vec<_>) = jobs.iter().copied().partition(|(_, job)| job.cost >= SMALL);
    small.sort_by_key(|(_, job)| job.id);
    let mut groups: Vec<Group<'a>> = large.into_iter().map(|job| vec![job]).collect();
    let (mut group, mut cost) = (Group::new(), 0);
    for (index, job) in small {
        if cost + job.cost > MOST || group.len() == MANY {
            groups.push(std::mem::take(&mut group));
            cost = 0;
        }
        group.push((index, job));
        cost += job.cost;
        if ends_a_group(job) {
            groups.push(std::mem::take(&mut group));
            cost = 0;
        }
    }
    groups.push(group);
    groups.retain(|group| !group.is_empty());
    groups.sort_by_key(|group| group.iter().map(|(index, _)| *index).min());
    groups
}

/// Whether the id ends in zero, as a hexadecimal number.
fn ends_a_group(job: &Job) -> bool {
    job.id.as_bytes().last().is_some_and(|byte| byte & 0xf == 0)
}

#[cfg(test)]
mod tests {
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
            settings: serde_json::Map::new(),
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
        fn every_job_is_in_one_group_and_none_is_too_large(costs in prop::collection::vec(0..2 * SMALL, 0..300)) {
            let jobs: Vec<Job> = (0..).zip(&costs).map(|(number, cost)| job(number, *cost)).collect();
            let indexed: Vec<(usize, &Job)> = jobs.iter().enumerate().collect();
            let groups = groups(&indexed);
            let mut seen: Vec<usize> = groups.iter().flatten().map(|(index, _)| *index).collect();
            seen.sort_unstable();
            prop_assert_eq!(seen, (0..jobs.len()).collect::<Vec<_>>());
            for group in &groups {
                let cost: u64 = group.iter().map(|(_, job)| job.cost).sum();
                prop_assert!(group.len() == 1 || (cost <= MOST && group.len() <= MANY));
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
            // Two where the bounds cut.
            assert!(changed <= 2, "{changed}");
            all_changed += changed;
        }
        assert!(all_changed <= 110, "{all_changed}");
    }
}

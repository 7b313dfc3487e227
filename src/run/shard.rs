//! Parts of a plan that cost the same, on which machines agree without talking to each other.

use std::cmp::Reverse;

use crate::digest::Digest;
use crate::run::job::Job;

/// One of several parts of a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// From 1.
    pub index: u64,
    /// Number of parts.
    pub count: u64,
}

/// How much more than the mean a part may cost: 1 in this many.
const SLACK: u128 = 20;

impl Shard {
    /// Whether each of `jobs` is in this part.
    ///
    /// Each job has a part of its own, by its id; one that is full sends it to the next with room (V. Mirrokni, M. Thorup,
    /// M. Zadimoghaddam, "Consistent Hashing with Bounded Loads", SODA 2018). So the order of the jobs does not matter, and
    /// after a change to some of them most others stay on the machine whose cache has them.
    pub fn picks(&self, jobs: &[&Job]) -> Vec<bool> {
        let count = usize::try_from(self.count).unwrap_or(usize::MAX).min(jobs.len().max(1));
        // More parts than jobs: those that are beyond stay empty.
        let own = self.index - 1;
        parts(jobs, count).into_iter().map(|part| part as u64 == own).collect()
    }
}

/// The part of each job, from 0. The heaviest choose first; where none has room, the least loaded takes it.
fn parts(jobs: &[&Job], count: usize) -> Vec<usize> {
    let total: u128 = jobs.iter().map(|job| u128::from(job.cost)).sum();
    let mean = total.div_ceil(count as u128);
    let budget = mean + mean / SLACK;
    let mut order: Vec<usize> = (0..jobs.len()).collect();
    order.sort_by_key(|&at| (Reverse(jobs[at].cost), jobs[at].id, &jobs[at].source));
    let (mut loads, mut parts) = (vec![0_u128; count], vec![0; jobs.len()]);
    for at in order {
        let cost = u128::from(jobs[at].cost);
        let own = own_part(jobs[at].id, count);
        let mut from_own = (own..count).chain(0..own);
        let free = from_own.find(|&part| loads[part] + cost <= budget);
        let part = free.or_else(|| (0..count).min_by_key(|&part| loads[part])).unwrap_or(own);
        loads[part] += cost;
        parts[at] = part;
    }
    parts
}

fn own_part(id: Digest, count: usize) -> usize {
    // The first eight bytes as a number: 16 hexadecimal digits.
    let number = id.as_bytes()[..8].iter().fold(0, |number: u64, byte| number << 8 | u64::from(*byte));
    (number % count as u64) as usize
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use serde_json::Map;

    use super::*;

    fn job(name: usize, cost: u64) -> Job {
        Job {
            id: crate::digest::digest(&name.to_le_bytes()),
            source: PathBuf::from(format!("{name}.gltf")),
            output: PathBuf::new(),
            settings: Map::new(),
            inputs: Vec::new(),
            outputs: Vec::new(),
            cost,
            command: Vec::new(),
        }
    }

    /// Costs from 1 to a million, most of them small, as files are.
    fn library(count: usize) -> Vec<Job> {
        (0..count).map(|name| job(name, 1_000_000 / (1 + (name as u64 * 7919) % 1000))).collect()
    }

    fn loads(jobs: &[&Job], count: usize) -> Vec<u64> {
        let mut loads = vec![0; count];
        parts(jobs, count).into_iter().zip(jobs).for_each(|(part, job)| loads[part] += job.cost);
        loads
    }

    #[test]
    fn parts_cost_the_same_up_to_the_slack_or_to_one_job() {
        for (jobs, count) in [(1, 1), (7, 3), (100, 8), (1000, 8), (1000, 300)] {
            let jobs = library(jobs);
            let jobs: Vec<&Job> = jobs.iter().collect();
            let loads = loads(&jobs, count);
            let mean = loads.iter().sum::<u64>().div_ceil(count as u64);
            let heaviest = jobs.iter().map(|job| job.cost).max().expect("a job");
            let most = loads.iter().max().copied().expect("a part");
            assert!(most <= (mean + mean / 20).max(heaviest), "{count}: {most} against {mean}, {heaviest}");
        }
        let equal: Vec<Job> = (0..10).map(|name| job(name, 5)).collect();
        assert_eq!(loads(&equal.iter().collect::<Vec<_>>(), 5), [10; 5]);
        let free: Vec<Job> = (0..1000).map(|name| job(name, 0)).collect();
        let mut counts = [0; 4];
        parts(&free.iter().collect::<Vec<_>>(), 4).into_iter().for_each(|part| counts[part] += 1);
        assert!(counts.iter().all(|count| (200..300).contains(count)), "{counts:?}");
    }

    #[test]
    fn every_job_is_in_one_part_whatever_the_order() {
        let jobs = library(500);
        for count in [1, 3, 64, 600] {
            let mut picked = vec![0; jobs.len()];
            let forwards: Vec<&Job> = jobs.iter().collect();
            let backwards: Vec<&Job> = jobs.iter().rev().collect();
            for index in 1..=count {
                let shard = Shard { index, count };
                let picks = shard.picks(&forwards);
                assert!(picks.iter().eq(shard.picks(&backwards).iter().rev()), "{index}/{count}");
                picks.into_iter().enumerate().for_each(|(at, is_picked)| picked[at] += u32::from(is_picked));
            }
            assert_eq!(picked, [1; 500]);
        }
        assert_eq!(Shard { index: 3, count: u64::MAX }.picks(&[]), [false; 0]);
    }

    #[test]
    fn after_a_change_most_jobs_stay_where_they_were() {
        let before = library(1000);
        let mut after = library(1000);
        for (name, changed) in after.iter_mut().enumerate().step_by(20) {
            *changed = job(2000 + name, changed.cost + 100);
        }
        let place = |jobs: &[Job]| -> std::collections::BTreeMap<PathBuf, usize> {
            let sources = jobs.iter().map(|job| job.source.clone());
            sources.zip(parts(&jobs.iter().collect::<Vec<_>>(), 8)).collect()
        };
        let (before, after) = (place(&before), place(&after));
        let moved = after.iter().filter(|(source, part)| before.get(*source).is_some_and(|was| was != *part)).count();
        assert!(moved < 100, "{moved} of 950 moved; equal parts by order of cost would move seven in eight");
    }
}

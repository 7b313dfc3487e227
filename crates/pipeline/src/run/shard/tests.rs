use std::path::PathBuf;

use super::*;

fn job(name: usize, cost: u64) -> Job {
    Job {
        id: crate::digest::digest(&name.to_le_bytes()),
        source: PathBuf::from(format!("{name}.gltf")),
        output: PathBuf::new(),
        name: None,
        settings: crate::project::Values::default(),
        inputs: Vec::new(),
        outputs: Vec::new(),
        cost,
        command: Vec::new(),
    }
}

/// Returns jobs with costs from 1 to a million, most of them small, like files.
fn library(count: usize) -> Vec<Job> {
    (0..count).map(|name| job(name, 1_000_000 / (1 + (name as u64 * 7919) % 1000))).collect()
}

fn loads(jobs: &[&Job], count: usize) -> Vec<u64> {
    let mut loads = vec![0; count];
    parts(jobs, count).into_iter().zip(jobs).for_each(|(part, job)| loads[part] += job.cost);
    loads
}

#[test]
fn parts_have_equal_cost_up_to_the_slack_or_one_job() {
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
fn every_job_is_in_one_part_in_any_order() {
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
fn most_jobs_keep_their_part_after_a_change() {
    let before = library(1000);
    let mut after = library(1000);
    for (name, changed) in after.iter_mut().enumerate().step_by(20) {
        *changed = job(2000 + name, changed.cost + 100);
    }
    let part_of = |jobs: &[Job]| -> std::collections::BTreeMap<PathBuf, usize> {
        let sources = jobs.iter().map(|job| job.source.clone());
        sources.zip(parts(&jobs.iter().collect::<Vec<_>>(), 8)).collect()
    };
    let (before, after) = (part_of(&before), part_of(&after));
    let moved = after.iter().filter(|(source, part)| before.get(*source).is_some_and(|was| was != *part)).count();
    assert!(moved < 100, "{moved} of 950 moved; equal parts by order of cost would move seven in eight");
}

//! Parts of a plan with about equal cost, on which machines agree without communicating.

use std::cmp::Reverse;

use crate::digest::Digest;
use crate::run::job::Job;

/// One of several parts of a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// The index, from 1.
    pub index: u64,
    /// Number of parts.
    pub count: u64,
}

/// A part may cost more than the mean by one part in this many.
const SLACK: u128 = 20;

impl Shard {
    /// Returns for each of `jobs` whether it is in this part.
    ///
    /// The id of a job selects its part. If that part is full, the job goes to the next part with space (V. Mirrokni,
    /// M. Thorup, M. Zadimoghaddam, "Consistent Hashing with Bounded Loads", SODA 2018). The order of the jobs does not
    /// matter, and after a change of some jobs most other jobs stay on the machine whose cache has them.
    pub fn picks(&self, jobs: &[&Job]) -> Vec<bool> {
        let count = usize::try_from(self.count).unwrap_or(usize::MAX).min(jobs.len().max(1));
        // With more parts than jobs, the parts beyond the number of jobs stay empty.
        let index = self.index - 1;
        parts(jobs, count).into_iter().map(|part| part as u64 == index).collect()
    }
}

/// Returns the part of each job, from 0. The most expensive jobs choose first; if all parts are full, the part with the
/// smallest load takes the job.
fn parts(jobs: &[&Job], count: usize) -> Vec<usize> {
    let total: u128 = jobs.iter().map(|job| u128::from(job.cost)).sum();
    let mean = total.div_ceil(count as u128);
    let budget = mean + mean / SLACK;
    let mut order: Vec<usize> = (0..jobs.len()).collect();
    order.sort_by_key(|&at| (Reverse(jobs[at].cost), jobs[at].id, &jobs[at].source));
    let (mut loads, mut parts) = (vec![0_u128; count], vec![0; jobs.len()]);
    for at in order {
        let cost = u128::from(jobs[at].cost);
        let preferred = preferred_part(jobs[at].id, count);
        let mut candidates = (preferred..count).chain(0..preferred);
        let free = candidates.find(|&part| loads[part] + cost <= budget);
        let part = free.or_else(|| (0..count).min_by_key(|&part| loads[part])).unwrap_or(preferred);
        loads[part] += cost;
        parts[at] = part;
    }
    parts
}

/// Returns the part that `id` selects.
fn preferred_part(id: Digest, count: usize) -> usize {
    // The first eight bytes as a number: 16 hexadecimal digits.
    let number = id.as_bytes()[..8].iter().fold(0, |number: u64, byte| number << 8 | u64::from(*byte));
    (number % count as u64) as usize
}

#[cfg(test)]
mod tests;

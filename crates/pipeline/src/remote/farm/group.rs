//! Grouping of jobs into actions. Long jobs have their own action. Short jobs share one, since an action costs time
//! itself.

use crate::run::Job;

/// Jobs below this many bytes of input are grouped: about half a second on one core. Three real assets bake at 1.6, 1.6
/// and 4.4 MB of input per second on one core, and the fixtures at 0.2 to 0.5 (docs/remote.md has the command).
const SMALL: u64 = 512 << 10;

/// Largest cost of a group, in bytes of input.
const MAX_COST: u64 = 4 * SMALL;

/// Most jobs in a group.
const MAX_JOBS: usize = 64;

/// Jobs that share an action, each with its index.
pub type Group<'a> = Vec<(usize, &'a Job)>;

/// Returns the groups of `jobs`. The jobs of a group are in the order of ids, and the groups in the order of their
/// first jobs.
///
/// Small jobs are sorted by id, and a group ends after each id that ends in zero. An added or removed job therefore
/// changes only its own group. If a bound ends the group first, it changes the groups up to the next such id.
pub fn groups<'a>(jobs: &[(usize, &'a Job)]) -> Vec<Group<'a>> {
    let (large, mut small): (Vec<_>, Vec<_>) = jobs.iter().copied().partition(|(_, job)| job.cost >= SMALL);
    small.sort_by_key(|(_, job)| job.id);
    let mut groups: Vec<Group<'a>> = large.into_iter().map(|job| vec![job]).collect();
    let (mut group, mut cost) = (Group::new(), 0);
    for (index, job) in small {
        if cost + job.cost > MAX_COST || group.len() == MAX_JOBS {
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

/// Returns whether the id ends in zero, as a hexadecimal number.
fn ends_a_group(job: &Job) -> bool {
    job.id.as_bytes().last().is_some_and(|byte| byte & 0xf == 0)
}

#[cfg(test)]
mod tests;

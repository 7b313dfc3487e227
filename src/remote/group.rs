//! Which jobs share an action: alone what takes long, together what would take less time than an action costs.

use crate::plan::Job;

/// Jobs below this many bytes of input are grouped: half a second.
///
/// TODO measured
const SMALL: u64 = 1 << 20;

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
    small.sort_by(|(_, a), (_, b)| a.id.cmp(&b.id));
    let mut groups: Vec<Group<'a>> = large.into_iter().map(|job| vec![job]).collect();
    let (mut group, mut cost) = (Group::new(), 0);
    for (index, job) in small {
        if cost + job.cost > MOST || group.len() == MANY {
            groups.push(std::mem::take(&mut group));
            cost = 0;
        }
        group.push((index, job));
        cost += job.cost;
        if job.id.ends_with('0') {
            groups.push(std::mem::take(&mut group));
            cost = 0;
        }
    }
    groups.push(group);
    groups.retain(|group| !group.is_empty());
    groups.sort_by_key(|group| group.iter().map(|(index, _)| *index).min());
    groups
}

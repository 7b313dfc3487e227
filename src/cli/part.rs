//! `--shard`: which part of a plan, said or told by the scheduler.

use std::str::FromStr;

use crate::run::Shard;

/// Where schedulers tell the index of a task, from 0, and Slurm the largest of its array.
const INDICES: [&str; 3] = ["SLURM_ARRAY_TASK_ID", "AWS_BATCH_JOB_ARRAY_INDEX", "JOB_COMPLETION_INDEX"];
const LARGEST: &str = "SLURM_ARRAY_TASK_MAX";

/// A part, as it is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// From 1; `None` leaves it to the scheduler.
    index: Option<u64>,
    count: u64,
}

/// Why the scheduler's index cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PartError {
    /// There is none.
    #[error(
        "--shard /{count}: expected the index of an array job in {}, found none of them set; name the part, such as \
         --shard 1/{count}",
        INDICES.join(", ")
    )]
    NoIndex {
        /// Number of parts.
        count: u64,
    },
    /// It is no index of a part.
    #[error("--shard /{count}: expected 0 to {} in {name}, found {found:?}; number the array from 0", count - 1)]
    OutOfRange {
        /// Number of parts.
        count: u64,
        /// The variable.
        name: &'static str,
        /// What is in it.
        found: String,
    },
}

impl FromStr for Part {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str| text.parse::<u64>().ok().filter(|number| *number > 0);
        let parts = text.split_once('/').and_then(|(index, count)| match index {
            "" => Some((None, number(count)?)),
            index => Some((Some(number(index)?), number(count)?)),
        });
        match parts {
            Some((index, count)) if index.is_none_or(|index| index <= count) => Ok(Self { index, count }),
            _ => Err(format!("expected I/N with I from 1 to N, such as 2/8, or /N, found {text:?}")),
        }
    }
}

impl Part {
    /// The part, by the `variable`s of the environment where it is not named.
    ///
    /// # Errors
    /// [`PartError`].
    pub fn shard(self, variable: &dyn Fn(&str) -> Option<String>) -> Result<Shard, PartError> {
        let count = self.count;
        let index = match self.index {
            Some(index) => index,
            None => {
                let found = INDICES.iter().find_map(|name| Some((*name, variable(name)?)));
                let (name, found) = found.ok_or(PartError::NoIndex { count })?;
                // An array from 1 would leave out the first part: all its tasks are told, not the last one only.
                let largest = variable(LARGEST).filter(|_| name == INDICES[0]).map(|largest| (LARGEST, largest));
                let mut index = 0;
                for (name, found) in largest.into_iter().chain([(name, found)]) {
                    let is_below = |index: &u64| *index < count;
                    index = match found.parse().ok().filter(is_below) {
                        Some(index) => index,
                        None => return Err(PartError::OutOfRange { count, name, found }),
                    };
                }
                index + 1
            }
        };
        Ok(Shard { index, count })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shard(text: &str, variables: &[(&str, &str)]) -> Result<Shard, PartError> {
        let variable = |name: &str| variables.iter().find(|(n, _)| *n == name).map(|(_, value)| (*value).to_owned());
        text.parse::<Part>().expect("a part").shard(&variable)
    }

    #[test]
    fn what_is_said_wins_over_the_scheduler() {
        let set = [("SLURM_ARRAY_TASK_ID", "7")];
        assert_eq!(shard("3/8", &set), Ok(Shard { index: 3, count: 8 }));
        assert_eq!(shard("/8", &set), Ok(Shard { index: 8, count: 8 }));
    }

    #[test]
    fn every_scheduler_counts_from_0() {
        for name in INDICES {
            assert_eq!(shard("/8", &[(name, "0")]), Ok(Shard { index: 1, count: 8 }), "{name}");
            assert_eq!(shard("/8", &[(name, "7")]), Ok(Shard { index: 8, count: 8 }), "{name}");
            for wrong in ["8", "-1", "", "x", "99999999999999999999"] {
                let error = PartError::OutOfRange { count: 8, name, found: wrong.to_owned() };
                assert_eq!(shard("/8", &[(name, wrong)]), Err(error), "{name}");
            }
        }
        assert_eq!(shard("/8", &[]), Err(PartError::NoIndex { count: 8 }));
    }

    #[test]
    fn a_slurm_array_from_1_fails_in_every_task() {
        let task = |id, largest| shard("/8", &[("SLURM_ARRAY_TASK_ID", id), (LARGEST, largest)]);
        assert!(matches!(task("1", "8"), Err(PartError::OutOfRange { name: LARGEST, .. })));
        assert_eq!(task("3", "3"), Ok(Shard { index: 4, count: 8 }), "a task that is submitted again alone");
    }

    #[test]
    fn nonsense_is_refused() {
        for text in ["", "/", "0/2", "3/2", "/0", "2", "2/", "a/b", "-1/2", "1/2/3"] {
            assert!(text.parse::<Part>().is_err(), "{text:?}");
        }
    }
}

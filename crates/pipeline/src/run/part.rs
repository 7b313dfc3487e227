//! `--shard`: the part of a plan that a task runs, named by the user or by the scheduler of an array job.

use std::str::FromStr;

use crate::run::shard::Shard;

/// The variables in which schedulers pass the index of a task, from 0.
const INDICES: [&str; 3] = ["SLURM_ARRAY_TASK_ID", "AWS_BATCH_JOB_ARRAY_INDEX", "JOB_COMPLETION_INDEX"];

/// The variable in which Slurm passes the largest index of an array.
const LARGEST: &str = "SLURM_ARRAY_TASK_MAX";

/// A part, as the user asks for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// The index from 1; `None` where the scheduler decides.
    index: Option<u64>,
    count: u64,
}

/// Why the scheduler's index cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PartError {
    /// No variable with an index is set.
    #[error(
        "--shard /{count}: expected the index of an array job in {}, found none of them set; name the part, such as \
         --shard 1/{count}",
        INDICES.join(", ")
    )]
    NoIndex {
        /// Number of parts.
        count: u64,
    },
    /// The variable holds no index of a part.
    #[error("--shard /{count}: expected 0 to {} in {name}, found {found:?}; number the array from 0", count - 1)]
    OutOfRange {
        /// Number of parts.
        count: u64,
        /// The variable.
        name: &'static str,
        /// The content of the variable.
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
    /// Returns the shard. Where the user names no index, `variable` reads it from the environment.
    ///
    /// # Errors
    /// [`PartError`] where the environment has no index of a part.
    pub fn shard(self, variable: &dyn Fn(&str) -> Option<String>) -> Result<Shard, PartError> {
        let count = self.count;
        let index = match self.index {
            Some(index) => index,
            None => {
                let found = INDICES.iter().find_map(|name| Some((*name, variable(name)?)));
                let (name, found) = found.ok_or(PartError::NoIndex { count })?;
                // An array from 1 would leave out the first part. The check of the largest index makes every task of
                // such an array fail, not the last task only.
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
mod tests;

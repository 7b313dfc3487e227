//! The choice of a model: candidates, their errors and costs, the cheapest candidate within the error bound, and the
//! reasons why a bound is missed. Candidates are measured at sample points, before any of them is baked.

mod candidate_set;
mod evaluate;
mod misses;
mod rule;
mod shown;
mod texture_samples;

pub use candidate_set::{CandidateSet, PyramidData};
pub use rule::choose;

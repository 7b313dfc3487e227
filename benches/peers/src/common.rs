//! The synthetic maps and the copy that the other benches use.

#![allow(dead_code, reason = "not all of it is needed here")]

#[path = "../../common/copy.rs"]
pub mod copy;
#[path = "../../common/maps.rs"]
pub mod maps;
#[path = "../../studies/generate_fixtures/fixtures/noise.rs"]
mod noise;
#[path = "../../studies/generate_fixtures/fixtures/picture.rs"]
mod picture;

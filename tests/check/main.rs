//! Tests of `check` and `inspect` on fresh and damaged bakes, and of their outputs against the schemas.

mod bounded;
mod clean;
mod current;
mod documents;
mod fix;
mod fixture;
mod formats;
mod inputs;
mod inspect;
mod matrix;
mod schemas;
#[path = "../common/skip.rs"]
mod skip;
mod storage;
mod table;
mod textures;
mod view;

//! `check` and `inspect` on fresh bakes, whole and damaged, and their outputs against the schemas.

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
mod storage;
mod table;
mod textures;
mod view;

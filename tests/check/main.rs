//! `check` and `inspect` on fresh bakes, whole and damaged, and their outputs against the schemas.

mod clean;
mod current;
mod documents;
mod fix;
mod fixture;
mod formats;
mod inspect;
mod schemas;
mod table;
mod textures;
mod view;

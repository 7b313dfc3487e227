//! Tests the command as its users run it: processes, folders, exit codes, bytes. They are one program, because each
//! program takes time to link.

mod bad_input;
mod build;
mod bytes;
mod cache;
mod compare;
mod config;
mod containers;
mod farm;
mod fixtures;
mod goldens;
mod merge;
mod notes;
mod own_anisotropy;
mod plain_textures;
mod plan;
mod process;
#[path = "../common/random.rs"]
mod random;
mod rdo;
mod real;
mod render;
mod scale_normals;
mod shared_bump_map;
#[path = "../common/skip.rs"]
mod skip;
mod survival;
mod transcripts;
mod trust;
mod validator;
mod watch;

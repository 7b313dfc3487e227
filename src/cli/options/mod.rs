//! Groups of options that several commands have.

pub mod cache;
pub mod job_choice;
pub mod remote;
pub mod selection;
pub mod texture;
pub mod view;

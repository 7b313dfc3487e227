//! KTX2 containers: our own writer, and a reader for everyone's files.

mod basis;
mod blocks;
mod error;
mod formats;
mod inflate;
mod provenance;
mod read;
mod texels;
mod write;

pub use error::ReadError;
pub use provenance::{PROVENANCE_KEY, Provenance, SourceDigest, provenance};
pub use read::{Ktx2, Level, decode_payload};
pub use write::{Key, Ktx2Writer, StoredLevel, Storing};

#[cfg(test)]
mod formats_tests;
#[cfg(test)]
mod read_tests;
#[cfg(test)]
mod test_files;
#[cfg(test)]
mod write_tests;

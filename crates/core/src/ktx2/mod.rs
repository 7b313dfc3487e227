//! KTX2 containers: a writer, and a reader for files of any writer.

mod basis;
mod blocks;
mod error;
mod formats;
mod inflate;
mod provenance;
mod read;
mod uncompressed;
mod write;

pub use error::ReadError;
pub use provenance::{PROVENANCE_KEY, Provenance, SourceDigest, provenance};
pub use read::{Ktx2, Level, decode_payload};
pub use write::{Key, Ktx2Writer, LevelWriter, StoredLevel};

#[cfg(test)]
mod test_files;

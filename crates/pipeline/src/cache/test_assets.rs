//! Assets and damage for the tests of both caches.

use std::io;
use std::path::{Path, PathBuf};

use crate::bake::{BakedAsset, NewFile, Source, bake_asset};
use crate::cache::Fits;
use crate::digest::{Digest, digest};
use crate::gltf::document::Document;
use crate::settings::Settings;

/// Accepts every entry.
pub const ANY: Fits<'_> = &|_| Ok(());

/// Returns the id of a job.
pub fn id(number: u8) -> Digest {
    digest(&[number])
}

/// Returns an asset of the document `{}`, a texture that holds `content`, and a copied file.
pub fn baked(content: &[u8]) -> BakedAsset {
    let document = Document::parse(br#"{ "asset": { "version": "2.0" } }"#).expect("a document");
    let no_files = |_: &Path| -> io::Result<Vec<u8>> { Err(io::ErrorKind::NotFound.into()) };
    let source = Source::new("a", &document, &no_files);
    let mut baked = bake_asset(&source, &Settings::default(), &|_| ()).expect("a document without bumps");
    baked.document = b"{}".to_vec();
    baked.files = vec![NewFile::new("a.roughcast/a.ktx2", content.to_vec())];
    baked.copies = vec![PathBuf::from("a.bin")];
    baked
}

/// Returns `bytes` with each byte changed in turn, and each beginning of `bytes`.
pub fn damaged(bytes: &[u8]) -> impl Iterator<Item = Vec<u8>> {
    (0..bytes.len()).flat_map(move |at| {
        let mut changed = bytes.to_vec();
        changed[at] ^= 1;
        [changed, bytes[..at].to_vec()]
    })
}

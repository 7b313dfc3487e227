//! Provenance, and whether the sources are still what was baked.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io;
use std::path::Path;

use super::findings::{Code, Findings};
use crate::bake::Source;
use crate::gltf::document::Document;
use crate::gltf::texture::ImageLocation;
use crate::texture::ktx2::{Ktx2, PROVENANCE_KEY, Provenance, provenance};

/// The sources of one baked asset, with digests that were computed.
pub struct Origin<'a> {
    document: Option<Document>,
    read: &'a (dyn Fn(&Path) -> io::Result<Vec<u8>> + Sync),
    digests: RefCell<BTreeMap<String, Result<Vec<String>, String>>>,
}

impl<'a> Origin<'a> {
    /// Sources beside `document`, or of a bare map where there is none. `read` takes paths relative to it.
    pub fn new(document: Option<Document>, read: &'a (dyn Fn(&Path) -> io::Result<Vec<u8>> + Sync)) -> Self {
        Self { document, read, digests: RefCell::default() }
    }

    /// BLAKE3 digests of what the provenance calls `uri`; several where the name is not unique.
    fn digests(&self, uri: &str) -> Result<Vec<String>, String> {
        self.digests.borrow_mut().entry(uri.to_owned()).or_insert_with(|| self.hash(uri)).clone()
    }

    fn hash(&self, uri: &str) -> Result<Vec<String>, String> {
        let locations = self.locations(uri);
        if locations.is_empty() {
            return Err("no such image in the source document".to_owned());
        }
        let hash = |location| Ok(blake3::hash(&self.bytes(location)?).to_hex().to_string());
        locations.iter().map(hash).collect()
    }

    fn bytes(&self, location: &ImageLocation) -> Result<Vec<u8>, String> {
        match (&self.document, location) {
            (Some(document), _) => {
                Source { stem: "", document, read: self.read }.image(location).map_err(|e| e.to_string())
            }
            // `map` records names of files, not URIs; a folder before the name is not of its making.
            (None, ImageLocation::Uri(name)) => {
                let name = Path::new(name).file_name().ok_or("a name that is none")?;
                (self.read)(Path::new(name)).map_err(|e| e.to_string())
            }
            (None, ImageLocation::BufferView(_)) => Err("a buffer view without a source document".to_owned()),
        }
    }

    /// The images that `describe` of `bake` may have meant: of a data URI it keeps the beginning only.
    fn locations(&self, uri: &str) -> Vec<ImageLocation> {
        let view = uri.strip_prefix("bufferViews[").and_then(|rest| rest.strip_suffix(']')?.parse().ok());
        if let Some(view) = view {
            return vec![ImageLocation::BufferView(view)];
        }
        let Some(start) = uri.strip_suffix("...").filter(|start| start.starts_with("data:")) else {
            return vec![ImageLocation::Uri(uri.to_owned())];
        };
        let Some(json) = self.document.as_ref().map(Document::json) else { return Vec::new() };
        let uris = (0..json.len("/images").unwrap_or(0)).filter_map(|i| json.read(&format!("/images/{i}/uri")).ok()?);
        uris.filter(|uri: &String| uri.starts_with(start)).map(ImageLocation::Uri).collect()
    }
}

/// Reads the provenance, and compares its digests with those of `origin` where one is given.
pub fn check_origin(file: &Ktx2<'_>, origin: Option<&Origin<'_>>, findings: &mut Findings) -> Option<Provenance> {
    let place = format!("key {PROVENANCE_KEY}");
    let found = provenance(file);
    let Some(found) = found else {
        if file.key_values().any(|(key, _)| key == PROVENANCE_KEY) {
            let message = "expected version, content, settings and sources as JSON, found something else; bake again";
            findings.add(Code::BadProvenance, place, message);
        } else if origin.is_some() {
            let message =
                "expected digests of the sources, found none; bake without --no-provenance, or check without --source";
            findings.add(Code::Untraceable, place, message);
        } else {
            findings.add(
                Code::NoProvenance,
                place,
                "expected where the texture comes from, found nothing; bake without --no-provenance",
            );
        }
        return None;
    };
    let version = env!("CARGO_PKG_VERSION");
    if found.version != version {
        let message =
            format!("expected version {version}, found {}; bake again for this version's output", found.version);
        findings.add(Code::OtherVersion, &place, message);
    }
    if let Some(origin) = origin {
        for source in &found.sources {
            match origin.digests(&source.uri) {
                Err(reason) => {
                    let message = format!("expected the source {}, found: {reason}", source.uri);
                    findings.add(Code::MissingSource, &place, message);
                }
                Ok(digests) if !digests.contains(&source.blake3) => {
                    let message =
                        format!("expected the source {} as it was baked, found it changed; bake again", source.uri);
                    findings.add(Code::Stale, &place, message);
                }
                Ok(_) => {}
            }
        }
    }
    Some(found)
}

//! The provenance of a texture (version, settings and sources of its bake), and whether it is still up to date.

use std::cmp::Ordering;

use semver::Version;

use super::findings::{Code, Findings};
use super::scope::Scope;
use super::settings::check_settings;
use super::source_digests::SourceDigests;
use crate::bake::DocumentProvenance;
use crate::digest::digest;
use crate::gltf::document::Document;
use crate::ktx2::{Ktx2, PROVENANCE_KEY, Provenance, SourceDigest, provenance};

/// Reads the provenance and compares it with the sources, settings and versions of `scope`.
pub fn check_provenance(file: &Ktx2<'_>, scope: &Scope<'_>, findings: &mut Findings) -> Option<Provenance> {
    let place = format!("key {PROVENANCE_KEY}");
    let found = provenance(file).and_then(|found| Some((Version::parse(&found.version).ok()?, found)));
    let Some((version, found)) = found else {
        if file.key_values().any(|(key, _)| key == PROVENANCE_KEY) {
            let message = "expected version, content, settings and sources as JSON, found something else; bake again";
            findings.add(Code::BadProvenance, place, message);
        } else if scope.origin.is_some() {
            let message =
                "expected digests of the sources, found none; bake without --no-provenance, or check without --source";
            findings.add(Code::Untraceable, place, message);
        } else {
            findings.add(Code::NoProvenance, place, "expected provenance, found none; bake without --no-provenance");
        }
        return None;
    };
    check_version(&version, scope.min_version, &place, findings);
    if let Some(origin) = scope.origin {
        check_sources(&found.sources, origin, &place, findings);
    }
    if let Some(expected) = scope.settings {
        check_settings(&found.settings, expected, &place, findings);
    }
    check_bound(&found, &place, findings);
    Some(found)
}

fn check_version(found: &Version, min: Option<&Version>, place: &str, findings: &mut Findings) {
    let own = env!("CARGO_PKG_VERSION");
    if let Some(min) = min.filter(|min| found.cmp_precedence(min) == Ordering::Less) {
        let message = format!("expected version {min} or newer, found {found}; bake again");
        findings.add(Code::OldVersion, place, message);
        return;
    }
    let Ok(running) = Version::parse(own) else { return };
    match found.cmp_precedence(&running) {
        Ordering::Less => {
            let message = format!("expected version {own}, found {found}; bake again for this version's output");
            findings.add(Code::OtherVersion, place, message);
        }
        Ordering::Greater => {
            let message = format!(
                "expected version {own} or older, found {found}, whose output this version may not understand; check \
                 with version {found}"
            );
            findings.add(Code::NewerVersion, place, message);
        }
        Ordering::Equal => {}
    }
}

/// Compares the recorded sources of `document`, whose bytes are `bytes`, with `origin`. `has_textures` says whether the
/// document has baked textures; their own provenance covers their source images.
pub fn check_document_provenance(
    document: &Document,
    bytes: &[u8],
    has_textures: bool,
    origin: &SourceDigests<'_>,
    findings: &mut Findings,
) {
    let Some((source, source_digest)) = origin.document() else { return };
    // A document without bumps is copied unchanged and has no provenance.
    if digest(bytes) == source_digest {
        return;
    }
    let is_stale = match DocumentProvenance::read(document) {
        Some(found) => {
            check_sources(&found.files, origin, DocumentProvenance::POINTER, findings);
            found.document != source_digest
        }
        None if has_textures || document.container() != source.container() => {
            let message = "expected the digest of the source document, found none; bake without --no-provenance, or \
                           check without --source";
            findings.add(Code::Untraceable, DocumentProvenance::POINTER, message);
            false
        }
        None => true,
    };
    if is_stale {
        let message = "expected the source document as it was baked, found it changed; bake again";
        findings.add(Code::Stale, "", message);
    }
}

fn check_sources(sources: &[SourceDigest], origin: &SourceDigests<'_>, place: &str, findings: &mut Findings) {
    for source in sources {
        match origin.digests(&source.uri) {
            Err(reason) => {
                let message = format!("expected the source {}, found: {reason}", source.uri);
                findings.add(Code::MissingSource, place, message);
            }
            Ok(digests) if !digests.contains(&source.blake3) => {
                let message =
                    format!("expected the source {} as it was baked, found it changed; bake again", source.uri);
                findings.add(Code::Stale, place, message);
            }
            Ok(_) => {}
        }
    }
}

/// Compares the lobe errors recorded at bake time with the recorded `--max-error`.
fn check_bound(found: &Provenance, place: &str, findings: &mut Findings) {
    // An anisotropy texture has the errors of its roughness texture, which reports them.
    let Some(bound) = found.settings["maxError"].as_f64().filter(|_| found.content != "anisotropy") else { return };
    let bound = bound as f32;
    let above = found.lobe_errors.iter().filter(|error| **error > bound).count();
    if above > 0 {
        let worst = found.lobe_errors.iter().copied().fold(0.0, f32::max);
        let message = format!(
            "expected a lobe error of at most {bound} at every level, found more at {above} of {} levels (worst \
             {worst:.3}); bake with --verbose to see why",
            found.lobe_errors.len()
        );
        findings.add(Code::LobeError, place, message);
    }
}

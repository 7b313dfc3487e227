//! Checks of a baked glTF document and of every file that the document names.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use ::gltf::json::{Image, Root};
use serde_json::Value;

use super::files::{Files, ReferencedFiles};
use super::findings::{Code, Finding, Findings};
use super::materials::{Uses, check_materials};
use super::partial_file::PartialFile;
use super::provenance::check_document_provenance;
use super::pyramid_levels::{OffsetFile, RoughnessFile, check_pyramid_levels};
use super::scope::Scope;
use super::texture::{Usage, check_texture};
use super::texture_references::{TextureReferences, Textures};
use crate::bake::SourceError;
use crate::gltf::document::{Container, Document, DocumentError};
use crate::gltf::material::materials;
use crate::gltf::roughness_pyramid::RoughnessPyramid;
use crate::gltf::texture::ImageLocation;
use crate::gltf::uri::{Uri, relative_path};
use crate::ktx2::Ktx2;

const KTX2_MIME: &str = "image/ktx2";

/// The result of the check of a document.
pub struct CheckedDocument {
    /// The findings of the document, then those of its images; the order is always the same.
    pub findings: Vec<Finding>,
    /// Files that the document names, relative to the document.
    pub files: Vec<PathBuf>,
}

/// Checks the document `name`, whose bytes are `bytes`. `files` reads the files in the document's folder.
pub fn check_document(name: &str, bytes: &[u8], files: &dyn Files, scope: &Scope<'_>) -> CheckedDocument {
    let mut findings = Findings::new(name);
    let (document, value, root) = match parse(bytes) {
        Ok(parsed) => parsed,
        Err(message) => {
            findings.add(Code::UnreadableDocument, "", message);
            return CheckedDocument { findings: findings.into_list(), files: Vec::new() };
        }
    };
    let settings = scope.settings.map(|settings| settings.resolved_for(document.container()));
    let scope = &Scope { settings: settings.as_ref(), ..*scope };
    let textures = Textures::read(&root, &mut findings);
    let uses = check_materials(&root, &value, &textures, &mut findings);
    textures.check_declarations(&root, &value, &mut findings);
    let referenced = ReferencedFiles::new(&document, &value, files, scope.is_deep);
    check_buffers(&root, &referenced, &mut findings);

    let of_images = Findings::new(name);
    let mut images = Images { name, referenced, root: &root, scope, contents: BTreeMap::new(), findings: of_images };
    for image in 0..root.images.len() {
        images.check(image, &textures, &uses, &mut findings);
    }
    images.check_pyramids(&uses.pyramids, &textures, &mut findings);
    let has_textures = !images.contents.is_empty();
    if !has_textures && materials(&value).iter().flatten().any(|material| !material.layers.is_empty()) {
        let message = "expected KTX2 textures of a bake, found bumps and no KTX2; if this is a source, bake it and \
                       check its output";
        findings.add(Code::NothingBaked, "", message);
    }
    let is_baked = images.contents.values().any(Option::is_some);
    if let Some(origin) = scope.origin {
        check_document_provenance(&document, bytes, has_textures, origin, &mut findings);
    }
    if let Some(settings) = scope.settings.filter(|_| is_baked) {
        let is_glb = document.container() == Container::Glb;
        if let Some(expected) = settings.glb.filter(|expected| *expected != is_glb) {
            let message =
                format!("expected glb = {expected}, found glb = {is_glb}; bake again, and delete this document");
            findings.add(Code::OtherSettings, "", message);
        }
    }
    let mut list = findings.into_list();
    list.append(&mut images.findings.into_list());
    CheckedDocument { findings: list, files: named_files(&root) }
}

/// Parses the document with our reader, and with the typed reader of crate `gltf`: engines refuse what that reader
/// refuses. The error is the message of a finding.
fn parse(bytes: &[u8]) -> Result<(Document, Value, Root), String> {
    let parsed = Document::parse(bytes).and_then(|document| {
        let value = document.json().value("")?.unwrap_or_default();
        Ok((document, value))
    });
    let unreadable = |reason: String| format!("expected a glTF 2.0 document, found: {reason}; bake again");
    let (document, value) = parsed.map_err(|error| match error {
        DocumentError::Json(error) => unreadable(error.to_string()),
        // The message says what was expected, and what to do.
        other => other.to_string(),
    })?;
    let root = ::gltf::json::deserialize::from_value(value.clone()).map_err(|error| unreadable(error.to_string()))?;
    Ok((document, value, root))
}

fn check_buffers(root: &Root, referenced: &ReferencedFiles<'_>, findings: &mut Findings) {
    for (index, buffer) in root.buffers.iter().enumerate() {
        let Some(uri) = &buffer.uri else { continue };
        let place = format!("/buffers/{index}");
        match referenced.buffer_length(uri) {
            Ok(length) if length < buffer.byte_length.0 => {
                let message = format!("expected {} bytes, found {length}; bake again", buffer.byte_length.0);
                findings.add(Code::BadReference, place, message);
            }
            result => add_error(result.err(), &place, findings),
        }
    }
}

fn add_error(error: Option<SourceError>, place: &str, findings: &mut Findings) {
    match error {
        None => {}
        Some(error @ SourceError::Read { .. }) => findings.add(Code::MissingFile, place, error.to_string()),
        Some(error) => findings.add(Code::BadReference, place, error.to_string()),
    }
}

/// The images of a document, checked one by one.
struct Images<'a> {
    name: &'a str,
    referenced: ReferencedFiles<'a>,
    root: &'a Root,
    scope: &'a Scope<'a>,
    /// Content of each KTX2 image by its provenance; other images have no entry.
    contents: BTreeMap<usize, Option<String>>,
    /// Findings about KTX2 images.
    findings: Findings,
}

impl Images<'_> {
    fn check(&mut self, index: usize, textures: &Textures, uses: &Uses, findings: &mut Findings) {
        let Some(image) = self.root.images.get(index) else { return };
        let place = format!("/images/{index}");
        let Some(location) = location(image) else {
            findings.add(Code::BadReference, place, "expected a uri or a bufferView, found neither; bake again");
            return;
        };
        let partial = match self.referenced.image(&location) {
            Ok(partial) => partial,
            Err(error) => return add_error(Some(error), &place, findings),
        };
        let mime = image.mime_type.as_ref().map(|m| m.0.as_str());
        for (texture, sources) in textures.users(index).filter(|(_, t)| t.core == Some(index)) {
            check_core_source(texture, sources, &partial, mime, findings);
        }
        let usage = Usage {
            by_basisu: textures.users(index).any(|(_, t)| t.basisu == Some(index)),
            normals: textures.users(index).any(|(texture, _)| uses.normals.contains(&texture)),
            colours: textures.users(index).any(|(texture, _)| uses.colours.contains(&texture)),
        };
        if partial.is_ktx2() || usage.by_basisu {
            match external(&location) {
                Some(path) => self.findings.set_file(sibling_path(self.name, &path), ""),
                None => self.findings.set_file(self.name, place),
            }
            let content = check_texture(partial.as_ktx2(), usage, self.scope, &mut self.findings);
            self.contents.insert(index, content);
        }
    }

    /// Reads the KTX2 of a texture.
    fn ktx2(&self, texture: usize, textures: &Textures) -> Option<PartialFile> {
        let image = self.root.images.get(textures.get(texture).basisu?)?;
        self.referenced.image(&location(image)?).ok()
    }

    /// Checks the textures of each extension, and their levels in a deep check.
    fn check_pyramids(&self, pyramids: &[(String, RoughnessPyramid)], textures: &Textures, findings: &mut Findings) {
        // Materials that share textures and ranges share the result.
        let mut results: BTreeMap<String, Vec<(u32, String)>> = BTreeMap::new();
        for (pointer, pyramid) in pyramids {
            check_contents(pointer, pyramid, textures, &self.contents, findings);
            if self.scope.is_deep {
                let key = self.levels_key(pyramid, textures);
                let found = results.entry(key).or_insert_with(|| self.check_levels(pyramid, textures));
                for (level, message) in found {
                    findings.add(Code::PyramidLevel, format!("{pointer}, level {level}"), message.as_str());
                }
            }
        }
    }

    /// Returns a key of everything that the levels of a pyramid depend on.
    fn levels_key(&self, pyramid: &RoughnessPyramid, textures: &Textures) -> String {
        let image = |texture: usize| textures.get(texture).basisu;
        let roughness = pyramid.roughness_texture.as_ref().map(|info| image(info.index));
        let RoughnessPyramid { offset_channels, offset_scale, roughness_min, roughness_max, .. } = pyramid;
        let values = (offset_channels, offset_scale, roughness_min, roughness_max);
        format!("{:?}", (image(pyramid.offset_texture.index), roughness, pyramid.roughness_model, values))
    }

    fn check_levels(&self, pyramid: &RoughnessPyramid, textures: &Textures) -> Vec<(u32, String)> {
        let Some(offset) = self.ktx2(pyramid.offset_texture.index, textures) else { return Vec::new() };
        let roughness = pyramid.roughness_texture.as_ref().and_then(|info| self.ktx2(info.index, textures));
        let roughness = match (&pyramid.roughness_model, &roughness, &pyramid.roughness_min, &pyramid.roughness_max) {
            (Some(model), Some(bytes), Some(min), Some(max)) => {
                let file = Ktx2::parse(bytes.as_ktx2()).ok();
                file.map(|file| RoughnessFile { file, model: *model, min, max })
            }
            _ => None,
        };
        let Ok(file) = Ktx2::parse(offset.as_ktx2()) else { return Vec::new() };
        let offset = OffsetFile { file, has_z: pyramid.has_z(), scale: pyramid.offset_scale };
        check_pyramid_levels(&offset, roughness.as_ref())
    }
}

fn check_core_source(
    texture: usize,
    sources: TextureReferences,
    partial: &PartialFile,
    mime: Option<&str>,
    findings: &mut Findings,
) {
    let place = format!("/textures/{texture}/source");
    let is_plain = matches!(partial.start(), [0x89, b'P', b'N', b'G', ..] | [0xFF, 0xD8, 0xFF, ..]);
    if mime == Some(KTX2_MIME) {
        let message = "expected image/png, image/jpeg or none, found image/ktx2: validators and Bevy refuse the file; \
                       bake to external files";
        findings.add(Code::KtxMimeType, place, message);
    } else if partial.is_ktx2() && sources.basisu == sources.core {
        let message = "expected PNG or JPEG, found the KTX2 itself: off the specification, as --gltf dual is";
        findings.add(Code::DualSource, place, message);
    } else if !is_plain {
        let message =
            "expected PNG or JPEG, found something else: some engines show nothing; bake with --gltf fallback";
        findings.add(Code::SourceFormat, place, message);
    }
}

/// Checks that each texture of the extension is a KTX2 with the content that the extension expects.
fn check_contents(
    pointer: &str,
    pyramid: &RoughnessPyramid,
    textures: &Textures,
    contents: &BTreeMap<usize, Option<String>>,
    findings: &mut Findings,
) {
    for (member, texture, expected) in pyramid.textures().into_iter().filter(|(_, t, _)| *t < textures.len()) {
        let place = format!("{pointer}/{member}");
        match textures.get(texture).basisu.and_then(|image| contents.get(&image)) {
            None => {
                let message = "expected a texture with a KTX2 image on KHR_texture_basisu, found none; bake again";
                findings.add(Code::ExtensionTexture, place, message);
            }
            Some(Some(found)) if found != expected => {
                let message = format!("expected a texture of content {expected}, found {found}; bake again");
                findings.add(Code::ExtensionContent, place, message);
            }
            Some(_) => {}
        }
    }
}

fn named_files(root: &Root) -> Vec<PathBuf> {
    let images = root.images.iter().filter_map(|i| i.uri.as_ref());
    let uris = images.chain(root.buffers.iter().filter_map(|b| b.uri.as_ref()));
    uris.filter_map(|uri| relative_path(uri).ok()).collect()
}

fn location(image: &Image) -> Option<ImageLocation> {
    match (&image.uri, &image.buffer_view) {
        (Some(uri), _) => Some(ImageLocation::Uri(uri.clone())),
        (None, view) => Some(ImageLocation::BufferView(view.as_ref()?.value())),
    }
}

fn external(location: &ImageLocation) -> Option<PathBuf> {
    match location {
        ImageLocation::Uri(uri) => match Uri::parse(uri) {
            Ok(Uri::Path(path)) => Some(path),
            _ => None,
        },
        ImageLocation::BufferView(_) => None,
    }
}

fn sibling_path(document: &str, path: &Path) -> String {
    Path::new(document).with_file_name("").join(path).display().to_string()
}

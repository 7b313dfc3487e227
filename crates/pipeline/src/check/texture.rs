//! Checks of one KTX2 file, with or without a document that names it.

use super::basisu::check_basisu;
use super::container::{check_keys, check_levels};
use super::decoded_levels::check_decoded_levels;
use super::descriptor::{Values, check_descriptor};
use super::findings::{Code, Findings};
use super::provenance::check_provenance;
use super::scope::Scope;
use crate::ktx2::{Ktx2, PROVENANCE_KEY, ReadError, provenance};
use crate::report::Content;

/// How a document uses a texture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Usage {
    /// `KHR_texture_basisu` names it.
    pub by_basisu: bool,
    /// A material reads normals from it.
    pub normals: bool,
    /// A material reads sRGB colours from it.
    pub colours: bool,
}

/// Checks a KTX2 file and returns its content as recorded by its provenance. A file of another writer is only parsed,
/// since our rules of baking do not apply to that file.
pub fn check_texture(bytes: &[u8], usage: Usage, scope: &Scope<'_>, findings: &mut Findings) -> Option<String> {
    let file = match Ktx2::parse(bytes) {
        Ok(file) => file,
        Err(error) => {
            let message = match error {
                ReadError::Foreign { .. } => error.to_string(),
                error => format!("expected a KTX2 file, found: {error}"),
            };
            findings.add(Code::UnreadableTexture, "", message);
            return None;
        }
    };
    if is_foreign(&file) {
        return None;
    }
    check_levels(&file, findings);
    check_keys(&file, bytes, findings);
    let recorded = provenance(&file).map(|provenance| provenance.content);
    let are_colours = recorded.map_or(usage.colours, |content| content == Content::Colour.name());
    let values = if are_colours { Values::Colours } else { Values::Data };
    check_descriptor(&file, values, findings);
    check_basisu(&file, usage.by_basisu, values, findings);
    let content = check_provenance(&file, scope, findings).map(|provenance| provenance.content);
    if scope.is_deep {
        check_decoded_levels(&file, usage.normals || matches!(content.as_deref(), Some("normal" | "offset")), findings);
    }
    content
}

fn is_foreign(file: &Ktx2<'_>) -> bool {
    let value = |name: &str| file.key_values().find(|(key, _)| *key == name).map(|(_, value)| value);
    value(PROVENANCE_KEY).is_none() && value("KTXwriter").is_some_and(|writer| !writer.starts_with(b"roughcast"))
}

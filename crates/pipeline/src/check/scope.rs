//! The scope of a check.

use semver::Version;

use super::source_digests::SourceDigests;
use crate::settings::Settings;

/// The scope of a check: whether it decodes levels, and what it compares with the provenance.
#[derive(Clone, Copy, Default)]
pub struct Scope<'a> {
    /// Whether levels are decoded. If not, their bytes are never used and may be zeros.
    pub is_deep: bool,
    /// The sources, to be compared with the recorded digests.
    pub origin: Option<&'a SourceDigests<'a>>,
    /// The settings of a bake today, to be compared with the recorded settings.
    pub settings: Option<&'a Settings>,
    /// The oldest version whose textures are accepted.
    pub min_version: Option<&'a Version>,
}

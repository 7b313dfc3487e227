//! How far a check goes.

use semver::Version;

use super::origin::Origin;
use crate::settings::Settings;

/// How far a check goes, and what it compares with.
#[derive(Clone, Copy, Default)]
pub struct Scope<'a> {
    /// Whether levels are decoded. If not, their bytes are not looked at: zeros may stand for them.
    pub is_deep: bool,
    /// The sources, to be compared with the digests that were recorded.
    pub origin: Option<&'a Origin<'a>>,
    /// What a bake would be asked for today, to be compared with what was recorded.
    pub settings: Option<&'a Settings>,
    /// The oldest version whose textures will do.
    pub min_version: Option<&'a Version>,
}

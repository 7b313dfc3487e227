//! How far a check goes.

use super::origin::Origin;

/// How far a check goes, and what it compares with.
#[derive(Clone, Copy, Default)]
pub struct Scope<'a> {
    /// Whether levels are decoded. If not, their bytes are not looked at: zeros may stand for them.
    pub is_deep: bool,
    /// The sources, to be compared with the digests that were recorded.
    pub origin: Option<&'a Origin<'a>>,
}

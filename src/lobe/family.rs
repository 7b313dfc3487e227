//! What a density of half-vectors is called.

/// A family of lobes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Family {
    /// Trowbridge-Reitz: what glTF prescribes.
    #[default]
    Ggx,
    /// Normally distributed slopes.
    Beckmann,
}

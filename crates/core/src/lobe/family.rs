//! Families of lobes.

/// The formula of the lobe that an engine shades with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Family {
    /// Trowbridge-Reitz, which glTF prescribes.
    #[default]
    #[cfg_attr(feature = "cli", value(help = "GGX, as glTF prescribes"))]
    Ggx,
    /// Normally distributed slopes.
    Beckmann,
}

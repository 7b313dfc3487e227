//! Settings that a bake refuses.

use crate::codec::Target;

/// A setting that makes no sense. Settings have the names of their flags and of their keys in `roughcast.toml`.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SettingsError {
    /// A value is outside its range.
    #[error("{name}: expected {expected}, found {found}; give a value in the range")]
    Range {
        /// The setting.
        name: &'static str,
        /// Its range.
        expected: &'static str,
        /// The value.
        found: String,
    },
    /// A setting is without the one that it needs.
    #[error("{name}: expected {needs} to be set too, found it unset; set both or neither")]
    Needs {
        /// The setting.
        name: &'static str,
        /// What it needs.
        needs: &'static str,
    },
    /// Only UASTC holds sRGB colours.
    #[error(
        "expected --target basis for --textures all, since its other payloads hold no sRGB colours, found --target \
         {}; write the colours with --target basis, or leave them with --textures bumps",
        target.name()
    )]
    ColoursWithoutBasis {
        /// The payload.
        target: Target,
    },
    /// Only textures of base colour that are written can be baked for suns.
    #[error(
        "expected --textures all for --diffuse-light suns, since it changes mips of base colours, found --textures \
         bumps; add --textures all, or leave --diffuse-light out"
    )]
    SunsWithoutColours,
    /// A .glb has no external texture that both references could name.
    #[error(
        "expected a .gltf for --gltf dual, which --engine bevy sets too, since both references name an external .ktx2; \
         found that a .glb is asked for: write a .gltf (`-o NAME.gltf`), or choose another form"
    )]
    DualInGlb,
}

//! Presets for engines: one table.

use serde::{Deserialize, Serialize};

use crate::codec::Target;
use crate::note::{self, Note};
use crate::settings::{Form, MaxModel, Model, OwnAnisotropy, Profile, Settings};

/// An engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Engine {
    /// three.js: its anisotropic lobes reflect the surroundings wrongly.
    Three,
    /// Babylon.js: its anisotropic lobes reflect the surroundings wrongly; turn its specular antialiasing off.
    Babylon,
    /// PlayCanvas: its anisotropic lobes are too narrow.
    Playcanvas,
    /// Filament: its glTF loader has no anisotropy.
    Filament,
    /// Bevy: refuses files that need KHR_texture_basisu, so that a .gltf in the dual form is written; its anisotropic
    /// lobes are too narrow.
    Bevy,
    /// Godot: drops the mips of images inside a .glb, so that a .gltf is written; its glTF import has no anisotropy;
    /// turn its roughness limiter off.
    Godot,
}

/// What an engine's own loader and shader need. docs/engines.md has the measurements and the sources.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    /// The name in `roughcast.toml` and on the command line.
    pub name: &'static str,
    /// The name for a person.
    title: &'static str,
    /// The payload that its loader reads.
    pub target: Target,
    /// The references to textures that its loader reads.
    pub form: Form,
    /// Whether it multiplies slopes by `normalTexture.scale`, as glTF says.
    pub reads_normal_scale: bool,
    /// Whether outputs are .glb files; `None` keeps the container of each source.
    pub glb: Option<bool>,
    /// Its support of `KHR_materials_anisotropy`.
    anisotropy: Anisotropy,
    /// Whether it shows the mips of images inside a .glb.
    keeps_mips_of_glb: bool,
    /// How its user turns off what widens baked lobes wherever the normals of pixels differ; `None` if nothing does so
    /// by default.
    limiter: Option<&'static str>,
}

/// An engine's own support of `KHR_materials_anisotropy`. No engine of the table shades such lobes correctly.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Anisotropy {
    /// Its loader does not read the extension.
    Unread,
    /// Its shader is wrong. A plugin or another shader can show the lobes.
    Wrong,
}

const BABYLON_LIMITER: &str =
    "set enableSpecularAntiAliasing of each loaded material to false, in onMaterialLoaded of the glTF loader";

const GODOT_LIMITER: &str =
    "turn the project setting rendering/anti_aliasing/screen_space_roughness_limiter/enabled off";

impl Engine {
    /// Every engine.
    pub const ALL: [Self; 6] = [Self::Three, Self::Babylon, Self::Playcanvas, Self::Filament, Self::Bevy, Self::Godot];

    /// Returns the names of all engines.
    pub fn names() -> impl Iterator<Item = &'static str> {
        Self::ALL.iter().map(|engine| engine.preset().name)
    }

    /// Returns the preset of the engine.
    pub fn preset(self) -> Preset {
        // Loaders that read KTX2 need no PNG copies.
        let defaults = |name, title| Preset {
            name,
            title,
            target: Target::Basis,
            form: Form::Strict,
            glb: None,
            reads_normal_scale: true,
            anisotropy: Anisotropy::Wrong,
            keeps_mips_of_glb: true,
            limiter: None,
        };
        match self {
            // Its shader looks the environment up once, with the shorter axis of the lobe and a bent normal.
            Self::Three => defaults("three", "three.js"),
            // Its shader has the formulas of three.js.
            Self::Babylon => Preset { limiter: Some(BABYLON_LIMITER), ..defaults("babylon", "Babylon.js") },
            // Its shader squares the alphas of anisotropic lobes once more.
            // For normalTexture.scale it mixes the normal with that of the surface.
            Self::Playcanvas => Preset { reads_normal_scale: false, ..defaults("playcanvas", "PlayCanvas") },
            Self::Filament => Preset { anisotropy: Anisotropy::Unread, ..defaults("filament", "Filament") },
            // Its loader refuses files that need KHR_texture_basisu and ignores normalTexture.scale, and its shader
            // squares the alphas of anisotropic lobes once more. The dual form needs external files.
            Self::Bevy => {
                Preset { form: Form::Dual, glb: Some(false), reads_normal_scale: false, ..defaults("bevy", "Bevy") }
            }
            // Its editor saves images inside a .glb as PNG and makes mips of its own. No test of ours runs it, so that
            // the form is the one that every importer of glTF reads. For normalTexture.scale it mixes the normal with
            // that of the surface.
            Self::Godot => Preset {
                form: Form::Fallback,
                glb: Some(false),
                reads_normal_scale: false,
                anisotropy: Anisotropy::Unread,
                keeps_mips_of_glb: false,
                limiter: Some(GODOT_LIMITER),
                ..defaults("godot", "Godot")
            },
        }
    }

    /// Returns the notes on a bake for the engine with `settings`: on a container whose mips it drops, and on a limiter
    /// of its own that is on by default.
    pub fn notes(self, settings: &Settings) -> Vec<Note> {
        let Preset { title, keeps_mips_of_glb, limiter, .. } = self.preset();
        if !settings.profile.is_portable() {
            return Vec::new();
        }
        let dropped = (settings.glb == Some(true) && !keeps_mips_of_glb).then(|| note::mips_dropped(title));
        dropped.into_iter().chain(limiter.map(|switch| note::engine_limiter(title, switch))).collect()
    }
}

impl Preset {
    /// Returns the model that a bake of `profile` needs. The engine's own shader decides on the model if the core
    /// material is baked. Offsets and D alone are for a plugin, which shows anisotropic lobes as they are.
    pub fn model(&self, profile: Profile) -> Model {
        if profile.is_portable() { Model::Isotropic } else { Model::Anisotropic }
    }

    /// Returns what becomes of the anisotropy that materials have of their own in a bake of `profile`.
    pub fn own_anisotropy(&self, profile: Profile) -> Option<OwnAnisotropy> {
        profile.is_portable().then_some(match self.anisotropy {
            Anisotropy::Unread => OwnAnisotropy::Ignore,
            // All of them take the axes of the highlight from the frame of the surface.
            Anisotropy::Wrong => OwnAnisotropy::Keep,
        })
    }

    /// Returns the model with the most parameters that [`Model::Auto`] may choose in a bake of `profile`: no engine of
    /// the table shows baked anisotropic lobes as they are.
    pub fn max_model(&self, profile: Profile) -> Option<MaxModel> {
        profile.is_portable().then_some(MaxModel::Isotropic)
    }
}

#[cfg(test)]
mod tests;

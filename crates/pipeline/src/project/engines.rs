//! Presets for engines: one table.

use clap::ValueEnum;
use serde::{Deserialize, Serialize};

use crate::codec::Target;
use crate::settings::{Form, Model, Profile};

/// An engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Engine {
    /// three.js: its anisotropic lobes reflect the surroundings wrongly.
    Three,
    /// Babylon.js.
    Babylon,
    /// PlayCanvas.
    Playcanvas,
    /// Filament: its glTF loader has no anisotropy.
    Filament,
    /// Bevy: refuses files that need KHR_texture_basisu, and its anisotropic lobes are too narrow.
    Bevy,
    /// Godot: its glTF import has no anisotropy.
    Godot,
}

/// What an engine's own loader and shader need. docs/engines.md has the measurements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    /// The name in `roughcast.toml` and on the command line.
    pub name: &'static str,
    /// The payload that its loader reads.
    pub target: Target,
    /// The references to textures that its loader reads.
    pub form: Form,
    /// The only model that its shader shows right; `None` if the shader shows all models right.
    model: Option<Model>,
}

/// Returns a row of [`Engine::preset`].
const fn row(name: &'static str, target: Target, form: Form, model: Option<Model>) -> Preset {
    Preset { name, target, form, model }
}

impl Engine {
    /// Returns the names of all engines.
    pub fn names() -> impl Iterator<Item = &'static str> {
        Self::value_variants().iter().map(|engine| engine.preset().name)
    }

    /// Returns the preset of the engine.
    pub fn preset(self) -> &'static Preset {
        match self {
            // Its shader reflects the surroundings wrongly where lobes are anisotropic.
            Self::Three => const { &row("three", Target::Basis, Form::Fallback, Some(Model::Isotropic)) },
            Self::Babylon => const { &row("babylon", Target::Basis, Form::Fallback, None) },
            Self::Playcanvas => const { &row("playcanvas", Target::Basis, Form::Fallback, None) },
            // Its glTF loader has no anisotropy.
            Self::Filament => const { &row("filament", Target::Basis, Form::Fallback, Some(Model::Isotropic)) },
            // Its loader refuses files that need KHR_texture_basisu, and its shader squares the alphas of anisotropic
            // lobes once more.
            Self::Bevy => const { &row("bevy", Target::Basis, Form::Dual, Some(Model::Isotropic)) },
            // Its glTF import has no anisotropy.
            Self::Godot => const { &row("godot", Target::Basis, Form::Fallback, Some(Model::Isotropic)) },
        }
    }
}

impl Preset {
    /// Returns the model that a bake of `profile` needs. The engine's own shader decides on the model if the core
    /// material is baked; offsets and D alone are for a plugin, which shows every model.
    pub fn model(&self, profile: Profile) -> Option<Model> {
        self.model.filter(|_| profile.is_portable())
    }
}

#[cfg(test)]
mod tests;

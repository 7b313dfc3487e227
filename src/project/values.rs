//! What a layer may say: every setting, by the name that its flag has too.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::bump::Frame;
use crate::codec::Target;
use crate::codec::uastc::Effort;
use crate::gltf::material::MAX_HEIGHT_SCALE;
use crate::lobe::{Distribution, Family};
use crate::settings::{Form, Model, Profile, Settings, View};

/// Settings, as far as they are said. Names are those of the flags of `bake`; see `roughcast bake --help`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
#[allow(missing_docs)]
pub struct Values {
    pub profile: Option<Profile>,
    pub model: Option<Model>,
    pub max_error: Option<f64>,
    pub quality: Option<Effort>,
    pub rdo: Option<f64>,
    pub distribution: Option<Distribution>,
    pub lobe: Option<Family>,
    pub target: Option<Target>,
    pub max_texels: Option<u64>,
    pub provenance: Option<bool>,
    pub engine: Option<Engine>,
    pub gltf: Option<Form>,
    pub glb: Option<bool>,
    pub frame: Option<FrameName>,
    pub main_direction: Option<[f64; 3]>,
    pub height_scale: Option<f64>,
    pub nearest: Option<f64>,
    pub screen_height: Option<u32>,
    pub fov: Option<f64>,
    pub aspect: Option<f64>,
    pub trim: Option<bool>,
}

/// A frame by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FrameName {
    /// [`Frame::Natural`].
    Natural,
    /// [`Frame::Unit`].
    Unit,
    /// [`Frame::MainDirection`].
    MainDirection,
}

/// An engine, for what its loader needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Engine {
    /// three.js, whose shader reflects the surroundings wrongly where lobes are ellipses (docs/engines.md).
    Three,
    /// Babylon.js.
    Babylon,
    /// PlayCanvas.
    Playcanvas,
    /// Filament, whose glTF loader has no anisotropy.
    Filament,
    /// Bevy, which refuses files that need KHR_texture_basisu and squares the alphas of ellipses once more (docs/engines.md).
    Bevy,
    /// Godot, whose glTF import has no anisotropy.
    Godot,
}

impl Engine {
    /// What it needs of a bake of `profile`. Its own shader decides on the model wherever the core material is baked, which both
    /// profiles have in common; pyramids alone are for a plugin's.
    pub fn values(self, profile: Profile) -> Values {
        let (gltf, model) = match self {
            Self::Babylon | Self::Playcanvas => (Form::Fallback, None),
            Self::Bevy => (Form::Dual, Some(Model::Isotropic)),
            Self::Three | Self::Filament | Self::Godot => (Form::Fallback, Some(Model::Isotropic)),
        };
        let model = model.filter(|_| profile.is_portable());
        Values { target: Some(Target::Basis), gltf: Some(gltf), model, ..Values::default() }
    }
}

/// A setting that makes no sense.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ValueError {
    /// Outside its range.
    #[error("{name}: expected {expected}, found {found}")]
    Range {
        /// The setting.
        name: &'static str,
        /// Its range.
        expected: &'static str,
        /// What was said.
        found: String,
    },
    /// Without the setting that it needs.
    #[error("{name}: expected {needs} to be set too, found it unset; set both or neither")]
    Needs {
        /// The setting.
        name: &'static str,
        /// What it needs.
        needs: &'static str,
    },
    /// Two that cannot be had together.
    #[error("--gltf dual needs external textures, which --glb does not have: leave one of them out")]
    DualInGlb,
}

impl Values {
    /// What holds where nothing is said; settings without a default are absent.
    pub fn defaults() -> Self {
        let defaults = Settings::default();
        Self {
            profile: Some(defaults.profile),
            model: Some(defaults.model),
            max_error: Some(0.1),
            quality: Some(defaults.effort),
            distribution: Some(defaults.distribution),
            lobe: Some(defaults.family),
            target: Some(defaults.target),
            max_texels: Some(defaults.max_texels),
            provenance: Some(defaults.provenance),
            gltf: Some(defaults.form),
            glb: Some(defaults.glb),
            frame: Some(FrameName::Unit),
            main_direction: Some([0.0, 1.0, 0.0]),
            fov: Some(45.0),
            aspect: Some(1.778),
            trim: Some(false),
            ..Self::default()
        }
    }

    /// Every name, in the order of the help.
    pub fn names() -> Vec<String> {
        Self::default().members().into_iter().map(|(name, _)| name).collect()
    }

    /// What is said, by name.
    pub fn said(&self) -> Map<String, Value> {
        self.members().into_iter().filter(|(_, value)| !value.is_null()).collect()
    }

    fn members(&self) -> Map<String, Value> {
        match serde_json::to_value(self) {
            Ok(Value::Object(members)) => members,
            // A struct of plain values is an object.
            _ => Map::new(),
        }
    }

    /// The settings, with defaults for what is not said.
    ///
    /// # Errors
    /// [`ValueError`] for what is out of range or does not go together.
    pub fn settings(&self) -> Result<Settings, ValueError> {
        let defaults = Settings::default();
        let glb = self.glb.unwrap_or(defaults.glb);
        let form = self.gltf.unwrap_or(defaults.form);
        if glb && form == Form::Dual {
            return Err(ValueError::DualInGlb);
        }
        let within = |name, value: Option<f64>, expected, is_within: fn(f64) -> bool| match value {
            Some(value) if !(value.is_finite() && is_within(value)) => {
                Err(ValueError::Range { name, expected, found: value.to_string() })
            }
            value => Ok(value),
        };
        let max_error = within("max-error", self.max_error, "a number from 0 to 1", |x| (0.0..=1.0).contains(&x))?;
        let height_scale = within("height-scale", self.height_scale, "a number from -1000000 to 1000000", |x| {
            x.abs() <= f64::from(MAX_HEIGHT_SCALE)
        })?;
        let rdo = within("rdo", self.rdo, "a number above 0, up to 6", |x| 0.0 < x && x <= 6.0)?;
        Ok(Settings {
            profile: self.profile.unwrap_or_default(),
            model: self.model.unwrap_or_default(),
            max_error: max_error.map_or(defaults.max_error, |e| e as f32),
            distribution: self.distribution.unwrap_or_default(),
            family: self.lobe.unwrap_or_default(),
            target: self.target.unwrap_or_default(),
            effort: self.quality.unwrap_or(defaults.effort),
            rdo,
            form,
            glb,
            frame: self.frame()?,
            height_scale: height_scale.map(|s| s as f32),
            view: self.view()?,
            max_texels: self.max_texels.unwrap_or(defaults.max_texels),
            provenance: self.provenance.unwrap_or(defaults.provenance),
        })
    }

    fn frame(&self) -> Result<Frame, ValueError> {
        match self.frame {
            None | Some(FrameName::Unit) => Ok(Frame::Unit),
            Some(FrameName::Natural) => Ok(Frame::Natural),
            Some(FrameName::MainDirection) => {
                let m = self.main_direction.unwrap_or([0.0, 1.0, 0.0]).map(|x| x as f32);
                let length = m.iter().map(|x| x * x).sum::<f32>().sqrt();
                if length.is_finite() && length > 0.0 {
                    Ok(Frame::MainDirection(m.map(|x| x / length)))
                } else {
                    let (name, expected) = ("main-direction", "a direction");
                    Err(ValueError::Range { name, expected, found: format!("{m:?}") })
                }
            }
        }
    }

    fn view(&self) -> Result<Option<View>, ValueError> {
        let trim = self.trim.unwrap_or(false);
        let (nearest, screen_height) = match (self.nearest, self.screen_height) {
            (Some(nearest), Some(rows)) => (nearest, rows),
            (Some(_), None) => return Err(ValueError::Needs { name: "nearest", needs: "screen-height" }),
            (None, Some(_)) => return Err(ValueError::Needs { name: "screen-height", needs: "nearest" }),
            (None, None) if trim => return Err(ValueError::Needs { name: "trim", needs: "nearest" }),
            (None, None) => return Ok(None),
        };
        let (fov, aspect) = (self.fov.unwrap_or(45.0), self.aspect.unwrap_or(1.778));
        let positive = "a number above 0";
        let checks = [
            ("nearest", nearest, positive, nearest > 0.0),
            ("screen-height", f64::from(screen_height), positive, screen_height > 0),
            ("fov", fov, "degrees between 0 and 180", 0.0 < fov && fov < 180.0),
            ("aspect", aspect, positive, aspect > 0.0),
        ];
        for (name, value, expected, is_within) in checks {
            if !(value.is_finite() && is_within) {
                return Err(ValueError::Range { name, expected, found: value.to_string() });
            }
        }
        Ok(Some(View { nearest, screen_height, fov, aspect, trim }))
    }
}

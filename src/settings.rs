//! What a bake can be asked for. Everything here changes output bytes, so all of it goes into the provenance.

mod view;

pub use view::{Finest, View};

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::bump::Frame;
use crate::codec::Target;
use crate::codec::uastc::Effort;
use crate::lobe::{Distribution, Family};

/// Which data to write.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Profile {
    /// Normal mips and roughness mips that any engine shades right.
    #[default]
    Portable,
    /// Offsets and D or lambda_1 for engines with a plugin; the core material stays as it was.
    Pyramid,
    /// Both together.
    Both,
}

impl Profile {
    /// Whether the core material is baked.
    pub fn is_portable(self) -> bool {
        matches!(self, Self::Portable | Self::Both)
    }

    /// Whether the extension is written.
    pub fn has_pyramid(self) -> bool {
        matches!(self, Self::Pyramid | Self::Both)
    }
}

/// What is modelled of the lost bumps; the later, the more.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Model {
    /// The smallest of the others that stays within the error bound.
    #[default]
    Auto,
    /// Nothing: normals get their mips, roughness stays.
    None,
    /// One number per texel.
    Isotropic,
    /// An ellipse per texel.
    Anisotropic,
}

impl Model {
    /// As on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::None => "none",
            Self::Isotropic => "isotropic",
            Self::Anisotropic => "anisotropic",
        }
    }
}

/// How textures are referenced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Form {
    /// A PNG of level 0 for every engine, the KTX2 on `KHR_texture_basisu` for those that know it. Conformant.
    #[default]
    Fallback,
    /// Only the KTX2, and `KHR_texture_basisu` is required. Conformant.
    Strict,
    /// `source` and the extension both name the KTX2: off the specification, but every engine loads it.
    Dual,
}

/// Settings of a bake.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Which data to write.
    pub profile: Profile,
    /// What is modelled.
    pub model: Model,
    /// Largest mean lobe error at any level, in [0, 1], that the choice of a model puts up with.
    pub max_error: f32,
    /// Shape that footprints are taken to have.
    pub distribution: Distribution,
    /// What the engine shades with.
    pub family: Family,
    /// Payload family.
    pub target: Target,
    /// Search effort of block encoders.
    pub effort: Effort,
    /// How much signal-to-noise ratio each level of [`Target::Basis`] may lose for fewer bytes, in dB: 0 to 6. None leaves its
    /// blocks as they are.
    pub rdo: Option<f64>,
    /// How textures are referenced.
    pub form: Form,
    /// Write .glb instead of .gltf with external files.
    pub glb: bool,
    /// Frame of the pyramid profile's offsets.
    pub frame: Frame,
    /// Height maps: relief in widths of a repeat (in mesh units under [`Frame::Natural`]), overriding the asset's.
    pub height_scale: Option<f32>,
    /// The camera, where one is told.
    pub view: Option<View>,
    /// Largest number of texels of an input image.
    pub max_texels: u64,
    /// Write version, settings and source digests into each KTX2.
    pub provenance: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            profile: Profile::default(),
            model: Model::default(),
            max_error: 0.1,
            distribution: Distribution::default(),
            family: Family::default(),
            target: Target::default(),
            effort: Effort::Fast,
            rdo: None,
            form: Form::default(),
            glb: false,
            frame: Frame::default(),
            height_scale: None,
            view: None,
            max_texels: 1 << 28,
            provenance: true,
        }
    }
}

impl Settings {
    /// What decides on the bytes of a texture that models `model`, for its provenance. Where that was chosen, `asked` is what
    /// was asked for.
    pub fn to_json(&self, model: Model) -> Value {
        let frame = match self.frame {
            Frame::Natural => json!("natural"),
            Frame::Unit => json!("unit"),
            Frame::MainDirection(m) => json!({ "mainDirection": m.map(f64::from) }),
        };
        let mut settings = json!({
            "profile": self.profile,
            "model": model,
            "maxError": f64::from(self.max_error),
            "distribution": self.distribution,
            "lobe": self.family,
            "target": self.target,
            "quality": match self.effort {
                Effort::Fast => "fast",
                Effort::Best => "best",
            },
            "gltf": self.form,
            "frame": frame,
            "heightScale": self.height_scale.map(f64::from),
        });
        if model != self.model {
            settings["asked"] = json!(self.model);
        }
        if let Some(loss) = self.rdo {
            settings["rdo"] = json!(loss);
        }
        if let Some(view) = self.view {
            settings["view"] = json!(view);
        }
        settings
    }
}

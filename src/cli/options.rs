//! Options that several commands share, and what they set.

use clap::{Args, ValueEnum};

use crate::bake::{Form, Model, Profile, Settings};
use crate::bump::Frame;
use crate::lobe::Family;
use crate::roughness::Distribution;
use crate::texture::Target;
use crate::texture::uastc::Effort;

/// What decides on the bytes of textures.
#[derive(Debug, Args)]
#[command(next_help_heading = "Texture options")]
pub struct TextureOptions {
    /// What to write: data for any engine, for engines with a plugin, or both.
    #[arg(long, value_enum, default_value_t = ProfileName::Portable)]
    profile: ProfileName,
    /// What to model of the lost bumps; auto takes the cheapest that stays within --max-error. [default: auto]
    #[arg(long, value_enum)]
    model: Option<ModelName>,
    /// Largest mean lobe error (0 to 1) that --model auto puts up with at any level: the share of reflected light that
    /// goes where it should not.
    #[arg(long, default_value_t = 0.1, value_parser = unit_interval, value_name = "E")]
    max_error: f32,
    /// How well lobes are fitted and how long block encoders search.
    #[arg(long, value_enum, default_value_t = QualityName::Fast)]
    quality: QualityName,
    /// Shape that the slopes under a texel are taken to have; auto goes by the slopes themselves.
    #[arg(long, value_enum, default_value_t = DistributionName::Auto)]
    distribution: DistributionName,
    /// Payload: UASTC for every engine, BC4/BC5/BC7, or half floats. [default: basis]
    #[arg(long, value_enum)]
    target: Option<TargetName>,
    /// Largest number of texels of an input image.
    #[arg(long, default_value_t = 1 << 28, value_name = "N")]
    max_texels: u64,
    /// Leave version, settings and source digests out of the KTX2 files.
    #[arg(long)]
    no_provenance: bool,
}

/// How the document refers to textures.
#[derive(Debug, Args)]
#[command(next_help_heading = "glTF options")]
pub struct DocumentOptions {
    /// How textures are referenced: with a PNG for engines without KTX2, without, or with the KTX2 in both places.
    /// [default: fallback]
    #[arg(long, value_enum)]
    gltf: Option<FormName>,
    /// Preset of --target, --gltf and --model for an engine; the options themselves win over it.
    #[arg(long, value_enum)]
    engine: Option<Engine>,
    /// Write .glb files with everything embedded.
    #[arg(long)]
    glb: bool,
    /// Frame of the offsets of the pyramid profile.
    #[arg(long, value_enum, default_value_t = FrameName::Unit)]
    frame: FrameName,
    /// Direction m of --frame main-direction, in the space of the mesh.
    #[arg(long, value_parser = direction, default_value = "0,1,0", value_name = "X,Y,Z", allow_hyphen_values = true)]
    main_direction: [f32; 3],
    /// Relief of height maps, in widths of a repeat (in mesh units with --frame natural), instead of the asset's own.
    #[arg(long, value_parser = finite, value_name = "S", allow_hyphen_values = true)]
    height_scale: Option<f32>,
}

impl TextureOptions {
    /// The settings, with what `document` adds.
    pub fn settings(&self, document: Option<&DocumentOptions>) -> Settings {
        let preset = document.and_then(|d| d.engine).map(Engine::preset).unwrap_or_default();
        let defaults = Settings::default();
        Settings {
            profile: self.profile.into(),
            model: self.model.map_or(preset.model, Into::into),
            max_error: self.max_error,
            distribution: self.distribution.into(),
            family: defaults.family,
            target: self.target.map_or(preset.target, Into::into),
            effort: self.quality.into(),
            form: document.and_then(|d| d.gltf).map_or(preset.form, Into::into),
            glb: document.is_some_and(|d| d.glb),
            frame: document.map_or(defaults.frame, DocumentOptions::frame),
            height_scale: document.and_then(|d| d.height_scale),
            view: None,
            max_texels: self.max_texels,
            provenance: !self.no_provenance,
        }
    }
}

impl DocumentOptions {
    fn frame(&self) -> Frame {
        match self.frame {
            FrameName::Natural => Frame::Natural,
            FrameName::Unit => Frame::Unit,
            FrameName::MainDirection => Frame::MainDirection(self.main_direction),
        }
    }
}

/// Declares a value of the command line with the names of a library type.
macro_rules! names {
    ($(#[$doc:meta])* $name:ident => $type:ident { $($(#[$variant_doc:meta])* $variant:ident),* $(,)? }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, ValueEnum)]
        pub enum $name { $($(#[$variant_doc])* $variant),* }

        impl From<$name> for $type {
            fn from(name: $name) -> Self {
                match name { $($name::$variant => Self::$variant),* }
            }
        }
    };
}

names! {
    /// `--profile`.
    ProfileName => Profile {
        /// Normal and roughness mips that any engine shades right
        Portable,
        /// Offset and roughness maps for engines with a plugin
        Pyramid,
        /// Both
        Both,
    }
}

names! {
    /// `--model`.
    ModelName => Model {
        /// The cheapest that stays within --max-error, in the smallest size
        Auto,
        /// Normals get their mips, roughness stays
        None,
        /// One number per texel
        Isotropic,
        /// An ellipse per texel
        Anisotropic,
    }
}

names! {
    /// `--quality`.
    QualityName => Effort {
        /// The pace of the decoder
        Fast,
        /// Lobes fitted to what lies three levels below; all block modes that pay
        Best,
    }
}

names! {
    /// `--distribution`.
    DistributionName => Distribution {
        /// The slopes' own: lobes are merged by likelihood, factors follow the kurtosis
        Auto,
        /// A 2-D normal distribution
        Normal,
        /// Uniform in a rectangle
        Uniform,
    }
}

names! {
    /// `--lobe`.
    LobeName => Family {
        /// GGX, as glTF prescribes
        Ggx,
        /// Normally distributed slopes
        Beckmann,
    }
}

names! {
    /// `--target`.
    TargetName => Target {
        /// UASTC LDR 4x4 with zstd: every engine
        Basis,
        /// BC4, BC5, BC7: desktop GPUs
        Bc,
        /// Half floats
        Float,
    }
}

names! {
    /// `--gltf`.
    FormName => Form {
        /// PNG of level 0 as source, KTX2 on KHR_texture_basisu
        Fallback,
        /// KTX2 only, KHR_texture_basisu required
        Strict,
        /// KTX2 as source and on KHR_texture_basisu: off the specification, loads everywhere
        Dual,
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum FrameName {
    /// Offsets in mesh units per repeat: bumps keep their height when the map is scaled
    Natural,
    /// Slopes in glTF's tangent frame
    Unit,
    /// Slopes along e1 = m x n and e2 = n x e1: no tangents at run time
    MainDirection,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Engine {
    /// three.js
    Three,
    /// Babylon.js
    Babylon,
    /// PlayCanvas
    Playcanvas,
    /// Filament: its glTF loader has no anisotropy
    Filament,
    /// Bevy: refuses files that need KHR_texture_basisu
    Bevy,
    /// Godot: its glTF import has no anisotropy
    Godot,
}

/// What an engine's preset sets.
#[derive(Clone, Copy, Default)]
struct Preset {
    target: Target,
    form: Form,
    model: Model,
}

impl Engine {
    fn preset(self) -> Preset {
        match self {
            Self::Three | Self::Babylon | Self::Playcanvas => Preset::default(),
            Self::Bevy => Preset { form: Form::Dual, ..Preset::default() },
            Self::Filament | Self::Godot => Preset { model: Model::Isotropic, ..Preset::default() },
        }
    }
}

/// A number from 0 to 1.
pub fn unit_interval(text: &str) -> Result<f32, String> {
    finite(text).and_then(|n| {
        if (0.0..=1.0).contains(&n) { Ok(n) } else { Err(format!("expected a number from 0 to 1, found {n}")) }
    })
}

/// A finite number.
pub fn finite(text: &str) -> Result<f32, String> {
    let number: f32 = text.parse().map_err(|_| format!("expected a number, found {text:?}"))?;
    if number.is_finite() { Ok(number) } else { Err(format!("expected a finite number, found {number}")) }
}

fn direction(text: &str) -> Result<[f32; 3], String> {
    let numbers = text.split(',').map(|part| finite(part.trim())).collect::<Result<Vec<_>, _>>()?;
    let found = numbers.len();
    let m: [f32; 3] = numbers.try_into().map_err(|_| format!("expected three numbers x,y,z, found {found}"))?;
    let length = m.iter().map(|x| x * x).sum::<f32>().sqrt();
    if length > 0.0 { Ok(m.map(|x| x / length)) } else { Err("expected a direction, found 0,0,0".to_owned()) }
}

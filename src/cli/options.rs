//! Options that several commands share, and what they set.

use clap::{Args, ValueEnum};

use crate::codec::Target;
use crate::codec::uastc::Effort;
use crate::lobe::{Distribution, Family};
use crate::project::{Engine, FrameName, Values};
use crate::settings::{Form, Model, Profile, Settings};

/// What decides on the bytes of textures.
#[derive(Debug, Args)]
#[command(next_help_heading = "Texture options")]
pub struct TextureOptions {
    /// What to write: data for any engine, for engines with a plugin, or both. [default: portable]
    #[arg(long, value_enum)]
    profile: Option<ProfileName>,
    /// What to model of the lost bumps; auto takes the cheapest that stays within --max-error. [default: auto]
    #[arg(long, value_enum)]
    model: Option<ModelName>,
    /// Largest mean lobe error (0 to 1) that --model auto puts up with at any level: the share of reflected light that
    /// goes where it should not. [default: 0.1]
    #[arg(long, value_parser = unit_interval_f64, allow_negative_numbers = true, value_name = "E")]
    max_error: Option<f64>,
    /// How well lobes are fitted and how long block encoders search. [default: fast]
    #[arg(long, value_enum)]
    quality: Option<QualityName>,
    /// Make UASTC textures smaller after zstd: rewrite their blocks so that each level loses less than this much of its
    /// signal-to-noise ratio (above 0, up to 6). For example --rdo 0.5: files become a sixth smaller.
    #[arg(long, value_parser = decibels, allow_negative_numbers = true, value_name = "DB")]
    rdo: Option<f64>,
    /// Shape that the slopes under a texel are taken to have; auto goes by the slopes themselves. [default: auto]
    #[arg(long, value_enum)]
    distribution: Option<DistributionName>,
    /// Payload: UASTC for every engine, BC4/BC5/BC7, or half floats. [default: basis]
    #[arg(long, value_enum)]
    target: Option<TargetName>,
    /// Largest number of texels of an input image. [default: 268435456]
    #[arg(long, value_name = "N")]
    max_texels: Option<u64>,
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
    engine: Option<EngineName>,
    /// Write .glb files with everything embedded.
    #[arg(long, num_args = 0..=1, require_equals = true, default_missing_value = "true", value_name = "BOOL")]
    glb: Option<bool>,
    /// Frame of the offsets of the pyramid profile. [default: unit]
    #[arg(long, value_enum)]
    frame: Option<FrameOption>,
    /// Direction m of --frame main-direction, in the space of the mesh. [default: 0,1,0]
    #[arg(long, value_parser = direction, value_name = "X,Y,Z", allow_hyphen_values = true)]
    main_direction: Option<[f64; 3]>,
    /// BumpMap of height maps, in widths of a repeat (in mesh units with --frame natural), instead of the asset's own.
    #[arg(long, value_parser = finite_f64, value_name = "S", allow_hyphen_values = true)]
    height_scale: Option<f64>,
}

impl TextureOptions {
    /// What is said.
    pub fn values(&self) -> Values {
        Values {
            profile: self.profile.map(Into::into),
            model: self.model.map(Into::into),
            max_error: self.max_error,
            quality: self.quality.map(Into::into),
            rdo: self.rdo,
            distribution: self.distribution.map(Into::into),
            target: self.target.map(Into::into),
            max_texels: self.max_texels,
            provenance: self.no_provenance.then_some(false),
            ..Values::default()
        }
    }

    /// The settings, for commands that know no others. Each value has been checked on its own, and none needs another.
    pub fn settings(&self) -> Settings {
        self.values().settings().unwrap_or_default()
    }
}

impl DocumentOptions {
    /// What is said, beside `values`.
    pub fn values(&self, values: Values) -> Values {
        Values {
            gltf: self.gltf.map(Into::into),
            engine: self.engine.map(Into::into),
            glb: self.glb,
            frame: self.frame.map(Into::into),
            main_direction: self.main_direction,
            height_scale: self.height_scale,
            ..values
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

names! {
    /// `--frame`.
    FrameOption => FrameName {
        /// Offsets in mesh units per repeat: bumps keep their height when the map is scaled
        Natural,
        /// Slopes in glTF's tangent frame
        Unit,
        /// Slopes along e1 = m x n and e2 = n x e1: no tangents at run time
        MainDirection,
    }
}

names! {
    /// `--engine`.
    EngineName => Engine {
        /// three.js: it reflects the surroundings wrongly in ellipses
        Three,
        /// Babylon.js
        Babylon,
        /// PlayCanvas
        Playcanvas,
        /// Filament: its glTF loader has no anisotropy
        Filament,
        /// Bevy: refuses files that need KHR_texture_basisu, and its ellipses are too narrow
        Bevy,
        /// Godot: its glTF import has no anisotropy
        Godot,
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

fn unit_interval_f64(text: &str) -> Result<f64, String> {
    unit_interval(text)?;
    finite_f64(text)
}

fn decibels(text: &str) -> Result<f64, String> {
    finite_f64(text).and_then(|n| {
        if 0.0 < n && n <= 6.0 { Ok(n) } else { Err(format!("expected a number above 0, up to 6, found {n}")) }
    })
}

fn finite_f64(text: &str) -> Result<f64, String> {
    finite(text)?;
    text.parse().map_err(|_| format!("expected a number, found {text:?}"))
}

fn direction(text: &str) -> Result<[f64; 3], String> {
    let numbers = text.split(',').map(|part| finite_f64(part.trim())).collect::<Result<Vec<_>, _>>()?;
    let found = numbers.len();
    let m: [f64; 3] = numbers.try_into().map_err(|_| format!("expected three numbers x,y,z, found {found}"))?;
    if m == [0.0; 3] { Err("expected a direction, found 0,0,0".to_owned()) } else { Ok(m) }
}

//! Options that several commands share, and the settings that they make.

use std::fmt::Display;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use crate::bump::FrameKind;
use crate::codec::Target;
use crate::codec::uastc::Effort;
use crate::lobe::Distribution;
use crate::project::{Engine, Values};
use crate::settings::{DiffuseLight, Form, Limit, MaxModel, Model, OwnAnisotropy, Profile, Settings, Textures, limit};

/// How textures are baked and encoded.
#[derive(Debug, Args)]
#[command(next_help_heading = "Texture options")]
pub struct TextureOptions {
    /// What to write: data for any engine, for engines with a plugin, or both. [default: portable]
    #[arg(long, value_enum)]
    profile: Option<Profile>,
    /// The model of the lost bumps; auto takes the cheapest model within --max-error. [default: auto]
    #[arg(long, value_enum)]
    model: Option<Model>,
    /// Largest mean lobe error (0 to 1) that --model auto accepts at any level: the share of reflected light in the
    /// wrong direction. [default: 0.1]
    #[arg(long, value_parser = unit_interval_f64, allow_negative_numbers = true, value_name = "E")]
    max_error: Option<f64>,
    /// How well lobes are fitted and how long block encoders search. [default: fast]
    #[arg(long, value_parser = effort(), value_name = "QUALITY")]
    quality: Option<Effort>,
    /// Make UASTC textures smaller after zstd: rewrite their blocks so that each level loses less than this much of its
    /// signal-to-noise ratio (above 0, up to 6). For example --rdo 0.5: files become a sixth smaller.
    #[arg(long, value_parser = decibels, allow_negative_numbers = true, value_name = "DB")]
    rdo: Option<f64>,
    /// Assumed distribution of the slopes under a texel; auto measures it. [default: auto]
    #[arg(long, value_enum)]
    distribution: Option<Distribution>,
    /// Payload: UASTC for every engine, BC4/BC5/BC7, or half floats. [default: basis]
    #[arg(long, value_enum)]
    target: Option<Target>,
    /// Most texels along a side of a written texture, at least 4: level 0 is the first level within this size. Coarser
    /// levels of bumps know their roughness, so nothing of it is lost. For example --max-size 1024.
    #[arg(long, value_parser = side, value_name = "N")]
    max_size: Option<u32>,
    /// Largest number of texels of an input image. [default: 268435456]
    #[arg(long, value_name = "N")]
    max_texels: Option<u64>,
    /// Leave version, settings and source digests out of the KTX2 files.
    #[arg(long)]
    no_provenance: bool,
}

/// Options that decide on how the document refers to textures.
#[derive(Debug, Args)]
#[command(next_help_heading = "glTF options")]
pub struct DocumentOptions {
    /// Which textures are written as KTX2. For example --textures all --rdo 0.5, so that no other tool is needed for
    /// base colour, emissive and occlusion. [default: bumps]
    #[arg(long, value_enum)]
    textures: Option<Textures>,
    /// The light that base colours are baked for. Under suns, bumps reflect less diffuse light than their mean normal,
    /// and their base colour is darkened by as much from level 1 on. Needs --textures all. [default: environment]
    #[arg(long, value_enum, value_name = "LIGHT")]
    diffuse_light: Option<DiffuseLight>,
    /// How textures are referenced. The form strict has no PNG copies, which only engines without KTX2 need, and stays
    /// valid in other tools. [default: strict, or what --engine needs]
    #[arg(long, value_enum)]
    gltf: Option<Form>,
    /// Preset of --target, --gltf, --glb, --model, --max-model, --own-anisotropy and --scale-normals for an engine; the
    /// options themselves win over it. A note names the engine's own limiter of roughness if that should be turned off.
    #[arg(long, value_enum)]
    engine: Option<Engine>,
    /// The model with the most parameters that --model auto may choose. [default: anisotropic]
    #[arg(long, value_enum)]
    max_model: Option<MaxModel>,
    /// What becomes of the anisotropy that a core material has of its own. --model anisotropic wins over it, and the
    /// profile pyramid ignores it. [default: bake, or what --engine needs]
    #[arg(long, value_enum, value_name = "HOW")]
    own_anisotropy: Option<OwnAnisotropy>,
    /// Write .glb files with everything inside, or with --glb=false .gltf files with external textures. [default: as
    /// each input, except .gltf for --engine bevy and godot and for --gltf dual]
    #[arg(long, num_args = 0..=1, require_equals = true, default_missing_value = "true", value_name = "BOOL")]
    glb: Option<bool>,
    /// Divide the slopes of low bumps in their texture and multiply normalTexture.scale, so that they lose less to the
    /// encoding. Bevy ignores the scale. [default: true under --gltf strict, or what --engine needs]
    #[arg(long, num_args = 0..=1, require_equals = true, default_missing_value = "true", value_name = "BOOL")]
    scale_normals: Option<bool>,
    /// Frame of the offsets of the pyramid profile. [default: unit]
    #[arg(long, value_enum)]
    frame: Option<FrameKind>,
    /// Direction m of --frame main-direction, in the space of the mesh. [default: 0,1,0]
    #[arg(long, value_parser = direction, value_name = "X,Y,Z", allow_hyphen_values = true)]
    main_direction: Option<[f64; 3]>,
    /// Height of height maps between 0 and 1, in widths of a repeat (in mesh units with --frame natural), instead of
    /// the value of the asset.
    #[arg(long, value_parser = finite_f64, value_name = "S", allow_hyphen_values = true)]
    height_scale: Option<f64>,
}

impl TextureOptions {
    /// Returns the explicit values.
    pub fn values(&self) -> Values {
        Values {
            profile: self.profile,
            model: self.model,
            max_error: self.max_error,
            quality: self.quality,
            rdo: self.rdo,
            distribution: self.distribution,
            target: self.target,
            max_size: self.max_size,
            max_texels: self.max_texels,
            provenance: self.no_provenance.then_some(false),
            ..Values::default()
        }
    }

    /// Returns the settings, for commands without other options. Each value was checked when it was parsed, and no
    /// value depends on another.
    pub fn settings(&self) -> Settings {
        self.values().settings().unwrap_or_default()
    }
}

impl DocumentOptions {
    /// Returns `values` with the explicit values of these options.
    pub fn values(&self, values: Values) -> Values {
        Values {
            textures: self.textures,
            diffuse_light: self.diffuse_light,
            gltf: self.gltf,
            engine: self.engine,
            max_model: self.max_model,
            own_anisotropy: self.own_anisotropy,
            glb: self.glb,
            scale_normals: self.scale_normals,
            frame: self.frame,
            main_direction: self.main_direction,
            height_scale: self.height_scale,
            ..values
        }
    }
}

/// Returns the parser of `--quality`. The encoder's crate declares the enum and knows no command line.
pub fn effort() -> impl TypedValueParser<Value = Effort> {
    let names = [
        PossibleValue::new(Effort::Fast.name()).help("A few times the time of decoding the source images"),
        PossibleValue::new(Effort::Best.name())
            .help("Lobes of all coarse levels fitted to level 0; all useful block modes tried"),
    ];
    let effort = |name: String| if name == Effort::Best.name() { Effort::Best } else { Effort::Fast };
    PossibleValuesParser::new(names).map(effort)
}

/// Parses a number from 0 to 1.
pub fn unit_interval(text: &str) -> Result<f32, String> {
    finite(text).and_then(|n| within(&limit::MAX_ERROR, n))
}

/// Parses a finite number.
pub fn finite(text: &str) -> Result<f32, String> {
    let number: f32 = text.parse().map_err(|_| format!("expected a number, found {text:?}"))?;
    if number.is_finite() { Ok(number) } else { Err(format!("expected a finite number, found {number}")) }
}

fn unit_interval_f64(text: &str) -> Result<f64, String> {
    unit_interval(text)?;
    finite_f64(text)
}

fn side(text: &str) -> Result<u32, String> {
    let side: u32 = text.parse().map_err(|_| format!("expected a number of texels, found {text:?}"))?;
    within(&limit::MAX_SIZE, side)
}

fn decibels(text: &str) -> Result<f64, String> {
    finite_f64(text).and_then(|n| within(&limit::RDO, n))
}

/// Returns `number` if it is within `limit`.
fn within<N: Copy + Display + Into<f64>>(limit: &Limit, number: N) -> Result<N, String> {
    if limit.accepts(number.into()) { Ok(number) } else { Err(format!("expected {}, found {number}", limit.expected)) }
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

//! What a bake can be asked for. [`RecordedSettings`] lists the settings that change the bytes of a texture.

mod container;
pub mod engines;
mod error;
pub mod limit;
mod recorded;
pub mod values;
mod view;

pub use error::SettingsError;
pub use limit::Limit;
pub use recorded::RecordedSettings;
pub use view::{Finest, View};

use serde::{Deserialize, Serialize};

use crate::bump::Frame;
use crate::codec::Target;
use crate::codec::uastc::Effort;
use crate::lobe::{Distribution, Family};

/// Which data to write.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Profile {
    /// Normal, roughness and anisotropy mips that engines load as they are.
    #[default]
    Portable,
    /// Offset and roughness maps for engines with a plugin. The core material stays as it was.
    #[cfg_attr(feature = "cli", value(help = "Offset and roughness maps for engines with a plugin"))]
    Pyramid,
    /// Both.
    Both,
}

impl Profile {
    /// Returns whether the core material is baked.
    pub fn is_portable(self) -> bool {
        matches!(self, Self::Portable | Self::Both)
    }

    /// Returns whether the extension is written.
    pub fn has_pyramid(self) -> bool {
        matches!(self, Self::Pyramid | Self::Both)
    }
}

/// What is modelled of the lost bumps. A later variant models more.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Model {
    /// The cheapest model, in the smallest size, that stays within [`Settings::max_error`].
    #[default]
    #[cfg_attr(feature = "cli", value(help = "The cheapest that stays within --max-error, in the smallest size"))]
    Auto,
    /// Normals get their mips, roughness stays.
    None,
    /// One number per texel.
    Isotropic,
    /// An anisotropic lobe per texel.
    Anisotropic,
}

impl Model {
    /// Returns the name, as the command line has it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::None => "none",
            Self::Isotropic => "isotropic",
            Self::Anisotropic => "anisotropic",
        }
    }
}

/// The model with the most parameters that a bake may choose by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum MaxModel {
    /// For engines without anisotropic lobes.
    #[cfg_attr(feature = "cli", value(help = "For engines without anisotropic lobes"))]
    Isotropic,
    /// Every model.
    #[default]
    #[cfg_attr(feature = "cli", value(help = "Every model"))]
    Anisotropic,
}

/// What becomes of the anisotropy that a material has of its own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum OwnAnisotropy {
    /// It is joined with the bumps to one lobe for each texel. An isotropic model drops it.
    #[default]
    #[cfg_attr(feature = "cli", value(help = "Join it with the bumps to one lobe; isotropic models drop it"))]
    Bake,
    /// It stays as it is, and so does the roughness. For engines that take the axes of anisotropic highlights from the
    /// surface instead of its bumps: such highlights hardly follow the bumps, so that lost bumps do not widen them.
    #[cfg_attr(
        feature = "cli",
        value(help = "Leave it and the roughness, for engines whose anisotropic highlights hardly follow bumps")
    )]
    Keep,
    /// It stays as it is, and bumps widen the roughness as if there was none. For engines that do not read it.
    #[cfg_attr(feature = "cli", value(help = "Leave it, and bake the roughness as for a material without it"))]
    Ignore,
}

/// Which textures of materials are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Textures {
    /// Normals, roughness and anisotropy of materials with bumps. All other images stay as they are.
    #[default]
    #[cfg_attr(feature = "cli", value(help = "Normals, roughness and anisotropy; other images stay as they are"))]
    Bumps,
    /// Also base colour, emissive, occlusion, metalness with roughness, clearcoat, transmission, thickness and
    /// iridescence.
    #[cfg_attr(feature = "cli", value(help = "Also base colour, emissive, occlusion and other maps"))]
    All,
}

/// The light that base colours are baked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum DiffuseLight {
    /// Light from all around, which bumps hardly lose. Mips of base colours are means.
    #[default]
    #[cfg_attr(feature = "cli", value(help = "Light from all around: mips of base colours are means"))]
    Environment,
    /// Suns and lamps alone. Mips of base colours are darkened by the diffuse light that bumps lose.
    #[cfg_attr(feature = "cli", value(help = "Suns and lamps alone: bumps darken mips of base colours"))]
    Suns,
}

/// How the document refers to textures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Form {
    /// Only the KTX2 is there, and `KHR_texture_basisu` is required. Conforms to the specification, and stays valid in
    /// tools that keep one image for each texture.
    #[default]
    #[cfg_attr(feature = "cli", value(help = "KTX2 only, KHR_texture_basisu required"))]
    Strict,
    /// A PNG of level 0 is the `source` of the texture, and `KHR_texture_basisu` names the KTX2. Engines without KTX2
    /// show the PNG. Conforms to the specification.
    #[cfg_attr(feature = "cli", value(help = "PNG of level 0 as source, KTX2 on KHR_texture_basisu"))]
    Fallback,
    /// `source` and `KHR_texture_basisu` both name the KTX2: against the specification, but every engine loads it. The
    /// KTX2 is a file, so that the document is a .gltf.
    #[cfg_attr(
        feature = "cli",
        value(help = "KTX2 as source and on KHR_texture_basisu: off the specification, loads everywhere")
    )]
    Dual,
}

/// Settings of a bake. Build them from [`Settings::default`] with the `with_` functions or by assigning to fields.
///
/// A `with_` function checks a value that can be out of range. A field takes any value, and a bake refuses the values
/// that [`Settings::validate`] refuses.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Settings {
    /// Which data to write.
    pub profile: Profile,
    /// What is modelled of the lost bumps.
    pub model: Model,
    /// The model with the most parameters that [`Model::Auto`] may choose. An explicit [`Model::Anisotropic`] overrides
    /// it.
    pub max_model: MaxModel,
    /// What becomes of the anisotropy that a core material has of its own. An explicit [`Model::Anisotropic`] overrides
    /// it, and [`Profile::Pyramid`] ignores it.
    pub own_anisotropy: OwnAnisotropy,
    /// Largest mean lobe error at any level, in [0, 1], that [`Model::Auto`] accepts.
    pub max_error: f32,
    /// The shape of the distribution of slopes that footprints are assumed to have.
    pub distribution: Distribution,
    /// The lobe that the engine shades with.
    pub lobe: Family,
    /// The payload of textures.
    pub target: Target,
    /// How well lobes are fitted and how long block encoders search.
    pub quality: Effort,
    /// How much signal-to-noise ratio, in dB, each level of [`Target::Basis`] may lose for fewer bytes: above 0, up to
    /// 6. `None` leaves the blocks as they are.
    pub rdo: Option<f64>,
    /// Which textures of materials are written. [`Textures::All`] needs [`Target::Basis`], the only payload with sRGB
    /// colours.
    pub textures: Textures,
    /// The light that base colours are baked for. [`DiffuseLight::Suns`] needs [`Textures::All`].
    pub diffuse_light: DiffuseLight,
    /// The most texels that a side of a written texture has, at least 4: level 0 is the first level within this size.
    /// `None` keeps the size of the images.
    pub max_size: Option<u32>,
    /// How the document refers to textures.
    pub gltf: Form,
    /// Whether a .glb with everything inside is written, or a .gltf with external files. `None` keeps the container of
    /// the source document, unless [`Form::Dual`] needs external files.
    pub glb: Option<bool>,
    /// Whether `normalTexture.scale` may change, so that the slopes of low bumps use all values of their texture. An
    /// engine that ignores the scale shows such bumps too strong. `None` leaves it to [`Self::gltf`]: scales may change
    /// under [`Form::Strict`].
    pub scale_normals: Option<bool>,
    /// Frame of the pyramid profile's offsets.
    pub frame: Frame,
    /// Scale of height maps in widths of a repeat (in mesh units under [`Frame::Natural`]). It overrides the asset's
    /// own.
    pub height_scale: Option<f32>,
    /// The camera, if it is known.
    pub view: Option<View>,
    /// Largest number of texels of an input image.
    pub max_texels: u64,
    /// Whether version, settings and source digests are written into each KTX2.
    pub provenance: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            profile: Profile::default(),
            model: Model::default(),
            max_model: MaxModel::default(),
            own_anisotropy: OwnAnisotropy::default(),
            max_error: 0.1,
            distribution: Distribution::default(),
            lobe: Family::default(),
            target: Target::default(),
            quality: Effort::Fast,
            rdo: None,
            textures: Textures::default(),
            diffuse_light: DiffuseLight::default(),
            max_size: None,
            gltf: Form::default(),
            glb: None,
            scale_normals: None,
            frame: Frame::default(),
            height_scale: None,
            view: None,
            max_texels: 1 << 28,
            provenance: true,
        }
    }
}

/// Declares a function that sets one field, every value of which is valid, and returns the settings.
macro_rules! setters {
    ($($name:ident: $field:ident, $type:ty;)*) => {
        $(
            #[doc = concat!("Sets [`Settings::", stringify!($field), "`].")]
            #[must_use]
            pub fn $name(self, $field: $type) -> Self {
                Self { $field, ..self }
            }
        )*
    };
}

impl Settings {
    setters! {
        with_profile: profile, Profile;
        with_model: model, Model;
        with_max_model: max_model, MaxModel;
        with_own_anisotropy: own_anisotropy, OwnAnisotropy;
        with_distribution: distribution, Distribution;
        with_lobe: lobe, Family;
        with_target: target, Target;
        with_quality: quality, Effort;
        with_textures: textures, Textures;
        with_diffuse_light: diffuse_light, DiffuseLight;
        with_gltf: gltf, Form;
        with_max_texels: max_texels, u64;
        with_provenance: provenance, bool;
    }

    /// Returns the model with the most parameters that the settings allow.
    pub(crate) fn model_limit(&self) -> Model {
        match (self.model, self.max_model) {
            (Model::Anisotropic, _) | (_, MaxModel::Anisotropic) => Model::Anisotropic,
            (_, MaxModel::Isotropic) => Model::Isotropic,
        }
    }

    /// Returns whether `normalTexture.scale` may change. The pyramid profile leaves it alone.
    pub(crate) fn effective_scale_normals(&self) -> bool {
        // Bevy, which ignores the scale, refuses the strict form and loads all others.
        self.profile.is_portable() && self.scale_normals.unwrap_or(self.gltf == Form::Strict)
    }

    /// Returns what the bake does with the anisotropy that a material has of its own.
    pub(crate) fn effective_own_anisotropy(&self) -> OwnAnisotropy {
        let is_overridden = !self.profile.is_portable() || self.model == Model::Anisotropic;
        if is_overridden { OwnAnisotropy::Bake } else { self.own_anisotropy }
    }

    /// Sets [`Settings::max_error`].
    ///
    /// # Errors
    /// [`SettingsError::Range`] for a value that is out of range.
    pub fn with_max_error(self, max_error: f32) -> Result<Self, SettingsError> {
        limit::MAX_ERROR.check(f64::from(max_error))?;
        Ok(Self { max_error, ..self })
    }

    /// Sets [`Settings::rdo`].
    ///
    /// # Errors
    /// [`SettingsError::Range`] for a value that is out of range.
    pub fn with_rdo(self, rdo: f64) -> Result<Self, SettingsError> {
        Ok(Self { rdo: Some(limit::RDO.check(rdo)?), ..self })
    }

    /// Sets [`Settings::max_size`].
    ///
    /// # Errors
    /// [`SettingsError::Range`] for a value that is out of range.
    pub fn with_max_size(self, max_size: u32) -> Result<Self, SettingsError> {
        limit::MAX_SIZE.check(f64::from(max_size))?;
        Ok(Self { max_size: Some(max_size), ..self })
    }

    /// Sets [`Settings::frame`].
    ///
    /// # Errors
    /// [`SettingsError::Range`] for a main direction whose length is not 1.
    pub fn with_frame(self, frame: Frame) -> Result<Self, SettingsError> {
        check_frame(frame)?;
        Ok(Self { frame, ..self })
    }

    /// Sets [`Settings::height_scale`].
    ///
    /// # Errors
    /// [`SettingsError::Range`] for a value that is out of range.
    pub fn with_height_scale(self, height_scale: f32) -> Result<Self, SettingsError> {
        limit::HEIGHT_SCALE.check(f64::from(height_scale))?;
        Ok(Self { height_scale: Some(height_scale), ..self })
    }

    /// Sets [`Settings::view`].
    ///
    /// # Errors
    /// [`SettingsError::Range`] for the first value of `view` that is out of range.
    pub fn with_view(self, view: View) -> Result<Self, SettingsError> {
        view.validate()?;
        Ok(Self { view: Some(view), ..self })
    }

    /// Checks every value and what the values mean together.
    ///
    /// # Errors
    /// [`SettingsError`] for the first value that is out of range, or for two that exclude each other.
    pub fn validate(&self) -> Result<(), SettingsError> {
        if self.glb == Some(true) && self.gltf == Form::Dual {
            return Err(SettingsError::DualInGlb);
        }
        if self.textures == Textures::All && self.target != Target::Basis {
            return Err(SettingsError::ColoursWithoutBasis { target: self.target });
        }
        if self.diffuse_light == DiffuseLight::Suns && self.textures != Textures::All {
            return Err(SettingsError::SunsWithoutColours);
        }
        limit::MAX_ERROR.check(f64::from(self.max_error))?;
        self.rdo.map(|loss| limit::RDO.check(loss)).transpose()?;
        self.max_size.map(|size| limit::MAX_SIZE.check(f64::from(size))).transpose()?;
        self.height_scale.map(|scale| limit::HEIGHT_SCALE.check(f64::from(scale))).transpose()?;
        check_frame(self.frame)?;
        self.view.map_or(Ok(()), |view| view.validate())
    }
}

/// Checks the length of a main direction.
fn check_frame(frame: Frame) -> Result<(), SettingsError> {
    let Frame::MainDirection(m) = frame else { return Ok(()) };
    let length = m.iter().map(|x| x * x).sum::<f32>().sqrt();
    // Normalising in single precision leaves a length within 3e-7 of 1. The comparison is false for NaN.
    if (length - 1.0).abs() < 1e-5 {
        Ok(())
    } else {
        let (name, expected) = ("main-direction", "a direction of length 1");
        Err(SettingsError::Range { name, expected, found: format!("{m:?}") })
    }
}

//! Settings as reports and the provenance of textures record them.

use serde::Serialize;

use super::{DiffuseLight, Form, MaxModel, Model, OwnAnisotropy, Profile, Settings, Textures, View};
use crate::bump::Frame;
use crate::codec::Target;
use crate::codec::uastc::Effort;
use crate::lobe::{Distribution, Family};

/// The settings that change the bytes of a texture. They are written in the order of the fields.
///
/// Numbers of single precision are held in double precision, whose digits provenance and reports have.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
#[non_exhaustive]
pub struct RecordedSettings {
    /// [`Settings::profile`].
    pub profile: Profile,
    /// The model of the texture.
    pub model: Model,
    /// [`Settings::max_error`].
    pub max_error: f64,
    /// [`Settings::distribution`].
    pub distribution: Distribution,
    /// [`Settings::lobe`].
    pub lobe: Family,
    /// [`Settings::target`].
    pub target: Target,
    /// [`Settings::quality`].
    pub quality: Effort,
    /// [`Settings::gltf`].
    pub gltf: Form,
    /// [`Settings::frame`].
    pub frame: Frame,
    /// [`Settings::height_scale`], `null` if it is not set.
    pub height_scale: Option<f64>,
    /// [`Settings::model`], if the texture has another model; absent otherwise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub asked: Option<Model>,
    /// [`Settings::max_model`]; absent if every model is allowed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_model: Option<MaxModel>,
    /// [`Settings::own_anisotropy`]; absent if anisotropy is baked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub own_anisotropy: Option<OwnAnisotropy>,
    /// [`Settings::rdo`]; absent if it is not set.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rdo: Option<f64>,
    /// Whether scales may have changed ([`Settings::scale_normals`]); absent if not.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub scale_normals: bool,
    /// [`Settings::textures`]; absent if only baked textures are written.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub textures: Option<Textures>,
    /// [`Settings::diffuse_light`]; absent for light from all around.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub diffuse_light: Option<DiffuseLight>,
    /// [`Settings::max_size`]; absent if it is not set.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_size: Option<u32>,
    /// [`Settings::view`]; absent if it is not set.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub view: Option<View>,
}

impl RecordedSettings {
    /// Returns what is recorded of `settings` for a texture that models `model`. If the bake chose the model, `asked`
    /// holds the model that was asked for.
    pub fn new(settings: &Settings, model: Model) -> Self {
        Self {
            profile: settings.profile,
            model,
            max_error: f64::from(settings.max_error),
            distribution: settings.distribution,
            lobe: settings.lobe,
            target: settings.target,
            quality: settings.quality,
            gltf: settings.gltf,
            frame: settings.frame,
            height_scale: settings.height_scale.map(f64::from),
            asked: (model != settings.model).then_some(settings.model),
            max_model: Some(settings.max_model).filter(|max_model| *max_model != MaxModel::Anisotropic),
            own_anisotropy: Some(settings.effective_own_anisotropy()).filter(|own| *own != OwnAnisotropy::Bake),
            rdo: settings.rdo,
            scale_normals: settings.effective_scale_normals(),
            textures: Some(settings.textures).filter(|textures| *textures != Textures::Bumps),
            diffuse_light: Some(settings.diffuse_light).filter(|light| *light != DiffuseLight::Environment),
            max_size: settings.max_size,
            view: settings.view,
        }
    }
}

#[cfg(test)]
mod tests;

//! All settings that a source of settings can set, under the names of their flags.

use serde::ser::SerializeMap;
use serde::{Deserialize, Serialize, Serializer};

use crate::bump::{Frame, FrameKind};
use crate::codec::Target;
use crate::codec::uastc::Effort;
use crate::lobe::{Distribution, Family};
use crate::settings::engines::Engine;
use crate::settings::{
    DiffuseLight, Form, MaxModel, Model, OwnAnisotropy, Profile, Settings, SettingsError, Textures, View, limit,
};

/// Declares the settings, each once: the struct that holds them, and what is done with every one of them.
macro_rules! values {
    ($($field:ident: $type:ty,)*) => {
        /// Settings, as far as a source sets them. Names are those of the flags of `bake`; see `roughcast bake --help`.
        #[derive(Clone, Debug, Default, PartialEq, Deserialize)]
        #[serde(rename_all = "kebab-case", deny_unknown_fields)]
        #[allow(missing_docs)]
        pub struct Values {
            $(pub $field: Option<$type>,)*
        }

        /// Where each value came from, for a person; `None` for defaults.
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct Origins {
            $($field: Option<String>,)*
        }

        /// Serialises the values that are set, in the order of plans: first those that have a default, then the others.
        /// The ids of jobs depend on this order.
        impl Serialize for Values {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                let defaults = Self::defaults();
                let mut members = serializer.serialize_map(None)?;
                for has_default in [true, false] {
                    $(
                        if let Some(value) = self.$field && defaults.$field.is_some() == has_default {
                            members.serialize_entry(&name(stringify!($field)), &value)?;
                        }
                    )*
                }
                members.end()
            }
        }

        impl Values {
            /// Returns every name, in the order of the help.
            pub fn names() -> Vec<String> {
                vec![$(name(stringify!($field))),*]
            }

            /// Returns the name of each value that is set and its text as JSON, in the order of plans.
            pub fn texts(&self) -> Vec<(String, String)> {
                let defaults = Self::defaults();
                let texts = [$(
                    self.$field.map(|value| (defaults.$field.is_none(), (name(stringify!($field)), text(&value)))),
                )*];
                let mut texts: Vec<_> = texts.into_iter().flatten().collect();
                texts.sort_by_key(|(is_last, _)| *is_last);
                texts.into_iter().map(|(_, text)| text).collect()
            }

            /// Returns whether no value is set.
            pub fn is_empty(&self) -> bool {
                $(self.$field.is_none())&&*
            }

            /// Returns the values of `later`, and those of `self` that `later` does not set.
            #[must_use]
            pub fn overridden_by(self, later: &Self) -> Self {
                Self { $($field: later.$field.or(self.$field)),* }
            }

            /// Returns the name of each value that is set, its text as JSON, which is TOML too, and its origin.
            pub fn lines<'o>(&self, origins: &'o Origins) -> Vec<(String, String, Option<&'o str>)> {
                let lines = [$(
                    self.$field.map(|value| (name(stringify!($field)), text(&value), origins.$field.as_deref())),
                )*];
                lines.into_iter().flatten().collect()
            }
        }

        impl Origins {
            /// Records `origin` for every value that `values` sets.
            pub fn record(&mut self, values: &Values, origin: &str) {
                $(
                    if values.$field.is_some() {
                        self.$field = Some(origin.to_owned());
                    }
                )*
            }
        }
    };
}

values! {
    profile: Profile,
    model: Model,
    max_model: MaxModel,
    own_anisotropy: OwnAnisotropy,
    max_error: f64,
    quality: Effort,
    rdo: f64,
    distribution: Distribution,
    lobe: Family,
    target: Target,
    max_size: u32,
    max_texels: u64,
    provenance: bool,
    engine: Engine,
    textures: Textures,
    diffuse_light: DiffuseLight,
    gltf: Form,
    glb: bool,
    scale_normals: bool,
    frame: FrameKind,
    main_direction: [f64; 3],
    height_scale: f64,
    nearest: f64,
    screen_height: u32,
    fov: f64,
    aspect: f64,
    trim: bool,
}

/// Returns the name of the setting that `field` holds.
fn name(field: &str) -> String {
    field.replace('_', "-")
}

/// Returns a value as JSON.
fn text(value: &impl Serialize) -> String {
    serde_json::to_string(value).unwrap_or_default()
}

impl Origins {
    /// Returns whether a source has set the largest model.
    pub fn has_max_model(&self) -> bool {
        self.max_model.is_some()
    }
}

impl Values {
    /// Returns whether nothing says how the engine shades anisotropic lobes, and lobes may become anisotropic.
    /// `has_max_model` says whether a largest model is set, and not its default.
    pub fn leaves_engine_open(&self, has_max_model: bool) -> bool {
        let is_free = self.engine.is_none() && self.model.unwrap_or_default() == Model::Auto && !has_max_model;
        is_free && self.profile.unwrap_or_default().is_portable()
    }

    /// Returns the defaults; settings without a default are unset.
    pub fn defaults() -> Self {
        let defaults = Settings::default();
        Self {
            profile: Some(defaults.profile),
            model: Some(defaults.model),
            max_model: Some(defaults.max_model),
            own_anisotropy: Some(defaults.own_anisotropy),
            // 0.1 in single precision is another number in double precision.
            max_error: Some(0.1),
            quality: Some(defaults.quality),
            distribution: Some(defaults.distribution),
            lobe: Some(defaults.lobe),
            target: Some(defaults.target),
            max_texels: Some(defaults.max_texels),
            provenance: Some(defaults.provenance),
            textures: Some(defaults.textures),
            diffuse_light: Some(defaults.diffuse_light),
            gltf: Some(defaults.gltf),
            glb: defaults.glb,
            scale_normals: defaults.scale_normals,
            frame: Some(defaults.frame.kind()),
            main_direction: Some([0.0, 1.0, 0.0]),
            fov: Some(View::DEFAULT_FOV),
            aspect: Some(View::DEFAULT_ASPECT),
            trim: Some(false),
            ..Self::default()
        }
    }

    /// Returns the values that the preset of `engine` sets in a bake of `profile`.
    pub fn of_engine(engine: Engine, profile: Profile) -> Self {
        let preset = engine.preset();
        Self {
            target: Some(preset.target),
            gltf: Some(preset.form),
            glb: preset.glb,
            model: Some(preset.model(profile)),
            max_model: preset.max_model(profile),
            own_anisotropy: preset.own_anisotropy(profile),
            scale_normals: Some(preset.reads_normal_scale),
            ..Self::default()
        }
    }

    /// Returns the settings, with defaults for values that are not set.
    ///
    /// # Errors
    /// [`SettingsError`] for values that are out of range or do not go together.
    pub fn settings(&self) -> Result<Settings, SettingsError> {
        let defaults = Settings::default();
        let form = self.gltf.unwrap_or(defaults.gltf);
        if self.glb == Some(true) && form == Form::Dual {
            return Err(SettingsError::DualInGlb);
        }
        let max_error = self.max_error.map(|error| limit::MAX_ERROR.check(error)).transpose()?;
        let height_scale = self.height_scale.map(|scale| limit::HEIGHT_SCALE.check(scale)).transpose()?;
        let rdo = self.rdo.map(|loss| limit::RDO.check(loss)).transpose()?;
        let mut settings = defaults;
        settings.profile = self.profile.unwrap_or_default();
        settings.model = self.model.unwrap_or_default();
        settings.max_model = self.max_model.unwrap_or_default();
        settings.own_anisotropy = self.own_anisotropy.unwrap_or_default();
        settings.max_error = max_error.map_or(settings.max_error, |e| e as f32);
        settings.distribution = self.distribution.unwrap_or_default();
        settings.lobe = self.lobe.unwrap_or_default();
        settings.target = self.target.unwrap_or_default();
        settings.quality = self.quality.unwrap_or(settings.quality);
        settings.rdo = rdo;
        settings.max_size = self.max_size;
        settings.textures = self.textures.unwrap_or_default();
        settings.diffuse_light = self.diffuse_light.unwrap_or_default();
        settings.gltf = form;
        settings.glb = self.glb;
        settings.scale_normals = self.scale_normals;
        settings.frame = self.frame()?;
        settings.height_scale = height_scale.map(|s| s as f32);
        settings.view = self.view()?;
        settings.max_texels = self.max_texels.unwrap_or(settings.max_texels);
        settings.provenance = self.provenance.unwrap_or(settings.provenance);
        settings.validate()?;
        Ok(settings)
    }

    /// Returns the frame, whose direction is normalised.
    fn frame(&self) -> Result<Frame, SettingsError> {
        match self.frame.unwrap_or_default() {
            FrameKind::Unit => Ok(Frame::Unit),
            FrameKind::Natural => Ok(Frame::Natural),
            FrameKind::MainDirection => {
                let m = self.main_direction.unwrap_or([0.0, 1.0, 0.0]).map(|x| x as f32);
                let length = m.iter().map(|x| x * x).sum::<f32>().sqrt();
                if length.is_finite() && length > 0.0 {
                    Ok(Frame::MainDirection(m.map(|x| x / length)))
                } else {
                    let (name, expected) = ("main-direction", "a direction");
                    Err(SettingsError::Range { name, expected, found: format!("{m:?}") })
                }
            }
        }
    }

    /// Returns the camera, which needs both `nearest` and `screen-height`.
    fn view(&self) -> Result<Option<View>, SettingsError> {
        let trim = self.trim.unwrap_or(false);
        let (nearest, screen_height) = match (self.nearest, self.screen_height) {
            (Some(nearest), Some(rows)) => (nearest, rows),
            (Some(_), None) => return Err(SettingsError::Needs { name: "nearest", needs: "screen-height" }),
            (None, Some(_)) => return Err(SettingsError::Needs { name: "screen-height", needs: "nearest" }),
            (None, None) if trim => return Err(SettingsError::Needs { name: "trim", needs: "nearest" }),
            (None, None) => return Ok(None),
        };
        let mut view = View::new(nearest, screen_height);
        view.fov = self.fov.unwrap_or(view.fov);
        view.aspect = self.aspect.unwrap_or(view.aspect);
        view.trim = trim;
        view.validate()?;
        Ok(Some(view))
    }
}

//! What the materials of a glTF document say of bumps and roughness.

use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

/// A use of a texture by a material.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureUse {
    /// Index into `textures`.
    pub texture: usize,
    /// How texture coordinates come about.
    pub mapping: Mapping,
}

/// Texture coordinates: the set and its transform.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mapping {
    /// Index n of `TEXCOORD_n`.
    pub tex_coord: u64,
    /// `KHR_texture_transform` as it stands in the file.
    pub transform: Option<Value>,
}

impl Mapping {
    /// Whether both give the same texture coordinates, however they are spelled.
    pub fn is_same(&self, other: &Self) -> bool {
        self.uv() == other.uv()
    }

    /// The texture coordinates as a set and a transform.
    pub fn uv(&self) -> UvTransform {
        let raw = self.transform.as_ref().and_then(|t| RawTransform::deserialize(t).ok()).unwrap_or_default();
        UvTransform {
            tex_coord: raw.tex_coord.unwrap_or(self.tex_coord),
            offset: raw.offset.unwrap_or([0.0; 2]),
            rotation: raw.rotation.unwrap_or(0.0),
            scale: raw.scale.unwrap_or([1.0; 2]),
        }
    }
}

/// `KHR_texture_transform` with its defaults.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UvTransform {
    /// Index n of `TEXCOORD_n`.
    pub tex_coord: u64,
    /// Added last.
    pub offset: [f64; 2],
    /// In radians, counter-clockwise.
    pub rotation: f64,
    /// Applied first.
    pub scale: [f64; 2],
}

impl UvTransform {
    /// Transformed texture coordinates.
    pub fn apply(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = (libm::sin(self.rotation), libm::cos(self.rotation));
        let (u, v) = (u * self.scale[0], v * self.scale[1]);
        [cos * u + sin * v + self.offset[0], -sin * u + cos * v + self.offset[1]]
    }
}

#[derive(Default, Deserialize)]
#[serde(rename_all = "camelCase")]
struct RawTransform {
    tex_coord: Option<u64>,
    offset: Option<[f64; 2]>,
    rotation: Option<f64>,
    scale: Option<[f64; 2]>,
}

/// Largest magnitude of `normalTexture.scale`: the fourth power of a slope so scaled is still a float. Scales below
/// 1e-6, whose reciprocals' squares are none, count as 0: such bumps are flat.
const MAX_NORMAL_SCALE: f32 = 1e4;
const MIN_NORMAL_SCALE: f32 = 1e-6;

/// Largest magnitude of the scale of a height texture.
pub const MAX_HEIGHT_SCALE: f32 = 1e6;

/// Where a layer's bumps come from.
#[derive(Clone, Debug, PartialEq)]
pub enum BumpSource {
    /// A normal texture and its `scale`, whose magnitude is 0 or from 1e-6 to 1e4.
    Normals(TextureUse, f32),
    /// A height texture and its scale (`extras.roughcast.heightTexture`), whose magnitude is at most
    /// [`MAX_HEIGHT_SCALE`].
    Heights(TextureUse, f32),
}

impl BumpSource {
    /// The texture.
    pub fn texture(&self) -> &TextureUse {
        match self {
            Self::Normals(texture, _) | Self::Heights(texture, _) => texture,
        }
    }
}

/// Which of a material's lobes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LayerKind {
    /// The metallic-roughness lobe.
    Base,
    /// `KHR_materials_clearcoat`.
    Clearcoat,
}

/// `KHR_materials_anisotropy` of a material.
#[derive(Clone, Debug, PartialEq)]
pub struct AnisotropySource {
    /// `anisotropyStrength`.
    pub strength: f32,
    /// `anisotropyRotation` in radians.
    pub rotation: f32,
    /// `anisotropyTexture`.
    pub texture: Option<TextureUse>,
}

/// A lobe of a material and the bumps under it.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Which lobe.
    pub kind: LayerKind,
    /// Its bumps.
    pub bumps: BumpSource,
    /// Texture whose green channel is the roughness.
    pub roughness: Option<TextureUse>,
    /// Factor of the roughness.
    pub roughness_factor: f32,
    /// A texture whose red channel is occlusion; only for the base.
    pub occlusion: Option<TextureUse>,
    /// Only for the base.
    pub anisotropy: Option<AnisotropySource>,
    /// Whether `KHR_materials_pbrSpecularGlossiness` takes the place of metallic-roughness.
    pub has_other_workflow: bool,
}

/// A material with its bumpy layers.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Index into `materials`.
    pub index: usize,
    /// Its name, or `material <index>`.
    pub name: String,
    /// Layers that have bumps; none when the material has neither normal nor height map.
    pub layers: Vec<Layer>,
}

/// The materials of `root`, the document's JSON.
///
/// # Errors
/// Per material, what does not have the shape that glTF 2.0 gives it.
pub fn materials(root: &Value) -> Vec<Result<Material, MaterialError>> {
    let list = root.get("materials").and_then(Value::as_array);
    list.into_iter().flatten().enumerate().map(|(index, value)| Material::read(index, value)).collect()
}

/// A material that cannot be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "material {index} ({name}): expected a glTF 2.0 material, found one whose {part} cannot be read: {reason}; fix it in the file"
)]
pub struct MaterialError {
    /// Index into `materials`.
    pub index: usize,
    /// Its name, or empty.
    pub name: String,
    /// The part of the material.
    pub part: &'static str,
    /// What the reader says.
    pub reason: String,
}

impl Material {
    fn read(index: usize, value: &Value) -> Result<Self, MaterialError> {
        let name = value.get("name").and_then(Value::as_str);
        let part = |part, value| Part { index, name, part, value };
        let extension = |key: &str| value.get("extensions").and_then(|e| e.get(key));

        let normal = part("normalTexture", value.get("normalTexture")).read_bumps(MAX_NORMAL_SCALE)?;
        let height = value.get("extras").and_then(|e| e.get("roughcast")).and_then(|r| r.get("heightTexture"));
        let height = part("extras.roughcast.heightTexture", height).read_bumps(MAX_HEIGHT_SCALE)?;
        let occlusion: Option<RawTexture> = part("occlusionTexture", value.get("occlusionTexture")).read()?;
        let surface: RawSurface =
            part("pbrMetallicRoughness", value.get("pbrMetallicRoughness")).read()?.unwrap_or_default();
        let anisotropy: Option<RawAnisotropy> =
            part("KHR_materials_anisotropy", extension("KHR_materials_anisotropy")).read()?;
        let coat: Option<RawClearcoat> =
            part("KHR_materials_clearcoat", extension("KHR_materials_clearcoat")).read()?;

        let coat_normal = extension("KHR_materials_clearcoat").and_then(|coat| coat.get("clearcoatNormalTexture"));
        let coat_normal = part("clearcoatNormalTexture", coat_normal).read_bumps(MAX_NORMAL_SCALE)?;

        let mut layers = Vec::new();
        let bumps = match (normal, height) {
            (Some(normal), _) => Some(normal.normals()),
            (None, Some(height)) => Some(height.heights()),
            (None, None) => None,
        };
        if let Some(bumps) = bumps {
            layers.push(Layer {
                kind: LayerKind::Base,
                bumps,
                roughness: surface.metallic_roughness_texture.map(RawTexture::into_use),
                roughness_factor: surface.roughness_factor.unwrap_or(1.0),
                occlusion: occlusion.map(RawTexture::into_use),
                anisotropy: anisotropy.map(|a| AnisotropySource {
                    strength: a.anisotropy_strength,
                    rotation: a.anisotropy_rotation,
                    texture: a.anisotropy_texture.map(RawTexture::into_use),
                }),
                has_other_workflow: extension("KHR_materials_pbrSpecularGlossiness").is_some(),
            });
        }
        if let Some((coat, normal)) = coat.zip(coat_normal) {
            layers.push(Layer {
                kind: LayerKind::Clearcoat,
                bumps: normal.normals(),
                roughness: coat.clearcoat_roughness_texture.map(RawTexture::into_use),
                roughness_factor: coat.clearcoat_roughness_factor,
                occlusion: None,
                anisotropy: None,
                has_other_workflow: false,
            });
        }
        let name = name.map_or_else(|| format!("material {index}"), str::to_owned);
        Ok(Self { index, name, layers })
    }
}

/// A part of a material that may be absent.
struct Part<'a> {
    index: usize,
    name: Option<&'a str>,
    part: &'static str,
    value: Option<&'a Value>,
}

impl Part<'_> {
    fn read<T: DeserializeOwned>(&self) -> Result<Option<T>, MaterialError> {
        match self.value {
            Some(value) if !fits_f32(value) => Err(self.failed("a number beyond the range of floats".to_owned())),
            value => value.map(T::deserialize).transpose().map_err(|reason| self.failed(reason.to_string())),
        }
    }

    /// A texture of bumps, whose scale is at most `most`.
    fn read_bumps(&self, most: f32) -> Result<Option<RawTexture>, MaterialError> {
        let texture: Option<RawTexture> = self.read()?;
        match texture.as_ref().and_then(|texture| texture.scale) {
            Some(scale) if scale.abs() > most => {
                Err(self.failed(format!("its scale is {scale:e}, and the most that is read is {most}")))
            }
            _ => Ok(texture),
        }
    }

    fn failed(&self, reason: String) -> MaterialError {
        MaterialError { index: self.index, name: self.name.unwrap_or_default().to_owned(), part: self.part, reason }
    }
}

/// Whether no number in `value` overflows the floats that engines read it into.
fn fits_f32(value: &Value) -> bool {
    match value {
        Value::Number(number) => number.as_f64().is_none_or(|n| (n as f32).is_finite()),
        Value::Array(elements) => elements.iter().all(fits_f32),
        Value::Object(members) => members.values().all(fits_f32),
        _ => true,
    }
}

#[derive(Clone, Deserialize)]
#[serde(rename_all = "camelCase")]
struct RawTexture {
    index: usize,
    #[serde(default)]
    tex_coord: u64,
    scale: Option<f32>,
    #[serde(default)]
    extensions: RawExtensions,
}

#[derive(Clone, Default, Deserialize)]
struct RawExtensions {
    #[serde(rename = "KHR_texture_transform")]
    transform: Option<Value>,
}

impl RawTexture {
    fn into_use(self) -> TextureUse {
        TextureUse {
            texture: self.index,
            mapping: Mapping { tex_coord: self.tex_coord, transform: self.extensions.transform },
        }
    }

    fn normals(self) -> BumpSource {
        let scale = self.scale.unwrap_or(1.0);
        let scale = if scale.abs() < MIN_NORMAL_SCALE { 0.0 } else { scale };
        BumpSource::Normals(self.into_use(), scale)
    }

    fn heights(self) -> BumpSource {
        let scale = self.scale.unwrap_or(DEFAULT_HEIGHT_SCALE);
        BumpSource::Heights(self.into_use(), scale)
    }
}

/// BumpMap of a height map whose scale no one tells: a twentieth of a repeat.
pub const DEFAULT_HEIGHT_SCALE: f32 = 0.05;

#[derive(Default, Deserialize)]
#[serde(rename_all = "camelCase")]
struct RawSurface {
    metallic_roughness_texture: Option<RawTexture>,
    roughness_factor: Option<f32>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct RawAnisotropy {
    #[serde(default)]
    anisotropy_strength: f32,
    #[serde(default)]
    anisotropy_rotation: f32,
    anisotropy_texture: Option<RawTexture>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct RawClearcoat {
    #[serde(default)]
    clearcoat_roughness_factor: f32,
    clearcoat_roughness_texture: Option<RawTexture>,
}

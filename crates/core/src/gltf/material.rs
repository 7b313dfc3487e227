//! Reads the layers of the materials of a glTF document, by the table of [`crate::gltf::layers`].

use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use super::layers::{AnisotropyRow, LAYERS, LayerRow, ReflectanceRow, member, split};

pub use super::layers::LayerKind;

/// A use of a texture by a material.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureUse {
    /// Index into `textures`.
    pub texture: usize,
    /// The texture coordinates with which the texture is read.
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
    /// Returns whether both give equal texture coordinates, in whatever spelling.
    pub fn is_same(&self, other: &Self) -> bool {
        self.uv() == other.uv()
    }

    /// Returns the texture coordinates as a set and a transform, with all defaults filled in.
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
    /// Transforms texture coordinates.
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

/// Largest magnitude of the scale of a normal texture: the fourth power of a slope with this scale is still a float.
const MAX_NORMAL_SCALE: f32 = 1e4;

/// Smallest magnitude of the scale of a normal texture, other than 0. The squared reciprocal of a smaller scale is no
/// finite float, and its bumps are flat, so a smaller scale is read as 0.
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
    /// Returns the texture.
    pub fn texture(&self) -> &TextureUse {
        match self {
            Self::Normals(texture, _) | Self::Heights(texture, _) => texture,
        }
    }
}

/// The anisotropy of a layer, such as `KHR_materials_anisotropy`.
#[derive(Clone, Debug, PartialEq)]
pub struct AnisotropySource {
    /// Multiplies the texture's strength.
    pub strength: f32,
    /// Angle that is added to the texture's direction, in radians.
    pub rotation: f32,
    /// Direction in red and green, strength in blue.
    pub texture: Option<TextureUse>,
}

/// What decides on the specular reflectance of a layer, besides the blue channel of its roughness texture.
#[derive(Clone, Debug, PartialEq)]
pub struct ReflectanceFactors {
    /// Base colour in sRGB.
    pub base_colour: Option<TextureUse>,
    /// Multiplies the linear base colour.
    pub base_colour_factor: [f32; 3],
    /// Multiplies the metalness.
    pub metallic_factor: f32,
    /// Alpha multiplies the reflectance of the dielectric.
    pub specular: Option<TextureUse>,
    /// Multiplies the reflectance of the dielectric.
    pub specular_factor: f32,
    /// Colour of the dielectric's F0 in sRGB.
    pub specular_colour: Option<TextureUse>,
    /// Multiplies the dielectric's F0.
    pub specular_colour_factor: [f32; 3],
}

/// A lobe of a material and the bumps under it.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Which lobe.
    pub kind: LayerKind,
    /// Whether the layer reflects any light.
    pub is_seen: bool,
    /// Its bumps.
    pub bumps: BumpSource,
    /// Texture whose green channel is the roughness.
    pub roughness: Option<TextureUse>,
    /// Multiplies the roughness.
    pub roughness_factor: f32,
    /// Texture whose red channel is occlusion, if occlusion may share an image with the layer's roughness.
    pub occlusion: Option<TextureUse>,
    /// The anisotropy of the lobe without bumps.
    pub anisotropy: Option<AnisotropySource>,
    /// What decides on the reflectance, or why that cannot be read; none if the reflectance of the layer is constant.
    pub reflectance: Option<Result<ReflectanceFactors, MaterialError>>,
    /// Whether an extension such as `KHR_materials_pbrSpecularGlossiness` takes the place of the roughness.
    pub has_other_workflow: bool,
}

/// A material with the layers that have bumps.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Index into `materials`.
    pub index: usize,
    /// Its name, or `material <index>`.
    pub name: String,
    /// Layers that have bumps; empty if the material has neither a normal nor a height map.
    pub layers: Vec<Layer>,
}

/// Reads the materials of `root`, the document's JSON.
///
/// # Errors
/// Returns an error in the place of each material that does not have the shape that glTF 2.0 gives it.
pub fn materials(root: &Value) -> Vec<Result<Material, MaterialError>> {
    let list = root.get("materials").and_then(Value::as_array);
    list.into_iter().flatten().enumerate().map(|(index, value)| Material::read(index, value)).collect()
}

/// A material that cannot be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "material {index} ({name}): expected a glTF 2.0 material, found one whose {part} cannot be read: {reason}; \
     fix it in the file"
)]
#[non_exhaustive]
pub struct MaterialError {
    /// Index into `materials`.
    pub index: usize,
    /// Its name, or empty.
    pub name: String,
    /// The part of the material.
    pub part: String,
    /// What is wrong with the part.
    pub reason: String,
}

impl Material {
    fn read(index: usize, value: &Value) -> Result<Self, MaterialError> {
        let name = value.get("name").and_then(Value::as_str);
        let raw = RawMaterial { index, name, value };
        let layers = LAYERS.iter().map(|row| raw.layer(row)).collect::<Result<Vec<_>, _>>()?;
        let name = name.map_or_else(|| format!("material {index}"), str::to_owned);
        Ok(Self { index, name, layers: layers.into_iter().flatten().collect() })
    }
}

/// A material's JSON.
struct RawMaterial<'a> {
    index: usize,
    name: Option<&'a str>,
    value: &'a Value,
}

impl<'a> RawMaterial<'a> {
    /// Reads a layer; none if the material does not have the layer, or if the layer has no bumps. A layer without bumps
    /// is checked nevertheless.
    fn layer(&self, row: &LayerRow) -> Result<Option<Layer>, MaterialError> {
        let extensions = self.value.get("extensions");
        if row.extension.is_some_and(|name| extensions.and_then(|extensions| extensions.get(name)).is_none()) {
            return Ok(None);
        }
        let bumps = self.bumps(row)?;
        let occlusion = row.occlusion_texture.map(|pointer| self.part(pointer).read::<RawTexture>());
        let occlusion = occlusion.transpose()?.flatten();
        let (object, _) = split(row.roughness_texture);
        let surface = self.part(object).object()?;
        let roughness: Option<RawTexture> = surface.read(row.roughness_texture)?;
        let roughness_factor: Option<f32> = surface.read(row.roughness_factor)?;
        let anisotropy = row.anisotropy.as_ref().map(|row| self.anisotropy(row)).transpose()?.flatten();
        let is_seen = row.strength.map_or(Ok(true), |pointer| self.is_positive(pointer))?;
        Ok(bumps.map(|bumps| Layer {
            kind: row.kind,
            is_seen,
            bumps,
            roughness: roughness.map(RawTexture::into_use),
            roughness_factor: roughness_factor.unwrap_or(row.default_roughness_factor),
            occlusion: occlusion.map(RawTexture::into_use),
            anisotropy,
            reflectance: row.reflectance.as_ref().map(|row| self.reflectance(row)),
            has_other_workflow: row.other_workflow.is_some_and(|pointer| self.part(pointer).value.is_some()),
        }))
    }

    /// Returns whether the number at `pointer`, which is 0 by default, is above 0.
    fn is_positive(&self, pointer: &'static str) -> Result<bool, MaterialError> {
        let (object, _) = split(pointer);
        Ok(self.part(object).object()?.read::<f32>(pointer)?.unwrap_or(0.0) > 0.0)
    }

    /// Reads the bumps of a layer: the normal texture, else the height texture.
    fn bumps(&self, row: &LayerRow) -> Result<Option<BumpSource>, MaterialError> {
        let normal = self.part(row.normal_texture).read_bumps(MAX_NORMAL_SCALE)?;
        let height = row.height_texture.map(|pointer| self.part(pointer).read_bumps(MAX_HEIGHT_SCALE));
        let height = height.transpose()?.flatten();
        Ok(normal.map(RawTexture::normals).or_else(|| height.map(RawTexture::heights)))
    }

    /// Returns the anisotropy. A strength of 0, which is the default, is none.
    fn anisotropy(&self, row: &AnisotropyRow) -> Result<Option<AnisotropySource>, MaterialError> {
        let object = self.part(row.object).object()?;
        if object.is_absent() {
            return Ok(None);
        }
        let texture: Option<RawTexture> = object.read(row.texture)?;
        let source = AnisotropySource {
            strength: object.read(row.strength)?.unwrap_or(0.0),
            rotation: object.read(row.rotation)?.unwrap_or(0.0),
            texture: texture.map(RawTexture::into_use),
        };
        Ok(Some(source).filter(|source| source.strength > 0.0))
    }

    fn reflectance(&self, row: &ReflectanceRow) -> Result<ReflectanceFactors, MaterialError> {
        let (surface, specular) = (self.part(row.object).object()?, self.part(row.specular).object()?);
        let base_colour: Option<RawTexture> = surface.read(row.base_colour_texture)?;
        let base_colour_factor: Option<[f32; 4]> = surface.read(row.base_colour_factor)?;
        let specular_texture: Option<RawTexture> = specular.read(row.specular_texture)?;
        let specular_colour: Option<RawTexture> = specular.read(row.specular_colour_texture)?;
        let [red, green, blue, _] = base_colour_factor.unwrap_or([1.0; 4]);
        Ok(ReflectanceFactors {
            base_colour: base_colour.map(RawTexture::into_use),
            base_colour_factor: [red, green, blue],
            metallic_factor: surface.read(row.metallic_factor)?.unwrap_or(1.0),
            specular: specular_texture.map(RawTexture::into_use),
            specular_factor: specular.read(row.specular_factor)?.unwrap_or(1.0),
            specular_colour: specular_colour.map(RawTexture::into_use),
            specular_colour_factor: specular.read(row.specular_colour_factor)?.unwrap_or([1.0; 3]),
        })
    }

    /// Returns the part of the material that is at `pointer`.
    fn part(&self, pointer: &'static str) -> Part<'a> {
        let value = self.value.pointer(&format!("/{pointer}"));
        Part { index: self.index, name: self.name, pointer, value }
    }
}

/// A part of a material that may be absent.
struct Part<'a> {
    index: usize,
    name: Option<&'a str>,
    pointer: &'static str,
    value: Option<&'a Value>,
}

/// An object of a material, all of whose numbers are floats.
struct ObjectPart<'a>(Part<'a>);

impl<'a> Part<'a> {
    fn read<T: DeserializeOwned>(&self) -> Result<Option<T>, MaterialError> {
        self.check_numbers()?;
        self.value.map(T::deserialize).transpose().map_err(|reason| self.failed(reason.to_string()))
    }

    /// Reads a texture of bumps, whose scale is at most `max_scale`.
    fn read_bumps(&self, max_scale: f32) -> Result<Option<RawTexture>, MaterialError> {
        let texture: Option<RawTexture> = self.read()?;
        match texture.as_ref().and_then(|texture| texture.scale) {
            Some(scale) if scale.abs() > max_scale => {
                Err(self.failed(format!("its scale is {scale:e}, and the most that is read is {max_scale}")))
            }
            _ => Ok(texture),
        }
    }

    /// Checks that the part is an object, if it is there.
    fn object(self) -> Result<ObjectPart<'a>, MaterialError> {
        self.check_numbers()?;
        if self.value.is_some_and(|value| !value.is_object()) {
            return Err(self.failed("it is no JSON object".to_owned()));
        }
        Ok(ObjectPart(self))
    }

    fn check_numbers(&self) -> Result<(), MaterialError> {
        match self.value {
            Some(value) if !fits_f32(value) => Err(self.failed("a number beyond the range of floats".to_owned())),
            _ => Ok(()),
        }
    }

    fn failed(&self, reason: String) -> MaterialError {
        let part = match self.pointer.starts_with("extras/") {
            true => self.pointer.replace('/', "."),
            false => member(self.pointer).to_owned(),
        };
        MaterialError { index: self.index, name: self.name.unwrap_or_default().to_owned(), part, reason }
    }
}

impl ObjectPart<'_> {
    fn is_absent(&self) -> bool {
        self.0.value.is_none()
    }

    /// Reads the member that is at `pointer` in the material; `null` counts as absent.
    fn read<T: DeserializeOwned>(&self, pointer: &'static str) -> Result<Option<T>, MaterialError> {
        let value = self.0.value.and_then(|object| object.get(member(pointer)));
        let read = value.map(Option::<T>::deserialize).transpose();
        read.map(Option::flatten).map_err(|reason| self.0.failed(reason.to_string()))
    }
}

/// Returns whether no number in `value` overflows the floats that engines read it into.
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

/// Scale of a height map that names none: a twentieth of a repeat of the texture.
pub const DEFAULT_HEIGHT_SCALE: f32 = 0.05;

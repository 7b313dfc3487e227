//! Makes materials from the extension while Bevy loads a glTF file.

use std::collections::{BTreeMap, BTreeSet};

use bevy::asset::{Handle, LoadContext};
use bevy::ecs::world::{EntityWorldMut, World};
use bevy::gltf::extensions::{ErasedGltfExtensionHandler, GltfExtensionHandler};
use bevy::gltf::{DefaultGltfImageSampler, GltfLoaderSettings, GltfMaterial};
use bevy::image::{
    CompressedImageFormatSupport, CompressedImageFormats, Image, ImageAddressMode, ImageFilterMode,
    ImageLoaderSettings, ImageSampler, ImageSamplerDescriptor, ImageType,
};
use bevy::material::OpaqueRendererMethod;
use bevy::mesh::UvChannel;
use bevy::pbr::{MeshMaterial3d, StandardMaterial};
use gltf::image::Source;
use gltf::texture::{MagFilter, MinFilter, WrappingMode};
use percent_encoding::percent_decode_str;
use tracing::warn;

use crate::extension::{EXTENSION, Extension, TextureInfo};
use crate::material::{Pyramid, PyramidMaterial};

/// Handles the extension in each glTF file.
#[derive(Clone)]
pub struct Handler {
    sampler: ImageSamplerDescriptor,
    formats: CompressedImageFormats,
    /// Images of the extension's textures, by index of the texture.
    textures: BTreeMap<usize, Handle<Image>>,
    /// Labels of Bevy's materials that have a [`PyramidMaterial`].
    labels: BTreeSet<String>,
}

impl Handler {
    /// Makes a handler with the default sampler and the texture formats that Bevy's own plugins found.
    pub fn new(world: &World) -> Self {
        let sampler = world.get_resource::<DefaultGltfImageSampler>().map(DefaultGltfImageSampler::get);
        let formats = world.get_resource::<CompressedImageFormatSupport>().map(|support| support.0);
        Self {
            sampler: sampler.unwrap_or_else(ImageSamplerDescriptor::linear),
            formats: formats.unwrap_or(CompressedImageFormats::NONE),
            textures: BTreeMap::new(),
            labels: BTreeSet::new(),
        }
    }

    /// Loads an image as linear data. Bevy would load a texture that only extensions name as sRGB. The first load of an
    /// image decides, and this one comes before Bevy's.
    fn load(
        &self,
        load_context: &mut LoadContext<'_>,
        file: &gltf::Gltf,
        texture: &gltf::Texture<'_>,
        settings: &GltfLoaderSettings,
    ) -> Result<Handle<Image>, String> {
        let default = settings.default_sampler.as_ref().unwrap_or(&self.sampler);
        let descriptor = if settings.override_sampler { default.clone() } else { sampler(&texture.sampler(), default) };
        let (sampler, usage) = (ImageSampler::Descriptor(descriptor), settings.load_materials);
        match texture.source().source() {
            Source::Uri { uri, .. } if uri.starts_with("data:") => {
                Err("images in data URIs are not supported".to_owned())
            }
            Source::Uri { uri, .. } => {
                let uri = percent_decode_str(uri).decode_utf8_lossy();
                let path = load_context.path().resolve_embed_str(&uri).map_err(|error| error.to_string())?;
                let settings = move |settings: &mut ImageLoaderSettings| {
                    settings.is_srgb = false;
                    settings.sampler = sampler.clone();
                    settings.asset_usage = usage;
                };
                Ok(load_context.load_builder().with_settings(settings).load(path))
            }
            Source::View { view, mime_type } => {
                let range = view.offset()..view.offset().saturating_add(view.length());
                let is_bin = matches!(view.buffer().source(), gltf::buffer::Source::Bin);
                let bytes = file.blob.as_ref().filter(|_| is_bin).and_then(|blob| blob.get(range));
                let bytes = bytes.ok_or("images in buffers of their own are not supported")?;
                let kind = ImageType::MimeType(mime_type);
                let image = Image::from_buffer(bytes, kind, self.formats, false, sampler, usage);
                let label = format!("Texture{}/roughcast", texture.index());
                Ok(load_context.add_labeled_asset(label, image.map_err(|error| error.to_string())?))
            }
        }
    }

    fn material(&self, load_context: &LoadContext<'_>, label: &str, extension: &Extension) -> Option<PyramidMaterial> {
        let mut base = load_context.get_labeled(standard_label(label))?.get::<StandardMaterial>()?.clone();
        base.normal_map_texture = None;
        // The G-buffer has no anisotropy.
        base.opaque_render_method = OpaqueRendererMethod::Forward;
        if let Some(lobe) = &extension.base_lobe {
            base.perceptual_roughness = lobe.roughness_factor;
            base.metallic_roughness_texture = self.optional(lobe.metallic_roughness_texture.as_ref())?;
            base.metallic_roughness_channel = channel(lobe.metallic_roughness_texture.as_ref());
            base.anisotropy_strength = lobe.anisotropy.strength;
            base.anisotropy_rotation = lobe.anisotropy.rotation;
            base.anisotropy_texture = self.optional(lobe.anisotropy.texture.as_ref())?;
            base.anisotropy_channel = channel(lobe.anisotropy.texture.as_ref());
        }
        let offset = self.textures.get(&extension.offset_texture.index)?.clone();
        let roughness = self.optional(extension.roughness_texture.as_ref())?;
        Some(PyramidMaterial { base, extension: Pyramid::new(extension, offset, roughness) })
    }

    /// Returns the image of a texture that may be absent, or `None` where the image cannot be loaded.
    fn optional(&self, info: Option<&TextureInfo>) -> Option<Option<Handle<Image>>> {
        match info {
            Some(info) => Some(Some(self.textures.get(&info.index)?.clone())),
            None => Some(None),
        }
    }
}

fn channel(info: Option<&TextureInfo>) -> UvChannel {
    if info.is_some_and(|info| info.channel() == 1) { UvChannel::Uv1 } else { UvChannel::Uv0 }
}

impl GltfExtensionHandler for Handler {
    fn dyn_clone(&self) -> Box<dyn ErasedGltfExtensionHandler> {
        Box::new(self.clone())
    }

    fn on_root(&mut self, load_context: &mut LoadContext<'_>, file: &gltf::Gltf, settings: &GltfLoaderSettings) {
        if settings.load_materials.is_empty() {
            return;
        }
        let extensions = file.materials().filter_map(|material| read(&material)?.ok());
        let indices: BTreeSet<usize> =
            extensions.flat_map(|e| e.textures().map(|t| t.index).collect::<Vec<_>>()).collect();
        for index in indices {
            let Some(texture) = file.textures().nth(index) else { continue };
            match self.load(load_context, file, &texture, settings) {
                Ok(handle) => drop(self.textures.insert(index, handle)),
                Err(error) => warn!("{}: textures[{index}]: {error}", load_context.path()),
            }
        }
    }

    fn on_material(
        &mut self,
        load_context: &mut LoadContext<'_>,
        material: &gltf::Material<'_>,
        _handle: Handle<GltfMaterial>,
        _asset: &GltfMaterial,
        label: &str,
    ) {
        let found = match read(material) {
            None => return,
            Some(Err(error)) => Err(error),
            Some(Ok(_)) if material.unlit() => Err("the material is not lit".to_owned()),
            Some(Ok(extension)) => {
                self.material(load_context, label, &extension).ok_or_else(|| "a texture cannot be loaded".to_owned())
            }
        };
        match found {
            Ok(pyramid) => {
                load_context.add_labeled_asset(pyramid_label(label), pyramid);
                self.labels.insert(label.to_owned());
            }
            Err(error) => warn!("{}: {label}: {EXTENSION}: {error}; shown without it", load_context.path()),
        }
    }

    fn on_spawn_mesh_and_material(
        &mut self,
        load_context: &mut LoadContext<'_>,
        _primitive: &gltf::Primitive<'_>,
        _mesh: &gltf::Mesh<'_>,
        _material: &gltf::Material<'_>,
        entity: &mut EntityWorldMut<'_>,
        label: &str,
    ) {
        if self.labels.contains(label) {
            let handle = load_context.get_label_handle::<PyramidMaterial>(pyramid_label(label));
            entity.remove::<MeshMaterial3d<StandardMaterial>>().insert(MeshMaterial3d(handle));
        }
    }
}

fn read(material: &gltf::Material<'_>) -> Option<Result<Extension, String>> {
    Some(Extension::read(material.extension_value(EXTENSION)?))
}

/// Returns the label of Bevy's own material.
fn standard_label(label: &str) -> String {
    format!("{label}/std")
}

/// Returns the label of the [`PyramidMaterial`].
fn pyramid_label(label: &str) -> String {
    format!("{label}/roughcast")
}

/// Returns Bevy's default sampler with the wrap modes and filters of glTF's sampler. A default with anisotropy keeps
/// its filters, since wgpu allows anisotropy with linear filters only.
fn sampler(given: &gltf::texture::Sampler<'_>, default: &ImageSamplerDescriptor) -> ImageSamplerDescriptor {
    let mut sampler = default.clone();
    sampler.address_mode_u = address_mode(given.wrap_s());
    sampler.address_mode_v = address_mode(given.wrap_t());
    if sampler.anisotropy_clamp != 1 {
        return sampler;
    }
    if let Some(filter) = given.mag_filter() {
        sampler.mag_filter = filter_mode(filter == MagFilter::Linear);
    }
    if let Some(filter) = given.min_filter() {
        use MinFilter::{Linear, LinearMipmapLinear, LinearMipmapNearest, NearestMipmapLinear};
        sampler.min_filter = filter_mode(matches!(filter, Linear | LinearMipmapNearest | LinearMipmapLinear));
        sampler.mipmap_filter = filter_mode(matches!(filter, NearestMipmapLinear | LinearMipmapLinear));
    }
    sampler
}

fn filter_mode(is_linear: bool) -> ImageFilterMode {
    if is_linear { ImageFilterMode::Linear } else { ImageFilterMode::Nearest }
}

fn address_mode(mode: WrappingMode) -> ImageAddressMode {
    match mode {
        WrappingMode::ClampToEdge => ImageAddressMode::ClampToEdge,
        WrappingMode::MirroredRepeat => ImageAddressMode::MirrorRepeat,
        WrappingMode::Repeat => ImageAddressMode::Repeat,
    }
}

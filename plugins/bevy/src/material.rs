//! The material: Bevy's standard one, with a pyramid in the place of its normal map.

use bevy::asset::{Asset, Handle};
use bevy::image::Image;
use bevy::math::{Mat3, Vec2, Vec3};
use bevy::mesh::MeshVertexBufferLayoutRef;
use bevy::pbr::{
    ExtendedMaterial, MaterialExtension, MaterialExtensionKey, MaterialExtensionPipeline, StandardMaterial,
};
use bevy::reflect::TypePath;
use bevy::render::render_resource::{AsBindGroup, RenderPipelineDescriptor, ShaderType, SpecializedMeshPipelineError};
use bevy::shader::ShaderRef;

use crate::extension::{Extension, Frame, Model};

/// A standard material whose bumps are a pyramid.
pub type PyramidMaterial = ExtendedMaterial<StandardMaterial, Pyramid>;

/// The textures of a pyramid: offsets, and the bumps that each level has lost.
#[derive(Asset, AsBindGroup, Clone, Debug, TypePath)]
#[bind_group_data(Variant)]
pub struct Pyramid {
    #[uniform(100)]
    values: Values,
    /// Unit normals of scaled offsets, linear.
    #[texture(101)]
    #[sampler(102)]
    offset: Handle<Image>,
    /// D or lambda_1, linear.
    #[texture(103)]
    #[sampler(104)]
    roughness: Option<Handle<Image>>,
    variant: Variant,
}

/// `Pyramid` of pyramid.wgsl.
#[derive(Clone, Debug, ShaderType)]
struct Values {
    offset_uv: Mat3,
    roughness_uv: Mat3,
    offset_scale: Vec2,
    roughness_min: Vec3,
    correction_factor: f32,
    roughness_max: Vec3,
    main_direction: Vec3,
}

/// What the shader is compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Variant {
    model: Option<Model>,
    frame: Frame,
    /// Whether the shader rebuilds z of the offset texture.
    rebuilds_z: bool,
    /// Whether the offset texture and the roughness texture are read with the second texture coordinates.
    second_uv: [bool; 2],
}

impl From<&Pyramid> for Variant {
    fn from(pyramid: &Pyramid) -> Self {
        pyramid.variant
    }
}

impl Pyramid {
    pub(crate) fn new(extension: &Extension, offset: Handle<Image>, roughness: Option<Handle<Image>>) -> Self {
        let [roughness_min, roughness_max] = extension.roughness_range();
        let roughness_info = extension.roughness_texture.as_ref();
        Self {
            values: Values {
                offset_uv: extension.offset_texture.uv_transform(),
                roughness_uv: roughness_info.map_or(Mat3::IDENTITY, |info| info.uv_transform()),
                offset_scale: extension.offset_scale,
                roughness_min,
                correction_factor: extension.correction_factor,
                roughness_max,
                main_direction: extension.main_direction.unwrap_or(Vec3::ZERO),
            },
            offset,
            roughness,
            variant: Variant {
                model: extension.roughness_model,
                frame: extension.frame,
                rebuilds_z: !extension.has_z(),
                second_uv: [Some(&extension.offset_texture), roughness_info]
                    .map(|t| t.is_some_and(|t| t.channel() == 1)),
            },
        }
    }
}

impl MaterialExtension for Pyramid {
    fn fragment_shader() -> ShaderRef {
        "embedded://bevy_roughcast/pyramid.wgsl".into()
    }

    fn specialize(
        _pipeline: &MaterialExtensionPipeline,
        descriptor: &mut RenderPipelineDescriptor,
        _layout: &MeshVertexBufferLayoutRef,
        key: MaterialExtensionKey<Self>,
    ) -> Result<(), SpecializedMeshPipelineError> {
        let Some(fragment) = &mut descriptor.fragment else { return Ok(()) };
        let Variant { model, frame, rebuilds_z, second_uv: [offset_uv, roughness_uv] } = key.bind_group_data;
        let defs = [
            // D needs the anisotropic lobe. The base lobe of a material without anisotropy is isotropic.
            (model == Some(Model::CovarianceFactor), "STANDARD_MATERIAL_ANISOTROPY"),
            (model == Some(Model::CovarianceFactor), "ROUGHCAST_FACTOR"),
            (model.is_some(), "ROUGHCAST_MODEL"),
            (frame == Frame::Natural, "ROUGHCAST_FRAME_NATURAL"),
            (frame == Frame::MainDirection, "ROUGHCAST_FRAME_MAIN"),
            (rebuilds_z, "ROUGHCAST_REBUILT_Z"),
            (offset_uv, "ROUGHCAST_OFFSET_UV_B"),
            (roughness_uv, "ROUGHCAST_ROUGHNESS_UV_B"),
        ];
        fragment.shader_defs.extend(defs.into_iter().filter(|(is_on, _)| *is_on).map(|(_, name)| name.into()));
        Ok(())
    }
}

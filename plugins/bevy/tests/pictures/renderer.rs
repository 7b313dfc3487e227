//! Renders with Bevy, without a window.

use std::path::Path;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use bevy::app::{PluginsState, TerminalCtrlCHandlerPlugin};
use bevy::asset::AssetPlugin;
use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::VisibilityClass;
use bevy::camera::{Exposure, Hdr, RenderTarget};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::gltf::{GltfAssetLabel, GltfMaterialName, GltfMeshName};
use bevy::math::Vec3;
use bevy::prelude::*;
use bevy::render::gpu_readback::{Readback, ReadbackComplete};
use bevy::render::render_resource::{TextureFormat, TextureUsages};
use bevy::transform::components::TransformTreeChanged;
use bevy::window::ExitCondition;
use bevy_roughcast::RoughcastPlugin;

/// Pixels along a side of a picture.
pub const SIZE: u32 = 64;
/// Direction toward the light.
pub const LIGHT: Vec3 = Vec3::new(0.1, 0.25, 1.0);

/// Linear radiance of a metal plane under a light of pi, row by row from the top.
pub type Picture = Vec<f32>;

/// An app that shows one glTF at a time to one camera.
pub struct Renderer {
    app: App,
    target: Handle<Image>,
    scene: Option<Entity>,
}

impl Renderer {
    /// Makes an app over the files of `folder`, with the plugin or without.
    pub fn new(folder: &Path, has_plugin: bool) -> Self {
        let mut app = App::new();
        let files = AssetPlugin { file_path: folder.to_string_lossy().into_owned(), ..default() };
        let window = WindowPlugin { primary_window: None, exit_condition: ExitCondition::DontExit, ..default() };
        app.add_plugins(DefaultPlugins.set(files).set(window).disable::<TerminalCtrlCHandlerPlugin>());
        if has_plugin {
            app.add_plugins(RoughcastPlugin);
        }
        register_types(&mut app);
        app.insert_resource(ClearColor(Color::BLACK)).insert_resource(GlobalAmbientLight::NONE);
        while app.plugins_state() == PluginsState::Adding {
            bevy::tasks::tick_global_task_pools_on_main_thread();
        }
        app.finish();
        app.cleanup();
        let mut image = Image::new_target_texture(SIZE, SIZE, TextureFormat::Rgba32Float, None);
        image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
        let target = app.world_mut().resource_mut::<Assets<Image>>().add(image);
        // From a distance of 1 the plane of 2 x 2 fills the picture.
        let projection = PerspectiveProjection { fov: 90_f32.to_radians(), aspect_ratio: 1.0, ..default() };
        app.world_mut().spawn((
            Camera3d::default(),
            Projection::Perspective(projection),
            RenderTarget::Image(target.clone().into()),
            Transform::from_xyz(0.0, 0.0, 1.0),
            Hdr,
            Msaa::Off,
            Tonemapping::None,
            // An exposure of 1.
            Exposure { ev100: -1.2_f32.log2() },
        ));
        app.world_mut().spawn((
            DirectionalLight { illuminance: std::f32::consts::PI, ..default() },
            Transform::from_translation(LIGHT).looking_at(Vec3::ZERO, Vec3::Y),
        ));
        Self { app, target, scene: None }
    }

    /// Draws a picture of a glTF.
    pub fn draw(&mut self, path: &str) -> Picture {
        if let Some(previous) = self.scene.take() {
            self.app.world_mut().despawn(previous);
        }
        let server = self.app.world().resource::<AssetServer>().clone();
        let scene = server.load(GltfAssetLabel::Scene(0).from_asset(path.to_owned()));
        self.scene = Some(self.app.world_mut().spawn(WorldAssetRoot(scene.clone())).id());
        for _ in 0..1000 {
            self.app.update();
            if let bevy::asset::RecursiveDependencyLoadState::Failed(error) =
                server.recursive_dependency_load_state(&scene)
            {
                panic!("{path}: {error}");
            }
            if server.is_loaded_with_dependencies(&scene) {
                return self.settled(path);
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        panic!("{path} is not loaded");
    }

    /// Draws until three pictures are equal, since pipelines compile while Bevy already draws.
    fn settled(&mut self, path: &str) -> Picture {
        let pictures = Arc::new(Mutex::new(Vec::<Picture>::new()));
        let seen = pictures.clone();
        let readback = self.app.world_mut().spawn(Readback::texture(self.target.clone()));
        let entity = { readback }
            .observe(move |event: On<ReadbackComplete>| {
                let floats = event.data.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap()));
                seen.lock().unwrap().push(floats.step_by(4).collect());
            })
            .id();
        for _ in 0..200 {
            self.app.update();
            let pictures = pictures.lock().unwrap();
            if let [.., a, b, c] = pictures.as_slice()
                && a.iter().any(|v| *v > 0.0)
                && a == b
                && b == c
            {
                self.app.world_mut().despawn(entity);
                return c.clone();
            }
        }
        panic!("{path} is not shown");
    }
}

/// Registers the components of glTF scenes. Bevy's feature reflect_auto_register would do so, but is slow to compile.
fn register_types(app: &mut App) {
    app.register_type::<Name>()
        .register_type::<ChildOf>()
        .register_type::<Children>()
        .register_type::<Transform>()
        .register_type::<GlobalTransform>()
        .register_type::<TransformTreeChanged>()
        .register_type::<Visibility>()
        .register_type::<InheritedVisibility>()
        .register_type::<ViewVisibility>()
        .register_type::<VisibilityClass>()
        .register_type::<Aabb>()
        .register_type::<Mesh3d>()
        .register_type::<GltfMeshName>()
        .register_type::<GltfMaterialName>();
}

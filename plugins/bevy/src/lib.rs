//! Shades glTF materials with `ROUGHCAST_materials_roughness_pyramid`, the extension that `roughcast bake --profile
//! pyramid` writes.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use bevy_roughcast::RoughcastPlugin;
//!
//! App::new().add_plugins((DefaultPlugins, RoughcastPlugin)).run();
//! ```
//!
//! After hardware filtering, each fragment tilts its normal by the offsets, n' = n - f_u e1 - f_v e2. It then roughens
//! the base lobe A by the bumps that the level has lost, A' = A + 2 c K, in the frame that the extension names.

mod extension;
mod loader;
mod material;

use bevy::app::{App, Plugin};
use bevy::asset::embedded_asset;
use bevy::gltf::extensions::GltfExtensionHandlers;
use bevy::pbr::MaterialPlugin;
use bevy::tasks::block_on;

pub use extension::{EXTENSION, Frame, Model};
pub use material::{Pyramid, PyramidMaterial};

/// Gives meshes of glTF files a [`PyramidMaterial`] where their material has the extension. Must be added after Bevy's
/// own plugins.
#[derive(Clone, Copy, Debug, Default)]
pub struct RoughcastPlugin;

impl Plugin for RoughcastPlugin {
    fn build(&self, app: &mut App) {
        embedded_asset!(app, "pyramid.wgsl");
        app.add_plugins(MaterialPlugin::<PyramidMaterial>::default());
    }

    fn finish(&self, app: &mut App) {
        let handler = loader::Handler::new(app.world());
        let handlers = app.world().resource::<GltfExtensionHandlers>().0.clone();
        block_on(handlers.write()).push(Box::new(handler));
    }
}

//! The container of the output document, and what goes by the form of its references to textures.

use super::{Form, Settings};
use crate::gltf::document::Container;

impl Settings {
    /// Sets [`Settings::glb`].
    #[must_use]
    pub fn with_glb(self, glb: bool) -> Self {
        Self { glb: Some(glb), ..self }
    }

    /// Sets [`Settings::scale_normals`].
    #[must_use]
    pub fn with_scale_normals(self, scale_normals: bool) -> Self {
        Self { scale_normals: Some(scale_normals), ..self }
    }

    /// Returns the settings for a source document in the container `source`, with explicit values of
    /// [`Settings::glb`] and [`Settings::scale_normals`].
    #[must_use]
    pub fn resolved_for(&self, source: Container) -> Self {
        self.with_glb(self.container(source) == Container::Glb).with_scale_normals(self.effective_scale_normals())
    }

    /// Returns the container of the output for a source document in the container `source`.
    pub fn container(&self, source: Container) -> Container {
        match self.glb {
            Some(true) => Container::Glb,
            Some(false) => Container::Gltf,
            // Both references of the dual form name an external file.
            None if self.gltf == Form::Dual => Container::Gltf,
            None => source,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_container_follows_the_source_and_scales_the_form_unless_they_are_explicit() {
        let default = Settings::default();
        assert_eq!(default.gltf, Form::Strict);
        for (settings, source, is_glb) in [
            (default, Container::Glb, true),
            (default, Container::Gltf, false),
            (default.with_glb(false), Container::Glb, false),
            (default.with_glb(true), Container::Gltf, true),
            (default.with_gltf(Form::Fallback), Container::Glb, true),
            (default.with_gltf(Form::Fallback), Container::Gltf, false),
            (default.with_gltf(Form::Dual), Container::Glb, false),
        ] {
            let resolved = settings.resolved_for(source);
            assert_eq!((resolved.glb, resolved.gltf), (Some(is_glb), settings.gltf), "{:?} {source:?}", settings.glb);
            assert_eq!(resolved.scale_normals, Some(resolved.gltf == Form::Strict), "scales follow the form");
            for explicit in [false, true] {
                let resolved = settings.with_scale_normals(explicit).resolved_for(source);
                assert_eq!(resolved.scale_normals, Some(explicit));
            }
            assert_eq!(resolved.validate(), Ok(()));
        }
    }
}

//! The container of the output document, the form of its references to textures, and what goes by that form.

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
    /// [`Settings::glb`], [`Settings::gltf`] and [`Settings::scale_normals`].
    #[must_use]
    pub fn resolved_for(&self, source: Container) -> Self {
        let container = self.container(source);
        let gltf = match (self.gltf, container) {
            // Fallbacks inside a .glb would make every reader load them, whether it needs them or not.
            (Form::Auto, Container::Glb) => Form::Strict,
            // A reader of a .gltf loads only the file that it shows, so that fallbacks cost nothing but disk space.
            (Form::Auto, Container::Gltf) => Form::Fallback,
            (explicit, _) => explicit,
        };
        let explicit = self.with_gltf(gltf).with_glb(container == Container::Glb);
        explicit.with_scale_normals(explicit.effective_scale_normals())
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
    fn container_and_form_follow_the_source_unless_they_are_explicit() {
        let default = Settings::default();
        for (settings, source, expected) in [
            (default, Container::Glb, (Some(true), Form::Strict)),
            (default, Container::Gltf, (Some(false), Form::Fallback)),
            (default.with_glb(false), Container::Glb, (Some(false), Form::Fallback)),
            (default.with_glb(true), Container::Gltf, (Some(true), Form::Strict)),
            (default.with_gltf(Form::Fallback), Container::Glb, (Some(true), Form::Fallback)),
            (default.with_gltf(Form::Strict), Container::Gltf, (Some(false), Form::Strict)),
            (default.with_gltf(Form::Dual), Container::Glb, (Some(false), Form::Dual)),
        ] {
            let resolved = settings.resolved_for(source);
            assert_eq!((resolved.glb, resolved.gltf), expected, "{:?} {:?} {source:?}", settings.glb, settings.gltf);
            assert_eq!(resolved.scale_normals, Some(resolved.gltf == Form::Strict), "scales follow the form");
            for explicit in [false, true] {
                let resolved = settings.with_scale_normals(explicit).resolved_for(source);
                assert_eq!(resolved.scale_normals, Some(explicit));
            }
            assert_eq!(resolved.validate(), Ok(()));
        }
    }
}

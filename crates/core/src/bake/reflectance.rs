//! Step 3: the images that decide on the reflectance of a base lobe. Only images that matter are decoded.

use crate::bake::decode::Images;
use crate::bake::group::{GroupLayer, ReflectanceTextures};
use crate::bake::image_error::ImageError;
use crate::gltf::material::ReflectanceFactors;
use crate::gltf::texture::TextureSource;
use crate::image::Image;
use crate::material::{Factored, Metalness, ReflectanceRows, ReflectanceSource};
use crate::mip::Wrap;
use crate::note::{self, Note};

/// The images and factors of a reflectance.
pub struct ReflectanceInput {
    factors: ReflectanceFactors,
    metalness: Metalness,
    base_colour: Option<Image>,
    specular: Option<Image>,
    specular_colour: Option<Image>,
}

impl ReflectanceInput {
    /// Decodes the images of the reflectance of `layer`, whose metalness is blue of `roughness`. Returns no reflectance
    /// if it is constant. An image that cannot be decoded is no error: the reflectance is then taken to be constant,
    /// and the note says why.
    ///
    /// # Errors
    /// [`ImageError`] if there is too little memory, since another try may succeed.
    pub fn new(
        images: &Images<'_>,
        layer: &GroupLayer,
        roughness: Option<&Image>,
    ) -> Result<(Option<Self>, Option<Note>), ImageError> {
        let Some(textures) = layer.reflectance() else { return Ok((None, None)) };
        match Self::decoded(images, layer, textures, roughness) {
            Ok(input) => Ok((input, None)),
            Err(error) if error.is_out_of_memory() => Err(error),
            Err(error) => Ok((None, Some(note::unknown_reflectance(&error)))),
        }
    }

    fn decoded(
        images: &Images<'_>,
        layer: &GroupLayer,
        textures: &ReflectanceTextures,
        roughness: Option<&Image>,
    ) -> Result<Option<Self>, ImageError> {
        let ReflectanceTextures { factors, base_colour, specular, specular_colour } = textures;
        let metalness = Metalness::new(roughness, factors.metallic_factor);
        let varies = matches!(metalness, Metalness::Texture(_));
        let base_colour = base_colour.as_deref().filter(|_| metalness.needs_base_colour());
        let is_dielectric = metalness != Metalness::Constant(1.0);
        let [specular, specular_colour] = [specular, specular_colour].map(|t| t.as_deref().filter(|_| is_dielectric));
        if !varies && [base_colour, specular, specular_colour].iter().all(Option::is_none) {
            return Ok(None);
        }
        let image = |texture: Option<&TextureSource>| texture.map(|t| images.colours(t, &layer.name)).transpose();
        Ok(Some(Self {
            factors: factors.clone(),
            metalness,
            base_colour: image(base_colour)?,
            specular: image(specular)?,
            specular_colour: image(specular_colour)?,
        }))
    }

    /// Puts the reflectance on a grid of `size` texels; `None` if it is constant. Metalness is blue of `roughness`.
    pub fn rows<'a>(
        &'a self,
        size: (u32, u32),
        wrap: [Wrap; 2],
        roughness: Option<&'a Image>,
    ) -> Option<ReflectanceRows<'a>> {
        let factors = &self.factors;
        let source = ReflectanceSource {
            roughness,
            metalness: self.metalness,
            base_colour: Factored { image: self.base_colour.as_ref(), factor: factors.base_colour_factor },
            specular: Factored { image: self.specular.as_ref(), factor: factors.specular_factor },
            specular_colour: Factored { image: self.specular_colour.as_ref(), factor: factors.specular_colour_factor },
        };
        ReflectanceRows::new(&source, size, wrap)
    }
}

#[cfg(test)]
mod tests;

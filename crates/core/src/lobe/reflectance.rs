//! Specular reflectance: how much light the lobe of a texel reflects, averaged over directions. It is the weight of the
//! lobe beside the lobes of other texels in a footprint.
//!
//! The materials are those of glTF 2.0 (appendix B) with `KHR_materials_specular`. Fresnel reflectance is that of C.
//! Schlick, "An inexpensive BRDF model for physically-based rendering", 1994: F0 + (F90 - F0) (1 - cos)^5.

/// Reflectance of a dielectric at normal incidence, for glTF's refractive index of 1.5.
pub const DIELECTRIC_F0: f32 = 0.04;

/// Mean of (1 - cos)^5 over a hemisphere of directions, weighted by their cosine.
const MEAN_SCHLICK: f32 = 1.0 / 21.0;

/// The least reflectance of a texel. A footprint of texels that reflect nothing still has a lobe.
const LEAST_REFLECTANCE: f32 = 1e-3;

/// Returns the luminance of a linear colour with the primaries of ITU-R BT.709, which are those of sRGB.
pub fn luminance(colour: [f32; 3]) -> f32 {
    colour.iter().zip(LUMINANCE).map(|(channel, weight)| channel * weight).sum()
}

/// Shares of red, green and blue in the luminance.
pub const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// What decides on the reflectance of a texel. All numbers are luminances or factors in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaterialTexel {
    /// Share of the metal.
    pub metalness: f32,
    /// F0 of the metal: the luminance of the base colour.
    pub metal_f0: f32,
    /// F0 of the dielectric, without the factor `specular`.
    pub dielectric_f0: f32,
    /// `specularFactor` times its texture, which multiplies F0 and F90 of the dielectric.
    pub specular: f32,
}

impl MaterialTexel {
    /// Returns the directional average of the reflectance, at least 0.001. Numbers outside of [0, 1] are clamped.
    #[inline(always)]
    pub fn reflectance(self) -> f32 {
        let [metalness, metal_f0, dielectric_f0, specular] =
            [self.metalness, self.metal_f0, self.dielectric_f0, self.specular].map(|number| number.clamp(0.0, 1.0));
        let dielectric = specular * averaged(dielectric_f0);
        (dielectric + metalness * (averaged(metal_f0) - dielectric)).max(LEAST_REFLECTANCE)
    }
}

/// Returns the directional average of Schlick's reflectance with F90 = 1.
#[inline(always)]
fn averaged(f0: f32) -> f32 {
    f0 + (1.0 - f0) * MEAN_SCHLICK
}

#[cfg(test)]
mod tests;

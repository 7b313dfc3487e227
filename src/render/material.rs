//! What a shader reads from a material's textures and makes of it: a normal and a lobe.

use super::sampler::Texture;
use crate::bump::{Offset, normal_from_offset};
use crate::lobe::Factor;
use crate::lobe::{Anisotropy, Roughness};
use crate::math::symmetric::Symmetric2;
use crate::math::vector::{Vector, normalised};

/// A texture whose texels stand for values: value = min + texel (max - min).
#[derive(Clone, Debug, PartialEq)]
pub struct Ranged {
    /// The texels.
    pub texture: Texture,
    /// Value of a texel of 0, channel by channel.
    pub min: [f64; 3],
    /// Value of a texel of 1.
    pub max: [f64; 3],
}

impl Ranged {
    fn value(&self, texel: [f64; 4]) -> [f64; 3] {
        [0, 1, 2].map(|c| self.min[c] + texel[c] * (self.max[c] - self.min[c]))
    }
}

/// Where the bumps are.
#[derive(Clone, Debug, PartialEq)]
pub enum Bumps {
    /// No map: flat.
    Flat,
    /// glTF's normal texture: x, y, z in [0, 1] with 1/2 for 0.
    Normals {
        /// The texels.
        texture: Texture,
        /// `normalTexture.scale`.
        scale: f64,
        /// Whether z is stored; else it is rebuilt from x and y after filtering.
        has_z: bool,
    },
    /// The pyramid profile's (f_u, f_v).
    Offsets(Ranged),
}

/// Where the roughness of the bumps that filtering removed is.
#[derive(Clone, Debug, PartialEq)]
pub enum LostBumps {
    /// Nowhere, or folded into the material's own roughness.
    RoughenedTextures,
    /// The pyramid profile's D, and the correction factor.
    Factor(Ranged, f64),
    /// The pyramid profile's lambda_1, and the correction factor.
    Lambda1(Ranged, f64),
}

/// `KHR_materials_anisotropy`.
#[derive(Clone, Debug, PartialEq)]
pub struct BaseAnisotropy {
    /// Direction in red and green, strength in blue; along (1, 0) with full strength when absent.
    pub texture: Option<Texture>,
    /// Multiplies the strength.
    pub strength: f64,
    /// Cosine and sine of the direction's rotation.
    pub rotation: [f64; 2],
}

/// A material as the renderer samples it.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Its bumps.
    pub bumps: Bumps,
    /// Roughness in green.
    pub roughness: Option<Texture>,
    /// Multiplies the roughness.
    pub roughness_factor: f64,
    /// Its own anisotropy.
    pub anisotropy: Option<BaseAnisotropy>,
    /// Bumps that filtering removed, where the shader adds them.
    pub lost: LostBumps,
}

/// What a shader knows of the surface under a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Unit normal in (T, B, N).
    pub normal: Vector,
    /// The lobe's squared alphas uu, uv, vv about that normal.
    pub squared_alpha: [f64; 3],
}

impl Material {
    /// The point that `read` makes of each texture: filtered, or a single texel.
    pub fn point(&self, read: &dyn Fn(&Texture) -> [f64; 4]) -> Point {
        let normal = match &self.bumps {
            Bumps::Flat => [0.0, 0.0, 1.0],
            Bumps::Normals { texture, scale, has_z } => {
                let [x, y, z] = decoded(read(texture));
                let z = if *has_z { z } else { (1.0 - x * x - y * y).max(0.0).sqrt() };
                normalised([x * scale, y * scale, z])
            }
            Bumps::Offsets(ranged) => {
                let [u, v, _] = ranged.value(read(&ranged.texture));
                normal_from_offset(Offset { u: u as f32, v: v as f32 }).map(f64::from)
            }
        };
        // A' = A + 2 c K, after filtering: D and lambda_1 are what the sampler averages (DESIGN section 3, "Lobes").
        let lost = match &self.lost {
            LostBumps::RoughenedTextures => Symmetric2::ZERO,
            LostBumps::Factor(ranged, c) => {
                let [d1, d2, d3] = ranged.value(read(&ranged.texture)).map(|d| d as f32);
                (2.0 * *c as f32) * Factor { d1, d2, d3 }.covariance()
            }
            LostBumps::Lambda1(ranged, c) => {
                let [lambda_1, ..] = ranged.value(read(&ranged.texture));
                let squared = (2.0 * c * lambda_1 * lambda_1) as f32;
                Symmetric2::diagonal(squared, squared)
            }
        };
        let a = self.base_lobe(read) + lost;
        Point { normal: normalised(normal), squared_alpha: [a.uu, a.uv, a.vv].map(f64::from) }
    }

    fn base_lobe(&self, read: &dyn Fn(&Texture) -> [f64; 4]) -> Symmetric2 {
        let roughness = self.roughness.as_ref().map_or(1.0, |t| read(t)[1]) * self.roughness_factor;
        let roughness = Roughness(roughness.clamp(0.0, 1.0) as f32);
        let (direction, strength) = match &self.anisotropy {
            None => ([1.0, 0.0], 0.0),
            Some(BaseAnisotropy { texture, strength, rotation: [cos, sin] }) => {
                // The texel that glTF defines for a material without an anisotropy texture.
                let texel = texture.as_ref().map_or([1.0, 0.5, 1.0, 1.0], read);
                let [x, y, _] = decoded(texel);
                let [x, y, _] = if x == 0.0 && y == 0.0 { [1.0, 0.0, 0.0] } else { normalised([x, y, 0.0]) };
                let direction = [x * cos - y * sin, x * sin + y * cos].map(|c| c as f32);
                (direction, (texel[2] * strength).clamp(0.0, 1.0) as f32)
            }
        };
        Anisotropy { roughness, strength, direction }.squared_alpha().0
    }
}

fn decoded(texel: [f64; 4]) -> Vector {
    [0, 1, 2].map(|c| 2.0 * texel[c] - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mip::Level;

    fn constant(texel: [f32; 4]) -> Texture {
        Texture::with_mips(Level { width: 1, height: 1, texels: vec![texel] })
    }

    fn ranged(texel: [f32; 4], min: [f64; 3], max: [f64; 3]) -> Ranged {
        Ranged { texture: constant(texel), min, max }
    }

    fn read(texture: &Texture) -> [f64; 4] {
        texture.nearest([0.5, 0.5])
    }

    /// Roughness 0.5 is alpha 0.25; D = [[0.2, 0.1], [0, 0.3]] is K = [[0.05, 0.03], [0.03, 0.09]].
    #[test]
    fn the_pyramid_profile_is_combined_with_range_and_correction() {
        let material = Material {
            bumps: Bumps::Offsets(ranged([0.75, 0.5, 0.0, 0.0], [-1.0, -1.0, 0.0], [1.0, 1.0, 1.0])),
            roughness: Some(constant([0.0, 0.5, 0.0, 0.0])),
            roughness_factor: 1.0,
            anisotropy: None,
            lost: LostBumps::Factor(ranged([0.5, 0.75, 0.75, 0.0], [0.0, -0.2, 0.0], [0.4, 0.2, 0.4]), 0.9),
        };
        let point = material.point(&read);
        let expected = normalised([-0.5, 0.0, 1.0]);
        let a = [0.0625 + 1.8 * 0.05, 1.8 * 0.03, 0.0625 + 1.8 * 0.09];
        for i in 0..3 {
            assert!((point.normal[i] - expected[i]).abs() < 1e-6, "{point:?}");
            assert!((point.squared_alpha[i] - a[i]).abs() < 1e-6, "{point:?}");
        }
        let lost = LostBumps::Lambda1(ranged([0.5, 0.0, 0.0, 0.0], [0.0; 3], [0.4; 3]), 0.9);
        let point = Material { lost, ..material }.point(&read);
        assert!((point.squared_alpha[0] - 0.0625 - 1.8 * 0.04).abs() < 1e-6);
        assert_eq!(point.squared_alpha[0], point.squared_alpha[2]);
    }

    #[test]
    fn gltf_textures_are_read_as_gltf_says() {
        // Strength sqrt(1/3) of alpha 0.25 makes 0.5 along the direction, which is turned by 90 degrees.
        let material = Material {
            bumps: Bumps::Normals { texture: constant([0.8, 0.5, 0.9, 1.0]), scale: 0.5, has_z: true },
            roughness: None,
            roughness_factor: 0.5,
            anisotropy: Some(BaseAnisotropy { texture: None, strength: (1f64 / 3.0).sqrt(), rotation: [0.0, 1.0] }),
            lost: LostBumps::RoughenedTextures,
        };
        let point = material.point(&read);
        assert!((point.normal[0] - 0.3 / (0.09f64 + 0.64).sqrt()).abs() < 1e-6, "{point:?}");
        assert!((point.squared_alpha[0] - 0.0625).abs() < 1e-6 && (point.squared_alpha[2] - 0.25).abs() < 1e-6);
    }
}

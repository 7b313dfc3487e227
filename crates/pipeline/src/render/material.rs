//! A material as a shader reads it: its textures give a normal and a lobe for each point.

use super::sampler::Texture;
use crate::bump::{Offset, normal_from_offset};
use crate::lobe::Factor;
use crate::lobe::{Anisotropy, Roughness};
use crate::material::slopes_of_texel;
use crate::math::symmetric::Symmetric2;
use crate::math::vector::{Vector, normalised};

/// A texture with a range: value = min + texel (max - min).
#[derive(Clone, Debug, PartialEq)]
pub struct RangedTexture {
    /// The texels.
    pub texture: Texture,
    /// Value of a texel of 0, channel by channel.
    pub min: [f64; 3],
    /// Value of a texel of 1.
    pub max: [f64; 3],
}

impl RangedTexture {
    fn value(&self, texel: [f64; 4]) -> [f64; 3] {
        [0, 1, 2].map(|c| self.min[c] + texel[c] * (self.max[c] - self.min[c]))
    }
}

/// The bumps of a material.
#[derive(Clone, Debug, PartialEq)]
pub enum Bumps {
    /// No map: the surface is flat.
    Flat,
    /// glTF's normal texture: x, y, z in [0, 1] with 1/2 for 0.
    Normals {
        /// The texels.
        texture: Texture,
        /// `normalTexture.scale`.
        scale: f64,
        /// Whether z is stored. If not, z is rebuilt from x and y after filtering.
        has_z: bool,
    },
    /// The pyramid profile's offsets, as unit normals of scaled offsets.
    Offsets {
        /// The texels.
        texture: Texture,
        /// What multiplies the slopes of the stored normals.
        scale: [f64; 2],
        /// Whether z is stored. If not, z is rebuilt from x and y after filtering.
        has_z: bool,
    },
}

/// The roughness of the bumps that filtering removed.
#[derive(Clone, Debug, PartialEq)]
pub enum LostBumps {
    /// The lost bumps are in the material's roughness, or nowhere.
    RoughenedTextures,
    /// The pyramid profile's D, and the correction factor.
    Factor(RangedTexture, f64),
    /// The pyramid profile's lambda_1, and the correction factor.
    Lambda1(RangedTexture, f64),
    /// The whole lobe, in place of roughness and anisotropy: squared alphas uu, uv, vv in red, green and blue.
    Lobes(Texture),
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
    /// The anisotropy of the base lobe.
    pub anisotropy: Option<BaseAnisotropy>,
    /// The lost bumps that the shader adds.
    pub lost: LostBumps,
}

/// Normal and lobe of the surface at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Unit normal in (T, B, N).
    pub normal: Vector,
    /// The lobe's squared alphas uu, uv, vv about that normal.
    pub squared_alpha: [f64; 3],
}

impl Material {
    /// Returns normal and lobe at a point. `read` samples a texture: filtered, or a single texel.
    pub fn point(&self, read: &impl Fn(&Texture) -> [f64; 4]) -> Point {
        let normal = match &self.bumps {
            Bumps::Flat => [0.0, 0.0, 1.0],
            Bumps::Normals { texture, scale, has_z } => {
                let [x, y, z] = decoded(with_z(read(texture), *has_z));
                normalised([x * scale, y * scale, z])
            }
            Bumps::Offsets { texture, scale, has_z } => {
                let [x, y, z, _] = with_z(read(texture), *has_z);
                let slopes = slopes_of_texel([x, y, z]);
                let [u, v] = [0, 1].map(|c| slopes[c] * scale[c]);
                normal_from_offset(Offset { u: u as f32, v: v as f32 }).map(f64::from)
            }
        };
        if let LostBumps::Lobes(texture) = &self.lost {
            let [uu, uv, vv, _] = read(texture);
            return Point { normal: normalised(normal), squared_alpha: [uu, uv, vv] };
        }
        // A' = A + 2 c K comes after filtering, since the sampler averages D and lambda_1.
        let lost = match &self.lost {
            LostBumps::RoughenedTextures | LostBumps::Lobes(_) => Symmetric2::ZERO,
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

    /// Returns the textures that a shader reads.
    pub fn textures(&self) -> impl Iterator<Item = &Texture> {
        let bumps = match &self.bumps {
            Bumps::Normals { texture, .. } | Bumps::Offsets { texture, .. } => Some(texture),
            Bumps::Flat => None,
        };
        let lost = match &self.lost {
            LostBumps::Factor(ranged, _) | LostBumps::Lambda1(ranged, _) => Some(&ranged.texture),
            LostBumps::Lobes(texture) => Some(texture),
            LostBumps::RoughenedTextures => None,
        };
        let anisotropy = self.anisotropy.as_ref().and_then(|a| a.texture.as_ref());
        [bumps, self.roughness.as_ref(), anisotropy, lost].into_iter().flatten()
    }

    /// Returns the columns and rows of a grid as fine as the finest texture.
    pub fn finest_size(&self) -> (u32, u32) {
        self.textures().map(|texture| texture.size(0)).fold((1, 1), |a, b| (a.0.max(b.0), a.1.max(b.1)))
    }

    fn base_lobe(&self, read: &impl Fn(&Texture) -> [f64; 4]) -> Symmetric2 {
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

/// Returns a texel of normals with the z that a reader rebuilds if there is none.
fn with_z([r, g, b, a]: [f64; 4], has_z: bool) -> [f64; 4] {
    let [x, y] = [r, g].map(|c| 2.0 * c - 1.0);
    let z = if has_z { b } else { 0.5 + 0.5 * (1.0 - x * x - y * y).max(0.0).sqrt() };
    [r, g, z, a]
}

fn decoded(texel: [f64; 4]) -> Vector {
    [0, 1, 2].map(|c| 2.0 * texel[c] - 1.0)
}

#[cfg(test)]
mod tests;

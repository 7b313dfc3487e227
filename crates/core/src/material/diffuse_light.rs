//! The share of a sun's diffuse light that bumps reflect, level by level: mips of the base colour are multiplied by it
//! under `--diffuse-light suns`.
//!
//! Under a sun in the direction l, a footprint of unit normals n_i reflects the mean of (n_i . l)+. Where no bump faces
//! away from the sun this is |mean n| times the cosine of the normalised mean normal, which engines shade with. A metal
//! has no diffuse light, and its base colour is its F0. The factor of a texel of metalness m is therefore
//! m + (1 - m) |mean n|, where m = sum(c m_i) / sum(c) counts by the luminance c of the base colour, as mips of
//! metalness do. The sum of F0 and albedo is then that of level 0 with its diffuse light times |mean n|.

use std::iter::repeat_n;

use crate::bump::{Offset, normal_from_offset};
use crate::image::Image;
use crate::material::bump_map::BumpMap;
use crate::material::reflectance::{Factored, Metalness, Number};
use crate::mip::{AreaResampled, MipTail, TexelRows, Wrap};

/// What decides on the diffuse light of a base lobe.
#[derive(Clone, Copy)]
pub struct DiffuseSource<'a> {
    /// The bumps.
    pub bump_map: &'a BumpMap,
    /// Multiplies their offsets.
    pub slope_scale: f32,
    /// Blue is metalness, if `metalness` is a texture.
    pub roughness: Option<&'a Image>,
    /// The metalness.
    pub metalness: Metalness,
    /// Base colour: sRGB in the texture, linear in the factor.
    pub base_colour: Factored<'a, [f32; 3]>,
}

/// Factors of the base colour of all levels.
pub struct DiffuseLight<'a> {
    level_0: Level0<'a>,
    tail: MipTail<Texel>,
}

/// A unit normal, metalness times luminance, and luminance.
type Texel = [f32; 5];

impl<'a> DiffuseLight<'a> {
    /// Puts `source` on a grid of `size` texels: normals as means over areas, textures as samplers magnify them.
    pub fn new(source: DiffuseSource<'a>, size: (u32, u32), wrap: [Wrap; 2]) -> Self {
        let DiffuseSource { bump_map, slope_scale, roughness, metalness, base_colour } = source;
        let level_0 = Level0 {
            normals: AreaResampled::new(UnitNormals { bump_map, slope_scale }, size.0, size.1),
            metalness: Number::of_metalness(metalness, roughness, size, wrap),
            luminance: Number::of_luminance(base_colour, 1.0, size, wrap),
        };
        Self { tail: MipTail::new(&level_0), level_0 }
    }

    /// Returns the factors of row `y` of `level`, in [0, 1]. Those of level 0 are 1, since engines magnify level 0 of
    /// the bumps with all its normals.
    pub fn row(&self, level: usize, y: u32) -> Vec<f32> {
        if level == 0 {
            return repeat_n(1.0, self.level_0.width() as usize).collect();
        }
        self.tail.with_row(&self.level_0, level, y, |row| row.iter().map(factor).collect())
    }
}

/// Returns m + (1 - m) |mean n|. A black texel is taken to be a metal, since its colour does not matter.
fn factor([x, y, z, product, luminance]: &Texel) -> f32 {
    let length = (x * x + y * y + z * z).sqrt().min(1.0);
    let metalness = if *luminance > 0.0 { (product / luminance).clamp(0.0, 1.0) } else { 1.0 };
    metalness + (1.0 - metalness) * length
}

/// Level 0.
struct Level0<'a> {
    normals: AreaResampled<UnitNormals<'a>>,
    metalness: Number<'a>,
    luminance: Number<'a>,
}

impl TexelRows for Level0<'_> {
    type Texel = Texel;

    fn width(&self) -> u32 {
        self.normals.width()
    }

    fn height(&self) -> u32 {
        self.normals.height()
    }

    fn row(&self, y: u32, out: &mut [Texel]) {
        let mut normals = vec![[0.0; 3]; out.len()];
        self.normals.row(y, &mut normals);
        let metalness = self.metalness.row(y, out.len());
        let luminance = self.luminance.row(y, out.len());
        for (((out, [x, y, z]), [metalness]), [luminance]) in out.iter_mut().zip(normals).zip(metalness).zip(luminance)
        {
            *out = [x, y, z, metalness * luminance, luminance];
        }
    }
}

/// The unit normals of a bump map.
struct UnitNormals<'a> {
    bump_map: &'a BumpMap,
    slope_scale: f32,
}

impl TexelRows for UnitNormals<'_> {
    type Texel = [f32; 3];

    fn width(&self) -> u32 {
        self.bump_map.width()
    }

    fn height(&self) -> u32 {
        self.bump_map.height()
    }

    fn row(&self, y: u32, out: &mut [[f32; 3]]) {
        let mut offsets = vec![[0.0; 2]; out.len()];
        self.bump_map.offsets(y, &mut offsets);
        for (out, [u, v]) in out.iter_mut().zip(offsets) {
            *out = normal_from_offset(Offset { u: self.slope_scale * u, v: self.slope_scale * v });
        }
    }
}

#[cfg(test)]
mod tests;

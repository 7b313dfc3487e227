//! Scores of decoded texels of baked levels, as an engine samples them.

use rayon::prelude::*;

use crate::image::Image;
use crate::lobe::{Anisotropy, Family, Roughness};
use crate::math::vector::{Vector, normalised};
use crate::metric::density::Lobe;
use crate::metric::footprint::{Footprint, Surface};
use crate::metric::reference::{Reference, SAMPLES, even_point};

/// One level of a material's textures, decoded from its files.
pub struct Decoded {
    /// x, y, z in [0, 1]. If there are two channels, z is rebuilt as engines do.
    pub normal: Image,
    /// Roughness in green. Without it, the roughness is the factor.
    pub roughness: Option<Image>,
    /// Factor of the roughness.
    pub roughness_factor: f32,
    /// Direction in red and green, strength in blue (`KHR_materials_anisotropy`). Without it, lobes are isotropic.
    pub anisotropy: Option<Image>,
}

impl Decoded {
    /// Returns the lobe of texel (`x`, `y`) as a glTF engine shades it, or `None` outside any of the images.
    pub fn lobe(&self, family: Family, x: u32, y: u32) -> Option<Lobe> {
        let texel = |image: &Image| Some([image.sample(x, y, 0)?, image.sample(x, y, 1)?, image.sample(x, y, 2)?]);
        let normal = match self.normal.channels {
            2 => with_z([self.normal.sample(x, y, 0)?, self.normal.sample(x, y, 1)?]),
            _ => texel(&self.normal)?,
        };
        let roughness = match &self.roughness {
            Some(image) => image.sample(x, y, 1)?,
            None => 1.0,
        };
        let anisotropy = match &self.anisotropy {
            Some(image) => Some(texel(image)?),
            None => None,
        };
        let a = shown_lobe(roughness * self.roughness_factor, anisotropy);
        Some(Lobe::new(family, shown_normal(normal, 1.0), a))
    }
}

/// Returns the normal that a glTF engine shades with, from a texel in [0, 1]. The engine multiplies x and y by `scale`.
pub fn shown_normal(texel: [f32; 3], scale: f32) -> Vector {
    let [x, y, z] = texel.map(|c| 2.0 * f64::from(c) - 1.0);
    normalised([x * f64::from(scale), y * f64::from(scale), z])
}

/// Returns the squared alphas uu, uv, vv that a glTF engine shades with, from a roughness and a texel of
/// `KHR_materials_anisotropy` in [0, 1].
pub fn shown_lobe(roughness: f32, anisotropy: Option<[f32; 3]>) -> [f64; 3] {
    let roughness = Roughness(roughness.clamp(0.0, 1.0));
    let lobe = match anisotropy {
        None => Anisotropy { roughness, strength: 0.0, direction: [1.0, 0.0] },
        Some([u, v, strength]) => {
            let [u, v, _] = normalised([2.0 * f64::from(u) - 1.0, 2.0 * f64::from(v) - 1.0, 0.0]);
            Anisotropy { roughness, strength, direction: [u as f32, v as f32] }
        }
    };
    let a = lobe.squared_alpha().0;
    [a.uu, a.uv, a.vv].map(f64::from)
}

/// Returns the texel with the z that engines rebuild from x and y.
pub fn with_z([x, y]: [f32; 2]) -> [f32; 3] {
    let [nx, ny] = [x, y].map(|c| 2.0 * f64::from(c) - 1.0);
    let nz = (1.0 - nx * nx - ny * ny).max(0.0).sqrt();
    [x, y, (0.5 * nz + 0.5) as f32]
}

/// Returns `count` texels spread evenly over a level of `size`, or all texels if there are no more. The choice depends
/// on nothing else.
pub fn sample_texels(size: (u32, u32), count: usize) -> Vec<(u32, u32)> {
    sample_rows(size, count, count)
}

/// Returns `count` texels spread evenly over at most `rows` rows of a level of `size`, or all texels if there are no
/// more.
pub(super) fn sample_rows((width, height): (u32, u32), count: usize, rows: usize) -> Vec<(u32, u32)> {
    if u64::from(width) * u64::from(height) <= count as u64 {
        return (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).collect();
    }
    let at = |share: f64, size: u32| (share * f64::from(size)) as u32;
    let of_row = count.div_ceil(rows.max(1)).max(1);
    let texel = |i| (at(even_point(i)[0], width), at(even_point(i / of_row)[1], height));
    (0..count).map(texel).collect()
}

/// Returns mean lobe errors over `texels` of a level of `size` texels. `errors` returns `N` errors of one texel. The
/// sum is in the order of the texels, so it does not depend on threads.
pub fn mean_errors<const N: usize>(
    surface: &Surface,
    family: Family,
    size: (u32, u32),
    texels: &[(u32, u32)],
    errors: impl Fn((u32, u32), &Footprint, &Reference) -> [f64; N] + Sync,
) -> [f64; N] {
    let each: Vec<[f64; N]> = texels
        .par_iter()
        .map(|&texel| {
            let footprint = surface.footprint(size, texel);
            let reference = Reference::new(family, &footprint, SAMPLES);
            errors(texel, &footprint, &reference)
        })
        .collect();
    let mut means = [0.0; N];
    for errors in &each {
        for (mean, error) in means.iter_mut().zip(errors) {
            *mean += error / each.len() as f64;
        }
    }
    means
}

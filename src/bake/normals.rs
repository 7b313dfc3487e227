//! Normal mips: at every level the unit normals of where the texels point.

use rayon::prelude::*;

use super::bumps::Bumps;
use super::chain::{Chain, Encoding, encode_chain};
use super::lobes::Lobes;
use super::relief::Relief;
use crate::bump::{Offset, normal_from_offset};
use crate::pyramid::{Area, Level, Moments, Rows, build};
use crate::texture::EncodeError;

/// Where the texels of a normal texture point, level by level.
pub struct Normals<'a> {
    finest: Area<&'a Relief>,
    /// Offsets (f_u, f_v).
    coarser: Vec<Level<[f32; 2]>>,
}

/// Offsets without their covariances, which are 3/5 of the memory of moments.
struct Means<R>(R);

impl<R: Rows<Texel = Moments>> Rows for Means<R> {
    type Texel = [f32; 2];

    fn width(&self) -> u32 {
        self.0.width()
    }

    fn height(&self) -> u32 {
        self.0.height()
    }

    fn row(&self, y: u32, out: &mut [[f32; 2]]) {
        let mut moments = vec![Moments::default(); out.len()];
        self.0.row(y, &mut moments);
        out.iter_mut().zip(moments).for_each(|(mean, m)| *mean = [m.mean.u, m.mean.v]);
    }
}

impl<'a> Normals<'a> {
    /// Texels of `bumps` point where `lobes` on the same grid do, or without them where their mean slope does.
    pub fn new(bumps: &Bumps<'a>, lobes: Option<&Lobes<'_>>) -> Self {
        let Some(lobes) = lobes else {
            return Self { finest: bumps.rows, coarser: build(&Means(bumps.rows)) };
        };
        let level = |(level, &(width, height)): (usize, &(u32, u32))| {
            let mut texels = vec![[0.0; 2]; width as usize * height as usize];
            texels.par_chunks_exact_mut(width as usize).enumerate().for_each(|(y, row)| {
                lobes.offsets(level, y as u32, row);
            });
            Level { width, height, texels }
        };
        let coarser = bumps.sizes().iter().enumerate().skip(1).map(level).collect();
        Self { finest: bumps.rows, coarser }
    }

    /// Sizes of all levels, level 0 first.
    pub fn sizes(&self) -> Vec<(u32, u32)> {
        let finest = (self.finest.width(), self.finest.height());
        [finest].into_iter().chain(self.coarser.iter().map(|l| (l.width, l.height))).collect()
    }

    /// The normal texture: x, y, z in [0, 1] with 1/2 for 0. Unit length at every level, since engines that rebuild z and
    /// engines that read it must agree.
    pub fn row(&self, level: usize, y: u32, out: &mut [[f32; 4]]) {
        let write = |(value, offset): (&mut [f32; 4], Offset)| {
            let [x, y, z] = normal_from_offset(offset);
            *value = [0.5 * x + 0.5, 0.5 * y + 0.5, 0.5 * z + 0.5, 1.0];
        };
        match level.checked_sub(1) {
            None => {
                let mut texels = vec![Moments::default(); out.len()];
                self.finest.row(y, &mut texels);
                out.iter_mut().zip(texels.iter().map(|m| m.mean)).for_each(write);
            }
            Some(coarser) => {
                let Level { width, texels, .. } = &self.coarser[coarser];
                let offsets = texels[y as usize * *width as usize..].iter().map(|&[u, v]| Offset { u, v });
                out.iter_mut().zip(offsets).for_each(write);
            }
        }
    }

    /// The texture, encoded.
    pub fn bake(&self, encoding: Encoding) -> Result<Chain, EncodeError> {
        encode_chain(&self.sizes(), encoding, &|level, y, out| self.row(level, y, out))
    }
}

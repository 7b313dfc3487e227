//! Normal mips: at every level the unit normals of where the texels point.

use std::iter::repeat;

use rayon::prelude::*;

use crate::bump::{Moments, Offset, normal_from_offset};
use crate::codec::EncodeError;
use crate::material::bump_map::BumpMap;
use crate::material::bumps::Bumps;
use crate::material::lobes::Lobes;
use crate::material::mip_chain::{Encoding, MipChain, encode_mip_chain};
use crate::mip::{Area, Level, MipTail, Rows, level_sizes};
use crate::simd::map_row;

/// Where the texels of a normal texture point, level by level.
pub struct Normals<'a> {
    finest: Area<&'a BumpMap>,
    tail: Offsets<'a>,
}

/// Offsets (f_u, f_v) of levels 1 and coarser.
enum Offsets<'a> {
    /// Where lobes point.
    Lobes(&'a Lobes<'a>),
    /// Where lobes pointed, or the mean slopes.
    MipTail(MipTail<[f32; 2]>),
}

/// Offsets without their covariances, which are 3/5 of the memory of moments.
struct Means<'a>(Area<&'a BumpMap>);

impl Rows for Means<'_> {
    type Texel = [f32; 2];

    fn width(&self) -> u32 {
        self.0.width()
    }

    fn height(&self) -> u32 {
        self.0.height()
    }

    fn row(&self, y: u32, out: &mut [[f32; 2]]) {
        if let Some(bump_map) = self.0.unchanged() {
            return bump_map.offsets(y, out);
        }
        let mut moments = vec![Moments::default(); out.len()];
        self.0.row(y, &mut moments);
        out.iter_mut().zip(moments).for_each(|(mean, m)| *mean = [m.mean.u, m.mean.v]);
    }
}

impl<'a> Normals<'a> {
    /// Texels of `bumps` point where their mean slope does.
    pub fn of_means(bumps: &Bumps<'a>) -> Self {
        Self { finest: bumps.rows, tail: Offsets::MipTail(MipTail::new(&Means(bumps.rows))) }
    }

    /// They point where `lobes` on the same grid do.
    pub fn of_lobes<'b: 'a>(bumps: &Bumps<'b>, lobes: &'a Lobes<'a>) -> Self {
        Self { finest: bumps.rows, tail: Offsets::Lobes(lobes) }
    }

    /// The same when `lobes` are gone.
    pub fn kept(bumps: &Bumps<'a>, lobes: &Lobes<'_>) -> Self {
        let level = |(level, &(width, height)): (usize, &(u32, u32))| {
            let mut texels = vec![[0.0; 2]; width as usize * height as usize];
            texels.par_chunks_exact_mut(width as usize).enumerate().for_each(|(y, row)| {
                lobes.offsets(level, y as u32, row);
            });
            Level { width, height, texels }
        };
        let levels: Vec<_> = bumps.sizes().iter().enumerate().skip(1).map(level).collect();
        Self { finest: bumps.rows, tail: Offsets::MipTail(levels.into()) }
    }

    /// Sizes of all levels, level 0 first.
    pub fn sizes(&self) -> Vec<(u32, u32)> {
        level_sizes(self.finest.width(), self.finest.height())
    }

    /// The normal texture: x, y, z in [0, 1] with 1/2 for 0. Unit length at every level, since engines that rebuild z and
    /// engines that read it must agree.
    pub fn row(&self, level: usize, y: u32, out: &mut [[f32; 4]]) {
        let texel = |offset: Offset| {
            let [x, y, z] = normal_from_offset(offset);
            [0.5 * x + 0.5, 0.5 * y + 0.5, 0.5 * z + 0.5]
        };
        let store = |value: &mut [f32; 4], [x, y, z]: [f32; 3]| *value = [x, y, z, 1.0];
        if let Some(bump_map) = self.finest.unchanged().filter(|_| level == 0) {
            return bump_map.map_offsets(y, repeat(0.0), out, |offset, _| texel(offset), store);
        }
        let mut offsets = vec![[0.0; 2]; out.len()];
        match &self.tail {
            Offsets::Lobes(lobes) if level > 0 => lobes.offsets(level, y, &mut offsets),
            Offsets::Lobes(_) => Means(self.finest).row(y, &mut offsets),
            Offsets::MipTail(means) => means.row(&Means(self.finest), level, y, &mut offsets),
        }
        map_row(offsets.into_iter(), out, |[u, v]| texel(Offset { u, v }), store);
    }

    /// The texture, encoded.
    pub fn bake(&self, encoding: Encoding) -> Result<MipChain, EncodeError> {
        encode_mip_chain(&self.sizes(), encoding, &|level, y, out| self.row(level, y, out))
    }
}

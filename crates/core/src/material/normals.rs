//! The normal texture: at every level the unit normals of the texels' directions.

use std::iter::repeat;

use rayon::prelude::*;

use crate::bump::{Moments, Offset, normal_from_offset};
use crate::codec::uastc::Lobe;
use crate::lobe::SquaredAlpha;
use crate::material::bump_map::BumpMap;
use crate::material::bumps::Bumps;
use crate::material::lobes::Lobes;
use crate::material::product::Product;
use crate::mip::{AreaResampled, Level, MipTail, TexelRows, level_sizes};
use crate::simd::map_row;

/// The normals of all texels of all levels.
pub struct Normals<'a> {
    level_0: AreaResampled<&'a BumpMap>,
    tail: Tail<'a>,
    /// The lobes about the normals, by which blocks of normals are chosen.
    lobes: Option<&'a Lobes<'a>>,
    /// Divides the slopes that the texture holds. The document's scale multiplies them.
    scale: f32,
}

/// Offsets (f_u, f_v) of levels 1 and coarser.
enum Tail<'a> {
    /// Directions of lobes, which are read when they are needed.
    Lobes(&'a Lobes<'a>),
    /// Offsets in memory: directions of lobes, or mean slopes.
    Offsets(MipTail<[f32; 2]>),
}

/// Mean offsets without their covariances, which are 3/5 of the memory of moments.
struct Means<'a>(AreaResampled<&'a BumpMap>);

impl TexelRows for Means<'_> {
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
    /// Takes the mean slopes of `bumps`.
    pub fn of_means(bumps: &Bumps<'a>) -> Self {
        Self { level_0: bumps.rows, tail: Tail::Offsets(MipTail::new(&Means(bumps.rows))), lobes: None, scale: 1.0 }
    }

    /// Takes the directions of `lobes`, which are on the grid of `bumps`. Blocks are chosen by the errors of `lobes`.
    pub fn of_lobes<'b: 'a>(bumps: &Bumps<'b>, lobes: &'a Lobes<'a>) -> Self {
        Self { level_0: bumps.rows, tail: Tail::Lobes(lobes), lobes: Some(lobes), scale: 1.0 }
    }

    /// Lets blocks be chosen by direction, for normals that lobes of other layers share.
    pub fn by_direction(self) -> Self {
        Self { lobes: None, ..self }
    }

    /// Divides the slopes that the texture holds by `scale`.
    pub fn with_scale(self, scale: f32) -> Self {
        Self { scale, ..self }
    }

    /// Returns what multiplies the slopes of the texture.
    pub fn scale(&self) -> f32 {
        self.scale
    }

    /// Copies the directions of `lobes`, so that the lobes need not stay in memory.
    pub fn copied_from_lobes(bumps: &Bumps<'a>, lobes: &Lobes<'_>) -> Self {
        let level = |(level, &(width, height)): (usize, &(u32, u32))| {
            let mut texels = vec![[0.0; 2]; width as usize * height as usize];
            texels.par_chunks_exact_mut(width as usize).enumerate().for_each(|(y, row)| {
                lobes.offsets(level, y as u32, row);
            });
            Level { width, height, texels }
        };
        let levels: Vec<_> = bumps.sizes().iter().enumerate().skip(1).map(level).collect();
        Self { level_0: bumps.rows, tail: Tail::Offsets(levels.into()), lobes: None, scale: 1.0 }
    }
}

/// Texels are x, y, z in [0, 1], with 1/2 for 0. Normals have unit length at every level, since engines that rebuild z
/// and engines that read z must agree.
impl Product for Normals<'_> {
    fn sizes(&self) -> Vec<(u32, u32)> {
        level_sizes(self.level_0.width(), self.level_0.height())
    }

    fn row(&self, level: usize, y: u32, out: &mut [[f32; 4]]) {
        let inverse = 1.0 / self.scale;
        let texel = |Offset { u, v }: Offset| {
            let [x, y, z] = normal_from_offset(Offset { u: inverse * u, v: inverse * v });
            [0.5 * x + 0.5, 0.5 * y + 0.5, 0.5 * z + 0.5]
        };
        let store = |value: &mut [f32; 4], [x, y, z]: [f32; 3]| *value = [x, y, z, 1.0];
        if let Some(bump_map) = self.level_0.unchanged().filter(|_| level == 0) {
            return bump_map.map_offsets(y, repeat(0.0), out, |offset, _| texel(offset), store);
        }
        let mut offsets = vec![[0.0; 2]; out.len()];
        match &self.tail {
            Tail::Lobes(lobes) if level > 0 => lobes.offsets(level, y, &mut offsets),
            Tail::Lobes(_) => Means(self.level_0).row(y, &mut offsets),
            Tail::Offsets(tail) => tail.row(&Means(self.level_0), level, y, &mut offsets),
        }
        map_row(offsets.into_iter(), out, |[u, v]| texel(Offset { u, v }), store);
    }

    fn has_lobes(&self) -> bool {
        self.lobes.is_some()
    }

    fn lobe_row(&self, level: usize, y: u32, out: &mut [Lobe]) {
        let Some(lobes) = self.lobes else { return };
        let mut squared_alphas = vec![SquaredAlpha::default(); out.len()];
        lobes.squared_alphas(level, y, &mut squared_alphas);
        // Texels hold slopes that the scale of the document multiplies.
        let scale = lobes.slope_scale() * self.scale;
        let scale = 1.0 / (scale * scale);
        for (lobe, SquaredAlpha(a)) in out.iter_mut().zip(squared_alphas) {
            *lobe = Lobe { uu: scale * a.uu, uv: scale * a.uv, vv: scale * a.vv };
        }
    }
}

//! Texture filtering as in hardware: level of detail from the pixel's footprint, trilinear and anisotropic.
//!
//! Vulkan 1.3 specification, section 16.5.9 "Texel Anisotropic Filtering" and the scale factor and level-of-detail
//! operations that it builds on.

use crate::mip::{Level, build};

/// A texel: four channels.
pub type Texel = [f32; 4];

/// Maximum number of taps along the footprint's longer side, as in hardware.
const MAX_ANISOTROPY: f64 = 16.0;

/// Change of the texture coordinates from one pixel to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Footprint {
    /// To the pixel on the right.
    pub across: [f64; 2],
    /// To the pixel below.
    pub down: [f64; 2],
}

/// How texels are averaged over a footprint.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, clap::ValueEnum)]
pub enum Filter {
    /// One tap in the level whose texels are as large as the footprint's longer side.
    #[value(help = "One tap in the level that fits the longer side of a pixel's footprint")]
    Trilinear,
    /// Up to 16 taps along the footprint, in the level whose texels are as large as the distance of the taps.
    #[default]
    #[value(help = "Up to 16 taps along it")]
    Anisotropic,
}

/// A repeating texture with all its levels.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    levels: Vec<Level<Texel>>,
}

impl Texture {
    /// Makes a texture from level 0 and the levels of the `mip_tail`, each of at least one texel.
    pub fn new(level_0: Level<Texel>, mip_tail: Vec<Level<Texel>>) -> Self {
        let mut levels = vec![level_0];
        levels.extend(mip_tail);
        Self { levels }
    }

    /// Makes a texture with a box-filtered mip tail, as engines do for images without mips.
    pub fn with_mips(level_0: Level<Texel>) -> Self {
        let mip_tail = build(&level_0);
        Self::new(level_0, mip_tail)
    }

    /// Returns the number of levels.
    pub fn level_count(&self) -> usize {
        self.levels.len()
    }

    /// Returns the texel of level 0 at `uv`.
    pub fn nearest(&self, uv: [f64; 2]) -> [f64; 4] {
        let level = &self.levels[0];
        let [x, y] = texel_of(uv, (level.width, level.height));
        level.texels[y * level.width as usize + x].map(f64::from)
    }

    /// Returns columns and rows of `level`. Levels beyond the last have the size of the last.
    pub fn size(&self, level: usize) -> (u32, u32) {
        let level = &self.levels[level.min(self.levels.len() - 1)];
        (level.width, level.height)
    }

    /// Returns the value at `uv`, interpolated from the finest level that is no larger than the given size. At the
    /// centre of a texel of a level of this size, it is this texel.
    pub fn linear_of_size(&self, (width, height): (u32, u32), uv: [f64; 2]) -> [f64; 4] {
        let fits = |l: &&Level<Texel>| l.width <= width && l.height <= height;
        let level = self.levels.iter().find(fits).unwrap_or(&self.levels[self.levels.len() - 1]);
        bilinear(level, uv)
    }

    /// Returns the mean over `footprint` about `uv`.
    pub fn sample(&self, uv: [f64; 2], footprint: &Footprint, filter: Filter) -> [f64; 4] {
        let Taps { count, step, level } = self.taps(footprint, filter);
        let mut sum = [0.0; 4];
        for tap in 0..count {
            let t = f64::from(tap + 1) / f64::from(count + 1) - 0.5;
            let point = [uv[0] + t * step[0], uv[1] + t * step[1]];
            for (sum, value) in sum.iter_mut().zip(self.trilinear(point, level)) {
                *sum += value / f64::from(count);
            }
        }
        sum
    }

    fn taps(&self, footprint: &Footprint, filter: Filter) -> Taps {
        let (width, height) = (f64::from(self.levels[0].width), f64::from(self.levels[0].height));
        let in_texels = |[u, v]: [f64; 2]| ((u * width) * (u * width) + (v * height) * (v * height)).sqrt();
        let (across, down) = (in_texels(footprint.across), in_texels(footprint.down));
        let (long, short, step) =
            if across >= down { (across, down, footprint.across) } else { (down, across, footprint.down) };
        let count = match filter {
            Filter::Trilinear => 1.0,
            Filter::Anisotropic => (long / short.max(1e-12)).ceil().clamp(1.0, MAX_ANISOTROPY),
        };
        let level = libm::log2((long / count).max(1e-12)).clamp(0.0, (self.levels.len() - 1) as f64);
        Taps { count: count as u32, step, level }
    }

    fn trilinear(&self, uv: [f64; 2], level: f64) -> [f64; 4] {
        let (fine, share) = (level.floor() as usize, level - level.floor());
        let fine_value = bilinear(&self.levels[fine], uv);
        match self.levels.get(fine + 1) {
            Some(coarse) if share > 0.0 => {
                let coarse_value = bilinear(coarse, uv);
                [0, 1, 2, 3].map(|c| fine_value[c] + share * (coarse_value[c] - fine_value[c]))
            }
            _ => fine_value,
        }
    }
}

struct Taps {
    count: u32,
    step: [f64; 2],
    level: f64,
}

fn texel(level: &Level<Texel>, x: f64, y: f64) -> Texel {
    level.texels[wrapped(y, level.height) * level.width as usize + wrapped(x, level.width)]
}

/// Returns the column and the row of the texel at `uv` of a repeating level of `size` texels.
pub(super) fn texel_of(uv: [f64; 2], (width, height): (u32, u32)) -> [usize; 2] {
    let texel = |at: f64, size: u32| {
        // The tool is compiled for processors that have no instruction for `floor`, so that `floor` is a slow call.
        let turns = at as i64 as f64;
        let share = at - turns + if at < turns { 1.0 } else { 0.0 };
        ((share * f64::from(size)) as usize).min(size as usize - 1)
    };
    [texel(uv[0], width), texel(uv[1], height)]
}

/// Returns the index of the integer `at` on an axis of `size` texels that repeats. `rem_euclid` of floats would be a
/// call of `fmod`, which divides bit by bit.
fn wrapped(at: f64, size: u32) -> usize {
    let length = f64::from(size);
    (at - (at / length).floor() * length).clamp(0.0, length - 1.0) as usize
}

fn bilinear(level: &Level<Texel>, uv: [f64; 2]) -> [f64; 4] {
    let (x, y) = (uv[0] * f64::from(level.width) - 0.5, uv[1] * f64::from(level.height) - 0.5);
    let (left, top) = (x.floor(), y.floor());
    let (right_share, lower_share) = (x - left, y - top);
    let mut sum = [0.0; 4];
    for (dx, dy, weight) in [
        (0.0, 0.0, (1.0 - right_share) * (1.0 - lower_share)),
        (1.0, 0.0, right_share * (1.0 - lower_share)),
        (0.0, 1.0, (1.0 - right_share) * lower_share),
        (1.0, 1.0, right_share * lower_share),
    ] {
        for (sum, value) in sum.iter_mut().zip(texel(level, left + dx, top + dy)) {
            *sum += weight * f64::from(value);
        }
    }
    sum
}

#[cfg(test)]
mod tests;

//! Texture filtering as hardware does it: level of detail from the pixel's footprint, trilinear and anisotropic.
//!
//! Vulkan 1.3 specification, section 16.5.9 "Texel Anisotropic Filtering" and the scale factor and level-of-detail
//! operations that it builds on.

use crate::mip::{Level, build};

/// A texel: four channels.
pub type Texel = [f32; 4];

/// Most taps along the footprint's longer side: what hardware offers.
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Filter {
    /// One tap in the level whose texels are as large as the footprint is long.
    Trilinear,
    /// Up to 16 taps along the footprint, in the level whose texels are as large as their distance.
    #[default]
    Anisotropic,
}

/// A texture that repeats, with all its levels.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    levels: Vec<Level<Texel>>,
}

impl Texture {
    /// A texture with level 0 and the `coarser` ones, each of at least one texel.
    pub fn new(first: Level<Texel>, coarser: Vec<Level<Texel>>) -> Self {
        let mut levels = vec![first];
        levels.extend(coarser);
        Self { levels }
    }

    /// A texture whose coarser levels are box-filtered, as engines make them for images without any.
    pub fn with_mips(level: Level<Texel>) -> Self {
        let coarser = build(&level);
        Self::new(level, coarser)
    }

    /// Number of levels.
    pub fn level_count(&self) -> usize {
        self.levels.len()
    }

    /// The texel of level 0 at `uv`.
    pub fn nearest(&self, uv: [f64; 2]) -> [f64; 4] {
        let level = &self.levels[0];
        let place = [uv[0] * f64::from(level.width), uv[1] * f64::from(level.height)];
        texel(level, place[0].floor(), place[1].floor()).map(f64::from)
    }

    /// Columns and rows of `level`, from which on all levels have those of the last.
    pub fn size(&self, level: usize) -> (u32, u32) {
        let level = &self.levels[level.min(self.levels.len() - 1)];
        (level.width, level.height)
    }

    /// The texel at `uv` of the finest level that is no larger than `size`.
    pub fn nearest_of_size(&self, (width, height): (u32, u32), uv: [f64; 2]) -> [f64; 4] {
        let fits = |l: &&Level<Texel>| l.width <= width && l.height <= height;
        let level = self.levels.iter().find(fits).unwrap_or(&self.levels[self.levels.len() - 1]);
        let place = [uv[0] * f64::from(level.width), uv[1] * f64::from(level.height)];
        texel(level, place[0].floor(), place[1].floor()).map(f64::from)
    }

    /// The mean over `footprint` about `uv`.
    pub fn sample(&self, uv: [f64; 2], footprint: &Footprint, filter: Filter) -> [f64; 4] {
        let Taps { count, step, level } = self.taps(footprint, filter);
        let mut sum = [0.0; 4];
        for tap in 0..count {
            let t = f64::from(tap + 1) / f64::from(count + 1) - 0.5;
            let place = [uv[0] + t * step[0], uv[1] + t * step[1]];
            for (sum, value) in sum.iter_mut().zip(self.trilinear(place, level)) {
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
    let wrapped = |at: f64, size: u32| (at.rem_euclid(f64::from(size)) as u32).min(size - 1) as usize;
    level.texels[wrapped(y, level.height) * level.width as usize + wrapped(x, level.width)]
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
mod tests {
    use super::*;

    /// 64 x 64 texels; red is a ramp from left to right in texels, green one from top to bottom.
    fn ramp() -> Texture {
        let texel = |i: u32| [(i % 64) as f32 + 0.5, (i / 64) as f32 + 0.5, 0.0, 1.0];
        Texture::with_mips(Level { width: 64, height: 64, texels: (0..64 * 64).map(texel).collect() })
    }

    /// Linear interpolation of a linear ramp, and of its box mips, is the ramp.
    #[test]
    fn a_ramp_stays_a_ramp() {
        let texture = ramp();
        for filter in [Filter::Trilinear, Filter::Anisotropic] {
            for (across, down) in [(0.1, 0.1), (3.0, 1.0), (1.0, 7.3), (4.0, 4.0)] {
                let footprint = Footprint { across: [across / 64.0, 0.0], down: [0.0, down / 64.0] };
                for uv in [[0.5, 0.5], [0.37, 0.61], [0.44, 0.5]] {
                    let found = texture.sample(uv, &footprint, filter);
                    assert!((found[0] - 64.0 * uv[0]).abs() < 1e-4, "{filter:?} {found:?}");
                    assert!((found[1] - 64.0 * uv[1]).abs() < 1e-4, "{filter:?} {found:?}");
                }
            }
        }
    }

    #[test]
    fn levels_of_known_footprints() {
        let texture = ramp();
        let of = |across: [f64; 2], down: [f64; 2], filter| {
            let taps = texture.taps(&Footprint { across, down }, filter);
            (taps.count, taps.level)
        };
        let texel = 1.0 / 64.0;
        assert_eq!(of([4.0 * texel, 0.0], [0.0, 4.0 * texel], Filter::Trilinear), (1, 2.0));
        assert_eq!(of([texel, 0.0], [0.0, 8.0 * texel], Filter::Trilinear), (1, 3.0));
        assert_eq!(of([texel, 0.0], [0.0, 8.0 * texel], Filter::Anisotropic), (8, 0.0));
        assert_eq!(of([2.0 * texel, 0.0], [0.0, 16.0 * texel], Filter::Anisotropic), (8, 1.0));
        // Beyond 16 taps the level gives way; beyond the last level and before the first nothing does.
        assert_eq!(of([0.0, 0.0], [0.0, 32.0 * texel], Filter::Anisotropic), (16, 1.0));
        assert_eq!(of([100.0, 0.0], [0.0, 100.0], Filter::Anisotropic), (1, 6.0));
        assert_eq!(of([0.0; 2], [0.0; 2], Filter::Anisotropic), (1, 0.0));
    }

    /// A footprint 1 texel by 8 over stripes one texel wide across it: anisotropic filtering keeps what lies beside, and
    /// averages what lies under it.
    #[test]
    fn anisotropic_taps_average_along_the_footprint_only() {
        let stripes = |horizontal: bool| {
            let value = |i: u32| if horizontal { (i / 64 % 2) as f32 } else { (i % 2) as f32 };
            let texels = (0..64 * 64).map(|i| [value(i); 4]).collect();
            Texture::with_mips(Level { width: 64, height: 64, texels })
        };
        let footprint = Footprint { across: [1.0 / 64.0, 0.0], down: [0.0, 8.0 / 64.0] };
        let uv = [9.5 / 64.0, 0.5];
        let under = stripes(true).sample(uv, &footprint, Filter::Anisotropic)[0];
        assert!((under - 0.5).abs() < 0.07, "{under}");
        assert_eq!(stripes(false).sample(uv, &footprint, Filter::Anisotropic)[0], 1.0);
        assert_eq!(stripes(false).sample(uv, &footprint, Filter::Trilinear)[0], 0.5);
    }

    #[test]
    fn textures_repeat() {
        let texture = ramp();
        let footprint = Footprint::default();
        let here = texture.sample([0.3, 0.8], &footprint, Filter::Trilinear);
        let there = texture.sample([5.3, -3.2], &footprint, Filter::Trilinear);
        for (a, b) in here.iter().zip(there) {
            assert!((a - b).abs() < 1e-6);
        }
        assert_eq!(texture.nearest([-1e-18, 1.0])[..2], [63.5, 0.5]);
    }
}

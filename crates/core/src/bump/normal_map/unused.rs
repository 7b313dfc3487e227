//! Texels of a normal map that hold no normal: the black parts of an atlas, which no triangle shows.

use std::ops::Range;

use rayon::prelude::*;

/// Every component of a black texel is below this number. A unit vector has no two such components. JPEG changes black
/// by a few of 255 steps, and this number is 12 of them away from -1.
const BLACK: f32 = -0.9;

/// Returns whether the components x, y and, if it is stored, z are black.
#[inline(always)]
fn is_black(components: impl Iterator<Item = f32>) -> bool {
    components.fold(true, |all, component| all & (component < BLACK))
}

/// Returns whether z, which is rebuilt if it is not stored, is not above the surface. Black is not, and edges of black
/// parts often are not, because they are blends of black and a normal.
fn is_below([x, y, z]: [f64; 3], has_z: bool) -> bool {
    if has_z { z <= 0.0 } else { x * x + y * y >= 1.0 }
}

/// Gives each unused texel the mean normal of the used texels in the finest mip texel around it that has any, so that
/// mips have the bumps of used texels. Returns how many texels got a normal: none if no texel is used.
///
/// A texel is unused if it is black. In a map with black texels it is also unused if it points along the surface or
/// below it.
///
/// The map has `width` columns of `channels` samples. The first samples of a texel are x, y and, if `has_z` is set, z.
/// `decode` returns the component of a sample, and `encode` the sample of a component.
pub fn fill<T: Copy + Sync>(
    samples: &mut [T],
    width: usize,
    channels: usize,
    has_z: bool,
    decode: impl Fn(T) -> f32 + Sync,
    encode: impl Fn(f32) -> T,
) -> u64 {
    let components = if has_z { 3 } else { 2 };
    // Most maps have no black texel, and need no more than this.
    let has_black = |row: &[T]| {
        let texels = row.chunks_exact(channels).map(|texel| is_black(texel[..components].iter().map(|v| decode(*v))));
        texels.fold(false, |any, is_black| any | is_black)
    };
    if !samples.par_chunks_exact(width * channels).any(has_black) {
        return 0;
    }
    let height = samples.len() / (width * channels);
    let mut filler = Filler { samples, width, channels, components, decode, encode };
    let used = filler.fill(0..width, 0..height).count;
    if used == 0 { 0 } else { (width * height) as u64 - used }
}

/// A normal map whose unused texels get normals.
struct Filler<'a, T, D, E> {
    samples: &'a mut [T],
    width: usize,
    channels: usize,
    /// 3 if z is stored, else 2.
    components: usize,
    decode: D,
    encode: E,
}

/// The sum of the used normals of a rectangle.
#[derive(Clone, Copy, Default)]
struct Sum {
    total: [f64; 3],
    count: u64,
}

impl<T: Copy, D: Fn(T) -> f32, E: Fn(f32) -> T> Filler<'_, T, D, E> {
    /// Fills unused texels of a rectangle, if it has used ones, and returns the sum of these.
    fn fill(&mut self, columns: Range<usize>, rows: Range<usize>) -> Sum {
        if columns.is_empty() || rows.is_empty() {
            return Sum::default();
        }
        if columns.len() == 1 && rows.len() == 1 {
            return self.texel(columns.start, rows.start);
        }
        let edge = edge(columns.len().max(rows.len()));
        let [left, right] = split(columns, edge);
        let [above, below] = split(rows, edge);
        let quarters = [(&left, &above), (&right, &above), (&left, &below), (&right, &below)];
        let sums = quarters.map(|(columns, rows)| self.fill(columns.clone(), rows.clone()));
        let mut sum = Sum::default();
        for quarter in &sums {
            sum.total.iter_mut().zip(quarter.total).for_each(|(total, part)| *total += part);
            sum.count += quarter.count;
        }
        if sum.count > 0 {
            let mean = sum.total.map(|total| (total / sum.count as f64) as f32);
            for ((columns, rows), _) in quarters.into_iter().zip(&sums).filter(|(_, quarter)| quarter.count == 0) {
                self.write(columns, rows, mean);
            }
        }
        sum
    }

    fn texel(&self, x: usize, y: usize) -> Sum {
        let first = (y * self.width + x) * self.channels;
        let samples = &self.samples[first..first + self.components];
        let mut sum = Sum { total: [0.0; 3], count: 1 };
        sum.total.iter_mut().zip(samples).for_each(|(total, sample)| *total = f64::from((self.decode)(*sample)));
        if is_below(sum.total, self.components == 3) { Sum::default() } else { sum }
    }

    fn write(&mut self, columns: &Range<usize>, rows: &Range<usize>, normal: [f32; 3]) {
        let (channels, components) = (self.channels, self.components);
        for y in rows.clone() {
            let row = &mut self.samples[(y * self.width + columns.start) * channels..][..columns.len() * channels];
            for texel in row.chunks_exact_mut(channels) {
                texel[..components].iter_mut().zip(normal).for_each(|(sample, c)| *sample = (self.encode)(c));
            }
        }
    }
}

/// Returns the largest power of two below `length`, which is at least 2: the texels along the edge of a mip's texel.
fn edge(length: usize) -> usize {
    length.div_ceil(2).next_power_of_two()
}

/// Splits a range after `length`, or at its end.
fn split(range: Range<usize>, length: usize) -> [Range<usize>; 2] {
    let middle = range.end.min(range.start + length);
    [range.start..middle, middle..range.end]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bump::normal_map::of_byte;

    fn filled(width: usize, channels: usize, samples: &mut [u8]) -> u64 {
        let has_z = channels > 2;
        let encode = |v: f32| ((0.5 * v + 0.5) * 255.0).round() as u8;
        fill(samples, width, channels, has_z, of_byte, encode)
    }

    #[test]
    fn unused_texels_get_the_mean_of_the_smallest_rectangle() {
        // The left quarter of 2 x 2 texels has one used texel, and the right one has three.
        let above = [[0, 0, 0], [100, 120, 240], [128, 128, 255], [140, 128, 250]];
        let below = [[3, 9, 2], [0, 0, 0], [0, 12, 0], [128, 110, 250]];
        let mut samples = [above, below].concat().concat();
        assert_eq!(filled(4, 3, &mut samples), 4);
        let above = [[100, 120, 240], [100, 120, 240], [128, 128, 255], [140, 128, 250]];
        let below = [[100, 120, 240], [100, 120, 240], [132, 122, 252], [128, 110, 250]];
        assert_eq!(samples, [above, below].concat().concat());
    }

    #[test]
    fn other_channels_stay_as_they_are() {
        let mut samples = [[0, 0, 0, 7], [128, 128, 255, 9]].concat();
        assert_eq!(filled(2, 4, &mut samples), 1);
        assert_eq!(samples, [[128, 128, 255, 7], [128, 128, 255, 9]].concat());
        let mut samples = [[0, 0], [140, 120]].concat();
        assert_eq!(filled(2, 2, &mut samples), 1);
        assert_eq!(samples, [[140, 120], [140, 120]].concat());
    }

    /// Texels at the edge of a black part are blends of black and a normal.
    #[test]
    fn normals_below_the_surface_are_unused_beside_black() {
        let normal = [128, 128, 255];
        let mut samples = [[0, 0, 0], [64, 64, 127], normal, normal].concat();
        assert_eq!(filled(4, 3, &mut samples), 2);
        assert_eq!(samples, normal.repeat(4));
        let mut without_black = [[64, 64, 127], [64, 64, 127], normal, normal].concat();
        assert_eq!(filled(4, 3, &mut without_black), 0);
        assert_eq!(without_black[..3], [64, 64, 127]);
    }

    /// Such an image is no normal map, and nothing tells which normals would be right.
    #[test]
    fn a_black_image_stays_as_it_is() {
        let mut samples = vec![0; 12];
        assert_eq!(filled(2, 3, &mut samples), 0);
        assert_eq!(samples, [0; 12]);
    }

    /// Every size, with one used texel at each place: all others get its normal.
    #[test]
    fn one_used_texel_fills_every_size() {
        for (width, height) in (1..9).flat_map(|width| (1..9).map(move |height| (width, height))) {
            for place in 0..width * height {
                let mut samples = vec![0; width * height * 3];
                samples[3 * place..][..3].copy_from_slice(&[90, 120, 230]);
                assert_eq!(filled(width, 3, &mut samples), (width * height - 1) as u64);
                assert_eq!(samples, [90, 120, 230].repeat(width * height), "{width} x {height}, {place}");
            }
        }
    }

    #[test]
    fn edges_are_those_of_mips() {
        assert_eq!([2, 3, 4, 5, 8, 9].map(edge), [1, 2, 2, 4, 4, 8]);
    }
}

//! The region of pictures that a sheet shows enlarged.

use serde::Serialize;

use super::displayed::Displayed;

/// How much larger than on the picture a region is shown.
pub const MAGNIFICATION: u32 = 4;

/// A region of a picture, in pixels from its left upper corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Crop {
    /// First column.
    pub left: u32,
    /// First row.
    pub top: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Crop {
    /// Returns the region in which the worst of `pictures` differs most from `truth` on a display. Its sides are
    /// those of the pictures divided by [`MAGNIFICATION`]. Pixels that the surface does not fill count as equal. If
    /// nothing differs, the region is in the middle.
    pub fn most_different(pictures: &[&Displayed], truth: &Displayed) -> Self {
        let [columns, rows] = truth.picture.size;
        let [width, height] = truth.picture.size.map(|side| (side / MAGNIFICATION).max(1));
        let sums = Sums::new(truth.picture.size, |i| {
            let difference = |picture: &&Displayed| {
                picture.values[i].iter().zip(truth.values[i]).map(|(a, b)| (a - b).abs()).sum::<f64>()
            };
            if truth.picture.coverage[i] == 1.0 { pictures.iter().map(difference).fold(0.0, f64::max) } else { 0.0 }
        });
        let mut best = Self { left: (columns - width) / 2, top: (rows - height) / 2, width, height };
        let mut most = sums.within(&best);
        for top in 0..=rows - height {
            for left in 0..=columns - width {
                let region = Self { left, top, width, height };
                let sum = sums.within(&region);
                // Rounding does not decide between regions that differ alike.
                if sum > most * (1.0 + 1e-9) {
                    (best, most) = (region, sum);
                }
            }
        }
        best
    }
}

/// A summed-area table (F. Crow, "Summed-area tables for texture mapping", 1984).
struct Sums {
    stride: usize,
    /// The sum above and to the left of each corner of a pixel.
    corners: Vec<f64>,
}

impl Sums {
    fn new([width, height]: [u32; 2], value: impl Fn(usize) -> f64) -> Self {
        let (width, height) = (width as usize, height as usize);
        let stride = width + 1;
        let mut corners = vec![0.0; stride * (height + 1)];
        for y in 0..height {
            let mut row = 0.0;
            for x in 0..width {
                row += value(y * width + x);
                corners[(y + 1) * stride + x + 1] = corners[y * stride + x + 1] + row;
            }
        }
        Self { stride, corners }
    }

    fn within(&self, region: &Crop) -> f64 {
        let at = |x: u32, y: u32| self.corners[y as usize * self.stride + x as usize];
        let (right, bottom) = (region.left + region.width, region.top + region.height);
        at(right, bottom) - at(region.left, bottom) - at(right, region.top) + at(region.left, region.top)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::{Picture, Tone};

    fn picture(spots: &[[u32; 2]]) -> Displayed {
        let mut pixels = vec![[0.2; 3]; 40 * 24];
        spots.iter().for_each(|[x, y]| pixels[(y * 40 + x) as usize] = [1.0; 3]);
        Displayed::new(Picture { size: [40, 24], pixels, coverage: vec![1.0; 40 * 24] }, &Tone { exposure: 1.0 })
    }

    #[test]
    fn the_region_holds_the_largest_difference() {
        let truth = picture(&[]);
        let [few, many] = [picture(&[[2, 2]]), picture(&[[30, 15], [31, 16], [38, 19]])];
        let found = Crop::most_different(&[&few, &many], &truth);
        assert_eq!((found.width, found.height), (10, 6));
        let holds =
            |[x, y]: [u32; 2]| (found.left..found.left + 10).contains(&x) && (found.top..found.top + 6).contains(&y);
        assert!([[30, 15], [31, 16], [38, 19]].into_iter().all(holds), "{found:?}");
    }

    #[test]
    fn surroundings_do_not_count_and_equal_pictures_show_the_middle() {
        let mut truth = picture(&[]);
        truth.picture.coverage[2 * 40 + 2] = 0.5;
        let found = Crop::most_different(&[&picture(&[[2, 2]])], &truth);
        assert_eq!(found, Crop { left: 15, top: 9, width: 10, height: 6 });
    }

    #[test]
    fn a_picture_of_one_pixel_is_its_own_region() {
        let one = Picture { size: [1, 1], pixels: vec![[0.5; 3]], coverage: vec![1.0] };
        let one = Displayed::new(one, &Tone { exposure: 1.0 });
        let found = Crop::most_different(&[&one], &one);
        assert_eq!(found, Crop { left: 0, top: 0, width: 1, height: 1 });
    }
}

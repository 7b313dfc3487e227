//! Normal maps: tangent-space normals in two or three channels of an image.

use rayon::prelude::*;

use crate::image::{Image, MapError, Samples, each};
use crate::simd::dispatch;

/// Which channels of an image hold the normal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum NormalLayout {
    /// x and y only when the image has two channels or its third is 0 throughout (as BC5 and RG textures decode), else x,
    /// y and z.
    #[default]
    Auto,
    /// x, y, z in the first three channels.
    Xyz,
    /// x and y in the first two channels; z = sqrt(1 - x^2 - y^2).
    Xy,
}

/// A normal map. Integers encode [-1, 1] as 2v - 1, as glTF engines decode them; so do floats unless an x or y is
/// negative, in which case they are the components themselves. Further channels (alpha) are ignored.
pub struct NormalMap {
    image: Image,
    has_z: bool,
    signed: bool,
    green_down: bool,
}

/// Largest and smallest magnitude of the largest component of a normal: squares of both, and 256 times them, are
/// floats.
const LONGEST: f64 = 1e9;
const SHORTEST: f64 = 1e-9;

impl NormalMap {
    /// Reads `image` as normals. `green_down` tells that y points down the image (DirectX convention); it is turned up.
    ///
    /// # Errors
    /// [`MapError::Channels`] with fewer than two channels, or fewer than three under [`NormalLayout::Xyz`];
    /// [`MapError::NotFinite`] with NaN or infinity.
    pub fn new(image: Image, layout: NormalLayout, green_down: bool) -> Result<Self, MapError> {
        let needed = if layout == NormalLayout::Xyz { 3 } else { 2 };
        if image.channels < needed {
            return Err(MapError::Channels {
                expected: if needed == 3 {
                    "a normal map with x, y and z"
                } else {
                    "a normal map with at least x and y"
                },
                found: image.channels,
            });
        }
        image.check_finite()?;
        let has_z = match layout {
            NormalLayout::Xyz => true,
            NormalLayout::Xy => false,
            NormalLayout::Auto => image.channels > 2 && !image.is_zero(2),
        };
        let signed = image.has_negative(2);
        let mut map = Self { image, has_z, signed, green_down };
        map.shorten();
        Ok(map)
    }

    /// Scales vectors so long or so short that their squares are no floats to a length of about 1. Only their direction
    /// counts.
    fn shorten(&mut self) {
        let (channels, signed, has_z) = (self.image.channels as usize, self.signed, self.has_z);
        let Samples::F32(samples) = &mut self.image.samples else { return };
        samples.par_chunks_exact_mut(channels).for_each(|texel| {
            // A z that is rebuilt makes short x and y what they should be.
            let (vector, least) = if has_z { (&mut texel[..3], SHORTEST) } else { (&mut texel[..2], 0.0) };
            let component = |sample: f32| if signed { f64::from(sample) } else { 2.0 * f64::from(sample) - 1.0 };
            let longest = vector.iter().map(|sample| component(*sample).abs()).fold(0.0, f64::max);
            if longest > 0.0 && !(least..=LONGEST).contains(&longest) {
                for sample in vector {
                    let scaled = component(*sample) / longest;
                    *sample = (if signed { scaled } else { 0.5 * scaled + 0.5 }) as f32;
                }
            }
        });
    }

    /// Columns.
    pub fn width(&self) -> u32 {
        self.image.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.image.height
    }

    /// Whether z is stored, and not rebuilt from x and y.
    pub fn has_z(&self) -> bool {
        self.has_z
    }

    /// Distance between neighbouring values of x or y near 0.
    pub fn step(&self) -> f32 {
        if self.signed { self.image.step() } else { 2.0 * self.image.step() }
    }

    /// Writes row `y` (0 is the top) to `out`, which has `width` normals of any length.
    pub fn row(&self, y: u32, out: &mut [[f32; 3]]) {
        let channels = self.image.channels as usize;
        let start = y as usize * out.len() * channels;
        let samples = start..start + out.len() * channels;
        match &self.image.samples {
            Samples::U8(all) => self.decode(&all[samples], out, |v| f32::from(v) * (2.0 / 255.0) - 1.0),
            Samples::U16(all) => {
                self.decode(&all[samples], out, |v| f32::from(v) * (2.0 / 65535.0) - 1.0);
            }
            Samples::F32(all) if self.signed => self.decode(&all[samples], out, |v| v),
            Samples::F32(all) => self.decode(&all[samples], out, |v| 2.0 * v - 1.0),
        }
    }

    fn decode<T: Copy>(&self, samples: &[T], out: &mut [[f32; 3]], component: impl Fn(T) -> f32) {
        match self.image.channels {
            2 => each(samples, out, |&[x, y]| [component(x), component(y), 0.0]),
            3 => dispatch!(fearless_simd::Level::new(), _simd => {
                out.as_flattened_mut().iter_mut().zip(samples).for_each(|(out, &sample)| *out = component(sample));
            }),
            _ => each(samples, out, |&[x, y, z, _]| [component(x), component(y), component(z)]),
        }
        if self.green_down {
            out.iter_mut().for_each(|normal| normal[1] = -normal[1]);
        }
        if !self.has_z {
            out.iter_mut().for_each(|[x, y, z]| *z = (1.0 - *x * *x - *y * *y).max(0.0).sqrt());
        }
    }
}

impl Image {
    /// Whether channel `c` is 0 in every texel.
    fn is_zero(&self, c: usize) -> bool {
        let n = self.channels as usize;
        match &self.samples {
            Samples::U8(v) => v.par_chunks_exact(n).all(|t| t[c] == 0),
            Samples::U16(v) => v.par_chunks_exact(n).all(|t| t[c] == 0),
            Samples::F32(v) => v.par_chunks_exact(n).all(|t| t[c] == 0.0),
        }
    }

    /// Whether one of the first `count` channels is negative somewhere.
    fn has_negative(&self, count: usize) -> bool {
        match &self.samples {
            Samples::F32(v) => v.par_chunks_exact(self.channels as usize).any(|t| t[..count].iter().any(|s| *s < 0.0)),
            _ => false,
        }
    }

    /// Refuses what has no value: no lobe and no mean comes out of it.
    ///
    /// # Errors
    /// [`MapError::NotFinite`] when a sample is NaN or infinite.
    pub fn check_finite(&self) -> Result<(), MapError> {
        let Samples::F32(samples) = &self.samples else {
            return Ok(());
        };
        let texels = samples.par_chunks_exact(self.channels as usize);
        let bad = |texel: &[f32]| texel.iter().any(|s| !s.is_finite());
        let Some(first) = texels.clone().position_first(bad) else {
            return Ok(());
        };
        Err(MapError::NotFinite {
            count: texels.filter(|t| bad(t)).count() as u64,
            x: (first % self.width as usize) as u32,
            y: (first / self.width as usize) as u32,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(channels: u32, samples: Samples) -> Image {
        Image { width: 1, height: 1, channels, samples }
    }

    fn only_normal(image: Image, layout: NormalLayout, green_down: bool) -> [f32; 3] {
        let map = NormalMap::new(image, layout, green_down).unwrap();
        let mut out = [[0.0; 3]];
        map.row(0, &mut out);
        out[0]
    }

    fn close(a: [f32; 3], b: [f32; 3]) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-4)
    }

    #[test]
    fn integers_decode_as_engines_do() {
        let normal = only_normal(image(3, Samples::U8(vec![255, 0, 128])), NormalLayout::Auto, false);
        assert!(close(normal, [1.0, -1.0, 1.0 / 255.0]));
        let normal = only_normal(image(4, Samples::U16(vec![65535, 0, 65535, 0])), NormalLayout::Auto, true);
        assert!(close(normal, [1.0, 1.0, 1.0]));
    }

    #[test]
    fn two_channels_rebuild_z() {
        for (channels, samples) in [(2, vec![0.6, 0.0]), (3, vec![0.6, -1e-9, 0.0])] {
            let mut samples = samples;
            samples[1] = -0.0;
            samples[0] = -0.6;
            let normal = only_normal(image(channels, Samples::F32(samples)), NormalLayout::Auto, false);
            assert!(close(normal, [-0.6, 0.0, 0.8]), "{normal:?}");
        }
    }

    #[test]
    fn floats_without_a_negative_are_biased() {
        let normal = only_normal(image(3, Samples::F32(vec![0.5, 0.8, 0.9])), NormalLayout::Auto, false);
        assert!(close(normal, [0.0, 0.6, 0.8]));
    }

    /// One such texel would spoil every level.
    #[test]
    fn vectors_of_any_length_keep_their_direction() {
        for length in [f32::MAX, 1e20, 1e-20, 1e-37] {
            let texel = [-0.6 * length, 0.0, 0.8 * length];
            let normal = only_normal(image(3, Samples::F32(texel.to_vec())), NormalLayout::Xyz, false);
            assert!(close(normal, [-0.75, 0.0, 1.0]), "{length}: {normal:?}");
        }
        let long = only_normal(image(3, Samples::F32(vec![f32::MAX, 0.5, 0.5])), NormalLayout::Xyz, false);
        assert!(close(long, [1.0, 0.0, 0.0]), "{long:?}");
        let two = only_normal(image(2, Samples::F32(vec![-f32::MAX, 1.0])), NormalLayout::Xy, false);
        assert!(close(two, [-1.0, 0.0, 0.0]), "{two:?}");
        let usual = vec![-0.1, 0.2, 0.9];
        assert_eq!(only_normal(image(3, Samples::F32(usual)), NormalLayout::Xyz, false), [-0.1, 0.2, 0.9]);
    }

    #[test]
    fn unusable_images_are_refused() {
        let grey = image(1, Samples::U8(vec![0]));
        assert!(matches!(NormalMap::new(grey, NormalLayout::Auto, false), Err(MapError::Channels { found: 1, .. })));
        let bad = image(3, Samples::F32(vec![0.0, f32::NAN, 1.0]));
        assert!(matches!(
            NormalMap::new(bad, NormalLayout::Auto, false),
            Err(MapError::NotFinite { count: 1, x: 0, y: 0 })
        ));
    }
}

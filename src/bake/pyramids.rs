//! The pyramid profile: offsets and D or lambda_1, each with the range that its texels stand for.

use rayon::prelude::*;
use serde::Serialize;

use super::chain::{Chain, Encoding, encode_chain};
use crate::lobe::SquaredAlpha;
use crate::pyramid::{Moments, Pyramid, Rows, ShapedMoments};
use crate::roughness::{Distribution, Factor, lambda_1};
use crate::texture::EncodeError;

/// What texels of 0 and 1 stand for, channel by channel: value = min + texel (max - min).
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Range {
    /// Value of a texel of 0.
    pub min: Vec<f32>,
    /// Value of a texel of 1.
    pub max: Vec<f32>,
}

impl Range {
    /// 0 to bound, and as far below 0 in each channel that `signed` tells.
    fn new(bounds: &[f32], signed: &[bool]) -> Self {
        // A range of no width has no inverse; a flat map may use any.
        let max: Vec<f32> = bounds.iter().map(|b| if *b > 0.0 { *b } else { 1.0 }).collect();
        // A hair further below 0 than above, so that 0 is a byte: 128.
        let min = max.iter().zip(signed).map(|(b, signed)| if *signed { -b * (128.0 / 127.0) } else { 0.0 }).collect();
        Self { min, max }
    }

    /// Texels are the values themselves.
    fn identity(channels: usize) -> Self {
        Self { min: vec![0.0; channels], max: vec![1.0; channels] }
    }

    /// What texels stand for after values are multiplied by `factor`.
    pub fn scaled(mut self, factor: f32) -> Self {
        for value in self.min.iter_mut().chain(&mut self.max) {
            *value *= factor;
        }
        self
    }

    fn normalise(&self, value: f32, channel: usize) -> f32 {
        (value - self.min[channel]) / (self.max[channel] - self.min[channel])
    }
}

/// A texture of the pyramid profile.
pub struct Ranged {
    /// The encoded levels.
    pub chain: Chain,
    /// What its texels stand for.
    pub range: Range,
}

/// Values per texel of a pyramid texture: 2 offsets, 3 elements of D or one lambda_1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// (f_u, f_v).
    Offset,
    /// (d1, d2, d3).
    Factor,
    /// lambda_1.
    Lambda1,
}

impl Quantity {
    /// Channels.
    pub fn channels(self) -> usize {
        match self {
            Self::Offset => 2,
            Self::Factor => 3,
            Self::Lambda1 => 1,
        }
    }

    /// Which channels may be negative.
    fn signed(self) -> &'static [bool] {
        match self {
            Self::Offset => &[true, true],
            Self::Factor => &[false, true, false],
            Self::Lambda1 => &[false],
        }
    }

    fn of(self, moments: Moments) -> [f32; 3] {
        match self {
            Self::Offset => [moments.mean.u, moments.mean.v, 0.0],
            Self::Factor => {
                let d = Factor::of(moments.covariance);
                [d.d1, d.d2, d.d3]
            }
            Self::Lambda1 => [lambda_1(moments.covariance), 0.0, 0.0],
        }
    }
}

/// The texture of one quantity over `moments`. Integer formats use the smallest range that holds every level that is written.
pub fn bake_quantity<R>(moments: &Pyramid<R>, quantity: Quantity, encoding: Encoding) -> Result<Ranged, EncodeError>
where
    R: Rows<Texel = Moments>,
{
    let values = |level: usize, y: u32, texels: &mut [Moments]| {
        moments.row(level, y, texels);
        texels.iter().map(move |m| quantity.of(*m)).collect::<Vec<_>>()
    };
    let (channels, sizes) = (quantity.channels(), moments.sizes());
    // A PNG fallback holds [0, 1] only, so with one floats have a range too.
    let range = if encoding.format.is_normalised() || encoding.fallback {
        let bounds = sizes.iter().enumerate().skip(encoding.first(&sizes)).fold(
            [0.0_f32; 3],
            |bounds, (level, &(width, height))| {
                let of_level = (0..height)
                    .into_par_iter()
                    .map_init(
                        || vec![Moments::default(); width as usize],
                        |texels, y| values(level, y, texels).into_iter().fold([0.0; 3], larger),
                    )
                    .reduce(|| [0.0; 3], larger);
                larger(bounds, of_level)
            },
        );
        Range::new(&bounds[..channels], quantity.signed())
    } else {
        Range::identity(channels)
    };
    let chain = encode_chain(&sizes, encoding, &|level, y, out| {
        let mut texels = vec![Moments::default(); out.len()];
        for (texel, value) in out.iter_mut().zip(values(level, y, &mut texels)) {
            for (c, out) in texel.iter_mut().enumerate().take(channels) {
                *out = range.normalise(value[c], c);
            }
        }
    })?;
    Ok(Ranged { chain, range })
}

/// The one c of a map under a lobe of `own` squared alphas: what its texels' covariances want, each as far as it is large
/// and each level alike. 1 for a map without bumps.
pub fn mean_correction<R>(moments: &Pyramid<R>, distribution: Distribution, own: SquaredAlpha) -> f32
where
    R: Rows<Texel = ShapedMoments>,
{
    let mut total = [0.0; 2];
    for (level, (width, height)) in moments.sizes().into_iter().enumerate().skip(1) {
        let in_row = |texels: &mut Vec<ShapedMoments>, y: u32| {
            moments.row(level, y, texels);
            texels.iter().fold([0.0; 2], |sum, m| {
                let corrected = distribution.correct(m, own).covariance.trace();
                [sum[0] + f64::from(corrected), sum[1] + f64::from(m.moments.covariance.trace())]
            })
        };
        let empty = || vec![ShapedMoments::default(); width as usize];
        // Row by row in order, so that the sum does not depend on threads.
        let rows: Vec<[f64; 2]> = (0..height).into_par_iter().map_init(empty, in_row).collect();
        let count = f64::from(width) * f64::from(height);
        total = rows.iter().fold(total, |t, row| [t[0] + row[0] / count, t[1] + row[1] / count]);
    }
    if total[1] > 0.0 { (total[0] / total[1]) as f32 } else { 1.0 }
}

/// The larger magnitude of each channel.
fn larger(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0].max(b[0].abs()), a[1].max(b[1].abs()), a[2].max(b[2].abs())]
}

//! The pyramid profile: offsets and D or lambda_1, each with the range that its texels stand for.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::bump::{Moments, ShapedMoments};
use crate::codec::EncodeError;
use crate::lobe::SquaredAlpha;
use crate::lobe::{Factor, lambda_1};
use crate::material::mip_chain::{Encoding, MipChain, encode_mip_chain};
use crate::mip::{Pyramid, Rows};
use crate::settings::Settings;

/// What texels of 0 and 1 stand for, channel by channel: value = min + texel (max - min).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
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

    /// What the first channels of a texel stand for.
    pub fn values<const N: usize>(&self, texel: [f32; 4]) -> [f32; N] {
        let value = |c: usize| match (self.min.get(c), self.max.get(c)) {
            (Some(min), Some(max)) => min + texel[c] * (max - min),
            _ => 0.0,
        };
        std::array::from_fn(value)
    }

    fn normalise(&self, value: f32, channel: usize) -> f32 {
        (value - self.min[channel]) / (self.max[channel] - self.min[channel])
    }
}

/// A texture of the pyramid profile.
pub struct Ranged {
    /// The encoded levels.
    pub mip_chain: MipChain,
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

/// The texture of one quantity over `moments`.
pub fn bake_quantity<R>(moments: &Pyramid<R>, quantity: Quantity, encoding: Encoding) -> Result<Ranged, EncodeError>
where
    R: Rows<Texel = Moments>,
{
    let range = range_of(moments, quantity, encoding);
    let mip_chain = encode_mip_chain(&moments.sizes(), encoding, &quantity_rows(moments, quantity, &range))?;
    Ok(Ranged { mip_chain, range })
}

/// The range of a quantity. Integer formats use the smallest that holds every level that is written.
pub fn range_of<R>(moments: &Pyramid<R>, quantity: Quantity, encoding: Encoding) -> Range
where
    R: Rows<Texel = Moments>,
{
    let (channels, sizes) = (quantity.channels(), moments.sizes());
    // A PNG fallback holds [0, 1] only, so with one floats have a range too.
    if !encoding.format.is_normalised() && !encoding.fallback {
        return Range::identity(channels);
    }
    let levels = sizes.iter().enumerate().skip(encoding.first(&sizes));
    let bounds = levels.fold([0.0_f32; 3], |bounds, (level, &(width, height))| {
        let of_row = |texels: &mut Vec<Moments>, y| {
            moments.row(level, y, texels);
            texels.iter().map(|m| quantity.of(*m)).fold([0.0; 3], larger)
        };
        let rows = (0..height).into_par_iter().map_init(|| vec![Moments::default(); width as usize], of_row);
        larger(bounds, rows.reduce(|| [0.0; 3], larger))
    });
    Range::new(&bounds[..channels], quantity.signed())
}

/// Rows of the texture of a quantity.
pub fn quantity_rows<R>(
    moments: &Pyramid<R>,
    quantity: Quantity,
    range: &Range,
) -> impl Fn(usize, u32, &mut [[f32; 4]]) + Sync
where
    R: Rows<Texel = Moments>,
{
    move |level, y, out| {
        let mut texels = vec![Moments::default(); out.len()];
        moments.row(level, y, &mut texels);
        for (texel, m) in out.iter_mut().zip(texels) {
            let value = quantity.of(m);
            for (c, out) in texel.iter_mut().enumerate().take(quantity.channels()) {
                *out = range.normalise(value[c], c);
            }
        }
    }
}

/// The one c of a map under a lobe of `own` squared alphas: what its texels' covariances want, each as far as it is large
/// and each level alike. 1 for a map without bumps.
pub fn mean_correction<R>(moments: &Pyramid<R>, settings: &Settings, own: SquaredAlpha) -> f32
where
    R: Rows<Texel = ShapedMoments>,
{
    let mut total = [0.0; 2];
    for (level, (width, height)) in moments.sizes().into_iter().enumerate().skip(1) {
        let in_row = |texels: &mut Vec<ShapedMoments>, y: u32| {
            moments.row(level, y, texels);
            texels.iter().fold([0.0; 2], |sum, m| {
                let corrected = settings.distribution.correct(m, own, settings.family).covariance.trace();
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

/// The share of the variance that filtering D in place of K loses halfway between neighbouring texels, at the level
/// where it is most. With D the mean of D1 and D2, (K1 + K2)/2 - D D^T = (D1 - D2)(D1 - D2)^T / 4: never less than 0.
pub fn filter_loss<R: Rows<Texel = Moments>>(moments: &Pyramid<R>) -> f32 {
    let sizes = moments.sizes();
    let of_level = |(level, &(width, height)): (usize, &(u32, u32))| {
        let factors = |y: u32, out: &mut Vec<[f32; 3]>| {
            let mut texels = vec![Moments::default(); width as usize];
            moments.row(level, y, &mut texels);
            out.clear();
            out.extend(texels.into_iter().map(|m| Quantity::Factor.of(m)));
        };
        let in_row = |(row, below): &mut (Vec<[f32; 3]>, Vec<[f32; 3]>), y: u32| {
            factors(y, row);
            let is_last = y + 1 == height;
            if !is_last {
                factors(y + 1, below);
            }
            let right = row.iter().zip(row.iter().skip(1));
            let down = row.iter().zip(below.iter()).filter(|_| !is_last);
            right.chain(down).fold([0.0; 2], |[lost, total], (a, b)| {
                let elements = a.iter().zip(b).map(|(a, b)| (f64::from(*a), f64::from(*b)));
                elements.fold([lost, total], |[lost, total], (a, b)| {
                    [lost + 0.25 * (a - b) * (a - b), total + 0.5 * (a * a + b * b)]
                })
            })
        };
        let rows: Vec<[f64; 2]> = (0..height).into_par_iter().map_init(Default::default, in_row).collect();
        let [lost, total] = rows.iter().fold([0.0; 2], |[l, t], [lost, total]| [l + lost, t + total]);
        if total > 0.0 { (lost / total) as f32 } else { 0.0 }
    };
    // Level 0 has no variance.
    sizes.iter().enumerate().skip(1).map(of_level).fold(0.0, f32::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::symmetric::Symmetric2;
    use crate::mip::Level;

    /// Two texels of rank 1, at +45 and -45 degrees: D = [[0, +-s], [0, s]], so that filtering cancels d2 and with it half
    /// of the variance, all of it along u.
    #[test]
    fn filtering_d_loses_what_its_texels_differ_by() {
        let texel = |sign: f32| Moments { covariance: Symmetric2::outer([sign, 1.0]), ..Moments::default() };
        // Level 1 of a map of 4 x 2 texels whose halves vary that way.
        let offsets = |sign: f32, scale: f32| {
            let mean = crate::bump::Offset { u: sign * scale, v: scale };
            Moments::flat(mean)
        };
        let row = [offsets(1.0, 1.0), offsets(1.0, -1.0), offsets(-1.0, 1.0), offsets(-1.0, -1.0)];
        let pyramid = Pyramid::new(Level { width: 4, height: 2, texels: [row, row].concat() });
        let mut level = [Moments::default(); 2];
        pyramid.row(1, 0, &mut level);
        assert_eq!(level, [texel(1.0), texel(-1.0)]);
        let loss = filter_loss(&pyramid);
        assert!((loss - 0.5).abs() < 1e-6, "{loss}");
        let [a, b] = level.map(|m| Quantity::Factor.of(m));
        let d: [f32; 3] = std::array::from_fn(|i| 0.5 * (a[i] + b[i]));
        let filtered = Factor { d1: d[0], d2: d[1], d3: d[2] }.covariance();
        let mean = 0.5 * (level[0].covariance + level[1].covariance);
        assert!((1.0 - filtered.trace() / mean.trace() - loss).abs() < 1e-6, "{filtered:?} {mean:?}");
    }

    #[test]
    fn nothing_is_lost_where_neighbours_are_alike() {
        let texels = (0..64).map(|i| Moments::flat(crate::bump::Offset { u: (i % 2) as f32, v: 0.0 })).collect();
        assert_eq!(filter_loss(&Pyramid::new(Level { width: 8, height: 8, texels })), 0.0);
        let flat = Level { width: 1, height: 1, texels: vec![Moments::default()] };
        assert_eq!(filter_loss(&Pyramid::new(flat)), 0.0);
    }
}

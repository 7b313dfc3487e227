//! The textures of the pyramid profile: offsets and D or lambda_1, each with the range that its texels stand for.

use rayon::prelude::*;

use crate::bump::Moments;
use crate::lobe::{Factor, lambda_1};
use crate::material::mip_chain::Encoding;
use crate::material::product::Product;
use crate::material::range::Range;
use crate::mip::{Pyramid, TexelRows};

/// What a texture of the pyramid profile holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// The offsets (f_u, f_v).
    Offset,
    /// The elements (d1, d2, d3) of the factor D.
    Factor,
    /// lambda_1.
    Lambda1,
}

impl Quantity {
    /// Returns how many channels the quantity has.
    pub fn channels(self) -> usize {
        match self {
            Self::Offset => 2,
            Self::Factor => 3,
            Self::Lambda1 => 1,
        }
    }

    /// Returns which channels may be negative.
    fn signed(self) -> &'static [bool] {
        match self {
            Self::Offset => &[true, true],
            Self::Factor => &[false, true, false],
            Self::Lambda1 => &[false],
        }
    }

    /// Returns the values of a texel, 0 beyond the channels.
    pub(super) fn of(self, moments: Moments) -> [f32; 3] {
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

/// The texture of a quantity over all levels of `moments`.
pub struct QuantityTexture<'m, R: TexelRows> {
    moments: &'m Pyramid<R>,
    quantity: Quantity,
    /// What its texels stand for.
    pub range: Range,
}

impl<'m, R: TexelRows<Texel = Moments>> QuantityTexture<'m, R> {
    /// Finds the range of a quantity. Integer formats have the smallest range that holds every level that `encoding`
    /// writes.
    pub fn new(moments: &'m Pyramid<R>, quantity: Quantity, encoding: Encoding) -> Self {
        Self { moments, quantity, range: range_of(moments, quantity, encoding) }
    }
}

impl<R: TexelRows<Texel = Moments>> Product for QuantityTexture<'_, R> {
    fn sizes(&self) -> Vec<(u32, u32)> {
        self.moments.sizes()
    }

    fn row(&self, level: usize, y: u32, out: &mut [[f32; 4]]) {
        let mut texels = vec![Moments::default(); out.len()];
        self.moments.row(level, y, &mut texels);
        for (texel, m) in out.iter_mut().zip(texels) {
            let value = self.quantity.of(m);
            for (c, out) in texel.iter_mut().enumerate().take(self.quantity.channels()) {
                *out = self.range.normalise(value[c], c);
            }
        }
    }
}

fn range_of<R>(moments: &Pyramid<R>, quantity: Quantity, encoding: Encoding) -> Range
where
    R: TexelRows<Texel = Moments>,
{
    let (channels, sizes) = (quantity.channels(), moments.sizes());
    // A PNG fallback holds [0, 1] only, so floats with a fallback have a range, too.
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

/// Returns the larger magnitude of each channel.
fn larger(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0].max(b[0].abs()), a[1].max(b[1].abs()), a[2].max(b[2].abs())]
}

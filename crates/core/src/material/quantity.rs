//! The roughness texture of the pyramid profile: D or lambda_1, with the range that its texels stand for.
//!
//! Alphas above 1 count as 1, so that lobes bound D by 0.71. `benches/studies/pyramid_coding.rs` finds that a linear
//! code of the whole range is within 0.002 of lobe error of companding codes, and that ranges by percentile are worse.

use rayon::prelude::*;

use crate::lobe::Factor;
use crate::material::mip_chain::Encoding;
use crate::material::product::Product;
use crate::material::pyramid_levels::{PyramidLevels, PyramidTexel};
use crate::material::range::Range;

/// What the roughness texture of the pyramid profile holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// The elements (d1, d2, d3) of the factor D.
    Factor,
    /// lambda_1.
    Lambda1,
}

impl Quantity {
    /// Returns how many channels the quantity has.
    pub fn channels(self) -> usize {
        match self {
            Self::Factor => 3,
            Self::Lambda1 => 1,
        }
    }

    /// Returns which channels may be negative.
    fn signed(self) -> &'static [bool] {
        match self {
            Self::Factor => &[false, true, false],
            Self::Lambda1 => &[false],
        }
    }

    /// Returns the values of a texel, 0 beyond the channels.
    pub(super) fn of(self, texel: PyramidTexel) -> [f32; 3] {
        match self {
            Self::Factor => {
                let d = Factor::of(texel.covariance);
                [d.d1, d.d2, d.d3]
            }
            Self::Lambda1 => [texel.isotropic.sqrt(), 0.0, 0.0],
        }
    }
}

/// The texture of a quantity over all levels.
pub struct QuantityTexture<'l> {
    levels: &'l dyn PyramidLevels,
    quantity: Quantity,
    /// What its texels stand for.
    pub range: Range,
}

impl<'l> QuantityTexture<'l> {
    /// Finds the range of a quantity. Integer formats have the smallest range that holds every level that `encoding`
    /// writes.
    pub fn new(levels: &'l dyn PyramidLevels, quantity: Quantity, encoding: Encoding) -> Self {
        Self { levels, quantity, range: range_of(levels, quantity, encoding) }
    }
}

impl Product for QuantityTexture<'_> {
    fn sizes(&self) -> Vec<(u32, u32)> {
        self.levels.sizes()
    }

    fn row(&self, level: usize, y: u32, out: &mut [[f32; 4]]) {
        let mut texels = vec![PyramidTexel::default(); out.len()];
        self.levels.row(level, y, &mut texels);
        for (out, texel) in out.iter_mut().zip(texels) {
            let value = self.quantity.of(texel);
            for (c, out) in out.iter_mut().enumerate().take(self.quantity.channels()) {
                *out = self.range.normalise(value[c], c);
            }
        }
    }
}

fn range_of(levels: &dyn PyramidLevels, quantity: Quantity, encoding: Encoding) -> Range {
    let (channels, sizes) = (quantity.channels(), levels.sizes());
    // A PNG fallback holds [0, 1] only, so floats with a fallback have a range, too.
    if !encoding.format.is_normalised() && !encoding.fallback {
        return Range::identity(channels);
    }
    let written = sizes.iter().enumerate().skip(encoding.first(&sizes));
    let bounds = written.fold([0.0_f32; 3], |bounds, (level, &(width, height))| {
        let of_row = |texels: &mut Vec<PyramidTexel>, y| {
            levels.row(level, y, texels);
            texels.iter().map(|texel| quantity.of(*texel)).fold([0.0; 3], larger)
        };
        let rows = (0..height).into_par_iter().map_init(|| vec![PyramidTexel::default(); width as usize], of_row);
        larger(bounds, rows.reduce(|| [0.0; 3], larger))
    });
    Range::new(&bounds[..channels], quantity.signed())
}

/// Returns the larger magnitude of each channel.
fn larger(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0].max(b[0].abs()), a[1].max(b[1].abs()), a[2].max(b[2].abs())]
}

//! The weights that indices stand for.

use crate::lanes::round;
use texel_simd::Real;

/// The weight that each index of a mode stands for, 0..=64: `gain * index` and two corrections.
///
/// The numbers are parameters, and not constants of the code, so that one search is compiled for all modes. Code for
/// each number of bits made the compiler take a third more time for the crate (136 s of CPU instead of 103).
pub(crate) struct Ramp {
    /// The largest index.
    pub last: f32,
    gain: f32,
    /// A correction is `gain * round(slope * index - shift)`. Shifts are a half and less than one step of the index, so
    /// that nothing lies half way and rounding goes down.
    first: Correction,
    /// Its gain is 1.
    second: Correction,
}

struct Correction {
    slope: f32,
    shift: f32,
    gain: f32,
}

const NO_CORRECTION: Correction = Correction { slope: 0.0, shift: 0.0, gain: 0.0 };

/// The ramps of indices with 1 to 5 bits, in this order.
static RAMPS: [Ramp; 5] = [
    Ramp { last: 1.0, gain: 64.0, first: NO_CORRECTION, second: NO_CORRECTION },
    Ramp { last: 3.0, gain: 21.0, first: Correction { slope: 0.5, shift: 0.25, gain: 1.0 }, second: NO_CORRECTION },
    Ramp { last: 7.0, gain: 9.0, first: Correction { slope: 0.25, shift: 0.375, gain: 1.0 }, second: NO_CORRECTION },
    Ramp {
        last: 15.0,
        gain: 4.0,
        first: Correction { slope: 0.25, shift: 0.375, gain: 1.0 },
        second: Correction { slope: 0.125, shift: 0.4375, gain: 1.0 },
    },
    Ramp {
        last: 31.0,
        gain: 2.0,
        first: Correction { slope: 0.0625, shift: 0.46875, gain: 2.0 },
        second: NO_CORRECTION,
    },
];

impl Ramp {
    /// Returns the ramp of indices with `bits` bits, 1 to 5.
    pub fn of(bits: u32) -> &'static Self {
        &RAMPS[bits.clamp(1, 5) as usize - 1]
    }

    /// Returns the weight of `index`.
    #[inline(always)]
    pub fn weight<F: Real>(&self, index: F) -> F {
        let splat = |value| index.splat_like(value);
        let Self { gain, first, second, .. } = self;
        let correction = round(index * splat(first.slope) - splat(first.shift)) * splat(first.gain);
        index * splat(*gain) + correction + round(index * splat(second.slope) - splat(second.shift))
    }
}

//! Points that are spread evenly over the samples of a pixel.

/// A quasirandom sequence in the four-dimensional unit cube (M. Roberts, "The unreasonable effectiveness of quasirandom
/// sequences", 2018), shifted for each pixel, so that the pattern of the sequence is not visible (R. Cranley, T.
/// Patterson, 1976). Numbers are in units of 2^-64, so that they wrap around by themselves.
pub struct Quasirandom {
    start: [u64; 4],
}

impl Quasirandom {
    /// The powers -1 to -4 of 1.16730..., the root of x^5 = x + 1.
    const STEPS: [u64; 4] =
        [0xdb4f_0b91_75ae_2165, 0xbbe0_5633_03a4_615f, 0xa0f2_ec75_a1fe_1575, 0x89e1_8285_7d9e_d688];

    /// Returns the sequence of a pixel. The finaliser of MurmurHash3 makes the bits of its shift.
    pub fn new(x: u32, y: u32) -> Self {
        let start = [1, 2, 3, 4].map(|salt: u32| {
            let mut bits = x.wrapping_mul(0x9e37_79b9) ^ y.wrapping_mul(0x85eb_ca6b).rotate_left(13) ^ (salt << 27);
            for multiplier in [0x85eb_ca6b, 0xc2b2_ae35] {
                bits = (bits ^ (bits >> 15)).wrapping_mul(multiplier);
            }
            u64::from(bits ^ (bits >> 16)) << 32
        });
        Self { start }
    }

    /// Returns point `i`.
    #[inline]
    pub fn point(&self, i: u32) -> [f32; 4] {
        let at = |axis: usize| {
            let bits = self.start[axis].wrapping_add(Self::STEPS[axis].wrapping_mul(u64::from(i) + 1));
            (bits >> 40) as f32 / (1u32 << 24) as f32
        };
        [at(0), at(1), at(2), at(3)]
    }
}

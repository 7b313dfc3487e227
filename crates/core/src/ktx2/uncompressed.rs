//! Decoding of uncompressed formats, which store each texel by itself.

use std::borrow::Cow;

use half::f16;

use crate::image::Samples;
use crate::ktx2::formats::{Texel, Values};

/// Decodes `payload`, whose length has been checked.
pub(super) fn decode(payload: Cow<'_, [u8]>, texel: &Texel) -> Samples {
    let pairs = || payload.as_chunks::<2>().0.iter();
    let words = || payload.as_chunks::<4>().0.iter();
    match texel.values {
        Values::Unorm8 => {
            let mut values = payload.into_owned();
            if texel.blue_first {
                for texel in values.chunks_exact_mut(texel.channels as usize) {
                    texel.swap(0, 2);
                }
            }
            Samples::U8(values)
        }
        Values::Unorm16 => Samples::U16(pairs().map(|&v| u16::from_le_bytes(v)).collect()),
        // -128 and -32768 also mean -1 (Vulkan 1.3, section 3.10.1, fixed-point conversion).
        Values::Snorm8 => {
            let value = |&v: &u8| (f32::from(v.cast_signed()) / 127.0).max(-1.0);
            Samples::F32(payload.iter().map(value).collect())
        }
        Values::Snorm16 => {
            let value = |&v: &[u8; 2]| (f32::from(i16::from_le_bytes(v)) / 32767.0).max(-1.0);
            Samples::F32(pairs().map(value).collect())
        }
        Values::Half => Samples::F32(pairs().map(|&v| f16::from_le_bytes(v).to_f32()).collect()),
        Values::Float => Samples::F32(words().map(|&v| f32::from_le_bytes(v)).collect()),
        Values::SharedExponent => {
            let texel = |&v: &[u8; 4]| shared_exponent(u32::from_le_bytes(v));
            Samples::F32(words().flat_map(texel).collect())
        }
        Values::PackedFloat => {
            let texel = |&v: &[u8; 4]| packed_floats(u32::from_le_bytes(v));
            Samples::F32(words().flat_map(texel).collect())
        }
    }
}

/// Decodes `E5B9G9R9`: mantissa * 2^(exponent - 15 - 9) (Khronos Data Format 1.3, section 10.4). The scale is built
/// from its bits, so it is exact.
fn shared_exponent(word: u32) -> [f32; 3] {
    let scale = f32::from_bits(((word >> 27) + 127 - 15 - 9) << 23);
    [0, 9, 18].map(|shift| ((word >> shift) & 0x1ff) as f32 * scale)
}

/// Decodes `B10G11R11`: halves without a sign whose mantissas are cut to 6 or 5 bits (Khronos Data Format 1.3, sections
/// 10.2 and 10.3).
fn packed_floats(word: u32) -> [f32; 3] {
    let widened = |bits: u32| f16::from_bits(bits as u16).to_f32();
    [widened((word & 0x7ff) << 4), widened(((word >> 11) & 0x7ff) << 4), widened((word >> 22) << 5)]
}

//! Normal mips: at every level the unit normals of where the texels point.

use super::bumps::Bumps;
use super::chain::{Chain, Encoding, encode_chain};
use super::lobes::Lobes;
use crate::bump::{Offset, normal_from_offset};
use crate::pyramid::Moments;
use crate::texture::EncodeError;

/// The normal texture of `bumps`: x, y, z in [0, 1] with 1/2 for 0. Unit length at every level, since engines that
/// rebuild z and engines that read it must agree. Texels point where `lobes` on the same grid do, or without them where
/// their mean slope does.
pub fn bake_normals(bumps: &Bumps<'_>, lobes: Option<&Lobes<'_>>, encoding: Encoding) -> Result<Chain, EncodeError> {
    let encode = |offsets: &(dyn Fn(usize, u32, &mut [Offset]) + Sync)| {
        encode_chain(&bumps.sizes(), encoding, &|level, y, out| {
            let mut texels = vec![Offset::default(); out.len()];
            offsets(level, y, &mut texels);
            for (value, offset) in out.iter_mut().zip(texels) {
                let [x, y, z] = normal_from_offset(offset);
                *value = [0.5 * x + 0.5, 0.5 * y + 0.5, 0.5 * z + 0.5, 1.0];
            }
        })
    };
    match lobes {
        Some(lobes) => encode(&|level, y, out| lobes.offsets(level, y, out)),
        None => {
            let moments = bumps.moments();
            encode(&|level, y, out| {
                let mut texels = vec![Moments::default(); out.len()];
                moments.row(level, y, &mut texels);
                out.iter_mut().zip(texels).for_each(|(offset, m)| *offset = m.mean);
            })
        }
    }
}

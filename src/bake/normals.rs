//! Normal mips: at every level the unit normal of the mean offset.

use super::chain::{Chain, Encoding, encode_chain};
use crate::bump::normal_from_offset;
use crate::pyramid::{Moments, Pyramid, Rows};
use crate::texture::EncodeError;

/// The normal texture over `moments`: x, y, z in [0, 1] with 1/2 for 0. Unit length at every level, since engines that
/// rebuild z and engines that read it must agree.
pub fn bake_normals<R>(moments: &Pyramid<R>, encoding: Encoding) -> Result<Chain, EncodeError>
where
    R: Rows<Texel = Moments>,
{
    encode_chain(&moments.sizes(), encoding, &|level, y, out| {
        let mut texels = vec![Moments::default(); out.len()];
        moments.row(level, y, &mut texels);
        for (value, texel) in out.iter_mut().zip(texels) {
            let [x, y, z] = normal_from_offset(texel.mean);
            *value = [0.5 * x + 0.5, 0.5 * y + 0.5, 0.5 * z + 0.5, 1.0];
        }
    })
}

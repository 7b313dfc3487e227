//! A product: a kind of texture that the bake makes.

use crate::codec::EncodeError;
use crate::material::mip_chain::{Encoding, MipChain, encode_mip_chain};

/// A texture as rows of values, before it is encoded.
pub trait Product: Sync {
    /// Returns the sizes of all levels, level 0 first.
    fn sizes(&self) -> Vec<(u32, u32)>;

    /// Writes the values of row `y` of `level` to `out`. Integer formats hold values in [0, 1].
    fn row(&self, level: usize, y: u32, out: &mut [[f32; 4]]);

    /// Encodes the levels that `encoding` asks for.
    ///
    /// # Errors
    /// [`EncodeError`] if the encoder fails.
    fn encode(&self, encoding: Encoding) -> Result<MipChain, EncodeError> {
        encode_mip_chain(&self.sizes(), encoding, &|level, y, out| self.row(level, y, out))
    }
}

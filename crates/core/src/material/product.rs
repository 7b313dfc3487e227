//! A product: a kind of texture that the bake makes.

use crate::codec::EncodeError;
use crate::codec::uastc::Lobe;
use crate::material::mip_chain::{Encoding, LevelRows, LobeRow, MipChain, encode_mip_chain};

/// A texture as rows of values, before it is encoded.
pub trait Product: Sync {
    /// Returns the sizes of all levels, level 0 first.
    fn sizes(&self) -> Vec<(u32, u32)>;

    /// Writes the values of row `y` of `level` to `out`. Integer formats hold values in [0, 1].
    fn row(&self, level: usize, y: u32, out: &mut [[f32; 4]]);

    /// Returns whether [`Self::lobe_row`] knows the lobes about the normals of the texels.
    fn has_lobes(&self) -> bool {
        false
    }

    /// Writes the lobes about the normals of row `y` of `level` to `out`, in the slopes of the texture.
    fn lobe_row(&self, _level: usize, _y: u32, _out: &mut [Lobe]) {}

    /// Encodes the levels that `encoding` asks for.
    ///
    /// # Errors
    /// [`EncodeError`] if the encoder fails.
    fn encode(&self, encoding: Encoding) -> Result<MipChain, EncodeError> {
        with_rows(self, |rows| encode_mip_chain(&self.sizes(), encoding, rows))
    }
}

/// Calls `function` with the texels of `product`.
pub fn with_rows<P: Product + ?Sized, R>(product: &P, function: impl FnOnce(LevelRows<'_>) -> R) -> R {
    let lobes: &LobeRow<'_> = &|level, y, out| product.lobe_row(level, y, out);
    let values = &|level: usize, y: u32, out: &mut [[f32; 4]]| product.row(level, y, out);
    function(LevelRows { values, lobes: product.has_lobes().then_some(lobes) })
}

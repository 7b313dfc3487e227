//! Payloads of textures: quantises rows of values, and encodes them as blocks or floats. This module knows nothing of
//! glTF.

#[cfg(feature = "bc")]
mod bc;
mod encode;
mod format;
mod png;
mod table;
mod texels;

pub use png::{encode_png, fallback};

pub use encode::{ORM, lower_rate};
pub use format::{Format, Target};
pub use table::{Codec, Identity, Rounding, encode};
pub use texels::{EncodeError, Texels};
/// The encoder and decoder of UASTC blocks, a crate of its own.
pub use uastc_encoder as uastc;

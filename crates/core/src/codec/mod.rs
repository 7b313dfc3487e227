//! Payloads of textures: quantises rows of values, and encodes them as blocks or floats. This module knows nothing of
//! glTF.

#[cfg(feature = "bc")]
mod bc;
mod encode;
mod error;
mod format;
mod png;
mod quantise;
mod rounding;
mod table;

pub use png::{encode_png, fallback};

pub use encode::{ORM, lower_rate};
pub use error::EncodeError;
pub use format::{PayloadFormat, Target};
pub use quantise::Texels;
pub use rounding::{Endpoints, Rounding, Weights};
pub use table::{Codec, Identity, encode};
/// The encoder and decoder of UASTC blocks, a crate of its own.
pub use uastc_encoder as uastc;

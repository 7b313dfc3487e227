//! Textures: quantising, block encoding, KTX2 in and out. This room knows nothing of glTF.

#[cfg(feature = "bc")]
mod bc;
mod encode;
mod format;
pub mod ktx2;

pub use encode::{EncodeError, ORM, Texels, encode, lower_rate};
pub use format::{Format, Target};
/// The encoder and decoder of UASTC blocks, a crate of its own.
pub use uastc_encoder as uastc;

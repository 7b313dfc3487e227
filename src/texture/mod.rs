//! Textures: quantising, block encoding, KTX2 in and out. This room knows nothing of glTF.

#[cfg(feature = "bc")]
mod bc;
mod encode;
mod format;
pub mod ktx2;
pub mod uastc;

pub use encode::{EncodeError, Texels, encode, lower_rate};
pub use format::{Format, Target};

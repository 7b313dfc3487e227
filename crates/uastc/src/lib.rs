#![doc = include_str!("../README.md")]

mod alpha;
mod bit_writer;
mod blocks;
mod candidate;
mod decode;
mod direction;
mod encoder;
mod hints;
mod image;
mod lanes;
mod line;
mod lobe;
mod metric;
mod moments;
mod normals;
mod pack;
mod partition;
mod polish;
mod ramp;
mod rate;
mod row;
mod search;
mod tables;
#[cfg(test)]
mod tests;
mod unpack;

pub use decode::decode_block;
pub use encoder::Encoder;
pub use image::{Image, SizeError};
pub use lobe::Lobe;
pub use metric::{Effort, Metric, Weight};
pub use rate::lower_rate;

/// Bytes of one block of 4 x 4 texels.
pub const BLOCK_BYTES: usize = 16;

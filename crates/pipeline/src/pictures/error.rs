//! Errors of drawing.

use std::path::PathBuf;

use crate::bake::BakeError;
use crate::output::PublishError;
use crate::readback::ReadBackError;

/// Why nothing is drawn.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The input, or a material of its bake, cannot be read.
    #[error(transparent)]
    ReadBack(#[from] ReadBackError),
    /// The input cannot be baked.
    #[error(transparent)]
    Bake(#[from] BakeError),
    /// A picture cannot be written.
    #[error(transparent)]
    Publish(#[from] PublishError),
    /// A picture cannot be encoded.
    #[error("expected to encode {}, found: {reason}; choose a smaller --width", path.display())]
    Encode {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
}

//! Small vectors and symmetric matrices. This module knows nothing of texels.

pub mod symmetric;
pub(crate) mod vector;

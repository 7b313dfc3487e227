//! Small vectors and symmetric 2 x 2 matrices.

pub mod symmetric;
pub mod vector;

//! The bumps of a relief on the grid of a texture.

use std::cell::OnceCell;

use super::relief::Relief;
use crate::pyramid::{Area, Pyramid, Rows, level_sizes};

/// Level 0 of a relief on a grid, and its moments when they are asked for.
pub struct Bumps<'a> {
    /// Level 0.
    pub rows: Area<&'a Relief>,
    moments: OnceCell<Pyramid<Area<&'a Relief>>>,
}

impl<'a> Bumps<'a> {
    /// `relief` on a grid of `width` x `height` texels.
    pub fn new(relief: &'a Relief, (width, height): (u32, u32)) -> Self {
        Self { rows: Area::new(relief, width, height), moments: OnceCell::new() }
    }

    /// Columns and rows of level 0.
    pub fn size(&self) -> (u32, u32) {
        (self.rows.width(), self.rows.height())
    }

    /// Sizes of all levels, level 0 first.
    pub fn sizes(&self) -> Vec<(u32, u32)> {
        level_sizes(self.rows.width(), self.rows.height())
    }

    /// Means and covariances of all levels, made by the first call.
    pub fn moments(&self) -> &Pyramid<Area<&'a Relief>> {
        self.moments.get_or_init(|| Pyramid::new(self.rows))
    }
}

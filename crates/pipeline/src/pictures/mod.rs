//! `roughcast render`: pictures of materials before and after the bake beside the reference, as files, and the error of
//! each picture.

mod columns;
mod draw;
mod error;
mod folder;
mod gallery;
mod report;

pub use draw::{PictureOptions, draw_pictures};
pub use error::PictureError;
pub use report::{ColumnReport, PicturesReport, RENDER_FORMAT, RowReport, SheetReport};

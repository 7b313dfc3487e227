//! `roughcast render`: pictures of materials before and after the bake beside the reference, as files, and the error of
//! each picture.

mod columns;
mod draw;
mod error;
mod folder;
mod gallery;
mod options;
mod report;
mod row;

pub use draw::draw_pictures;
pub use error::PictureError;
pub use options::PictureOptions;
pub use report::{ColumnReport, PicturesReport, RENDER_FORMAT, RowReport, SheetReport};

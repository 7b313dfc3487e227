//! Pictures as files: a sheet, each picture alone, and the gallery.

use std::path::Path;

use super::error::PictureError;
use crate::codec::encode_png;
use crate::codec::uastc::Effort;
use crate::image::{Image, Samples};
use crate::inspect::encode_exr;
use crate::output::Guard;
use crate::render::{Crop, Panel, Picture, Sheet, Tone};

/// A picture and its presentation.
pub struct Shown<'a> {
    /// The line above the picture.
    pub heading: String,
    /// The picture.
    pub picture: &'a Picture,
    /// The region that is shown enlarged.
    pub crop: Option<Crop>,
    /// The lines below the picture.
    pub labels: Vec<String>,
    /// The tone mapping.
    pub tone: Tone,
}

impl Shown<'_> {
    fn panel(&self) -> Panel<'_> {
        Panel {
            picture: self.picture,
            tone: self.tone,
            heading: self.heading.clone(),
            crop: self.crop,
            labels: self.labels.clone(),
        }
    }
}

/// The output folder.
pub struct Folder<'a> {
    output: &'a Path,
    has_exr: bool,
    guard: Guard,
}

impl<'a> Folder<'a> {
    /// Returns the folder `output`, in which `guard` decides what may be written. If `has_exr`, pictures are also
    /// written as EXR files.
    pub fn new(output: &'a Path, has_exr: bool, guard: Guard) -> Self {
        Self { output, has_exr, guard }
    }

    /// Writes `picture` to a file of its own. Returns its path.
    pub fn write_picture(&mut self, stem: &str, picture: &Picture, tone: &Tone) -> Result<String, PictureError> {
        if self.has_exr {
            let path = self.output.join(format!("{stem}.exr"));
            let [width, height] = picture.size;
            let samples = Samples::F32(picture.pixels.iter().flatten().copied().collect());
            self.write_file(&path, encode_exr(Image { width, height, channels: 3, samples }))?;
        }
        self.write_png(stem, Sheet::from_picture(picture, tone))
    }

    /// Writes a sheet of rows of pictures. Returns its path.
    pub fn write_sheet(
        &mut self,
        stem: &str,
        title: &str,
        subtitle: &str,
        rows: &[Vec<Shown<'_>>],
    ) -> Result<String, PictureError> {
        let rows: Vec<Vec<Panel<'_>>> = rows.iter().map(|row| row.iter().map(Shown::panel).collect()).collect();
        self.write_png(stem, Sheet::from_rows(title, subtitle, &rows))
    }

    /// Writes `text` to the file `name`.
    pub fn write_text(&mut self, name: &str, text: String) -> Result<String, PictureError> {
        self.write_file(&self.output.join(name), Ok(text.into_bytes()))
    }

    fn write_png(&mut self, stem: &str, sheet: Option<Sheet>) -> Result<String, PictureError> {
        let path = self.output.join(format!("{stem}.png"));
        let encoded = match sheet {
            Some(sheet) => encode_png(&sheet.rgba, sheet.width, sheet.height, Effort::Best),
            None => Err("more pixels than a file can hold".to_owned()),
        };
        self.write_file(&path, encoded)
    }

    fn write_file(&mut self, path: &Path, encoded: Result<Vec<u8>, String>) -> Result<String, PictureError> {
        let output = self.guard.reserve_file(path)?;
        let bytes = encoded.map_err(|reason| PictureError::Encode { path: path.to_owned(), reason })?;
        output.write(&bytes)?;
        Ok(path.display().to_string())
    }
}

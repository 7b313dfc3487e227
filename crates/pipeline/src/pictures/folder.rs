//! Pictures as files: a sheet, and each picture alone.

use std::path::Path;

use super::error::PictureError;
use crate::codec::encode_png;
use crate::codec::uastc::Effort;
use crate::image::{Image, Samples};
use crate::inspect::encode_exr;
use crate::output::Guard;
use crate::render::{Panel, Picture, Sheet, Tone};

/// A picture and its presentation.
pub struct Shown {
    /// The name, as in file names.
    pub name: &'static str,
    /// The picture.
    pub picture: Picture,
    /// The lines below the picture.
    pub labels: Vec<String>,
    /// The tone mapping.
    pub tone: Tone,
}

impl Shown {
    fn panel(&self, distance: Option<f64>) -> Panel<'_> {
        let mut labels = self.labels.clone();
        if let (Some(distance), Some(first)) = (distance, labels.first_mut()) {
            *first += &format!(", distance {distance}");
        }
        Panel { picture: &self.picture, tone: self.tone, labels }
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

    /// Writes a sheet of rows, each with its distance where there are several, and every picture. Returns the sheet's
    /// path.
    pub fn write(&mut self, stem: &str, rows: &[(Option<f64>, Vec<Shown>)]) -> Result<String, PictureError> {
        for (distance, row) in rows {
            let distance = distance.map_or(String::new(), |d| format!(".d{d}"));
            for Shown { name, picture, tone, .. } in row {
                let stem = format!("{stem}{distance}.{name}");
                self.write_sheet(&stem, Sheet::from_picture(picture, tone))?;
                if self.has_exr {
                    let path = self.output.join(format!("{stem}.exr"));
                    let [width, height] = picture.size;
                    let samples = Samples::F32(picture.pixels.iter().flatten().copied().collect());
                    let encoded = encode_exr(Image { width, height, channels: 3, samples });
                    self.write_file(&path, encoded)?;
                }
            }
        }
        let sheet: Vec<Vec<Panel<'_>>> =
            rows.iter().map(|(distance, row)| row.iter().map(|shown| shown.panel(*distance)).collect()).collect();
        self.write_sheet(stem, Sheet::from_rows(&sheet))
    }

    fn write_sheet(&mut self, stem: &str, sheet: Option<Sheet>) -> Result<String, PictureError> {
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

//! Pictures as files: a sheet, each picture alone, and the gallery.

use std::path::{Path, PathBuf};

use super::error::PictureError;
use crate::codec::encode_png;
use crate::codec::uastc::Effort;
use crate::image::{Image, Samples};
use crate::inspect::encode_exr;
use crate::output::Guard;
use crate::render::{Crop, Displayed, Panel, Sheet};

/// A picture and its presentation.
pub struct Shown<'a> {
    /// The line above the picture.
    pub heading: String,
    /// The picture.
    pub picture: &'a Displayed,
    /// The region that is shown enlarged.
    pub crop: Option<Crop>,
    /// The lines below the picture.
    pub labels: Vec<String>,
}

impl Shown<'_> {
    fn panel(&self) -> Panel<'_> {
        Panel { picture: self.picture, heading: self.heading.clone(), crop: self.crop, labels: self.labels.clone() }
    }
}

/// A file before it is written.
pub struct EncodedFile {
    path: PathBuf,
    /// Its bytes, or why it cannot be encoded.
    encoded: Result<Vec<u8>, String>,
}

/// The files of one picture.
pub struct PictureFiles {
    png: EncodedFile,
    exr: Option<EncodedFile>,
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

    /// Encodes a picture as files of its own.
    pub fn encode_picture(&self, stem: &str, displayed: &Displayed) -> PictureFiles {
        let exr = self.has_exr.then(|| {
            let [width, height] = displayed.picture.size;
            let samples = Samples::F32(displayed.picture.pixels.iter().flatten().copied().collect());
            self.file(stem, "exr", encode_exr(Image { width, height, channels: 3, samples }))
        });
        PictureFiles { exr, png: self.png(stem, Sheet::from_picture(displayed)) }
    }

    /// Encodes a sheet of rows of pictures.
    pub fn encode_sheet(&self, stem: &str, title: &str, subtitle: &str, rows: &[Vec<Shown<'_>>]) -> EncodedFile {
        let rows: Vec<Vec<Panel<'_>>> = rows.iter().map(|row| row.iter().map(Shown::panel).collect()).collect();
        self.png(stem, Sheet::from_rows(title, subtitle, &rows))
    }

    fn png(&self, stem: &str, sheet: Option<Sheet>) -> EncodedFile {
        let encoded = match sheet {
            Some(sheet) => encode_png(&sheet.rgba, sheet.width, sheet.height, Effort::Best),
            None => Err("more pixels than a file can hold".to_owned()),
        };
        self.file(stem, "png", encoded)
    }

    fn file(&self, stem: &str, extension: &str, encoded: Result<Vec<u8>, String>) -> EncodedFile {
        EncodedFile { path: self.output.join(format!("{stem}.{extension}")), encoded }
    }

    /// Writes the files of a picture. Returns the path of the PNG file.
    pub fn write_picture(&mut self, files: PictureFiles) -> Result<String, PictureError> {
        files.exr.map(|exr| self.write(exr)).transpose()?;
        self.write(files.png)
    }

    /// Writes `text` to the file `name`.
    pub fn write_text(&mut self, name: &str, text: String) -> Result<String, PictureError> {
        self.write(EncodedFile { path: self.output.join(name), encoded: Ok(text.into_bytes()) })
    }

    /// Writes a file. Returns its path.
    pub fn write(&mut self, EncodedFile { path, encoded }: EncodedFile) -> Result<String, PictureError> {
        let output = self.guard.reserve_file(&path)?;
        let bytes = encoded.map_err(|reason| PictureError::Encode { path: path.clone(), reason })?;
        output.write(&bytes)?;
        Ok(path.display().to_string())
    }
}

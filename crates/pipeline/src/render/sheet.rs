//! Contact sheets: pictures in rows and columns, each with a line of text below it.

use super::draw::Picture;
use super::font;
use super::tone::Tone;

/// A labelled picture on a sheet.
pub struct Panel<'a> {
    /// The picture.
    pub picture: &'a Picture,
    /// Its tone mapping.
    pub tone: Tone,
    /// Lines of text below the picture.
    pub labels: Vec<String>,
}

/// An image of opaque RGBA8 pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Rows top to bottom.
    pub rgba: Vec<u8>,
}

/// Pixels between lines, and between panels.
const LEADING: u32 = 4;
/// Pixels between panels.
const GAP: u32 = 6;
const PAPER: u8 = 250;
const INK: u8 = 40;

impl Sheet {
    /// Makes a blank sheet. Returns `None` if it would have no pixels, or more than a file can address.
    fn new(width: u32, height: u32) -> Option<Self> {
        let bytes = width.checked_mul(height)?.checked_mul(4).filter(|b| *b > 0)?;
        let mut rgba = vec![PAPER; bytes as usize];
        rgba.iter_mut().skip(3).step_by(4).for_each(|a| *a = 255);
        Some(Self { width, height, rgba })
    }

    /// Makes a sheet of one picture without a label. Returns `None` if the picture has no pixels.
    pub fn from_picture(picture: &Picture, tone: &Tone) -> Option<Self> {
        let mut sheet = Self::new(picture.size[0], picture.size[1])?;
        sheet.place(picture, tone, 0, 0);
        Some(sheet)
    }

    /// Makes a sheet of `rows` of panels of equal size. Returns `None` if there are no panels.
    pub fn from_rows(rows: &[Vec<Panel<'_>>]) -> Option<Self> {
        let columns = rows.iter().map(Vec::len).max()? as u32;
        let [width, height] = rows.first()?.first()?.picture.size;
        let lines = rows.iter().flatten().map(|panel| panel.labels.len()).max()? as u32;
        let line = font::LINE + LEADING;
        let row_height = height + lines * line + GAP;
        let mut sheet = Self::new(
            columns.checked_mul(width + GAP)?.saturating_sub(GAP),
            row_height.checked_mul(rows.len() as u32)?,
        )?;
        for (y, row) in (0..).map(|r| r * row_height).zip(rows) {
            for (x, panel) in (0..).map(|c| c * (width + GAP)).zip(row) {
                sheet.place(panel.picture, &panel.tone, x, y);
                for (below, label) in (0..).zip(&panel.labels) {
                    sheet.write(label, x, y + height + LEADING + below * line, width);
                }
            }
        }
        Some(sheet)
    }

    fn place(&mut self, picture: &Picture, tone: &Tone, left: u32, top: u32) {
        let width = picture.size[0];
        for (i, pixel) in (0..).zip(&picture.pixels) {
            let shown = tone.displayed(*pixel).map(|c| (c * 255.0).round() as u8);
            self.set(left + i % width, top + i / width, shown);
        }
    }

    /// Writes as much of `text` as fits into `width` pixels.
    fn write(&mut self, text: &str, left: u32, top: u32, width: u32) {
        font::draw(text, width, |x, y, coverage| {
            let shade = f32::from(PAPER) + coverage * (f32::from(INK) - f32::from(PAPER));
            self.set(left + x, top + y, [shade.round() as u8; 3]);
        });
    }

    fn set(&mut self, x: u32, y: u32, [r, g, b]: [u8; 3]) {
        if x < self.width && y < self.height {
            let at = (y as usize * self.width as usize + x as usize) * 4;
            if let Some(pixel) = self.rgba.get_mut(at..at + 3) {
                pixel.copy_from_slice(&[r, g, b]);
            }
        }
    }
}

//! Contact sheets: pictures in rows and columns below a title, each with its heading, an enlarged region and lines of
//! text.

use super::crop::{Crop, MAGNIFICATION};
use super::displayed::Displayed;
use super::font;

/// A labelled picture on a sheet.
pub struct Panel<'a> {
    /// The picture.
    pub picture: &'a Displayed,
    /// The line of text above the picture.
    pub heading: String,
    /// The region that is framed, and shown enlarged below the picture.
    pub crop: Option<Crop>,
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

/// Height of a line of labels with the space to the next line.
const LINE: u32 = font::LABEL + 4;
/// Pixels between panels, and around them.
const GAP: u32 = 8;
const PAPER: [u8; 3] = [250; 3];
const INK: [u8; 3] = [40; 3];
/// The frame of an enlarged region, which is told from every grey.
const FRAME: [u8; 3] = [255, 176, 0];

impl Sheet {
    /// Makes a blank sheet. Returns `None` if it would have no pixels, or more than a file can address.
    fn new(width: u32, height: u32) -> Option<Self> {
        let bytes = width.checked_mul(height)?.checked_mul(4).filter(|b| *b > 0)?;
        let mut rgba = vec![255; bytes as usize];
        rgba.chunks_exact_mut(4).for_each(|pixel| pixel[..3].copy_from_slice(&PAPER));
        Some(Self { width, height, rgba })
    }

    /// Makes a sheet of one picture without a label. Returns `None` if the picture has no pixels.
    pub fn from_picture(displayed: &Displayed) -> Option<Self> {
        let [width, height] = displayed.picture.size;
        let mut sheet = Self::new(width, height)?;
        sheet.place(displayed, [0, 0]);
        Some(sheet)
    }

    /// Makes a sheet of `rows` of panels of equal size below a title and a line of text. Columns are as wide as their
    /// pictures and texts. Returns `None` if there are no panels, or more pixels than a file can address.
    pub fn from_rows(title: &str, subtitle: &str, rows: &[Vec<Panel<'_>>]) -> Option<Self> {
        let panels = || rows.iter().flatten();
        let columns = rows.iter().map(Vec::len).max()? as u32;
        let [picture_width, height] = rows.first()?.first()?.picture.picture.size;
        let texts = panels().flat_map(|panel| panel.labels.iter().chain([&panel.heading]));
        let width = texts.map(|text| font::width(text, font::LABEL)).max()?.max(picture_width);
        let lines = panels().map(|panel| panel.labels.len()).max()? as u32;
        let enlarged = panels().filter_map(|panel| panel.crop).map(|crop| crop.height * MAGNIFICATION + GAP / 2).max();
        let header = GAP + font::TITLE + GAP / 2 + LINE;
        let row_height = GAP + LINE + height + enlarged.unwrap_or(0) + GAP / 2 + lines * LINE;
        let title_width = font::width(title, font::TITLE).max(font::width(subtitle, font::LABEL));
        let text_width = columns.checked_mul(width.checked_add(GAP)?)?.checked_sub(GAP)?.max(title_width);
        let mut sheet = Self::new(
            text_width.checked_add(2 * GAP)?,
            row_height.checked_mul(rows.len() as u32)?.checked_add(header + GAP)?,
        )?;
        sheet.write(title, font::TITLE, [GAP, GAP], text_width);
        sheet.write(subtitle, font::LABEL, [GAP, GAP + font::TITLE + GAP / 2], text_width);
        for (row, panels) in (0..).zip(rows) {
            for (column, panel) in (0..).zip(panels) {
                sheet.draw(panel, [GAP + column * (width + GAP), header + row * row_height + GAP], width);
            }
        }
        Some(sheet)
    }

    /// Draws `panel` at (`left`, `top`), with texts of at most `width` pixels.
    fn draw(&mut self, panel: &Panel<'_>, [left, top]: [u32; 2], width: u32) {
        let [_, height] = panel.picture.picture.size;
        self.write(&panel.heading, font::LABEL, [left, top], width);
        let mut below = top + LINE;
        self.place(panel.picture, [left, below]);
        if let Some(crop) = panel.crop {
            self.frame(&crop, [left, below]);
        }
        below += height + GAP / 2;
        if let Some(crop) = panel.crop {
            self.enlarge(panel, &crop, [left, below]);
            below += crop.height * MAGNIFICATION + GAP / 2;
        }
        for (line, label) in (0..).zip(&panel.labels) {
            self.write(label, font::LABEL, [left, below + line * LINE], width);
        }
    }

    fn place(&mut self, displayed: &Displayed, [left, top]: [u32; 2]) {
        let [width, height] = displayed.picture.size;
        for i in 0..width * height {
            self.set([left + i % width, top + i / width], displayed.bytes(i as usize));
        }
    }

    /// Draws the frame of `crop` on the picture at (`left`, `top`), just outside of the region where there is space.
    fn frame(&mut self, crop: &Crop, [left, top]: [u32; 2]) {
        let [first_x, first_y] = [left + crop.left.saturating_sub(1), top + crop.top.saturating_sub(1)];
        let [last_x, last_y] = [left + crop.left + crop.width, top + crop.top + crop.height];
        for x in first_x..=last_x {
            [first_y, last_y].iter().for_each(|y| self.set([x, *y], FRAME));
        }
        for y in first_y..=last_y {
            [first_x, last_x].iter().for_each(|x| self.set([*x, y], FRAME));
        }
    }

    /// Draws the pixels of `crop` as squares.
    fn enlarge(&mut self, panel: &Panel<'_>, crop: &Crop, [left, top]: [u32; 2]) {
        for y in 0..crop.height * MAGNIFICATION {
            for x in 0..crop.width * MAGNIFICATION {
                let [column, row] = [crop.left + x / MAGNIFICATION, crop.top + y / MAGNIFICATION];
                let at = row as usize * panel.picture.picture.size[0] as usize + column as usize;
                self.set([left + x, top + y], panel.picture.bytes(at));
            }
        }
    }

    /// Writes as much of `text` as fits into `width` pixels.
    fn write(&mut self, text: &str, height: u32, [left, top]: [u32; 2], width: u32) {
        font::draw(text, height, width, |x, y, coverage| {
            let shade = f32::from(PAPER[0]) + coverage * (f32::from(INK[0]) - f32::from(PAPER[0]));
            self.set([left + x, top + y], [shade.round() as u8; 3]);
        });
    }

    fn set(&mut self, [x, y]: [u32; 2], rgb: [u8; 3]) {
        if x < self.width && y < self.height {
            let at = (y as usize * self.width as usize + x as usize) * 4;
            if let Some(pixel) = self.rgba.get_mut(at..at + 3) {
                pixel.copy_from_slice(&rgb);
            }
        }
    }
}

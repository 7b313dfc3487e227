//! Text on pictures, in the font Hack.

use ab_glyph::{Font, FontRef, ScaleFont, point};
use epaint_default_fonts::HACK_REGULAR;

/// Height of a line of labels in pixels, from the highest to the lowest letter. Letters are 7.8 pixels wide.
pub const LABEL: u32 = 15;
/// Height of a title in pixels. Letters are 11.4 pixels wide.
pub const TITLE: u32 = 22;

/// Returns how many pixels wide `text` is in letters that are `height` pixels high.
pub fn width(text: &str, height: u32) -> u32 {
    let Ok(font) = FontRef::try_from_slice(HACK_REGULAR) else { return 0 };
    let font = font.as_scaled(height as f32);
    text.chars().map(|letter| font.h_advance(font.glyph_id(letter))).sum::<f32>().ceil() as u32
}

/// Calls `ink` with each pixel of `text` that has ink, and the share of the pixel that the ink covers. Letters are
/// `height` pixels high. The text begins at the origin and ends before the letter that would need more than `width`
/// pixels.
pub fn draw(text: &str, height: u32, width: u32, mut ink: impl FnMut(u32, u32, f32)) {
    // The font is a constant that can be read, as the tests of sheets show.
    let Ok(font) = FontRef::try_from_slice(HACK_REGULAR) else { return };
    let font = font.as_scaled(height as f32);
    let mut left = 0.0;
    for letter in text.chars() {
        let mut glyph = font.scaled_glyph(letter);
        let advance = font.h_advance(glyph.id);
        if left + advance > width as f32 {
            return;
        }
        glyph.position = point(left, font.ascent());
        left += advance;
        let Some(outline) = font.outline_glyph(glyph) else { continue };
        // Outlines may begin left of the origin or above it.
        let [first_x, first_y] = [outline.px_bounds().min.x, outline.px_bounds().min.y].map(|c| c as i64);
        outline.draw(|x, y, coverage| {
            let at = [first_x + i64::from(x), first_y + i64::from(y)].map(u32::try_from);
            if let [Ok(x), Ok(y)] = at {
                ink(x, y, coverage.clamp(0.0, 1.0));
            }
        });
    }
}

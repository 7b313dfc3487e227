//! Panels side by side.

use std::error::Error;
use std::path::Path;

use roughcast::codec::encode_png;
use roughcast::codec::uastc::Effort;
use roughcast::output::Guard;

const GAP: u32 = 8;

/// Square panels with white between them.
pub struct Canvas {
    side: u32,
    width: u32,
    rgba: Vec<u8>,
}

impl Canvas {
    /// Makes `panels` panels of `side` x `side` pixels.
    pub fn new(panels: u32, side: u32) -> Self {
        let width = panels * (side + GAP) - GAP;
        Self { side, width, rgba: vec![255; (4 * width * side) as usize] }
    }

    /// Colours a panel. `colour` takes a point of the unit square, y down, and returns red, green and blue in [0, 1].
    pub fn fill(&mut self, panel: usize, colour: impl Fn([f64; 2]) -> [f64; 3]) {
        let left = panel as u32 * (self.side + GAP);
        for i in 0..self.side * self.side {
            let (x, y) = (i % self.side, i / self.side);
            let point = [x, y].map(|c| (f64::from(c) + 0.5) / f64::from(self.side));
            let at = 4 * (y * self.width + left + x) as usize;
            for (byte, value) in self.rgba[at..].iter_mut().zip(colour(point)) {
                *byte = (255.0 * value.clamp(0.0, 1.0)).round() as u8;
            }
        }
    }
}

/// Writes the canvas to a file of `folder`.
pub fn write(folder: &Path, name: &str, canvas: Canvas) -> Result<(), Box<dyn Error>> {
    let png = encode_png(&canvas.rgba, canvas.width, canvas.side, Effort::Best)?;
    Guard::default().reserve_file(&folder.join(name))?.write(&png)?;
    println!("\n{name}");
    Ok(())
}

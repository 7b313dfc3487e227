//! Maps of any size, row by row: tiles of real maps, rotated and mirrored so that no two neighbours are equal.
//!
//! zstd would find plain repetition, which would favour every tool that compresses.

use std::path::Path;

use roughcast::decode::decode;
use roughcast::image::{DecodeOptions, Image};

use crate::{Failure, common};

/// Normal maps of about 1024 x 1024 texels: fibres, grain, edges.
const REAL: [&str; 3] = ["wool_normal.png", "sand_normal.jpg", "texture_bricks_normal.jpg"];
/// Side of a tile of real maps. Smaller maps repeat within the tile.
const REAL_SIDE: usize = 1024;
/// Side of a tile of synthetic maps.
const SYNTHETIC_SIDE: usize = 2048;
/// Ways to rotate and mirror a square.
const SYMMETRIES: usize = 8;

/// A texel of 8 bits.
type Texel = [u8; 3];

/// A plane of tiles.
pub struct Mosaic {
    side: usize,
    tiles: Vec<Vec<Texel>>,
    /// Whether texels rotate with their tile, as normals do.
    rotates: bool,
}

impl Mosaic {
    /// Makes a plane of the normal maps in the folder `data`, or of a synthetic map without that folder.
    ///
    /// # Errors
    /// When a map of `data` cannot be read.
    pub fn normals(data: Option<&Path>) -> Result<Self, Failure> {
        let Some(data) = data else { return Ok(Self::synthetic(common::maps::normals, true)) };
        let tile = |name: &&str| -> Result<Vec<Texel>, Failure> {
            let image = decode(&std::fs::read(data.join(name))?, &DecodeOptions::default())?;
            Ok((0..REAL_SIDE * REAL_SIDE).map(|i| texel(&image, i % REAL_SIDE, i / REAL_SIDE)).collect())
        };
        let tiles = REAL.iter().map(tile).collect::<Result<_, _>>()?;
        Ok(Self { side: REAL_SIDE, tiles, rotates: true })
    }

    /// Makes a plane of occlusion 1, roughness of about 0.45 and metal 0.
    pub fn surface() -> Self {
        Self::synthetic(common::maps::surface, false)
    }

    fn synthetic(map: fn(usize) -> Vec<u8>, rotates: bool) -> Self {
        Self { side: SYNTHETIC_SIDE, tiles: vec![map(SYNTHETIC_SIDE).as_chunks::<3>().0.to_vec()], rotates }
    }

    /// Rerotates row `y` of the plane.
    pub fn row(&self, y: usize, out: &mut [Texel]) {
        let (down, y) = (y / self.side, y % self.side);
        for (across, out) in out.chunks_mut(self.side).enumerate() {
            // Kinds of tiles differ by five from row to row and by one from column to column.
            let kind = (across + 5 * down) % (SYMMETRIES * self.tiles.len());
            let (tile, symmetry) = (&self.tiles[kind % self.tiles.len()], kind / self.tiles.len());
            for (x, out) in out.iter_mut().enumerate() {
                let (column, row) = rotated(x, y, self.side, symmetry);
                let texel = tile[row * self.side + column];
                *out = if self.rotates { rotated_normal(texel, symmetry) } else { texel };
            }
        }
    }
}

/// Rerotates RGB of a texel of an image that repeats.
fn texel(image: &Image, x: usize, y: usize) -> Texel {
    let (x, y) = (x as u32 % image.width, y as u32 % image.height);
    [0, 1, 2].map(|c| (image.sample(x, y, c).unwrap_or(0.0) * 255.0 + 0.5) as u8)
}

/// Rerotates the source texel of a texel in a rotated tile: bit 0 mirrors columns, bit 1 mirrors rows, and bit 2 then
/// swaps the two.
fn rotated(x: usize, y: usize, side: usize, symmetry: usize) -> (usize, usize) {
    let x = if symmetry & 1 == 0 { x } else { side - 1 - x };
    let y = if symmetry & 2 == 0 { y } else { side - 1 - y };
    if symmetry & 4 == 0 { (x, y) } else { (y, x) }
}

/// Rotates the normal with its tile; y points up the image.
fn rotated_normal([x, y, z]: Texel, symmetry: usize) -> Texel {
    let (x, y) = if symmetry & 4 == 0 { (x, y) } else { (255 - y, 255 - x) };
    let x = if symmetry & 1 == 0 { x } else { 255 - x };
    let y = if symmetry & 2 == 0 { y } else { 255 - y };
    [x, y, z]
}

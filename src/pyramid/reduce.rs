//! The next coarser level: area-weighted boxes of 2 taps for even sizes, 3 for odd ones (polyphase boxes).

use rayon::prelude::*;

use super::{Merge, Rows};

/// Texels under one coarser texel along one axis: at most 3.
const MAX_TAPS: usize = 3;

/// One level of a pyramid, rows top to bottom.
#[derive(Clone, Debug, PartialEq)]
pub struct Level<T> {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width * height` texels.
    pub texels: Vec<T>,
}

impl<T: Merge> Rows for Level<T> {
    type Texel = T;

    fn width(&self) -> u32 {
        self.width
    }

    fn height(&self) -> u32 {
        self.height
    }

    fn row(&self, y: u32, out: &mut [T]) {
        let width = self.width as usize;
        out.copy_from_slice(&self.texels[y as usize * width..][..width]);
    }
}

/// Size of the next coarser level along one axis: max(1, n / 2), as OpenGL, Vulkan and WebGPU define mip chains.
pub fn level_size(size: u32) -> u32 {
    (size / 2).max(1)
}

/// Sizes of all levels of a full chain, level 0 first, down to 1 x 1.
pub fn level_sizes(width: u32, height: u32) -> Vec<(u32, u32)> {
    let mut sizes = vec![(width, height)];
    let mut last = (width, height);
    while last != (1, 1) {
        last = (level_size(last.0), level_size(last.1));
        sizes.push(last);
    }
    sizes
}

/// Levels 1 and coarser over `source`, which is level 0; empty for a source of 1 x 1.
pub fn build<R: Rows>(source: &R) -> Vec<Level<R::Texel>> {
    let mut levels: Vec<Level<R::Texel>> = Vec::new();
    for (width, height) in level_sizes(source.width(), source.height()).into_iter().skip(1) {
        let level = match levels.last() {
            None => reduce(source, width, height),
            Some(finer) => reduce(finer, width, height),
        };
        levels.push(level);
    }
    levels
}

fn reduce<R: Rows>(finer: &R, width: u32, height: u32) -> Level<R::Texel> {
    let fine_width = finer.width() as usize;
    let mut texels = vec![R::Texel::default(); width as usize * height as usize];
    texels.par_chunks_mut(width as usize).enumerate().for_each_init(
        || vec![R::Texel::default(); fine_width * MAX_TAPS],
        |rows, (y, out)| {
            let down = Taps::new(finer.height(), y as u32);
            for (tap, row) in rows.chunks_exact_mut(fine_width).enumerate().take(down.count) {
                finer.row(down.first + tap as u32, row);
            }
            reduce_row(rows, fine_width, &down, out);
        },
    );
    Level { width, height, texels }
}

/// `rows` holds the finer rows under this row, one after another; `out` the coarser texels.
fn reduce_row<T: Merge>(rows: &[T], fine_width: usize, down: &Taps, out: &mut [T]) {
    let mut weights = [0.0; MAX_TAPS * MAX_TAPS];
    let mut parts = [T::default(); MAX_TAPS * MAX_TAPS];
    for (x, texel) in out.iter_mut().enumerate() {
        let across = Taps::new(fine_width as u32, x as u32);
        let mut count = 0;
        for tap_y in 0..down.count {
            let row = &rows[tap_y * fine_width..][..fine_width];
            for tap_x in 0..across.count {
                weights[count] = down.weights[tap_y] * across.weights[tap_x];
                parts[count] = row[across.first as usize + tap_x];
                count += 1;
            }
        }
        *texel = T::merge(&weights[..count], &parts[..count]);
    }
}

/// The finer texels under one coarser texel along one axis.
struct Taps {
    first: u32,
    count: usize,
    weights: [f32; MAX_TAPS],
}

impl Taps {
    /// Coarser texel `i` of an axis of `size` finer texels covers [i, i + 1) * size / level_size(size).
    fn new(size: u32, i: u32) -> Self {
        match (size, size % 2) {
            (1, _) => Self { first: 0, count: 1, weights: [1.0, 0.0, 0.0] },
            (_, 0) => Self { first: 2 * i, count: 2, weights: [0.5, 0.5, 0.0] },
            // size = 2m + 1: the areas (m - i), m, (i + 1) over size (S. Guthe, P. Heckbert, "Non-power-of-two
            // mipmap creation", 2005).
            _ => {
                let (m, n) = ((size / 2) as f32, size as f32);
                Self { first: 2 * i, count: 3, weights: [(m - i as f32) / n, m / n, (i as f32 + 1.0) / n] }
            }
        }
    }
}

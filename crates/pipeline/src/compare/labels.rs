//! Positions for labels, so that no label hides another.

/// Distance between lines of labels.
pub const LINE: f64 = 12.5;

/// Returns heights that are at least [`LINE`] apart, between `top` and `bottom`, and as near as possible to the heights
/// `wanted`, which rise: the least squares under that constraint, by pooling adjacent violators.
pub fn stack(wanted: &[f64], [top, bottom]: [f64; 2]) -> Vec<f64> {
    // Sum and number of the labels of each block, without the distances between them.
    let mut blocks: Vec<(f64, usize)> = Vec::new();
    let mean = |(sum, count): (f64, usize)| sum / count as f64;
    for (i, y) in wanted.iter().enumerate() {
        let mut block = (y - i as f64 * LINE, 1);
        while let Some(above) = blocks.pop_if(|above| mean(*above) >= mean(block)) {
            block = (block.0 + above.0, block.1 + above.1);
        }
        blocks.push(block);
    }
    let lowest = (bottom - wanted.len().saturating_sub(1) as f64 * LINE).max(top);
    let first = blocks.into_iter().flat_map(|block| std::iter::repeat_n(mean(block).clamp(top, lowest), block.1));
    first.enumerate().map(|(i, y)| y + i as f64 * LINE).collect()
}

/// The areas of a chart that are already in use.
pub struct Labels {
    bounds: [f64; 4],
    boxes: Vec<[f64; 4]>,
}

/// Least distance between labels side by side.
const GAP: f64 = 6.0;

/// Estimates the width of `text` in a wide sans-serif font of 11 pixels.
pub fn width(text: &str) -> f64 {
    6.4 * text.chars().count() as f64
}

impl Labels {
    /// Allows labels inside `bounds` (left, top, right, bottom), but not on any of `points`.
    pub fn new(bounds: [f64; 4], points: impl Iterator<Item = [f64; 2]>) -> Self {
        let boxes = points.map(|[x, y]| [x - 4.5, y - 4.5, x + 4.5, y + 4.5]).collect();
        Self { bounds, boxes }
    }

    /// Keeps labels off `area` (left, top, right, bottom).
    pub fn avoid(&mut self, area: [f64; 4]) {
        self.boxes.push(area);
    }

    /// Returns the left end and the vertical middle of the label of a point: beside the point, or at the nearest free
    /// position above or below.
    pub fn place(&mut self, [x, y]: [f64; 2], text: &str) -> [f64; 2] {
        let w = width(text);
        let offsets = (0..30).flat_map(|i| {
            let dy = 0.5 * LINE * f64::from(i);
            [[12.0, dy], [12.0, -dy], [-12.0 - w, dy], [-12.0 - w, -dy]]
        });
        let area = |[dx, dy]: [f64; 2]| [x + dx, y + dy - 0.5 * LINE, x + dx + w, y + dy + 0.5 * LINE];
        let with_gap = |[left, top, right, bottom]: [f64; 4]| [left - GAP, top, right + GAP, bottom];
        let [left, top, right, bottom] = self.bounds;
        let inside = |b: &[f64; 4]| b[0] >= left && b[1] >= top && b[2] <= right && b[3] <= bottom;
        let apart = |b: &[f64; 4], o: &[f64; 4]| b[2] <= o[0] || o[2] <= b[0] || b[3] <= o[1] || o[3] <= b[1];
        let free = |b: &[f64; 4]| inside(b) && self.boxes.iter().all(|o| apart(b, o));
        let found = offsets.map(area).find(free).unwrap_or_else(|| area([12.0, 0.0]));
        self.boxes.push(with_gap(found));
        [found[0], 0.5 * (found[1] + found[3])]
    }
}

//! Level 0 as samplers magnify it. Between the centres of texels an engine shows interpolated normals, which differ
//! less than the texels do: on noisy maps their slopes have 0.34 to 0.68 of the variance.

use std::array::from_fn;

use fearless_simd::{Simd, SimdBase};

use crate::lobe::{OrientedLobe, SquaredAlpha, frame};
use crate::math::symmetric::Symmetric2;
use crate::math::vector::dot;
use crate::mip::{TexelRows, Wrap};
use crate::simd::{LANES, Real, Wide, dispatch};

/// The texels of a level 0 with what a sampler interpolates within their areas: each texel becomes the lobe about its
/// mean normal, widened by twice the covariance of the slopes about that normal.
///
/// A texel is represented by four points at a distance of 1/2 - 1/sqrt 12 from its centre along both axes. These are
/// the nodes of the Gauss-Legendre rule with two points on each cell between four texel centres (M. Abramowitz, I.
/// Stegun, "Handbook of mathematical functions", 1964, 25.4.30), where the mean square of an interpolated value is
/// exact.
pub struct Magnified<'r, R> {
    /// Level 0.
    pub source: &'r R,
    /// The sampler's mode, across and down; `None` if the texels themselves count.
    pub wrap: Option<[Wrap; 2]>,
    /// Whether all texels have one alpha in all directions.
    pub is_isotropic: bool,
}

/// The share of the neighbour at a node, along each axis: 1/2 - 1/sqrt 12.
const SHARE: f32 = 0.211_324_87;

impl<R: TexelRows<Texel = OrientedLobe>> TexelRows for Magnified<'_, R> {
    type Texel = OrientedLobe;

    fn width(&self) -> u32 {
        self.source.width()
    }

    fn height(&self) -> u32 {
        self.source.height()
    }

    fn row(&self, y: u32, out: &mut [OrientedLobe]) {
        self.rows(y, out);
    }

    fn rows(&self, first: u32, out: &mut [OrientedLobe]) {
        match self.wrap {
            None => self.source.rows(first, out),
            Some(wrap) if self.is_isotropic => self.widened_rows::<ISOTROPIC>(wrap, first, out),
            Some(wrap) => self.widened_rows::<ANISOTROPIC>(wrap, first, out),
        }
    }
}

impl<R: TexelRows<Texel = OrientedLobe>> Magnified<'_, R> {
    fn widened_rows<const N: usize>(&self, [across, down]: [Wrap; 2], first: u32, out: &mut [OrientedLobe]) {
        let (width, height) = (self.width() as usize, self.height());
        let mut rows: [Row<N>; 3] = from_fn(|_| Row::new(width));
        for (y, out) in (first..).zip(out.chunks_exact_mut(width)) {
            let [before, after] = neighbours(y, height, down);
            let mut read = |y, row: &mut Row<N>| {
                self.source.row(y, out);
                row.read(out, across);
            };
            let [above, centre, below] = &mut rows;
            if y == first {
                read(before, above);
                read(y, centre);
            }
            read(after, below);
            dispatch!(fearless_simd::Level::new(), simd => widened_row(simd, &rows, out));
            rows.rotate_left(1);
        }
    }
}

/// Returns the texels before and after `i` on an axis of `size` texels. One texel beyond the border, a mirrored map
/// equals a clamped one.
fn neighbours(i: u32, size: u32, wrap: Wrap) -> [u32; 2] {
    match wrap {
        Wrap::Repeat => [i.checked_sub(1).unwrap_or(size - 1), if i + 1 < size { i + 1 } else { 0 }],
        Wrap::Mirror | Wrap::Clamp => [i.saturating_sub(1), (i + 1).min(size - 1)],
    }
}

/// What a sampler interpolates of an anisotropic lobe: the normal and, for the squared alphas uu and vv, the roughness,
/// which is the fourth root. Engines interpolate the direction and the strength of an anisotropy; here uv is
/// interpolated, which differs little between neighbours.
const ANISOTROPIC: usize = 6;
/// The numbers of an isotropic lobe: the normal and one roughness.
const ISOTROPIC: usize = 4;

/// A row of level 0 by number: [`ISOTROPIC`] or [`ANISOTROPIC`] numbers for each texel.
struct Row<const N: usize> {
    /// The texels. Before the first texel stands its neighbour; after the last texel stands its neighbour, repeated to
    /// fill a vector.
    texels: [Vec<f32>; N],
    /// The points to the left and to the right of the centre of each texel.
    sides: [[Vec<f32>; N]; 2],
}

impl<const N: usize> Row<N> {
    /// Returns room for a row of `width` texels.
    fn new(width: usize) -> Self {
        let whole = width.next_multiple_of(LANES);
        let numbers = |length| from_fn(|_| vec![0.0; length]);
        Self { texels: numbers(whole + 2), sides: from_fn(|_| numbers(whole)) }
    }

    fn read(&mut self, lobes: &[OrientedLobe], wrap: Wrap) {
        let last = lobes.len() as u32 - 1;
        let [before, _] = neighbours(0, last + 1, wrap);
        let [_, after] = neighbours(last, last + 1, wrap);
        self.write(0, &lobes[before as usize..][..1]);
        self.write(1, lobes);
        for i in lobes.len() + 1..self.texels[0].len() {
            self.write(i, &lobes[after as usize..][..1]);
        }
        dispatch!(fearless_simd::Level::new(), _simd => self.interpolate());
    }

    /// Writes the numbers of `lobes` from place `first` on.
    fn write(&mut self, first: usize, lobes: &[OrientedLobe]) {
        let mut texels = self.texels.each_mut().map(|numbers| &mut numbers[first..][..lobes.len()]);
        for (i, OrientedLobe { normal: [x, y, z], squared_alpha: SquaredAlpha(a) }) in lobes.iter().enumerate() {
            // An isotropic lobe has the first numbers only.
            for (texels, number) in texels.iter_mut().zip([*x, *y, *z, a.uu, a.uv, a.vv]) {
                texels[i] = number;
            }
        }
    }

    #[inline(always)]
    fn interpolate(&mut self) {
        for i in (3..N).step_by(2) {
            self.texels[i].iter_mut().for_each(|a| *a = a.sqrt().sqrt());
        }
        let [left, right] = &mut self.sides;
        for ((left, right), texels) in left.iter_mut().zip(right).zip(&self.texels) {
            let (before, texel, after) = (&texels[..left.len()], &texels[1..], &texels[2..]);
            for i in 0..left.len() {
                let centre = (1.0 - SHARE) * texel[i];
                left[i] = centre + SHARE * before[i];
                right[i] = centre + SHARE * after[i];
            }
        }
    }
}

#[inline(always)]
fn widened_row<S: Simd, const N: usize>(simd: S, rows: &[Row<N>; 3], out: &mut [OrientedLobe]) {
    let zero = Wide::splat(simd, 0.0);
    for (chunk, out) in out.chunks_mut(LANES).enumerate() {
        let mut columns = [[[zero; N]; 2]; 3];
        for (column, row) in columns.iter_mut().zip(rows) {
            for (point, side) in column.iter_mut().zip(&row.sides) {
                for (number, numbers) in point.iter_mut().zip(side) {
                    *number = Wide::from_slice(simd, &numbers[chunk * LANES..][..LANES]);
                }
            }
        }
        let [x, y, z, uu, uv, vv] = widened(&columns);
        let [x, y, z, uu, uv, vv]: [[f32; LANES]; 6] = [x.into(), y.into(), z.into(), uu.into(), uv.into(), vv.into()];
        for (lane, lobe) in out.iter_mut().enumerate() {
            let squared_alpha = SquaredAlpha(Symmetric2::new(uu[lane], uv[lane], vv[lane]));
            *lobe = OrientedLobe { normal: [x[lane], y[lane], z[lane]], squared_alpha };
        }
    }
}

/// Returns the numbers of the lobe of a texel: its mean normal, and the squared alphas of its mean roughness, widened
/// by twice the covariance of the slopes. `columns` are the points to the left and to the right of the centre of the
/// texel before, of the texel, and of the texel after, down the image.
#[inline(always)]
fn widened<F: Real, const N: usize>(columns: &[[[F; N]; 2]; 3]) -> [F; 6] {
    let zero = columns[0][0][0].splat_like(0.0);
    let (near, far) = (zero.splat_like(1.0 - SHARE), zero.splat_like(SHARE));
    let quarter = zero.splat_like(0.25);
    let (mut nodes, mut mean) = ([[zero; N]; 4], [zero; N]);
    for i in 0..N {
        for side in 0..2 {
            let centre = near * columns[1][side][i];
            nodes[side][i] = centre + far * columns[0][side][i];
            nodes[2 + side][i] = centre + far * columns[2][side][i];
        }
        mean[i] = (nodes[0][i] + nodes[1][i] + (nodes[2][i] + nodes[3][i])) * quarter;
    }
    let (x, y, z, u) = (mean[0], mean[1], mean[2], mean[3]);
    let (uv, v) = if N == ANISOTROPIC { (mean[N - 2], mean[N - 1]) } else { (zero, u) };
    let length = (x * x + y * y + z * z).sqrt();
    let axes = frame([x / length, y / length, z / length]);
    let (mut sums, mut products) = ([zero; 2], [zero; 3]);
    for node in &nodes {
        let normal = [node[0], node[1], node[2]];
        let scale = zero.splat_like(1.0) / dot(axes[2], normal).max(zero.splat_like(LEAST_COSINE));
        let (s, t) = (dot(axes[0], normal) * scale, dot(axes[1], normal) * scale);
        sums = [sums[0] + s, sums[1] + t];
        products = [products[0] + s * s, products[1] + s * t, products[2] + t * t];
    }
    let (s, t) = (sums[0] * quarter, sums[1] * quarter);
    let [ss, st, tt] = [products[0] * quarter, products[1] * quarter, products[2] * quarter];
    // Slopes about their own mean normal hardly have a mean, so this difference does not cancel.
    let covariance = [ss - s * s, st - s * t, tt - t * t];
    let base = [u * u * (u * u), uv, v * v * (v * v)];
    let [_, _, [x, y, z]] = axes;
    let [uu, uv, vv] = [0, 1, 2].map(|i| base[i] + covariance[i] + covariance[i]);
    [x, y, z, uu, uv, vv]
}

/// Points that are steeper about the mean normal count as this steep.
const LEAST_COSINE: f32 = 0.05;

#[cfg(test)]
mod tests;

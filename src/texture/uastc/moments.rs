//! First and second moments of the colours of a block or subset.
//!
//! Sums of texels and of their products are whole numbers below 2^24, hence exact in `f32`
//! whatever the order.

#![expect(clippy::needless_range_loop, reason = "lane loops read several arrays at one index")]

/// One value per texel of a block, row 0 first.
pub(super) type Lane = [f32; 16];

/// All sixteen texels.
pub(super) const ALL: Lane = [1.0; 16];

/// Count, sums and scatter (sum of products of the departures from the mean) of a subset.
#[derive(Clone, Copy)]
pub(super) struct Moments<const N: usize> {
    pub count: f32,
    pub sums: [f32; N],
    pub scatter: [[f32; N]; N],
}

/// Sum over the texels, in four lanes that vectorise.
#[inline(always)]
pub(super) fn sum(v: impl Fn(usize) -> f32) -> f32 {
    let mut lanes = [0.0; 4];
    for k in 0..4 {
        for (j, lane) in lanes.iter_mut().enumerate() {
            *lane += v(4 * k + j);
        }
    }
    (lanes[0] + lanes[2]) + (lanes[1] + lanes[3])
}

/// Moments of the texels in `subset` (1 for a member, 0 for the rest), which has a member.
#[inline(always)]
pub(super) fn moments<const N: usize>(texels: &[Lane; N], subset: &Lane) -> Moments<N> {
    let mut m = Moments { count: sum(|i| subset[i]), sums: [0.0; N], scatter: [[0.0; N]; N] };
    let share = 1.0 / m.count;
    for a in 0..N {
        m.sums[a] = sum(|i| subset[i] * texels[a][i]);
    }
    for a in 0..N {
        for b in a..N {
            let products = sum(|i| subset[i] * texels[a][i] * texels[b][i]);
            m.scatter[a][b] = products - m.sums[a] * m.sums[b] * share;
            m.scatter[b][a] = m.scatter[a][b];
        }
    }
    m
}

/// Direction of the largest scatter, of any length; zero where all texels are equal.
#[inline(always)]
pub(super) fn principal_axis<const N: usize>(scatter: &[[f32; N]; N]) -> [f32; N] {
    if N == 1 {
        return [1.0; N];
    }
    // Eight power iterations as three squarings; the best-aligned column of the result.
    let mut power = *scatter;
    for _ in 0..3 {
        let trace: f32 = (0..N).map(|i| power[i][i]).sum();
        let scale = if trace > 1e-6 { 1.0 / trace } else { 0.0 };
        for row in &mut power {
            for v in row {
                *v *= scale;
            }
        }
        let mut square = [[0.0; N]; N];
        for a in 0..N {
            for b in a..N {
                square[a][b] = (0..N).map(|k| power[a][k] * power[k][b]).sum();
                square[b][a] = square[a][b];
            }
        }
        power = square;
    }
    let mut best = 0;
    for c in 1..N {
        if power[c][c] > power[best][best] {
            best = c;
        }
    }
    power[best]
}

/// Scatter along `axis`, the larger eigenvalue if the axis is principal.
#[inline(always)]
pub(super) fn scatter_along<const N: usize>(scatter: &[[f32; N]; N], axis: &[f32; N]) -> f32 {
    let length: f32 = axis.iter().map(|a| a * a).sum();
    let mut along = 0.0;
    for a in 0..N {
        for b in 0..N {
            along += axis[a] * axis[b] * scatter[a][b];
        }
    }
    if length > 0.0 { along / length } else { 0.0 }
}

/// Moments of some of the channels.
pub(super) fn part<const N: usize, const M: usize>(m: &Moments<N>, channels: [usize; M]) -> Moments<M> {
    Moments {
        count: m.count,
        sums: channels.map(|c| m.sums[c]),
        scatter: channels.map(|a| channels.map(|b| m.scatter[a][b])),
    }
}

//! Tables over kurtosis and the ratio of the bumps' deviation to alpha.

/// Nodes along the logarithm of kurtosis: 1 to 64 in steps of a factor of sqrt 2.
pub const KURTOSES: usize = 13;

/// Nodes along the logarithm of deviation over alpha: 1/4 to 32 in steps of a factor of 2.
pub const RATIOS: usize = 8;

/// A value at each node: ratio by ratio, kurtosis by kurtosis.
pub type Lattice = [[f32; KURTOSES]; RATIOS];

/// The correction tables of a family of lobes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Table {
    /// The correction factor c.
    pub factor: Lattice,
    /// Shift of the centre in standard deviations, for a skewness of 1.
    pub shift: Lattice,
    /// c for a normal distribution, by ratio.
    pub normal: [f32; RATIOS],
    /// c for a uniform distribution, by ratio.
    pub uniform: [f32; RATIOS],
}

/// A point between four nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LatticePoint {
    /// First of the two ratios and of the two kurtoses.
    pub node: [usize; 2],
    /// Share of the second of each, in [0, 1].
    pub share: [f32; 2],
}

impl LatticePoint {
    /// Returns the point of `kurtosis` and sqrt(`variance` / `squared_alpha`), clamped to the table.
    pub fn new(kurtosis: f32, variance: f32, squared_alpha: f32) -> Self {
        let along = |position: f32, nodes: usize| {
            let position = position.clamp(0.0, (nodes - 1) as f32);
            let node = (position as usize).min(nodes - 2);
            (node, position - node as f32)
        };
        let ratio = variance / squared_alpha.max(f32::MIN_POSITIVE);
        let (ratio, ratio_share) = along(0.5 * libm::log2f(ratio.max(f32::MIN_POSITIVE)) + 2.0, RATIOS);
        let (kurtosis, kurtosis_share) = along(2.0 * libm::log2f(kurtosis), KURTOSES);
        Self { node: [ratio, kurtosis], share: [ratio_share, kurtosis_share] }
    }

    /// Returns the four nodes around the point and their weights, which sum to 1.
    pub fn nodes(self) -> [([usize; 2], f32); 4] {
        let ([i, j], [s, t]) = (self.node, self.share);
        [
            ([i, j], (1.0 - s) * (1.0 - t)),
            ([i, j + 1], (1.0 - s) * t),
            ([i + 1, j], s * (1.0 - t)),
            ([i + 1, j + 1], s * t),
        ]
    }

    /// Interpolates a column of ratios linearly.
    pub fn along(self, column: &[f32; RATIOS]) -> f32 {
        let (i, share) = (self.node[0], self.share[0]);
        (1.0 - share) * column[i] + share * column[i + 1]
    }

    /// Interpolates `lattice` linearly.
    pub fn interpolate(self, lattice: &Lattice) -> f32 {
        self.nodes().into_iter().map(|([i, j], weight)| weight * lattice[i][j]).sum()
    }
}

#[cfg(test)]
mod tests;

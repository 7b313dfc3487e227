//! Tables over kurtosis and the ratio of the bumps' deviation to alpha.

/// Nodes along the logarithm of kurtosis: 1 to 64 in steps of a factor of sqrt 2.
pub const KURTOSES: usize = 13;

/// Nodes along the logarithm of deviation over alpha: 1/4 to 32 in steps of a factor of 2.
pub const RATIOS: usize = 8;

/// A value at each node: ratio by ratio, kurtosis by kurtosis.
pub type Lattice = [[f32; KURTOSES]; RATIOS];

/// What is known of a family of lobes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Table {
    /// c.
    pub factor: Lattice,
    /// Shift of the centre, in deviations for a skewness of 1.
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
    /// Where `kurtosis` and sqrt(`variance` / `squared_alpha`) lie; beyond the table its nearest border.
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

    /// The four nodes about the place and their weights, which sum to 1.
    pub fn nodes(self) -> [([usize; 2], f32); 4] {
        let ([i, j], [s, t]) = (self.node, self.share);
        [
            ([i, j], (1.0 - s) * (1.0 - t)),
            ([i, j + 1], (1.0 - s) * t),
            ([i + 1, j], s * (1.0 - t)),
            ([i + 1, j + 1], s * t),
        ]
    }

    /// The value of a column of ratios, linear between nodes.
    pub fn along(self, column: &[f32; RATIOS]) -> f32 {
        let (i, share) = (self.node[0], self.share[0]);
        (1.0 - share) * column[i] + share * column[i + 1]
    }

    /// The value of `lattice`, linear between nodes.
    pub fn interpolate(self, lattice: &Lattice) -> f32 {
        self.nodes().into_iter().map(|([i, j], weight)| weight * lattice[i][j]).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_are_where_they_are_named() {
        assert_eq!(LatticePoint::new(1.0, 0.25, 4.0), LatticePoint { node: [0, 0], share: [0.0, 0.0] });
        assert_eq!(LatticePoint::new(4.0, 4.0, 1.0), LatticePoint { node: [3, 4], share: [0.0, 0.0] });
        let far = LatticePoint::new(1e9, 1.0, 0.0);
        assert_eq!(far, LatticePoint { node: [RATIOS - 2, KURTOSES - 2], share: [1.0, 1.0] });
        let flat = LatticePoint::new(3.0, 0.0, 0.01);
        assert_eq!((flat.node[0], flat.share[0]), (0, 0.0));
    }

    #[test]
    fn interpolation_is_linear() {
        let mut lattice = [[0.0; KURTOSES]; RATIOS];
        for (i, row) in lattice.iter_mut().enumerate() {
            for (j, value) in row.iter_mut().enumerate() {
                *value = 3.0 * i as f32 + j as f32;
            }
        }
        let point = LatticePoint { node: [2, 5], share: [0.25, 0.5] };
        assert!((point.interpolate(&lattice) - (3.0 * 2.25 + 5.5)).abs() < 1e-5);
    }
}

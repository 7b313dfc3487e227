//! Lobes for tests.

use super::{Alpha, OrientedLobe, SquaredAlpha};

/// Returns an isotropic lobe about the normal (`x`, 0, z).
pub fn isotropic_lobe(alpha: f32, x: f32) -> OrientedLobe {
    OrientedLobe { normal: [x, 0.0, (1.0 - x * x).sqrt()], squared_alpha: SquaredAlpha::isotropic(Alpha(alpha)) }
}

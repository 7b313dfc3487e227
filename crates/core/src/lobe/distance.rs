//! Distances between concentric GGX lobes in closed form: half the integral of |P - Q| over slopes, in [0, 1].

use super::Alpha;

/// Returns the distance between two isotropic lobes. Their cumulated densities r^2/(alpha^2 + r^2) differ most where
/// the densities cross, at r^2 = alpha_1 alpha_2. The difference there is |alpha_1 - alpha_2| / (alpha_1 + alpha_2).
pub fn isotropic_distance(a: Alpha, b: Alpha) -> f32 {
    let sum = a.0 + b.0;
    if sum > 0.0 { (a.0 - b.0).abs() / sum } else { 0.0 }
}

/// Returns the distance between an anisotropic lobe of axis ratio rho >= 1 and its closest isotropic lobe:
/// 2/pi (arctan sqrt rho - arctan 1/sqrt rho).
///
/// Both lobes have equal peaks, so that along each direction one density is above the other everywhere, and the radial
/// integral of (1 + g r^2)^-2 is 1/(2g). With g = cos^2/rho + rho sin^2, there remains an integral of 1/g over the
/// directions with g < 1, |tan| < 1/sqrt rho, whose antiderivative is arctan(rho tan).
pub fn shape_distance(axis_ratio: f32) -> f32 {
    let root = f64::from(axis_ratio.max(1.0)).sqrt();
    (std::f64::consts::FRAC_2_PI * (libm::atan(root) - libm::atan(1.0 / root))) as f32
}

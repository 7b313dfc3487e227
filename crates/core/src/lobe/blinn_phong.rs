//! The paper's modified Blinn-Phong angle (appendix A): cos^2 of the angle between normal and half-vector after the
//! lobe is scaled to the unit circle, so that one highlight function f(cos^2) serves every roughness.
//!
//! `cos2` is the squared cosine of the angle between the unit normal and the half-vector h, `d` the components of n - h
//! along e1 and e2; |d|^2 = 1 - cos2.

use crate::lobe::factor::Factor;

/// Returns the angle of an elliptical lobe: cos2 / (|D^-1 d|^2 + cos2), which measures d relative to the radius of the
/// ellipse. With f = exp(-tan^2/2), highlights are exactly normal densities of slopes of covariance K = D D^T.
///
/// The printed formula ([`printed_cos2`]) differs and is wrong unless K is isotropic (test `erratum_3_*`). For a
/// singular D, cos^2 is 0 if d has a component along a direction without variance.
pub fn elliptical_cos2(cos2: f32, d: [f32; 2], factor: Factor) -> f32 {
    // D^-1 d by back substitution: D is upper triangular.
    let over = |a: f32, b: f32| if a == 0.0 { 0.0 } else { a / b };
    let y = over(d[1], factor.d3);
    let x = over(d[0] - factor.d2 * y, factor.d1);
    let radius = x * x + y * y;
    if radius.is_finite() { cos2 / (radius + cos2) } else { 0.0 }
}

/// Returns the angle by the formula as printed in the paper: cos2 / (|d|^4 / |D d|^2 + cos2).
pub fn printed_cos2(cos2: f32, d: [f32; 2], factor: Factor) -> f32 {
    let (x, y) = (factor.d1 * d[0] + factor.d2 * d[1], factor.d3 * d[1]);
    let (squared, stretched) = (d[0] * d[0] + d[1] * d[1], x * x + y * y);
    if squared == 0.0 { 1.0 } else { cos2 / (squared * squared / stretched + cos2) }
}

#[cfg(test)]
mod tests;

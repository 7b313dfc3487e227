//! The transfer function of sRGB (IEC 61966-2-1).

/// Returns the linear value of an sRGB value in [0, 1].
pub fn srgb_to_linear(value: f64) -> f64 {
    if value <= 0.040_45 { value / 12.92 } else { libm::pow((value + 0.055) / 1.055, 2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_values_of_srgb_are_linearised() {
        for (srgb, linear) in [(0.0, 0.0), (0.040_45, 0.003_130_8), (0.5, 0.214_041), (188.0 / 255.0, 0.502_886)] {
            assert!((srgb_to_linear(srgb) - linear).abs() < 1e-6, "{srgb}");
        }
        assert_eq!(srgb_to_linear(1.0), 1.0);
    }
}

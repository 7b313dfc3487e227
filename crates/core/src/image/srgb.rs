//! The transfer function of sRGB (IEC 61966-2-1).

/// Returns the linear value of an sRGB value in [0, 1].
pub fn srgb_to_linear(value: f64) -> f64 {
    if value <= 0.040_45 { value / 12.92 } else { libm::pow((value + 0.055) / 1.055, 2.4) }
}

/// Returns the sRGB value of a linear value in [0, 1].
pub fn linear_to_srgb(value: f32) -> f32 {
    if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * libm::powf(value, 1.0 / 2.4) - 0.055 }
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

    #[test]
    fn every_code_survives_both_ways() {
        for code in 0..=255_u8 {
            let linear = srgb_to_linear(f64::from(code) / 255.0) as f32;
            assert_eq!((255.0 * linear_to_srgb(linear)).round(), f32::from(code));
        }
        let mut least = 0.0;
        for step in 0..=1_000_u16 {
            let srgb = linear_to_srgb(f32::from(step) / 1000.0);
            assert!(srgb >= least && (srgb_to_linear(f64::from(srgb)) - f64::from(step) / 1000.0).abs() < 1e-6);
            least = srgb;
        }
    }
}

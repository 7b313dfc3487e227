//! Tone mapping from linear radiance to display values.

use super::draw::Picture;

/// Exposure and tone curve: L = e x; L / (1 + L) (E. Reinhard et al., "Photographic tone reproduction for digital
/// images", 2002, eq. 3), then the display's gamma of 2.2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tone {
    /// The factor e.
    pub exposure: f64,
}

impl Tone {
    /// Exposes for the surface on `picture`, whose mean radiance becomes `key`.
    pub fn expose_for(picture: &Picture, key: f64) -> Self {
        let (mut sum, mut covered) = (0.0, 0.0);
        for (pixel, coverage) in picture.pixels.iter().zip(&picture.coverage) {
            if *coverage == 1.0 {
                // Few very bright pixels would otherwise darken all others.
                sum += pixel.iter().map(|c| f64::from(*c).min(100.0)).sum::<f64>() / 3.0;
                covered += 1.0;
            }
        }
        Self { exposure: if sum > 0.0 { key * covered / sum } else { 1.0 } }
    }

    /// Returns red, green and blue in [0, 1] for a display with gamma 2.2.
    pub fn displayed(&self, pixel: [f32; 3]) -> [f64; 3] {
        pixel.map(|c| {
            let light = (self.exposure * f64::from(c)).max(0.0);
            if light.is_finite() { libm::pow(light / (1.0 + light), 1.0 / 2.2) } else { 1.0 }
        })
    }
}

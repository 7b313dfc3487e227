//! Measures of the difference between a picture and the ground truth.

use super::displayed::Displayed;
use super::draw::Picture;

/// Two measures of the difference between two pictures.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Difference {
    /// sum |a - b| / sum b over linear radiance: 0 is equal, and at 1 the wrong light equals all light. Pixels that the
    /// surface does not fill are left out.
    pub relative_l1: f64,
    /// Structural similarity of the displayed pictures (Z. Wang et al., "Image quality assessment: from error
    /// visibility to structural similarity", 2004, eq. 13): the mean over windows of 8 x 8 pixels, every 4 pixels, of
    /// (2 m_a m_b + C1)(2 s_ab + C2) / ((m_a^2 + m_b^2 + C1)(s_a^2 + s_b^2 + C2)) of the tone-mapped luminance, with C1
    /// = 0.01^2 and C2 = 0.03^2. 1 is equal. Windows that the surface does not fill are left out.
    pub ssim: f64,
}

/// Side of a window, and the step from one to the next.
const WINDOW: usize = 8;
const STEP: usize = 4;

impl Difference {
    /// Compares `picture` with `truth`.
    pub fn between(picture: &Displayed, truth: &Displayed) -> Self {
        Self { relative_l1: relative_l1(&picture.picture, &truth.picture), ssim: ssim(picture, truth) }
    }
}

/// Returns [`Difference::relative_l1`], or 0 if there is no light.
pub fn relative_l1(picture: &Picture, truth: &Picture) -> f64 {
    let (mut wrong, mut light) = (0.0, 0.0);
    for ((a, b), covered) in picture.pixels.iter().zip(&truth.pixels).zip(&truth.coverage) {
        if *covered == 1.0 {
            for (a, b) in a.iter().zip(b) {
                wrong += (f64::from(*a) - f64::from(*b)).abs();
                light += f64::from(*b);
            }
        }
    }
    if light > 0.0 { wrong / light } else { 0.0 }
}

fn ssim(picture: &Displayed, truth: &Displayed) -> f64 {
    let [width, height] = truth.picture.size.map(|side| side as usize);
    let luminance = |displayed: &Displayed| -> Vec<f64> {
        displayed.values.iter().map(|[r, g, b]| 0.2126 * r + 0.7152 * g + 0.0722 * b).collect()
    };
    let (a, b) = (luminance(picture), luminance(truth));
    let (mut sum, mut count) = (0.0, 0.0);
    for top in (0..(height + 1).saturating_sub(WINDOW)).step_by(STEP) {
        for left in (0..(width + 1).saturating_sub(WINDOW)).step_by(STEP) {
            let inside = || (0..WINDOW * WINDOW).map(|i| (top + i / WINDOW) * width + left + i % WINDOW);
            if inside().all(|i| truth.picture.coverage[i] == 1.0) {
                sum += similarity(inside().map(|i| (a[i], b[i])));
                count += 1.0;
            }
        }
    }
    if count > 0.0 { sum / count } else { 1.0 }
}

fn similarity(pairs: impl Iterator<Item = (f64, f64)> + Clone) -> f64 {
    let n = (WINDOW * WINDOW) as f64;
    let (sum_a, sum_b) = pairs.clone().fold((0.0, 0.0), |(x, y), (a, b)| (x + a, y + b));
    let (mean_a, mean_b) = (sum_a / n, sum_b / n);
    let (mut aa, mut bb, mut ab) = (0.0, 0.0, 0.0);
    for (a, b) in pairs {
        let (a, b) = (a - mean_a, b - mean_b);
        (aa, bb, ab) = (aa + a * a / n, bb + b * b / n, ab + a * b / n);
    }
    let (c1, c2) = (1e-4, 9e-4);
    (2.0 * mean_a * mean_b + c1) * (2.0 * ab + c2) / ((mean_a * mean_a + mean_b * mean_b + c1) * (aa + bb + c2))
}

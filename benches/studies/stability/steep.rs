//! Slopes beyond the clamp, normals below the surface, and alphas above 1.

use roughcast::bump::{MAX_SLOPE, offset_from_normal};
use roughcast::lobe::Family;
use roughcast::metric::{Footprint, Lobe, Part, Reference, SAMPLES, oracle};
use roughcast::mip::Pyramid;

use super::synthetic::level;
use super::{head, row};

pub fn print() {
    head(
        "Steep slopes and normals below the surface",
        &["texel", "its slope", "clamped", "alpha along u of 64 x 64 texels with one such texel", "without the clamp"],
    );
    // Normals of 8 bits: a vertical wall, a wall that leans over, and a steep wall.
    for normal in [[1.0, 0.0, 0.5], [1.0, 0.0, 0.05], [1.0, 0.0, 1.0 / 255.0], [1.0, 0.0, 0.0], [0.8, 0.0, -0.6]] {
        let slope = if normal[2] > 0.0 { normal[0] / normal[2] } else { f64::INFINITY };
        let kept = f64::from(offset_from_normal(normal.map(|x| x as f32)).u);
        let alpha = |slope: f64| {
            let texels = level(64, 64, |x, y| if (x, y) == (9, 9) { [slope, 0.0] } else { [0.0; 2] });
            (2.0 * f64::from(Pyramid::new(texels).coarsest().covariance.uu)).sqrt()
        };
        let unclamped = if slope.is_finite() { format!("{:.3}", alpha(slope)) } else { "infinite".to_owned() };
        let [x, y, z] = normal.map(|c| format!("{c:.3}"));
        row(&[
            format!("({x}, {y}, {z})"),
            if slope.is_finite() { format!("{slope:.1}") } else { "none".to_owned() },
            format!("{kept:.1}"),
            format!("{:.3}", alpha(kept)),
            unclamped,
        ]);
    }
    println!("\nMAX_SLOPE is {MAX_SLOPE}.");

    head(
        "Alpha above 1",
        &["deviation", "alpha wanted", "D, c = 1, not clamped", "clamped to 1", "best with alpha up to 1"],
    );
    for deviation in [0.3, 0.6, 1.0, 2.0, 4.0] {
        let base = [0.04, 0.0, 0.04];
        // A normal distribution of slopes on a lattice.
        let points = (-12..=12).flat_map(|i| (-12..=12).map(move |j| [f64::from(i) / 4.0, f64::from(j) / 4.0]));
        let parts = points.map(|[x, y]| Part {
            weight: libm::exp(-0.5 * (x * x + y * y)),
            normal: [-deviation * x, -deviation * y, 1.0],
            base,
        });
        let Some(footprint) = Footprint::new(parts.collect()) else { continue };
        let reference = Reference::new(Family::Ggx, &footprint, SAMPLES);
        let wanted = (0.04 + 2.0 * deviation * deviation).sqrt();
        let lobe = |alpha| Lobe::isotropic(Family::Ggx, [0.0, 0.0, 1.0], alpha);
        let clamped = lobe(wanted.min(1.0));
        row(&[
            deviation.to_string(),
            format!("{wanted:.2}"),
            format!("{:.3}", reference.error(&lobe(wanted))),
            format!("{:.3}", reference.error(&clamped)),
            format!("{:.3}", oracle(&reference, &[clamped]).1),
        ]);
    }
}

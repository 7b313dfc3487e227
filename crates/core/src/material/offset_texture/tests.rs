use proptest::prelude::*;

use super::*;
use crate::bump::Moments;
use crate::codec::Target;
use crate::codec::uastc::Effort;
use crate::mip::{Level, Pyramid};
use crate::settings::Settings;

/// Returns levels whose level 0 has these offsets in one row.
fn levels(offsets: &[[f32; 2]]) -> Pyramid<Level<Moments>> {
    let texels = offsets.iter().map(|&[u, v]| Moments::flat(Offset { u, v })).collect();
    Pyramid::new(Level { width: offsets.len() as u32, height: 1, texels })
}

/// Returns the texels of level 0 under `scale`.
fn stored(offsets: &[[f32; 2]], scale: f32) -> Vec<[f64; 3]> {
    let levels = levels(offsets);
    let mut row = vec![[0.0; 4]; offsets.len()];
    OffsetTexture { levels: &levels, scale }.row(0, 0, &mut row);
    row.into_iter().map(|[x, y, z, _]| [x, y, z].map(f64::from)).collect()
}

fn is_unit(texel: &[f64; 3]) -> bool {
    let length = texel.iter().map(|c| (2.0 * c - 1.0) * (2.0 * c - 1.0)).sum::<f64>().sqrt();
    (length - 1.0).abs() < 1e-6
}

proptest! {
    /// A component of the normal is off by half a step of 8 bits, e = 1/255. A slope g = x / z is then off by at most
    /// (1 + g) e / (z - e).
    #[test]
    fn bytes_hold_offsets_within_the_error_of_a_step(
        offset in prop::array::uniform2(-16.0..16.0f32), scale in 0.02..4.0f32,
    ) {
        let texel = stored(&[offset], scale)[0];
        prop_assert!(is_unit(&texel));
        let bytes = texel.map(|c| (255.0 * c).round() / 255.0);
        let found = slopes_of_texel(bytes).map(|g| g * f64::from(scale));
        let [g, step] = [f64::from(offset[0].hypot(offset[1]) / scale), 1.0 / 255.0];
        let z = 1.0 / (1.0 + g * g).sqrt();
        let [u, v] = offset.map(f64::from);
        if z > LEAST_Z + step {
            let bound = f64::from(scale) * (1.0 + g) * step / (z - step);
            prop_assert!((found[0] - u).abs() <= bound && (found[1] - v).abs() <= bound, "{offset:?}: {found:?}");
        } else {
            // Steeper slopes keep their direction, and are at most 32 times the scale.
            let length = found[0].hypot(found[1]);
            prop_assert!(length <= f64::from(scale) * 1.01 / LEAST_Z, "{found:?}");
            let cosine = (found[0] * u + found[1] * v) / (length * u.hypot(v));
            prop_assert!(cosine > 0.999, "{found:?} for {offset:?}");
        }
    }

    /// The best scale is the least of the mean error s a + b / s, found by steps in double precision.
    #[test]
    fn the_scale_has_the_least_mean_error(
        offsets in prop::collection::vec(prop::array::uniform2(-3.0..3.0f32), 1..20), factor in 0.01..1.0f32,
    ) {
        let offsets: Vec<_> = offsets.into_iter().map(|o| o.map(|f| f * factor)).collect();
        let of_texels: Vec<f64> = rows(&levels(&offsets));
        let error = |s: f64| of_texels.iter().map(|f| (s + f * f / s) / (1.0 + f * f)).sum::<f64>();
        let scale = f64::from(steepness(&levels(&offsets), 0).best_scale());
        for step in [0.9, 0.99, 1.01, 1.1] {
            prop_assert!(error(scale) <= error(scale * step) * (1.0 + 1e-6), "{scale} x {step}");
        }
    }
}

/// Returns the lengths of the offsets of all levels.
fn rows(levels: &Pyramid<Level<Moments>>) -> Vec<f64> {
    let mut lengths = Vec::new();
    for (level, (width, height)) in levels.sizes().into_iter().enumerate() {
        for y in 0..height {
            let mut row = vec![PyramidTexel::default(); width as usize];
            PyramidLevels::row(levels, level, y, &mut row);
            lengths.extend(row.iter().map(|texel| f64::from(texel.offset.u).hypot(f64::from(texel.offset.v))));
        }
    }
    lengths
}

#[test]
fn one_percent_of_steep_texels_leave_the_precision_of_the_others() {
    let offsets: Vec<[f32; 2]> = (0..400).map(|i| if i % 100 == 7 { [16.0, 0.0] } else { [0.1, -0.05] }).collect();
    let scale = steepness(&levels(&offsets), 0).scale();
    assert!(scale > 0.1 && scale < 0.8, "{scale}");
    let bytes = stored(&offsets, scale)[0].map(|c| (255.0 * c).round() / 255.0);
    let found = slopes_of_texel(bytes).map(|g| g * f64::from(scale));
    // A range of -16 to 16 has steps of 0.13.
    assert!((found[0] - 0.1).abs() < 0.002 && (found[1] + 0.05).abs() < 0.002, "{found:?}");
}

#[test]
fn only_maps_with_bumps_in_bytes_are_scaled() {
    assert_eq!(steepness(&levels(&[[0.0; 2]; 8]), 0).scale(), 2.0);
    let encoding = |target| Encoding {
        fallback: false,
        effort: Effort::Fast,
        ..Encoding::of_normals(&Settings { target, ..Settings::default() })
    };
    let bumpy = levels(&[[0.1, 0.0]; 8]);
    assert_eq!(OffsetTexture::new(&bumpy, encoding(Target::Float)).scale, 1.0);
    assert!((OffsetTexture::new(&bumpy, encoding(Target::Basis)).scale - 0.2).abs() < 1e-6);
}

//! Tests how close blocks are to their source.

use super::*;

fn encoded_psnr(sources: &[Texels], effort: Effort) -> f64 {
    let blocks: Vec<Texels> =
        sources.iter().map(|texels| decoded(&encode_block(texels, Metric::Rgb, effort))).collect();
    psnr(sources, &blocks)
}

#[test]
fn normals_keep_their_psnr() {
    // From smooth normals to white noise; 0.3 dB below the measured PSNR.
    for (noise, fast_floor, best_floor) in [(0.0, 46.1, 46.8), (0.1, 43.7, 44.3), (0.9, 29.6, 29.8)] {
        let sources = normals(noise, 256);
        let (fast, best) = (encoded_psnr(&sources, Effort::Fast), encoded_psnr(&sources, Effort::Best));
        assert!(fast >= fast_floor, "noise {noise}: fast has {fast:.2} dB");
        assert!(best >= best_floor, "noise {noise}: best has {best:.2} dB");
    }
}

#[test]
fn best_is_never_worse_than_fast() {
    for texels in all_kinds() {
        let [fast, best] =
            EFFORTS.map(|effort| squared_error(&texels, &decoded(&encode_block(&texels, Metric::Rgb, effort))));
        assert!(best <= fast, "{best} over {fast} for {texels:?}");
    }
}

#[test]
fn texels_that_are_grey_only_after_weighting_keep_their_colour() {
    // Red and blue vary four times as much as green: their weighted variations are equal.
    let texels: Texels =
        std::array::from_fn(|i| [200 + 4 * (i as u8 % 8), 50 + i as u8 % 8, 200 + 4 * (i as u8 % 8), 255]);
    for effort in EFFORTS {
        let error = squared_error(&texels, &decoded(&encode_block(&texels, SURFACE, effort)));
        assert!(error < 200, "{effort:?}: {error}");
    }
}

#[test]
fn weights_lower_the_error_of_roughness() {
    // Sums of squared differences over all blocks: of roughness alone, and with a sixteenth of red and blue.
    let sums = |metric, effort| {
        all_kinds().iter().fold([0.0, 0.0], |[roughness, weighted], texels| {
            let block = decoded(&encode_block(texels, metric, effort));
            let of = |c: usize| (0..16).map(|i| f64::from(texels[i][c].abs_diff(block[i][c])).powi(2)).sum::<f64>();
            [roughness + of(1), weighted + of(1) + (of(0) + of(2)) / 16.0]
        })
    };
    for effort in EFFORTS {
        let [evenly, surface] = [Metric::Rgb, SURFACE].map(|metric| sums(metric, effort));
        assert!(surface[0] < 0.5 * evenly[0], "{effort:?}: {} of {}", surface[0], evenly[0]);
        assert!(surface[1] < 0.8 * evenly[1], "{effort:?}: {} of {}", surface[1], evenly[1]);
    }
}

#[test]
fn roughness_with_constant_red_and_blue_keeps_its_error() {
    // Sums of squared differences over 16 blocks, a fifth above the measured sums. Red and blue count a sixteenth.
    for (spread, most) in [(3, 0.0), (12, 88.0), (60, 361.0), (255, 1002.0)] {
        let [fast, best] = EFFORTS.map(|effort| {
            green(spread).fold(0.0, |sum, texels| {
                let block = decoded(&encode_block(&texels, SURFACE, effort));
                let of = |c: usize| (0..16).map(|i| f64::from(texels[i][c].abs_diff(block[i][c])).powi(2)).sum::<f64>();
                sum + of(1) + (of(0) + of(2)) / 16.0
            })
        });
        assert!(best <= fast && fast <= most, "{spread}: {best} {fast}");
    }
}

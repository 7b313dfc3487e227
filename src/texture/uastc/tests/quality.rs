//! How near the blocks are to their source.

use super::super::encode_block;
use super::*;

fn ratio(sources: &[Texels], effort: Effort) -> f64 {
    let blocks: Vec<Texels> =
        sources.iter().map(|texels| decoded(&encode_block(texels, Metric::Rgb, effort))).collect();
    psnr(sources, &blocks)
}

#[test]
fn normals_keep_their_ratio() {
    // From smooth to white noise; 0.3 dB below what was measured.
    for (noise, fast_floor, best_floor) in [(0.0, 46.1, 46.8), (0.1, 43.7, 44.3), (0.9, 29.6, 29.8)] {
        let sources = normals(noise, 256);
        let (fast, best) = (ratio(&sources, Effort::Fast), ratio(&sources, Effort::Best));
        assert!(fast >= fast_floor, "noise {noise}: fast has {fast:.2} dB");
        assert!(best >= best_floor, "noise {noise}: best has {best:.2} dB");
    }
}

#[test]
fn best_is_never_worse_than_fast() {
    for texels in all_kinds() {
        for (metric, count) in [(Metric::Rgb, 3), (Metric::Rgba, 4)] {
            let [fast, best] =
                EFFORTS.map(|effort| squared_error(&texels, &decoded(&encode_block(&texels, metric, effort)), count));
            assert!(best <= fast, "{best} over {fast} for {texels:?}");
        }
    }
}

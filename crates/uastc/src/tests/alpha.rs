//! Tests of blocks with alpha against the decoder and the transcoder of `basisu`.

use super::*;
use basisu::etc::uastc_to_etc2::transcode_uastc_to_etc2_rgba;
use basisu::uastc::bc3_bc5::transcode_uastc_to_bc3;

/// Returns the peak signal-to-noise ratio in dB, over RGBA.
fn rgba_psnr(sources: &[Texels], blocks: &[Texels]) -> f64 {
    let pairs = sources.as_flattened().as_flattened().iter().zip(blocks.as_flattened().as_flattened());
    let error: f64 = pairs.map(|(a, b)| f64::from(a.abs_diff(*b)).powi(2)).sum();
    10.0 * (65025.0 * 64.0 * sources.len() as f64 / error).log10()
}

/// Returns blocks of a smooth picture, whose alpha is that of one `kind` of map.
fn pictures(kind: &str) -> Vec<Texels> {
    let mut random = Random(5);
    (0..256)
        .map(|block| {
            std::array::from_fn(|i| {
                let (x, y) = ((block % 16 * 4 + i % 4) as f64, (block / 16 * 4 + i / 4) as f64);
                let mut wave = |a: f64, b: f64| 128.0 + 90.0 * (a * x + (b * y).sin()).sin() + 6.0 * random.unit();
                let (r, g, b) = (wave(0.11, 0.2), wave(0.17, 0.1), wave(0.05, 0.3));
                let alpha = match kind {
                    "gradient" => 4.0 * x,
                    "mask" => {
                        if (x - 32.0).hypot(y - 32.0) < 20.0 {
                            255.0
                        } else {
                            0.0
                        }
                    }
                    _ => 255.0 * random.unit(),
                };
                [r, g, b, alpha].map(|v| v as u8)
            })
        })
        .collect()
}

#[test]
fn alpha_keeps_its_psnr() {
    // 0.3 dB below the measured ratios.
    for (kind, floors) in [("noise", [27.8, 28.0]), ("gradient", [33.9, 35.6]), ("mask", [35.0, 36.1])] {
        let sources = pictures(kind);
        for (effort, floor) in EFFORTS.into_iter().zip(floors) {
            let blocks: Vec<Texels> =
                sources.iter().map(|texels| decoded(&encode_block(texels, Metric::Rgba, effort))).collect();
            let found = rgba_psnr(&sources, &blocks);
            assert!(found >= floor, "{kind}, {effort:?}: {found:.2} dB");
        }
    }
}

#[test]
fn opaque_blocks_are_those_of_rgb() {
    for mut texels in all_kinds() {
        texels.iter_mut().for_each(|texel| texel[3] = 255);
        for effort in EFFORTS {
            assert_eq!(encode_block(&texels, Metric::Rgba, effort), encode_block(&texels, Metric::Rgb, effort));
        }
    }
}

#[test]
fn constant_alpha_is_exact_in_solid_blocks_and_clear_ends_stay_clear() {
    for alpha in [0, 1, 127, 254, 255] {
        let block = encode_block(&[[9, 200, 31, alpha]; 16], Metric::Rgba, Effort::Fast);
        assert_eq!(decoded(&block), [[9, 200, 31, alpha]; 16]);
    }
    // A texel of a mask is clear or opaque after the block as it was before.
    let mask = std::array::from_fn(|i| [40, 90, 20, if i % 4 < 2 { 0 } else { 255 }]);
    for effort in EFFORTS {
        let found = decoded(&encode_block(&mask, Metric::Rgba, effort));
        assert_eq!(found.map(|texel| texel[3]), mask.map(|texel| texel[3]));
    }
}

#[test]
fn transcoded_alpha_is_close() {
    for kind in ["gradient", "mask"] {
        let sources = pictures(kind);
        let (mut etc2, mut bc3) = (0_u64, 0_u64);
        for texels in &sources {
            let block = encode_block(texels, Metric::Rgba, Effort::Fast);
            let error = |found: [u32; 16]| -> u64 {
                let alphas = found.map(|texel| texel.to_le_bytes()[3]);
                alphas.iter().zip(texels).map(|(a, b)| u64::from(a.abs_diff(b[3])).pow(2)).sum()
            };
            let mut found = [0; 16];
            texture2ddecoder::decode_etc2_rgba8_block(&transcode_uastc_to_etc2_rgba(&block).unwrap(), &mut found);
            etc2 += error(found);
            texture2ddecoder::decode_bc3_block(&transcode_uastc_to_bc3(&block, false).unwrap(), &mut found);
            bc3 += error(found);
        }
        let root_mean_square = |sum: u64| (sum as f64 / (16.0 * sources.len() as f64)).sqrt();
        let found = [root_mean_square(etc2), root_mean_square(bc3)];
        assert!(found.iter().all(|error| *error < 6.0), "{kind}: {found:?} levels by ETC2 and BC3");
    }
}

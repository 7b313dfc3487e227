//! Tests that blocks transcode, guided by their hints, to textures close to the source.

use super::*;
use crate::hints::{Hints, LEAST_BIAS};
use crate::tables::{MODE_0, MODE_6};
use basisu::etc::{uastc_to_etc1, uastc_to_etc2};
use basisu::uastc::{astc_pack, bc1, bc3_bc5, bc7};
use texel_simd::{LANES, dispatch, instruction_sets};

fn unpack(decode: impl FnOnce(&mut [u32])) -> Texels {
    let mut texels = [0; 16];
    decode(&mut texels);
    texels.map(|texel: u32| {
        let [b, g, r, a] = texel.to_le_bytes();
        [r, g, b, a]
    })
}

const TARGETS: [&str; 6] = ["ETC1", "ETC2", "BC1", "BC3", "BC7", "ASTC"];

/// Transcodes a block to each of [`TARGETS`] and decodes the results.
fn transcoded(block: &[u8; BLOCK_BYTES]) -> [Texels; 6] {
    let etc1 = uastc_to_etc1::transcode_uastc_to_etc1(block).unwrap();
    let etc2 = uastc_to_etc2::transcode_uastc_to_etc2_rgba(block).unwrap();
    let bc1 = bc1::transcode_uastc_to_bc1(block, false).unwrap();
    let bc3 = bc3_bc5::transcode_uastc_to_bc3(block, false).unwrap();
    let bc7 = bc7::transcode_uastc_to_bc7(block).unwrap();
    let astc = astc_pack::transcode_uastc_to_astc(block).unwrap();
    [
        unpack(|out| texture2ddecoder::decode_etc1_block(&etc1, out)),
        unpack(|out| texture2ddecoder::decode_etc2_rgba8_block(&etc2, out)),
        unpack(|out| texture2ddecoder::decode_bc1_block(&bc1, out)),
        unpack(|out| texture2ddecoder::decode_bc3_block(&bc3, out)),
        unpack(|out| texture2ddecoder::decode_bc7_block(&bc7, out)),
        unpack(|out| texture2ddecoder::decode_astc_block(&astc, 4, 4, out)),
    ]
}

/// Returns the PSNR over RGB of each of [`TARGETS`].
fn ratios(sources: &[Texels], effort: Effort) -> [f64; 6] {
    let blocks: Vec<[Texels; 6]> =
        sources.iter().map(|texels| transcoded(&encode_block(texels, Metric::Rgb, effort))).collect();
    std::array::from_fn(|target| {
        let texels: Vec<Texels> = blocks.iter().map(|b| b[target]).collect();
        psnr(sources, &texels)
    })
}

#[test]
fn transcoded_normals_keep_their_psnr() {
    // Rather flat and rather rough normals; 1 dB below the measured PSNR.
    let smooth = [35.8, 35.8, 38.0, 38.0, 44.8, 45.6];
    let rough = [26.6, 26.6, 28.4, 28.4, 36.0, 36.1];
    for (noise, floors) in [(0.02, smooth), (0.4, rough)] {
        let sources = normals(noise, 128);
        for effort in EFFORTS {
            let found = ratios(&sources, effort);
            for target in 0..6 {
                assert!(
                    found[target] >= floors[target],
                    "{}: {:.2} dB, {effort:?}, noise {noise}",
                    TARGETS[target],
                    found[target]
                );
            }
        }
    }
}

#[test]
fn transcoded_solid_blocks_differ_by_at_most_8_levels() {
    let mut random = Random(11);
    for _ in 0..500 {
        let colour: [u8; 4] = std::array::from_fn(|_| random.byte());
        let block = encode_block(&[colour; 16], Metric::Rgb, Effort::Fast);
        for (target, result) in TARGETS.iter().zip(transcoded(&block)) {
            for c in 0..3 {
                let off = result[7][c].abs_diff(colour[c]);
                assert!(off <= 8, "{target}: {colour:?} became {:?}", result[7]);
            }
            assert_eq!(result[0][3], 255, "{target}");
        }
    }
}

#[test]
fn every_block_transcodes() {
    for texels in all_kinds() {
        for (metric, effort) in METRICS.into_iter().flat_map(|m| EFFORTS.map(|e| (m, e))) {
            let block = encode_block(&texels, metric, effort);
            let results = transcoded(&block);
            // BC7 and ASTC store the block almost unchanged: BC7 has endpoints of 5 to 8 bits, and the ASTC decoder
            // rounds.
            let source = decoded(&block);
            for (at, bound) in [(4, 12), (5, 1)] {
                for (a, b) in source.iter().zip(results[at]) {
                    let off = (0..4).map(|c| a[c].abs_diff(b[c])).max();
                    assert!(off <= Some(bound), "{}: {a:?} became {b:?}", TARGETS[at]);
                }
            }
        }
    }
}

/// Computes the ETC1 fields of [`Hints`] with integers: flip, differential, bias and tables.
fn by_integers(texels: &Texels) -> (bool, bool, u8, [u8; 2]) {
    let is_second = |i: usize, flip: bool| if flip { i >= 8 } else { i % 4 >= 2 };
    let sums = |flip: bool| -> [[i32; 3]; 2] {
        std::array::from_fn(|half| {
            let own = (0..16).filter(|i| is_second(*i, flip) == (half == 1));
            own.fold([0; 3], |sum, i| std::array::from_fn(|c| sum[c] + i32::from(texels[i][c])))
        })
    };
    let distance = |[a, b]: [[i32; 3]; 2]| (0..3).map(|c| (a[c] - b[c]).pow(2)).sum::<i32>();
    let flip = distance(sums(true)) > distance(sums(false));
    let sums = sums(flip);
    let bases = |limit: i32| sums.map(|half| half.map(|s| (s * limit + 1020) / 2040));
    let five = bases(31);
    let differential = (0..3).all(|c| (-4..=3).contains(&(five[1][c] - five[0][c])));
    let (bases, limit) = if differential { (five, 31) } else { (bases(15), 15) };
    let digits = bases.as_flattened().iter().map(|&base| usize::from(base > 0) + usize::from(base == limit));
    let state = digits.rev().fold(0, |state, digit| 3 * state + digit);
    let luma = |[r, g, b]: [i32; 3]| r * 54 + g * 183 + b * 19;
    let tables = [0, 1].map(|half| {
        let mean = luma(sums[half]) / 8;
        let own = (0..16).filter(|i| is_second(*i, flip) == (half == 1));
        let reach = own.map(|i| (luma(std::array::from_fn(|c| i32::from(texels[i][c]))) - mean).abs()).max();
        let reach = reach.unwrap_or(0) * 9 / 16 / 256;
        [12, 23, 35, 51, 70, 93, 144].iter().filter(|&&limit| reach > limit).count() as u8
    });
    (flip, differential, LEAST_BIAS[state], tables)
}

#[test]
fn hints_equal_those_of_integers_in_every_lane() {
    let mut random = Random(3);
    let mut blocks = all_kinds();
    blocks.extend((0..400).map(|i| {
        let (base, range) = (random.byte(), [1, 8, 60, 255][i % 4]);
        std::array::from_fn(|_| std::array::from_fn(|_| base.saturating_add(random.byte() % range)))
    }));
    for group in blocks.chunks(LANES).filter(|group| group.len() == LANES) {
        let modes: [_; LANES] = std::array::from_fn(|j| if j % 2 == 0 { &MODE_0 } else { &MODE_6 });
        let group: &[Texels; LANES] = group.try_into().unwrap();
        let alone: Vec<Hints> = group.iter().zip(modes).map(|(texels, mode)| Hints::of(texels, mode)).collect();
        for (hints, texels) in alone.iter().zip(group) {
            assert_eq!((hints.flip, hints.differential, hints.bias, hints.tables), by_integers(texels), "{texels:?}");
        }
        for set in instruction_sets() {
            assert_eq!(
                dispatch!(set, simd => Hints::of_lanes(simd, group.each_ref(), modes)).to_vec(),
                alone,
                "{set:?}"
            );
        }
    }
}

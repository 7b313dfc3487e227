use super::*;
use crate::bump::normal_map::NormalLayout;
use crate::image::{Image, Samples};

#[test]
fn slopes_of_hand_computed_normals() {
    let offset = offset_from_normal([0.6, 0.0, 0.8]);
    assert!((offset.u + 0.75).abs() < 1e-6 && offset.v == 0.0);
    // Length cancels.
    assert_eq!(offset_from_normal([1.2, -0.4, 1.6]), offset_from_normal([0.6, -0.2, 0.8]));
}

#[test]
fn steep_and_backward_normals_keep_their_direction() {
    for normal in [[1.0, 0.0, 0.001], [1.0, 0.0, 0.0], [1.0, 0.0, -1.0]] {
        assert_eq!(offset_from_normal(normal), Offset { u: -MAX_SLOPE, v: 0.0 });
    }
    for normal in [[0.0, 0.0, 0.0], [0.0, 0.0, -1.0]] {
        assert_eq!(offset_from_normal(normal), Offset::default());
    }
}

#[test]
fn rows_hold_what_single_normals_would() {
    let normals = [[0.0, -0.1, 1.0], [1.0, 0.0, 0.05], [0.6, 0.0, -0.8], [0.0, 0.0, 0.0], [0.3, 0.4, 0.5]];
    let image = Image { width: 5, height: 1, channels: 3, samples: Samples::F32(normals.concat()) };
    let map = NormalMap::new(image, NormalLayout::Xyz, false).unwrap();
    let mut row = [Moments::default(); 5];
    NormalOffsets::new(&map).row(0, &mut row);
    assert_eq!(row, normals.map(|normal| Moments::flat(offset_from_normal(normal))));
}

#[test]
fn numbers_stay_beside_their_texels_where_some_are_steep() {
    let normal = |i: u32| if i % 50 == 49 { [1.0, 0.0, 0.01] } else { [0.01 * i as f32, -0.1, 1.0] };
    let samples = Samples::F32((0..150).flat_map(normal).collect());
    let image = Image { width: 150, height: 1, channels: 3, samples };
    let map = NormalMap::new(image, NormalLayout::Xyz, false).unwrap();
    let mut row = [[0.0; 2]; 150];
    let beside = (0..150).map(|i| i as f32);
    let of = |Offset { u, .. }: Offset, beside| [u, beside];
    NormalOffsets::new(&map).map_offsets(0, beside, &mut row, of, |texel, made| *texel = made);
    for (i, texel) in (0..).zip(row) {
        assert_eq!(texel, [offset_from_normal(normal(i)).u, i as f32]);
    }
}

#[test]
fn outliers_are_counted() {
    let normals = [[0.0, -0.1, 1.0], [1.0, 0.0, 0.05], [0.6, 0.0, -0.8], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0625]];
    let image = Image { width: 5, height: 1, channels: 3, samples: Samples::F32(normals.concat()) };
    let map = NormalMap::new(image, NormalLayout::Xyz, false).unwrap();
    assert_eq!(NormalOffsets::new(&map).outliers(), Outliers { steep: 1, below: 2, unused: 0 });
}

/// A dome whose slopes cross many steps, in 8 bits: what it differs by from the exact one.
#[test]
fn noise_is_what_rounding_makes() {
    let n = 256;
    let exact: Vec<[f32; 3]> = (0..n * n)
        .map(|i| {
            let [x, y] = [i % n, i / n].map(|c| 0.2 * (c as f32 / n as f32 - 0.5));
            [x, y, (1.0 - x * x - y * y).sqrt()]
        })
        .collect();
    let bytes = exact.iter().flatten().map(|c| ((0.5 * c + 0.5) * 255.0).round() as u8).collect();
    let image = Image { width: n, height: n, channels: 3, samples: Samples::U8(bytes) };
    let map = NormalMap::new(image, NormalLayout::Xyz, false).unwrap();
    let offsets = NormalOffsets::new(&map);
    let mut row = vec![Moments::default(); n as usize];
    let mut sums = [0.0; 2];
    for (y, exact) in exact.chunks_exact(n as usize).enumerate() {
        offsets.row(y as u32, &mut row);
        for (found, exact) in row.iter().zip(exact) {
            let exact = offset_from_normal(*exact);
            sums[0] += f64::from(found.mean.u - exact.u).powi(2) / f64::from(n * n);
            sums[1] += f64::from(found.mean.v - exact.v).powi(2) / f64::from(n * n);
        }
    }
    let expected = offsets.noise();
    for (found, expected) in sums.into_iter().zip([expected.uu, expected.vv]) {
        assert!((found / f64::from(expected) - 1.0).abs() < 0.1, "{found} {expected}");
    }
}

#[test]
fn normal_and_offset_are_inverse() {
    for normal in [[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [-0.48, 0.64, 0.6]] {
        let back = normal_from_offset(offset_from_normal(normal));
        for (a, b) in normal.iter().zip(back) {
            assert!((a - b).abs() < 1e-6);
        }
    }
}

use super::*;
use crate::instruction_sets;

#[test]
fn rows_of_any_length_equal_single_texels() {
    let function = |[x, y]: [f32; 2]| [x / y, (x * x + y * y).sqrt(), x.max(y)];
    for length in [0usize, 1, 63, 64, 65, 200] {
        let texels: Vec<[f32; 2]> = (0..length).map(|i| [i as f32 - 70.5, 0.1 + i as f32]).collect();
        let expected: Vec<[f32; 3]> = texels.iter().copied().map(function).collect();
        // Marks the last texel, a texel beyond the row, and no texel.
        for (marked, is_any) in [(length.wrapping_sub(1), length > 0), (length, false), (usize::MAX, false)] {
            let marking = |texel: [f32; 2]| (function(texel), texel[1] == 0.1 + marked as f32);
            for set in instruction_sets() {
                let mut out = vec![[0.0; 3]; length];
                let found =
                    map_row_with(set, texels.iter().copied(), &mut out, marking, |texel, result| *texel = result);
                assert_eq!((&out, found), (&expected, is_any), "{length} texels, {marked}, {set:?}");
            }
        }
    }
}

#[test]
fn elements_beyond_a_row_mark_nothing() {
    let mut row = vec![0.0; 6];
    // The strip is filled up with zeros beyond the row.
    let is_zero = |[x]: [f32; 1]| ([x], x == 0.0);
    assert!(!map_row_marking((1..7).map(|i| [i as f32]), &mut row, is_zero, |out, [x]| *out = x));
}

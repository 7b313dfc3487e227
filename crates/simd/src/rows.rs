//! Functions of texels, applied to whole rows.

use crate::dispatch;

/// Texels of a row that are processed at a time. Their numbers stay in the nearest cache.
const STRIP: usize = 64;

/// Applies `of` to the numbers of every texel of a row, with the vectors of the processor, and stores the results.
///
/// `texels` yields as many texels as `out` holds; `store` writes what `of` returns for a texel to its place in `out`.
/// `of` should not branch.
///
/// The numbers of neighbouring texels are transposed into plain arrays first: compilers turn loops over such arrays
/// into vector code, but not loops over texels of three or five numbers.
pub fn map_row<'a, T: 'a, const N: usize, const M: usize>(
    texels: impl Iterator<Item = [f32; N]>,
    out: &'a mut [T],
    of: impl Fn([f32; N]) -> [f32; M],
    store: impl FnMut(&mut T, [f32; M]),
) {
    map_row_marking(texels, out, |texel| (of(texel), false), store);
}

/// Works as [`map_row`] does, with a function `of` that also marks texels. Returns whether it marked any.
pub fn map_row_marking<'a, T: 'a, const N: usize, const M: usize>(
    texels: impl Iterator<Item = [f32; N]>,
    out: &'a mut [T],
    of: impl Fn([f32; N]) -> ([f32; M], bool),
    store: impl FnMut(&mut T, [f32; M]),
) -> bool {
    map_row_with(fearless_simd::Level::new(), texels, out, of, store)
}

fn map_row_with<'a, T: 'a, const N: usize, const M: usize>(
    level: fearless_simd::Level,
    texels: impl Iterator<Item = [f32; N]>,
    out: &'a mut [T],
    of: impl Fn([f32; N]) -> ([f32; M], bool),
    store: impl FnMut(&mut T, [f32; M]),
) -> bool {
    dispatch!(level, _simd => map_strips(texels, out, of, store))
}

#[inline(always)]
fn map_strips<'a, T: 'a, const N: usize, const M: usize>(
    mut texels: impl Iterator<Item = [f32; N]>,
    out: &'a mut [T],
    of: impl Fn([f32; N]) -> ([f32; M], bool),
    mut store: impl FnMut(&mut T, [f32; M]),
) -> bool {
    let (mut from, mut to, mut marks) = ([[0.0; STRIP]; N], [[0.0; STRIP]; M], [0; STRIP]);
    let mut is_any_marked = false;
    for out in out.chunks_mut(STRIP) {
        for (i, texel) in texels.by_ref().take(out.len()).enumerate() {
            for n in 0..N {
                from[n][i] = texel[n];
            }
        }
        for i in 0..STRIP {
            let mut texel = [0.0; N];
            for n in 0..N {
                texel[n] = from[n][i];
            }
            let (made, is_marked) = of(texel);
            for m in 0..M {
                to[m][i] = made[m];
            }
            marks[i] = u32::from(is_marked);
        }
        is_any_marked |= marks[..out.len()].iter().fold(0, |any, mark| any | mark) != 0;
        for (i, out) in out.iter_mut().enumerate() {
            let mut made = [0.0; M];
            for m in 0..M {
                made[m] = to[m][i];
            }
            store(out, made);
        }
    }
    is_any_marked
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instruction_sets;

    #[test]
    fn rows_of_any_length_hold_what_single_texels_would() {
        let of = |[x, y]: [f32; 2]| [x / y, (x * x + y * y).sqrt(), x.max(y)];
        for length in [0usize, 1, 63, 64, 65, 200] {
            let texels: Vec<[f32; 2]> = (0..length).map(|i| [i as f32 - 70.5, 0.1 + i as f32]).collect();
            let expected: Vec<[f32; 3]> = texels.iter().copied().map(of).collect();
            // The last texel alone, one beyond it, and none.
            for (marked, is_any) in [(length.wrapping_sub(1), length > 0), (length, false), (usize::MAX, false)] {
                let marking = |texel: [f32; 2]| (of(texel), texel[1] == 0.1 + marked as f32);
                for set in instruction_sets() {
                    let mut out = vec![[0.0; 3]; length];
                    let found =
                        map_row_with(set, texels.iter().copied(), &mut out, marking, |texel, made| *texel = made);
                    assert_eq!((&out, found), (&expected, is_any), "{length} texels, {marked}, {set:?}");
                }
            }
        }
    }

    #[test]
    fn what_stands_beyond_a_row_marks_nothing() {
        let mut row = vec![0.0; 6];
        // The rest of its strip is zeros.
        let is_zero = |[x]: [f32; 1]| ([x], x == 0.0);
        assert!(!map_row_marking((1..7).map(|i| [i as f32]), &mut row, is_zero, |out, [x]| *out = x));
    }
}

//! Applies functions of texels to rows.

use crate::dispatch;

/// Number of texels that are processed at a time. Their numbers stay in the level 1 cache.
const STRIP: usize = 64;

/// Applies `function` to the numbers of every texel of a row and stores the results, with the vectors of the processor.
///
/// `texels` yields as many texels as `out` holds. `store` writes the result for a texel to its element of `out`.
/// `function` should not branch.
///
/// The numbers of neighbouring texels are first transposed into plain arrays. Compilers vectorise loops over such
/// arrays, but not loops over texels of three or five numbers.
pub fn map_row<'a, T: 'a, const N: usize, const M: usize>(
    texels: impl Iterator<Item = [f32; N]>,
    out: &'a mut [T],
    function: impl Fn([f32; N]) -> [f32; M],
    store: impl FnMut(&mut T, [f32; M]),
) {
    // A function that is not compiled into the loop is not vectorised.
    map_row_marking(
        texels,
        out,
        #[inline(always)]
        |texel| (function(texel), false),
        store,
    );
}

/// Works like [`map_row`] with a `function` that can also mark texels. Returns whether any texel was marked.
pub fn map_row_marking<'a, T: 'a, const N: usize, const M: usize>(
    texels: impl Iterator<Item = [f32; N]>,
    out: &'a mut [T],
    function: impl Fn([f32; N]) -> ([f32; M], bool),
    store: impl FnMut(&mut T, [f32; M]),
) -> bool {
    map_row_with(fearless_simd::Level::new(), texels, out, function, store)
}

fn map_row_with<'a, T: 'a, const N: usize, const M: usize>(
    level: fearless_simd::Level,
    texels: impl Iterator<Item = [f32; N]>,
    out: &'a mut [T],
    function: impl Fn([f32; N]) -> ([f32; M], bool),
    store: impl FnMut(&mut T, [f32; M]),
) -> bool {
    dispatch!(level, _simd => map_strips(texels, out, function, store))
}

#[inline(always)]
fn map_strips<'a, T: 'a, const N: usize, const M: usize>(
    mut texels: impl Iterator<Item = [f32; N]>,
    out: &'a mut [T],
    function: impl Fn([f32; N]) -> ([f32; M], bool),
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
            let (result, is_marked) = function(texel);
            for m in 0..M {
                to[m][i] = result[m];
            }
            marks[i] = u32::from(is_marked);
        }
        is_any_marked |= marks[..out.len()].iter().fold(0, |any, mark| any | mark) != 0;
        for (i, out) in out.iter_mut().enumerate() {
            let mut result = [0.0; M];
            for m in 0..M {
                result[m] = to[m][i];
            }
            store(out, result);
        }
    }
    is_any_marked
}

#[cfg(test)]
mod tests;

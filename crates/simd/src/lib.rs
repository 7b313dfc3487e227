//! Arithmetic on texels, written once for single numbers and for vectors of them.
//!
//! Kernels are generic over [`Real`] and put one texel into each lane of a vector ([`Wide`]). Every lane then holds the
//! bits that a single number would, whatever vectors the machine has: only operations that IEEE 754 rounds alike
//! everywhere are offered, so there is no fused multiplication and no approximate reciprocal. [`dispatch!`] compiles a
//! kernel for every instruction set and calls the one that the processor has; [`map_row`] applies a function of one
//! texel to a row.
//!
//! ```
//! use texel_simd::{Real, map_row};
//!
//! fn length<F: Real>([x, y]: [F; 2]) -> F {
//!     (x * x + y * y).sqrt()
//! }
//!
//! let texels = [[3.0, 4.0], [5.0, 12.0]];
//! let mut lengths = [0.0; 2];
//! map_row(texels.into_iter(), &mut lengths, |texel| [length(texel)], |out, [length]| *out = length);
//! assert_eq!(lengths, [5.0, 13.0]);
//! ```
//!
//! The vectors are those of crate `fearless_simd`, which is re-exported so that users can name its types.

mod real;
mod rows;

pub use fearless_simd;
use fearless_simd::{Level, f32x16};
pub use real::Real;
pub use rows::{map_row, map_row_marking};

/// Texels side by side in a vector: as many as a vector of AVX-512 holds. With shorter vectors each number takes two or
/// four of them; with AVX2 a bake of Roughcast takes as long as with eight lanes.
pub const LANES: usize = 16;

/// The numbers of [`LANES`] texels.
pub type Wide<S> = f32x16<S>;

/// Evaluates `$op` with the vectors `$simd` of the instruction set at `$level`, as `fearless_simd::dispatch!` does.
///
/// On x86-64 code is made for three of the four sets that `fearless_simd` knows, since each of them adds as much to the
/// time that kernels take to compile: few machines have SSE4.2 and no AVX2. With AVX-512 a bake of Roughcast takes 0.86
/// of the time that it takes with AVX2.
#[macro_export]
macro_rules! dispatch {
    ($level:expr, $simd:ident => $op:expr) => {{
        let level: $crate::fearless_simd::Level = $level;
        #[cfg(target_arch = "x86_64")]
        match (level.as_avx512(), level.as_avx2(), level.as_sse2()) {
            (Some($simd), ..) => $crate::fearless_simd::Simd::vectorize($simd, #[inline(always)] || $op),
            (None, Some($simd), _) => $crate::fearless_simd::Simd::vectorize($simd, #[inline(always)] || $op),
            (None, None, Some($simd)) => $crate::fearless_simd::Simd::vectorize($simd, #[inline(always)] || $op),
            (None, None, None) => unreachable!("SSE2 is part of x86-64"),
        }
        #[cfg(not(target_arch = "x86_64"))]
        $crate::fearless_simd::dispatch!(level, $simd => $op)
    }};
}

/// Returns the instruction sets that [`dispatch!`] can choose from on this machine, the best one last: for tests that
/// compare what kernels compute with each of them.
pub fn instruction_sets() -> Vec<Level> {
    let all = Level::new();
    #[cfg(target_arch = "x86_64")]
    let sets = [all.as_sse2().map(Level::Sse2), all.as_avx2().map(Level::Avx2), all.as_avx512().map(Level::Avx512)];
    #[cfg(not(target_arch = "x86_64"))]
    let sets = [Some(all)];
    sets.into_iter().flatten().collect()
}

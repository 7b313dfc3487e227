//! Arithmetic on texels, written once for single numbers and for vectors of numbers.
//!
//! Kernels are generic over [`Real`] and put one texel into each lane of a vector ([`Wide`]). Every lane holds the bits
//! that a single number would have, on every machine. [`Real`] therefore offers only operations that IEEE 754 rounds
//! exactly, without fused multiplication and approximate reciprocals. [`dispatch!`] compiles a kernel for every
//! instruction set and calls the best one of the processor. [`map_row`] applies a function of one texel to a row.
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
//! The vectors are those of the crate `fearless_simd`, which is re-exported so that users can name its types.

mod real;
mod rows;

pub use fearless_simd;
use fearless_simd::Level;
pub use real::Real;
pub use rows::{map_row, map_row_marking};
pub use width::{LANES, Wide, WideMask, WideU32};

/// Numbers of texels side by side, on processors whose vectors may have 16 numbers.
///
/// With AVX2 each number of [`LANES`] texels takes two vectors, and with SSE2 four of them; with AVX2 a bake of
/// Roughcast takes as long as with eight lanes.
#[cfg(target_arch = "x86_64")]
mod width {
    /// How many texels stand side by side in a vector.
    pub const LANES: usize = 16;
    /// The numbers of [`LANES`] texels.
    pub type Wide<S> = fearless_simd::f32x16<S>;
    /// The whole numbers of [`LANES`] texels.
    pub type WideU32<S> = fearless_simd::u32x16<S>;
    /// The truth values of [`LANES`] texels.
    pub type WideMask<S> = fearless_simd::mask32x16<S>;
}

/// Numbers of texels side by side, elsewhere: vectors of NEON and of WebAssembly have four numbers, and without vectors
/// longer arrays of numbers take the compiler minutes.
#[cfg(not(target_arch = "x86_64"))]
mod width {
    /// How many texels stand side by side in a vector.
    pub const LANES: usize = 4;
    /// The numbers of [`LANES`] texels.
    pub type Wide<S> = fearless_simd::f32x4<S>;
    /// The whole numbers of [`LANES`] texels.
    pub type WideU32<S> = fearless_simd::u32x4<S>;
    /// The truth values of [`LANES`] texels.
    pub type WideMask<S> = fearless_simd::mask32x4<S>;
}

/// Evaluates `$op` with the vectors `$simd` of the instruction set at `$level`, as `fearless_simd::dispatch!` does.
///
/// On x86-64, code is compiled for SSE2, AVX2 and AVX-512, but not for SSE4.2, because every instruction set adds to
/// the compile time and few machines have SSE4.2 without AVX2. A bake of Roughcast with AVX-512 takes 0.86 of the time
/// with AVX2.
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

/// Returns the instruction sets that [`dispatch!`] can choose from on this machine, the best one last. Tests use this
/// function to compare the results of kernels between instruction sets.
pub fn instruction_sets() -> Vec<Level> {
    let all = Level::new();
    #[cfg(target_arch = "x86_64")]
    let sets = [all.as_sse2().map(Level::Sse2), all.as_avx2().map(Level::Avx2), all.as_avx512().map(Level::Avx512)];
    #[cfg(not(target_arch = "x86_64"))]
    let sets = [Some(all)];
    sets.into_iter().flatten().collect()
}

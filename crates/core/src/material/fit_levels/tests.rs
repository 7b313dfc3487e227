use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::*;
use crate::lobe::test_lobes::isotropic_lobe;
use crate::lobe::{OrientedLobe, SquaredAlpha};
use crate::math::symmetric::Symmetric2;
use crate::metric::{Lobe, Precision, sample_sites};
use crate::mip::Level;

const SIDE: u32 = 64;

/// Returns mirrors with tilts at random, beside rough texels.
fn mirrors_beside_rough_texels() -> Level<OrientedLobe> {
    let mut state = 1_u32;
    let mut random = || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (state >> 16) as f32 / 65536.0
    };
    let texels = (0..SIDE * SIDE).map(|_| {
        let (x, y, alpha) = (random() * 0.2 - 0.1, random() * 0.2 - 0.1, if random() < 0.4 { 0.05 } else { 0.5_f32 });
        let length = (x * x + y * y + 1.0).sqrt();
        let squared_alpha = SquaredAlpha(Symmetric2::diagonal(alpha * alpha, alpha * alpha));
        OrientedLobe { normal: [x / length, y / length, 1.0 / length], squared_alpha }
    });
    Level { width: SIDE, height: SIDE, texels: texels.collect() }
}

/// Returns the mean lobe error of `levels`.
fn error(level_0: &Level<OrientedLobe>, tail: &MipTail<OrientedLobe>, levels: Range<usize>) -> f64 {
    let rows = |first, out: &mut [OrientedLobe]| level_0.rows(first, out);
    let sites = sample_sites(&level_sizes(SIDE, SIDE), levels, Family::Ggx, Precision::QUICK, &rows);
    let errors = sites.iter().map(|site| {
        let mut row = vec![OrientedLobe::default(); (SIDE >> site.level) as usize];
        tail.row(level_0, site.level, site.texel.1, &mut row);
        let OrientedLobe { normal, squared_alpha: SquaredAlpha(a) } = row[site.texel.0 as usize];
        site.reference.error(&Lobe::new(Family::Ggx, normal.map(f64::from), [a.uu, a.uv, a.vv].map(f64::from)))
    });
    errors.sum::<f64>() / sites.len() as f64
}

#[test]
fn the_first_kept_level_stands_for_level_1() {
    let level_0 = mirrors_beside_rough_texels();
    // Level 1 has 32 x 32 texels, so that it is kept in one tail only.
    let tails = [SIDE * SIDE, 16 * 16].map(|most| MipTail::with_max_kept(&level_0, u64::from(most)));
    assert_eq!(tails.each_ref().map(MipTail::first_kept), [1, 2]);
    let merged = error(&level_0, &tails[0], 4..6);
    let [kept, unkept] = tails.map(|mut tail| {
        fit_levels(&level_0, &mut tail, Family::Ggx, Effort::Fast);
        error(&level_0, &tail, 4..6)
    });
    assert!(unkept < kept + 0.01 && unkept < merged + 0.01, "{unkept} {kept} {merged}");
}

/// Counts the rows that are read.
struct Counted<'a> {
    level_0: &'a Level<OrientedLobe>,
    rows: AtomicUsize,
}

impl TexelRows for Counted<'_> {
    type Texel = OrientedLobe;

    fn width(&self) -> u32 {
        self.level_0.width
    }

    fn height(&self) -> u32 {
        self.level_0.height
    }

    fn row(&self, y: u32, out: &mut [OrientedLobe]) {
        self.rows.fetch_add(1, Ordering::Relaxed);
        self.level_0.row(y, out);
    }
}

/// Level 1 is computed to mark texels of level 2, to fit their widths, and to fit level 3. Besides, level 2 is fitted
/// to level 0.
#[test]
fn coarse_levels_do_not_compute_level_1_again() {
    let level_0 = mirrors_beside_rough_texels();
    let counted = Counted { level_0: &level_0, rows: AtomicUsize::default() };
    let mut tail = MipTail::with_max_kept(&counted, 16 * 16);
    counted.rows.store(0, Ordering::Relaxed);
    fit_levels(&counted, &mut tail, Family::Ggx, Effort::Fast);
    assert_eq!(counted.rows.into_inner(), 4 * SIDE as usize);
}

/// Lobes that differ in width alone get the best width, although their merges drift.
#[test]
fn widths_of_a_flat_surface_are_fitted() {
    let mut state = 7_u32;
    let mut random = || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (state >> 16) as f32 / 65536.0
    };
    // Squares of 2 x 2 texels are alike, since `fast` fits to texels of level 1.
    let squares: Vec<f32> = (0..SIDE * SIDE / 4).map(|_| if random() < 0.7 { 0.1 } else { 0.35 }).collect();
    let square = |x: u32, y: u32| squares[(y / 2 * (SIDE / 2) + x / 2) as usize];
    let texels = (0..SIDE * SIDE).map(|i| isotropic_lobe(square(i % SIDE, i / SIDE), 0.0)).collect();
    let level_0 = Level { width: SIDE, height: SIDE, texels };
    let merged = MipTail::new(&level_0);
    let [fast, best] = [Effort::Fast, Effort::Best].map(|quality| {
        let mut tail = MipTail::new(&level_0);
        fit_levels(&level_0, &mut tail, Family::Ggx, quality);
        error(&level_0, &tail, 2..5)
    });
    let merged = error(&level_0, &merged, 2..5);
    assert!(fast < 1.05 * best && fast < 0.9 * merged, "{fast} {best} {merged}");
}

use std::sync::atomic::AtomicUsize;

use super::*;
use crate::lobe::SquaredAlpha;
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

/// Returns the mean lobe error of levels 4 and 5.
fn error(level_0: &Level<OrientedLobe>, tail: &MipTail<OrientedLobe>) -> f64 {
    let rows = |first, out: &mut [OrientedLobe]| level_0.rows(first, out);
    let sites = sample_sites(&level_sizes(SIDE, SIDE), 4..6, Family::Ggx, Precision::QUICK, &rows);
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
    let merged = error(&level_0, &tails[0]);
    let [kept, unkept] = tails.map(|mut tail| {
        fit_levels(&level_0, &mut tail, Family::Ggx, Effort::Fast);
        error(&level_0, &tail)
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

/// Level 1 is computed to mark uneven texels of level 2 and to fit level 3. Besides, level 2 is fitted to level 0.
#[test]
fn coarse_levels_do_not_compute_level_1_again() {
    let level_0 = mirrors_beside_rough_texels();
    let counted = Counted { level_0: &level_0, rows: AtomicUsize::default() };
    let mut tail = MipTail::with_max_kept(&counted, 16 * 16);
    counted.rows.store(0, Ordering::Relaxed);
    fit_levels(&counted, &mut tail, Family::Ggx, Effort::Fast);
    assert_eq!(counted.rows.into_inner(), 3 * SIDE as usize);
}

/// Between 2 and 4 times the least alpha, the distance of the normals counts: half of the least alpha, which is 0.1.
#[test]
fn lobes_of_one_direction_differ_from_a_larger_ratio_on() {
    let differ_with = |ratio: f32, distance: f32| {
        let lobe = |alpha: f32, x: f32| OrientedLobe {
            normal: [x, 0.0, (1.0 - x * x).sqrt()],
            squared_alpha: SquaredAlpha(Symmetric2::diagonal(alpha * alpha, alpha * alpha)),
        };
        let narrow = lobe(0.1, 0.0);
        differ(&[narrow, narrow, lobe(0.1 * ratio, distance), narrow])
    };
    assert_eq!([1.9, 2.1, 3.9, 4.1].map(|ratio| differ_with(ratio, 0.04)), [false, false, false, true]);
    assert_eq!([1.9, 2.1, 3.9, 4.1].map(|ratio| differ_with(ratio, 0.06)), [false, true, true, true]);
}

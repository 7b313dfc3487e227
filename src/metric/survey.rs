//! A quick judgement of a whole material: few texels per level, each with a coarse truth.

use std::collections::BTreeMap;
use std::ops::Range;

use rayon::prelude::*;

use crate::lobe::{Family, OrientedLobe};
use crate::metric::clump::clumped;
use crate::metric::footprint::{Footprint, Part, overlaps};
use crate::metric::reference::{Reference, even_point};
use crate::metric::score::sample_texels;

/// How much a survey looks at, level by level: where a level has few texels, each is looked at the closer. Time grows with
/// `half_vectors * parts`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Precision {
    /// Texels of a level.
    pub texels: usize,
    /// Level-0 texels that are drawn from all their footprints together, where there are more.
    pub level0: u32,
    /// Parts of a footprint after clumping.
    pub parts: usize,
    /// Half-vectors for all texels together, at most 2048 for one.
    pub half_vectors: usize,
}

impl Precision {
    /// For a default bake: mean errors per level within about 0.01 of the full judge (`examples/survey.rs`: 0.0066, root mean square;
    /// with twice the ground 0.0056, where the choice of texels makes 0.018 of either).
    pub const QUICK: Self = Self { texels: 64, level0: 1 << 16, parts: 256, half_vectors: 8192 };

    fn samples(&self, texels: usize) -> usize {
        (self.half_vectors / texels.max(1)).clamp(1, 2048)
    }

    /// Rows, and columns of each, that are drawn from one of `texels` footprints.
    fn grid(&self, texels: usize) -> u32 {
        (self.level0 / texels.max(1) as u32).isqrt().clamp(1, 256)
    }
}

/// A judged texel.
pub struct Site {
    /// Its level.
    pub level: usize,
    /// Column and row in the level.
    pub texel: (u32, u32),
    /// What it covers, clumped.
    pub footprint: Footprint,
    /// The truth that lobes are judged by.
    pub reference: Reference,
}

/// A texel to be judged.
struct SamplePoint {
    level: usize,
    size: (u32, u32),
    texel: (u32, u32),
    grid: u32,
    samples: usize,
    /// How many of the level come before it.
    index: usize,
}

/// Writes a row of level-0 texels.
pub type Level0Row<'a> = dyn Fn(u32, &mut [OrientedLobe]) + Sync + 'a;

/// The judged texels of `levels` of a chain with `sizes`, whose texels have lobes of `family`, level by level: always the same ones. `row` is read once for
/// each row of level 0 that is needed. Depends on neither machine nor threads.
pub fn survey(
    sizes: &[(u32, u32)],
    levels: Range<usize>,
    family: Family,
    precision: Precision,
    row: &Level0Row<'_>,
) -> Vec<Site> {
    let Some(&whole) = sizes.first() else { return Vec::new() };
    let mut points = Vec::new();
    for level in levels {
        let Some(&size) = sizes.get(level) else { break };
        let texels = sample_texels(size, precision.texels);
        let (grid, samples) = (precision.grid(texels.len()), precision.samples(texels.len()));
        let point = |(index, texel)| SamplePoint { level, size, texel, grid, samples, index };
        points.extend(texels.into_iter().enumerate().map(point));
    }
    // All rows of level 0 that some texel covers, with the texels.
    let mut rows: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (index, point) in points.iter().enumerate() {
        for (row, _) in point.rows(whole) {
            rows.entry(row).or_default().push(index);
        }
    }
    let rows: Vec<(u32, Vec<usize>)> = rows.into_iter().collect();
    let counts: Vec<usize> = points.iter().map(|point| point.columns(whole, 0).len()).collect();
    // Lobes alone: as parts, with their shares and in double precision, one list for each texel, they cost a bake of 4096 x 4096
    // 14 000 page faults more (`perf stat -e page-faults`).
    let drawn: Vec<Vec<OrientedLobe>> = rows
        .par_iter()
        .map_init(
            || vec![OrientedLobe::default(); whole.0 as usize],
            |lobes, (y, users)| {
                row(*y, lobes);
                let mut drawn = Vec::with_capacity(users.iter().map(|index| counts[*index]).sum());
                for index in users {
                    drawn.extend(points[*index].columns(whole, *y).iter().map(|(column, _)| lobes[*column as usize]));
                }
                drawn
            },
        )
        .collect();
    let mut strips: Vec<Vec<&[OrientedLobe]>> = points.iter().map(|_| Vec::new()).collect();
    for ((_, users), mut drawn) in rows.iter().zip(drawn.iter().map(Vec::as_slice)) {
        for index in users {
            let (strip, rest) = drawn.split_at(counts[*index]);
            strips[*index].push(strip);
            drawn = rest;
        }
    }
    let site = |(point, strips): (&SamplePoint, Vec<&[OrientedLobe]>)| {
        let parts = point.rows(whole).into_iter().zip(strips).flat_map(|((y, share), strip)| {
            let columns = point.columns(whole, y).into_iter().zip(strip);
            columns.map(move |((_, weight), lobe)| part(lobe, share * weight))
        });
        let footprint = clumped(parts.collect(), precision.parts)?;
        let reference = Reference::continued(family, &footprint, point.samples, point.index * point.samples);
        Some(Site { level: point.level, texel: point.texel, footprint, reference })
    };
    points.par_iter().zip(strips).filter_map(site).collect()
}

impl SamplePoint {
    /// Rows of level 0, which has the size `whole`, that are drawn from the texel, top to bottom, with their shares.
    fn rows(&self, whole: (u32, u32)) -> Vec<(u32, f64)> {
        drawn(whole.1, self.size.1, self.texel.1, self.grid, self.level)
    }

    /// Columns that are drawn from row `y`, as many from each: others from each row, or regular bumps could hide between them.
    fn columns(&self, whole: (u32, u32), y: u32) -> Vec<(u32, f64)> {
        drawn(whole.0, self.size.0, self.texel.0, self.grid, y as usize)
    }
}

/// The texels of an axis of `old` that texel `i` of `new` covers, with their shares; `limit` of them in even strata where
/// there are more, `turn` deciding where in its stratum each lies.
fn drawn(old: u32, new: u32, i: u32, limit: u32, turn: usize) -> Vec<(u32, f64)> {
    let new = new.max(1);
    let covered = f64::from(old) / f64::from(new);
    if covered <= f64::from(limit) {
        return overlaps(old, new, i);
    }
    let start = covered * f64::from(i.min(new - 1));
    let at = |stratum: u32| {
        let [jitter, _] = even_point(stratum as usize + 61 * turn);
        let texel = start + (f64::from(stratum) + jitter) * covered / f64::from(limit);
        ((texel as u32).min(old - 1), 1.0 / f64::from(limit))
    };
    (0..limit).map(at).collect()
}

fn part(lobe: &OrientedLobe, weight: f64) -> Part {
    let a = lobe.squared_alpha.0;
    Part { weight, normal: lobe.normal.map(f64::from), base: [a.uu, a.uv, a.vv].map(f64::from) }
}

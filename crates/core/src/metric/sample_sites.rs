//! Sample sites: few texels of each level with small references, from which the lobe errors of a whole material are
//! estimated quickly.

use std::collections::BTreeMap;
use std::ops::Range;

use rayon::prelude::*;

use crate::lobe::{Family, OrientedLobe};
use crate::metric::cluster::clustered;
use crate::metric::decoded::sample_texels;
use crate::metric::footprint::{Footprint, Part, overlaps};
use crate::metric::reference::{Reference, even_point};

/// How many sites each level has. A level with few texels has more samples for each texel. Time grows with
/// `half_vectors * parts`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Precision {
    /// Most texels of a level.
    pub texels: usize,
    /// Most level-0 texels drawn from the footprints of a level, all together.
    pub level0: u32,
    /// Most parts of a footprint after clustering.
    pub parts: usize,
    /// Half-vectors for all texels of a level together, at most 2048 for one texel.
    pub half_vectors: usize,
}

impl Precision {
    /// The precision of a default bake: mean errors of a level within about 0.01 of all samples.
    /// `benches/studies/survey.rs` measures 0.0066 (root mean square), and 0.0056 with twice the level-0 texels. The
    /// choice of texels contributes 0.018 to both.
    pub const QUICK: Self = Self { texels: 64, level0: 1 << 16, parts: 256, half_vectors: 8192 };

    fn samples(&self, texels: usize) -> usize {
        (self.half_vectors / texels.max(1)).clamp(1, 2048)
    }

    /// Returns the number of rows, and of columns in each row, that are drawn from one of `texels` footprints.
    fn grid(&self, texels: usize) -> u32 {
        (self.level0 / texels.max(1) as u32).isqrt().clamp(1, 256)
    }
}

/// A texel with its reference, ready for candidates to be compared.
pub struct Site {
    /// The texel's level.
    pub level: usize,
    /// Column and row in the level.
    pub texel: (u32, u32),
    /// The texel's footprint, clustered.
    pub footprint: Footprint,
    /// The reference that candidates are compared with.
    pub reference: Reference,
}

/// A texel that is to be sampled.
struct SamplePoint {
    level: usize,
    size: (u32, u32),
    texel: (u32, u32),
    grid: u32,
    samples: usize,
    /// How many sample points of the level precede this one.
    index: usize,
}

/// Writes one row of level-0 texels.
pub type Level0Row<'a> = dyn Fn(u32, &mut [OrientedLobe]) + Sync + 'a;

/// Returns the sampled texels of `levels` of a mip chain with `sizes`, whose texels have lobes of `family`, level by
/// level. `row` is called once for each row of level 0 that is needed. The result depends on neither machine nor
/// threads.
pub fn sample_sites(
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
    // All rows of level 0 that a footprint covers, with the indices of its sample points.
    let mut rows: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (index, point) in points.iter().enumerate() {
        for (row, _) in point.rows(whole) {
            rows.entry(row).or_default().push(index);
        }
    }
    let rows: Vec<(u32, Vec<usize>)> = rows.into_iter().collect();
    let counts: Vec<usize> = points.iter().map(|point| point.columns(whole, 0).len()).collect();
    // Only lobes are kept here. Parts with shares in double precision, in one list for each texel, cost a bake of
    // 4096 x 4096 texels 14 000 more page faults (`perf stat -e page-faults`).
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
        let footprint = clustered(parts.collect(), precision.parts)?;
        let reference = Reference::from_point(family, &footprint, point.samples, point.index * point.samples);
        Some(Site { level: point.level, texel: point.texel, footprint, reference })
    };
    points.par_iter().zip(strips).filter_map(site).collect()
}

impl SamplePoint {
    /// Returns the rows of level 0, which has the size `whole`, that are drawn for this point, top to bottom, with
    /// shares.
    fn rows(&self, whole: (u32, u32)) -> Vec<(u32, f64)> {
        strata(whole.1, self.size.1, self.texel.1, self.grid, self.level)
    }

    /// Returns the columns that are drawn from row `y`, equally many from each row. Rows draw different columns,
    /// because regular bumps could hide between equal ones.
    fn columns(&self, whole: (u32, u32), y: u32) -> Vec<(u32, f64)> {
        strata(whole.0, self.size.0, self.texel.0, self.grid, y as usize)
    }
}

/// Returns the texels of an axis of length `old` that texel `i` of an axis of length `new` covers, with their shares.
/// Where there are more than `limit`, one texel is drawn from each of `limit` equal strata. `seed` decides where in its
/// stratum each texel lies.
fn strata(old: u32, new: u32, i: u32, limit: u32, seed: usize) -> Vec<(u32, f64)> {
    let new = new.max(1);
    let covered = f64::from(old) / f64::from(new);
    if covered <= f64::from(limit) {
        return overlaps(old, new, i);
    }
    let start = covered * f64::from(i.min(new - 1));
    let at = |stratum: u32| {
        let [jitter, _] = even_point(stratum as usize + 61 * seed);
        let texel = start + (f64::from(stratum) + jitter) * covered / f64::from(limit);
        ((texel as u32).min(old - 1), 1.0 / f64::from(limit))
    };
    (0..limit).map(at).collect()
}

fn part(lobe: &OrientedLobe, weight: f64) -> Part {
    let a = lobe.squared_alpha.0;
    Part { weight, normal: lobe.normal.map(f64::from), base: [a.uu, a.uv, a.vv].map(f64::from) }
}

#[cfg(test)]
mod tests;

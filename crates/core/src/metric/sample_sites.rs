//! Sample sites: few texels of each level with small references, from which the lobe errors of a whole material are
//! estimated quickly.

use std::collections::BTreeMap;
use std::ops::Range;

use rayon::prelude::*;

use crate::lobe::{Family, LobeTexel, OrientedLobe};
use crate::metric::decoded::sample_rows;
use crate::metric::draws::{DRAWN, DrawnFootprint};
use crate::metric::footprint::{Footprint, Part};
use crate::metric::reference::Reference;

/// How many sites each level has. A level with few texels has more samples for each texel. Time grows with
/// `half_vectors * parts`, and with `rows`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Precision {
    /// Most texels of a level.
    pub texels: usize,
    /// Least texels of a level that is not counted whole, where `level0` would allow fewer.
    pub least: usize,
    /// Most texels in all rows of a level that have sites, but at least `least` rows. Candidates are computed row by
    /// row.
    pub rows: usize,
    /// Most level-0 texels drawn from the footprints of a level, all together.
    pub level0: u32,
    /// Half-vectors for all texels of a level together, at most 2048 for one texel.
    pub half_vectors: usize,
}

impl Precision {
    /// The precision of a default bake. Mean errors are within about 0.01 of those of all texels at levels up to 4, and
    /// within 0.03 at coarser levels (`benches/studies/survey.rs`).
    pub const QUICK: Self = Self { texels: 1024, least: 64, rows: 1 << 18, level0: 1 << 17, half_vectors: 8192 };

    /// Returns the texels of a level of `size` that have sites. Level 0 has the size `whole`.
    fn sites(&self, whole: (u32, u32), size: (u32, u32)) -> Vec<(u32, u32)> {
        let texels = self.texels.min(self.level0 as usize / covered(whole, size)).max(self.least);
        let rows = (self.rows / size.0.max(1) as usize).max(self.least);
        sample_rows(size, texels, rows)
    }

    fn samples(&self, texels: usize) -> usize {
        (self.half_vectors / texels.max(1)).clamp(1, 2048)
    }

    /// Returns the number of rows, and of columns in each row, that are drawn from one of `texels` footprints.
    fn strata(&self, texels: usize) -> u32 {
        (self.level0 / texels.max(1) as u32).isqrt().clamp(1, 2 * DRAWN)
    }
}

/// Returns about how many bytes [`sample_sites`] takes for `levels` of a mip chain with `sizes`.
pub fn sample_bytes(sizes: &[(u32, u32)], levels: Range<usize>, precision: Precision) -> u64 {
    let Some(&whole) = sizes.first() else { return 0 };
    let parts = |&size: &(u32, u32)| {
        let texels = precision.sites(whole, size).len();
        texels * covered(whole, size).min((precision.strata(texels) as usize).pow(2))
    };
    let parts: usize = sizes.iter().take(levels.end).skip(levels.start).map(parts).sum();
    // Each part is also a lobe while it is drawn.
    (parts * (size_of::<Part>() + size_of::<OrientedLobe>())) as u64
}

/// A texel with its reference, ready for candidates to be compared.
pub struct Site {
    /// The texel's level.
    pub level: usize,
    /// Column and row in the level.
    pub texel: (u32, u32),
    /// The drawn part of the texel's footprint.
    pub footprint: Footprint,
    /// The reference that candidates are compared with.
    pub reference: Reference,
}

/// A texel that is to be sampled.
struct SamplePoint {
    level: usize,
    drawn: DrawnFootprint,
    samples: usize,
    /// How many sample points of the level precede this one.
    index: usize,
}

/// Rows of level 0 that are read together, if they are needed.
const BAND: u32 = 16;

/// Writes rows of level-0 texels: the row of a number and the rows below.
pub type Level0Rows<'a, T> = dyn Fn(u32, &mut [T]) + Sync + 'a;

/// Returns the sampled texels of `levels` of a mip chain with `sizes`, whose texels have lobes of `family`, level by
/// level. `read` is called once for each band of rows of level 0 that are needed. Texels count by area x reflectance.
/// The result depends on neither machine nor threads.
pub fn sample_sites<T: LobeTexel>(
    sizes: &[(u32, u32)],
    levels: Range<usize>,
    family: Family,
    precision: Precision,
    read: &Level0Rows<'_, T>,
) -> Vec<Site> {
    let Some(&whole) = sizes.first() else { return Vec::new() };
    let mut points = Vec::new();
    for level in levels {
        let Some(&size) = sizes.get(level) else { break };
        let texels = precision.sites(whole, size);
        let (strata, samples) = (precision.strata(texels.len()), precision.samples(texels.len()));
        let point = |(index, texel)| {
            let drawn = DrawnFootprint { whole, size, texel, strata };
            SamplePoint { level, drawn, samples, index }
        };
        points.extend(texels.into_iter().enumerate().map(point));
    }
    // All rows of level 0 that a footprint covers, with the indices of its sample points.
    let mut rows: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (index, point) in points.iter().enumerate() {
        for (row, _) in point.drawn.rows() {
            rows.entry(row).or_default().push(index);
        }
    }
    let rows: Vec<(u32, Vec<usize>)> = rows.into_iter().collect();
    let bands: Vec<&[(u32, Vec<usize>)]> = rows.chunk_by(|a, b| a.0 / BAND == b.0 / BAND).collect();
    let counts: Vec<usize> = points.iter().map(|point| point.drawn.columns(0).len()).collect();
    // Only lobes are kept here. Parts with shares in double precision, in one list for each texel, cost a bake of
    // 4096 x 4096 texels 14 000 more page faults (`perf stat -e page-faults`).
    let width = whole.0 as usize;
    let draw = |lobes: &mut Vec<T>, band: &[(u32, Vec<usize>)]| -> Vec<Vec<T>> {
        let (first, last) = (band[0].0, band[band.len() - 1].0);
        lobes.resize((last - first + 1) as usize * width, T::default());
        read(first, lobes);
        let of_row = |(y, users): &(u32, Vec<usize>)| {
            let lobes = &lobes[(y - first) as usize * width..][..width];
            let mut drawn = Vec::with_capacity(users.iter().map(|index| counts[*index]).sum());
            for index in users {
                drawn.extend(points[*index].drawn.columns(*y).iter().map(|(column, _)| lobes[*column as usize]));
            }
            drawn
        };
        band.iter().map(of_row).collect()
    };
    let drawn: Vec<Vec<Vec<T>>> = bands.par_iter().map_init(Vec::new, |lobes, band| draw(lobes, band)).collect();
    let mut strips: Vec<Vec<&[T]>> = points.iter().map(|_| Vec::new()).collect();
    for ((_, users), mut drawn) in rows.iter().zip(drawn.iter().flatten().map(Vec::as_slice)) {
        for index in users {
            let (strip, rest) = drawn.split_at(counts[*index]);
            strips[*index].push(strip);
            drawn = rest;
        }
    }
    let site = |(point, strips): (&SamplePoint, Vec<&[T]>)| {
        let parts = point.drawn.rows().into_iter().zip(strips).flat_map(|((y, share), strip)| {
            let columns = point.drawn.columns(y).into_iter().zip(strip);
            columns.map(move |((_, weight), texel)| {
                let weight = share * weight * texel.reflectance();
                Part::of(f64::from(weight), texel.lobe())
            })
        });
        let footprint = Footprint::new(parts.collect())?;
        let reference = Reference::from_point(family, &footprint, point.samples, point.index * point.samples);
        Some(Site { level: point.level, texel: point.drawn.texel, footprint, reference })
    };
    points.par_iter().zip(strips).filter_map(site).collect()
}

/// Returns how many texels of a level of size `whole` a texel of a level of `size` may overlap.
fn covered(whole: (u32, u32), size: (u32, u32)) -> usize {
    let along = |old: u32, new: u32| old.div_ceil(new.max(1)) as usize + usize::from(!old.is_multiple_of(new.max(1)));
    along(whole.0, size.0) * along(whole.1, size.1)
}

#[cfg(test)]
mod tests;

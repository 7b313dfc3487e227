//! Sample sites: few texels of each level with small references, from which the lobe errors of a whole material are
//! estimated quickly.

use std::collections::BTreeMap;
use std::ops::Range;

use rayon::prelude::*;

use crate::lobe::{Family, LobeTexel};
use crate::metric::decoded::sample_texels;
use crate::metric::draws::{DRAWN, DrawnFootprint};
use crate::metric::footprint::{Footprint, Part};
use crate::metric::reference::Reference;

/// How many sites each level has. A level with few texels has more samples for each texel. Time grows with
/// `half_vectors * parts`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Precision {
    /// Most texels of a level.
    pub texels: usize,
    /// Most level-0 texels drawn from the footprints of a level, all together.
    pub level0: u32,
    /// Half-vectors for all texels of a level together, at most 2048 for one texel.
    pub half_vectors: usize,
}

impl Precision {
    /// The precision of a default bake: mean errors of a level within about 0.01 of all samples.
    /// `benches/studies/survey.rs` measures 0.0066 (root mean square), and 0.0056 with twice the level-0 texels. The
    /// choice of texels contributes 0.018 to both.
    pub const QUICK: Self = Self { texels: 64, level0: 1 << 16, half_vectors: 8192 };

    fn samples(&self, texels: usize) -> usize {
        (self.half_vectors / texels.max(1)).clamp(1, 2048)
    }

    /// Returns the number of rows, and of columns in each row, that are drawn from one of `texels` footprints.
    fn strata(&self, texels: usize) -> u32 {
        (self.level0 / texels.max(1) as u32).isqrt().clamp(1, 2 * DRAWN)
    }
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
        let texels = sample_texels(size, precision.texels);
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

#[cfg(test)]
mod tests;

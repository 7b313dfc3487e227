//! The lobe error against a reference that is sampled once and shared by all candidates.

use crate::lobe::Family;
use crate::math::vector::Vector;
use crate::metric::density::Lobe;
use crate::metric::footprint::{Footprint, Part};
use crate::metric::mixture::{BATCH, Batch, Mixture};

/// Samples of a footprint that keep the error of [`Reference::error`] below 0.002 (test
/// `doubling_the_samples_changes_little`).
pub const SAMPLES: usize = 4096;

/// Half-vectors drawn evenly from a footprint, with the footprint's density at each.
pub struct Reference {
    family: Family,
    points: Vec<Vector>,
    densities: Vec<f64>,
}

impl Reference {
    /// Samples `footprint`, whose texels have lobes of `family`. The points are a fixed sequence: equal input gives
    /// equal points.
    pub fn new(family: Family, footprint: &Footprint, samples: usize) -> Self {
        Self::from_point(family, footprint, samples, 0)
    }

    /// Samples `footprint` with the points of the sequence from `first` on. Footprints whose errors are averaged should
    /// not share points.
    pub(super) fn from_point(family: Family, footprint: &Footprint, samples: usize, first: usize) -> Self {
        let mut parts: Vec<&Part> = footprint.parts().iter().collect();
        // Neighbours in the list are neighbours in direction, so that samples are also spread evenly over directions.
        parts.sort_by_key(|part| morton_code(part.normal));
        let mut points = Vec::with_capacity(samples);
        let (mut index, mut below) = (0, 0.0);
        for i in 0..samples {
            let chosen = (i as f64 + 0.5) / samples as f64;
            while index + 1 < parts.len() && below + parts[index].weight <= chosen {
                below += parts[index].weight;
                index += 1;
            }
            let lobe = Lobe::new(family, parts[index].normal, parts[index].base);
            points.push(lobe.sample(even_point(first + i)));
        }
        let half_vectors: Vec<_> = points.iter().map(|h| h.map(|c| c as f32)).collect();
        let lobes: Vec<_> = parts.iter().map(|part| (part.weight as f32, part.lobe())).collect();
        let batches: Vec<Batch> = half_vectors.chunks(BATCH).map(Batch::new).collect();
        let densities = Mixture::new(family, &lobes).densities(&batches);
        let densities = densities.into_iter().flatten().take(samples).map(f64::from).collect();
        Self { family, points, densities }
    }

    /// Returns the family of the footprint's lobes.
    pub fn family(&self) -> Family {
        self.family
    }

    /// Returns the half-vectors.
    pub fn points(&self) -> &[Vector] {
        &self.points
    }

    /// Returns the share of half-vectors per steradian at each point.
    pub fn densities(&self) -> &[f64] {
        &self.densities
    }

    /// Returns 1/2 integral |P_ref - P| dw in [0, 1]: the share of reflected half-vectors that `lobe` puts in the wrong
    /// place.
    ///
    /// Both densities integrate to 1: what `P` lacks in one place, it has too much of elsewhere. The error is therefore
    /// the integral of (P_ref - P)+, which is the mean of (1 - P / P_ref)+ over half-vectors drawn from P_ref. No
    /// half-vector need be drawn from P.
    pub fn error(&self, lobe: &Lobe) -> f64 {
        self.error_of_every(1, lobe)
    }

    /// Returns [`Self::error`] over every `stride`-th half-vector.
    pub(super) fn error_of_every(&self, stride: usize, lobe: &Lobe) -> f64 {
        let pairs = self.points.iter().zip(&self.densities).step_by(stride);
        let count = pairs.len();
        let sum: f64 = pairs.map(|(h, density)| (1.0 - lobe.density(*h) / density).max(0.0)).sum();
        sum / count as f64
    }
}

/// Returns point `i` of a sequence that fills the unit square evenly: the additive recurrence of the plastic constant
/// (M. Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018).
pub(super) fn even_point(i: usize) -> [f64; 2] {
    const PLASTIC: f64 = 1.324_717_957_244_746;
    let n = i as f64 + 1.0;
    [(0.5 + n / PLASTIC).fract(), (0.5 + n / (PLASTIC * PLASTIC)).fract()]
}

/// Returns the Morton code of a direction: its position along a z-order curve over the square of (x, y).
fn morton_code([x, y, _]: Vector) -> u32 {
    let spread = |c: f64| {
        let mut bits = ((0.5 * c + 0.5) * 65535.0) as u32;
        bits = (bits | (bits << 8)) & 0x00ff_00ff;
        bits = (bits | (bits << 4)) & 0x0f0f_0f0f;
        bits = (bits | (bits << 2)) & 0x3333_3333;
        (bits | (bits << 1)) & 0x5555_5555
    };
    spread(x) | (spread(y) << 1)
}

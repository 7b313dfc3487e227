//! Searches the endpoints of a block without a time limit.

use crate::format::{Ends, Kind};
use crate::objective::{Reading, Target, total_variation};

/// Texels of a vector that the compiler can keep in registers.
const LANES: usize = 4;

/// How many starts and kicks each subset gets.
#[derive(Clone, Copy)]
pub struct Effort {
    /// Starts at two random texels of the subset.
    pub starts: usize,
    /// Kicks of the best endpoints in a row that may fail.
    pub patience: usize,
}

/// The texels of one subset.
pub struct Subset<'a> {
    kind: &'a Kind,
    reading: Reading,
    members: Vec<Target>,
    /// The numbers of [`Target`] by lanes: both rows, `n` and the factor. Lanes without a texel have no error.
    lanes: Vec<[[f32; LANES]; 10]>,
}

/// A random generator (SplitMix64) that gives the same searches on every machine.
pub struct Random(pub u64);

impl Random {
    fn below(&mut self, count: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % count as u64) as usize
    }

    fn unit(&mut self) -> f32 {
        self.below(1 << 20) as f32 / (1 << 20) as f32
    }
}

impl<'a> Subset<'a> {
    pub fn new(kind: &'a Kind, subset: usize, targets: &[Target; 16], reading: Reading) -> Self {
        let members: Vec<Target> = kind.subsets[subset].iter().map(|&i| targets[i]).collect();
        let lanes = members.chunks(LANES).map(|chunk| {
            let mut lanes = [[0.0; LANES]; 10];
            lanes[8] = [1.0; LANES];
            for (j, target) in chunk.iter().enumerate() {
                let numbers = target.rows.as_flattened().iter().chain(&target.n).chain([&target.factor]);
                numbers.enumerate().for_each(|(k, &number)| lanes[k][j] = number);
            }
            lanes
        });
        Self { kind, reading, lanes: lanes.collect(), members }
    }

    /// Returns the sum of total variations with the best entry for each texel.
    fn error(&self, ends: &Ends) -> f32 {
        let mut least = [[f32::INFINITY; LANES]; 16 / LANES];
        for &weights in &self.kind.weights {
            let (v, loss) = self.reading.entry([0, 1, 2].map(|c| self.kind.level(ends, c, weights)));
            for (least, lanes) in least.iter_mut().zip(&self.lanes) {
                for j in 0..LANES {
                    let dot = |k: usize| lanes[k][j] * v[0] + lanes[k + 1][j] * v[1] + lanes[k + 2][j] * v[2];
                    let (p, q, along) = (dot(0), dot(3), dot(6).max(1e-3));
                    let squared = (p * p + q * q + loss * lanes[9][j]) / (along * along);
                    least[j] = if squared < least[j] { squared } else { least[j] };
                }
            }
        }
        let mut sum = 0.0;
        for least in &least[..self.lanes.len()] {
            least.iter().for_each(|&q| sum += total_variation(q));
        }
        sum
    }

    /// Fits the endpoints of each channel to the levels of the texels by regression on their best entries.
    fn regress(&self, ends: &Ends) -> Ends {
        let entry = |weights| self.reading.entry([0, 1, 2].map(|c| self.kind.level(ends, c, weights)));
        let palette: Vec<_> = self.kind.weights.iter().map(|&weights| (weights, entry(weights))).collect();
        let mut sums = [[0.0_f32; 5]; 3];
        for target in &self.members {
            let (mut least, mut at) = (f32::INFINITY, [0; 2]);
            for (weights, entry) in &palette {
                let squared = target.squared(entry);
                if squared < least {
                    (least, at) = (squared, *weights);
                }
            }
            // Iterated reweighted least squares of the total variation.
            let share = 1.0 / (least + 4.0);
            for (c, sums) in sums.iter_mut().enumerate() {
                let weight = f32::from(at[usize::from(self.kind.selector != Some(c))]) / 64.0;
                let level = target.levels[c];
                let terms = [1.0, weight, weight * weight, level, weight * level];
                sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += share * term);
            }
        }
        sums.map(|[n, w, ww, x, wx]| {
            let determinant = n * ww - w * w;
            let slope = if determinant > 1e-5 * n * ww { (n * wx - w * x) / determinant } else { 0.0 };
            let low = (x - slope * w) / n;
            [self.kind.nearest(low), self.kind.nearest(low + slope)]
        })
    }

    /// Returns endpoints at two random texels, moved outwards or inwards at random.
    fn random_ends(&self, random: &mut Random) -> Ends {
        let [a, b] = [(); 2].map(|()| self.members[random.below(self.members.len())].levels);
        let [p, q] = [(); 2].map(|()| 0.8 * random.unit() - 0.2);
        [0, 1, 2].map(|c| {
            let step = b[c] - a[c];
            [self.kind.nearest(a[c] - p * step), self.kind.nearest(b[c] + q * step)]
        })
    }

    /// Moves one to three endpoints at random.
    fn kicked(&self, mut ends: Ends, random: &mut Random) -> Ends {
        let count = self.kind.levels.len();
        for _ in 0..1 + random.below(3) {
            let (reach, k) = (1 + count / [32, 16, 8, 4][random.below(4)], random.below(6));
            let end = &mut ends[k / 2][k % 2];
            *end = (usize::from(*end) + random.below(2 * reach + 1)).saturating_sub(reach).min(count - 1) as u8;
        }
        ends
    }

    /// Moves single endpoints within `reach` levels, and pairs of endpoints within `pair_reach` levels, until nothing
    /// improves.
    fn descend(&self, ends: &mut Ends, error: &mut f32, reach: i32, pair_reach: i32) {
        let last = self.kind.levels.len() as i32 - 1;
        let mut try_moves = |moves: &[(usize, i32)]| {
            let mut moved = *ends;
            for &(k, by) in moves {
                let end = &mut moved[k / 2][k % 2];
                let to = i32::from(*end) + by;
                if by == 0 || !(0..=last).contains(&to) {
                    return false;
                }
                *end = to as u8;
            }
            let found = self.error(&moved);
            let is_better = found < *error;
            if is_better {
                (*ends, *error) = (moved, found);
            }
            is_better
        };
        loop {
            let mut is_better = false;
            for k in 0..6 {
                for by in -reach..=reach {
                    is_better |= try_moves(&[(k, by)]);
                }
            }
            if is_better {
                continue;
            }
            for (k, l) in (0..6).flat_map(|k| (0..k).map(move |l| (k, l))) {
                for (by, other) in
                    (-pair_reach..=pair_reach).flat_map(|a| (-pair_reach..=pair_reach).map(move |b| (a, b)))
                {
                    is_better |= try_moves(&[(k, by), (l, other)]);
                }
            }
            if !is_better {
                return;
            }
        }
    }

    /// Returns the best endpoints found from `given` and from random starts.
    pub fn search(&self, given: &[Ends], effort: Effort, random: &mut Random) -> (Ends, f32) {
        let mut best = ([[0; 2]; 3], f32::INFINITY);
        let random_starts: Vec<Ends> = (0..effort.starts).map(|_| self.random_ends(random)).collect();
        for start in given.iter().chain(&random_starts) {
            let mut found = (*start, self.error(start));
            for _ in 0..4 {
                let ends = self.regress(&found.0);
                let error = self.error(&ends);
                if error >= found.1 {
                    break;
                }
                found = (ends, error);
            }
            self.descend(&mut found.0, &mut found.1, 2, 1);
            if found.1 < best.1 {
                best = found;
            }
        }
        let mut failures = 0;
        while failures < effort.patience {
            let mut ends = self.kicked(best.0, random);
            if random.below(2) == 0 {
                ends = self.regress(&ends);
            }
            let mut error = self.error(&ends);
            self.descend(&mut ends, &mut error, 2, 1);
            failures += 1;
            if error < best.1 {
                (best, failures) = ((ends, error), 0);
            }
        }
        best
    }

    /// Tries all levels of single endpoints, and pairs within five levels, until nothing improves.
    pub fn finish(&self, (mut ends, mut error): (Ends, f32)) -> (Ends, f32) {
        self.descend(&mut ends, &mut error, self.kind.levels.len() as i32, 5);
        (ends, error)
    }

    /// Returns the least error of all endpoints, which only modes of few levels allow.
    pub fn exhaust(&self) -> f32 {
        let count = self.kind.levels.len();
        let mut least = f32::INFINITY;
        // Swapped endpoints give the same palette but for rounding: the first channel rises.
        for k in 0..count.pow(6) {
            let end = |j: u32| (k / count.pow(j) % count) as u8;
            let ends = [[end(0), end(1)], [end(2), end(3)], [end(4), end(5)]];
            if ends[0][0] <= ends[0][1] {
                least = least.min(self.error(&ends));
            }
        }
        least
    }

    /// Returns the decoded colours of the texels, in the order of the subset.
    pub fn colours(&self, ends: &Ends) -> Vec<[u8; 3]> {
        let palette: Vec<[u8; 3]> =
            self.kind.weights.iter().map(|&weights| [0, 1, 2].map(|c| self.kind.level(ends, c, weights))).collect();
        let nearest = |target: &Target| {
            let squared = |colour: &&[u8; 3]| target.squared(&self.reading.entry(**colour));
            palette.iter().min_by(|a, b| squared(a).total_cmp(&squared(b))).copied().unwrap_or_default()
        };
        self.members.iter().map(nearest).collect()
    }
}

/// The best block found.
pub struct Found {
    /// Its index among the kinds.
    pub kind: usize,
    pub error: f32,
    pub colours: [[u8; 3]; 16],
    /// The least error found with each kind.
    pub by_kind: Vec<f32>,
}

/// Kinds whose quick search is worse than the best one by this factor get no thorough search.
const HOPELESS: f32 = 1.15;

/// Searches all `kinds` for a block that is given as `targets`. `given` are the encoder's blocks: they are starts too.
pub fn search(kinds: &[Kind], targets: &[Target; 16], reading: Reading, given: &[[u8; 16]], effort: usize) -> Found {
    let mut random = Random(1);
    let mut search = |kind: &Kind, starts: &[Vec<Ends>], effort: Effort| -> (Vec<Ends>, f32) {
        let subsets = (0..kind.subsets.len()).map(|k| {
            let own: Vec<Ends> = starts.iter().map(|ends| ends[k]).collect();
            Subset::new(kind, k, targets, reading).search(&own, effort, &mut random)
        });
        let (ends, errors): (Vec<Ends>, Vec<f32>) = subsets.unzip();
        (ends, errors.iter().sum())
    };
    let quick = Effort { starts: 3 * effort, patience: 4 * effort };
    let thorough = Effort { starts: 12 * effort, patience: 24 * effort };
    let quick = kinds.iter().map(|kind| {
        let starts: Vec<Vec<Ends>> = given.iter().filter_map(|block| kind.ends_of(block)).collect();
        search(kind, &starts, quick)
    });
    let mut found: Vec<(Vec<Ends>, f32)> = quick.collect();
    let limit = HOPELESS * found.iter().map(|found| found.1).fold(f32::INFINITY, f32::min);
    for (kind, found) in kinds.iter().zip(&mut found).filter(|(_, found)| found.1 <= limit) {
        let (ends, _) = search(kind, std::slice::from_ref(&found.0), thorough);
        let subsets = ends.into_iter().enumerate().map(|(k, ends)| {
            let subset = Subset::new(kind, k, targets, reading);
            subset.finish((ends, subset.error(&ends)))
        });
        let (ends, errors): (Vec<Ends>, Vec<f32>) = subsets.unzip();
        *found = (ends, errors.iter().sum());
    }
    let by_kind: Vec<f32> = found.iter().map(|found| found.1).collect();
    let best = (0..kinds.len()).min_by(|&a, &b| by_kind[a].total_cmp(&by_kind[b])).unwrap_or(0);
    let mut colours = [[0; 3]; 16];
    for (k, ends) in found[best].0.iter().enumerate() {
        let subset = Subset::new(&kinds[best], k, targets, reading);
        for (&i, colour) in kinds[best].subsets[k].iter().zip(subset.colours(ends)) {
            colours[i] = colour;
        }
    }
    Found { kind: best, error: by_kind[best], colours, by_kind }
}

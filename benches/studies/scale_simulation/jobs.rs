//! The jobs: measured costs of each kind of material, and the share of each kind in a library.

use super::farm::Action;

/// A kind of material, with its measured costs (docs/scale.md has the commands).
pub struct Kind {
    pub name: &'static str,
    /// Share of the materials of a library, which is an assumption.
    pub share: f64,
    /// Processor seconds of a bake, and of a run that finds the bake in the cache.
    pub bake: f64,
    pub cached: f64,
    /// Bytes of the inputs, and bytes of the material's entry in the cache.
    pub inputs: f64,
    pub kept: f64,
}

/// Kinds of one texture set each, measured on one thread.
pub const KINDS: [Kind; 4] = [
    Kind { name: "128^2", share: 0.30, bake: 0.08, cached: 0.003, inputs: 59_810.0, kept: 80_459.0 },
    Kind { name: "1024^2", share: 0.40, bake: 0.37, cached: 0.005, inputs: 2_189_621.0, kept: 4_271_294.0 },
    Kind { name: "2048^2", share: 0.25, bake: 0.83, cached: 0.008, inputs: 4_448_648.0, kept: 12_349_377.0 },
    Kind { name: "4096^2", share: 0.05, bake: 2.76, cached: 0.017, inputs: 9_118_828.0, kept: 42_887_502.0 },
];

/// Actions shorter than this are grouped, as `bake --remote` groups jobs.
const LEAST_WORK: f64 = 0.5;

/// What the cache and the machines have at the start.
#[derive(Clone, Copy, PartialEq)]
pub enum Cache {
    /// Nothing is cached.
    Cold,
    /// Everything is in the store, and the machines are new.
    Warm,
    /// Machines have the files and caches of the last run. One material in a hundred has changed.
    Changed,
}

/// Returns the actions of `count` materials, with kinds mixed as by a hash.
pub fn actions(count: u64, cache: Cache) -> impl Iterator<Item = Action> {
    let mut jobs = (0..count).map(move |index| job(index, cache));
    std::iter::from_fn(move || {
        let mut action = jobs.next()?;
        while action.work < LEAST_WORK {
            let Some(job) = jobs.next() else { break };
            action = Action { down: action.down + job.down, work: action.work + job.work, up: action.up + job.up };
        }
        Some(action)
    })
}

fn job(index: u64, cache: Cache) -> Action {
    let random = scrambled(index);
    let kind = kind((random >> 11) as f64 / (1_u64 << 53) as f64);
    let is_cached = match cache {
        Cache::Cold => false,
        Cache::Warm => true,
        Cache::Changed => !scrambled(random).is_multiple_of(100),
    };
    if !is_cached {
        return Action { down: kind.inputs, work: kind.bake, up: kind.kept };
    }
    // Inputs are read in either case, since their digests name the job.
    let down = if cache == Cache::Warm { kind.inputs + kind.kept } else { 0.0 };
    Action { down, work: kind.cached, up: 0.0 }
}

fn kind(place: f64) -> &'static Kind {
    let mut sum = 0.0;
    let found = KINDS.iter().find(|kind| {
        sum += kind.share;
        place < sum
    });
    found.unwrap_or(&KINDS[KINDS.len() - 1])
}

/// Returns a number of SplitMix64 (G. Steele, D. Lea, C. Flood, "Fast splittable pseudorandom number generators",
/// OOPSLA 2014).
fn scrambled(index: u64) -> u64 {
    let mut z = index.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

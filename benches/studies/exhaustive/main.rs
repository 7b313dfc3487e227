//! Prints how far encoded normals are from the best blocks that UASTC has, as markdown.
//!
//! `cargo run --release -p studies --bin exhaustive [EFFORT] [NAME]` searches with EFFORT (1 by default) times the
//! starts, on crops of 16 x 16 texels of the maps whose names contain NAME. It reads `../shared/data/maps` if it is
//! present, and generates further maps. `exhaustive check` compares the search with all endpoints there are.
//!
//! Lobe errors are those of exact lobes about encoded normals, against the footprints. The floor is the block with the
//! least sum of total variations between the lobes about the wanted and about the decoded normals, among:
//! - modes 0, 1, 5 and 18, mode 6 with each selector, modes 2 and 4 with all 30 patterns, mode 7 with all 19 patterns
//!   and mode 3 with all 11 patterns. (One colour is a case of mode 1. Modes 9 to 14 spend bits on alpha: their
//!   endpoints or weights are coarser than those of the modes with the same subsets and planes.)
//! - all levels of the mode's endpoints, by local search for each subset. Every texel has its best palette entry.
//!
//! The local search starts with the blocks of both qualities and at pairs of random texels, with four rounds of
//! regression. It moves single endpoints by up to 2 levels and all pairs of endpoints by 1 level each, until nothing
//! improves. It then kicks one to three endpoints at random and goes on, until 24 kicks in a row fail. Kinds that are
//! 15 % worse than the best one after 3 starts and 4 kicks get no more. The others end with passes over all levels of
//! single endpoints and pairs of endpoints within 5 levels, until nothing improves.
//!
//! There are two floors. The encoder's objective also counts engines that rebuild z, lengths of vectors, and normals
//! rounded to 8 bits (`crates/uastc/src/direction.rs`). The other floor has only the total variation of normalised
//! vectors.

mod check;
mod crop;
mod format;
mod gaps;
mod maps;
mod objective;
mod search;

use std::error::Error;

use crop::crops;
use format::kinds;
use gaps::Gaps;

const ALPHAS: [f32; 2] = [0.05, 0.2];
const LEVELS: [u32; 2] = [2, 4];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let is_check = arguments.first().is_some_and(|first| first == "check");
    let effort = arguments.first().and_then(|first| first.parse().ok()).unwrap_or(1);
    let name = arguments.get(1).map_or("", String::as_str);
    let kinds = kinds();
    if is_check {
        return check::check(&kinds);
    }
    println!(
        "| map | alpha | level | exact | fast | best | floor | floor, normalised | \
         fast / floor | best / floor | best / floor, normalised |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    let (mut all, mut count, mut gaps) = (Sums::default(), 0.0, Gaps::default());
    for (map, image) in maps::maps()?.into_iter().filter(|(map, _)| map.contains(name)) {
        let mut of_map = Sums::default();
        for alpha in ALPHAS {
            for crop in crops(&image, alpha)? {
                let sums = crop.measure(&kinds, effort, &mut gaps);
                print_row(&map, &alpha.to_string(), &crop.level.to_string(), &sums, 1.0);
                of_map.add(&sums);
            }
        }
        print_row(&map, "all", "all", &of_map, (ALPHAS.len() * LEVELS.len()) as f64);
        all.add(&of_map);
        count += (ALPHAS.len() * LEVELS.len()) as f64;
    }
    print_row("all", "all", "all", &all, count);
    gaps.print();
    Ok(())
}

/// Sums of lobe errors and of total variations.
#[derive(Clone, Copy, Default)]
struct Sums {
    /// Errors of exact normals, `fast`, `best`, the floor and the floor of normalised vectors.
    errors: [f64; 5],
    /// Variations of `fast`, `best` and the floor, in both readings.
    variations: [[f64; 3]; 2],
}

impl Sums {
    fn add(&mut self, other: &Self) {
        self.errors.iter_mut().zip(other.errors).for_each(|(sum, own)| *sum += own);
        let own = self.variations.as_flattened_mut().iter_mut();
        own.zip(other.variations.as_flattened()).for_each(|(sum, own)| *sum += own);
    }
}

fn print_row(map: &str, alpha: &str, level: &str, sums: &Sums, count: f64) {
    let [exact, fast, best, floor, normalised] = sums.errors.map(|sum| sum / count);
    let [[own_fast, own_best, own_floor], [_, shown_best, shown_floor]] = sums.variations;
    println!(
        "| {map} | {alpha} | {level} | {exact:.4} | {fast:.4} | {best:.4} | {floor:.4} | {normalised:.4} | \
         {:.3} | {:.3} | {:.3} |",
        own_fast / own_floor,
        own_best / own_floor,
        shown_best / shown_floor,
    );
}

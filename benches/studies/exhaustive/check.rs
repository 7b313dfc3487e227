//! Compares the search with a search of all endpoints, which modes of few levels allow.

use std::error::Error;

use rayon::prelude::*;

use crate::crop::crops;
use crate::format::Kind;
use crate::objective::Reading;
use crate::search::{Effort, Random, Subset};
use crate::{ALPHAS, maps};

/// Prints the comparison for all subsets of mode 3, whose endpoints have twelve levels: one block of each map.
pub fn check(kinds: &[Kind]) -> Result<(), Box<dyn Error>> {
    println!("| map | subsets | found | sum found / least sum |");
    println!("|---|---|---|---|");
    let kinds: Vec<&Kind> = kinds.iter().filter(|kind| kind.mode == 3).collect();
    for (map, image) in maps::maps()? {
        let crops = crops(&image, ALPHAS[0])?;
        let targets = crops[0].targets(5, Reading::Encoder);
        let subsets: Vec<(&Kind, usize)> = kinds.iter().flat_map(|&kind| (0..3).map(move |k| (kind, k))).collect();
        let pairs: Vec<[f32; 2]> = subsets
            .par_iter()
            .map(|&(kind, k)| {
                let subset = Subset::new(kind, k, &targets, Reading::Encoder);
                let effort = Effort { starts: 12, patience: 24 };
                let found = subset.finish(subset.search(&[], effort, &mut Random(1)));
                [found.1, subset.exhaust()]
            })
            .collect();
        let sum = |k: usize| pairs.iter().map(|pair| f64::from(pair[k])).sum::<f64>();
        let found = pairs.iter().filter(|[found, least]| *found <= least * 1.00001).count();
        println!("| {map} | {} | {found} | {:.5} |", pairs.len(), sum(0) / sum(1));
    }
    Ok(())
}

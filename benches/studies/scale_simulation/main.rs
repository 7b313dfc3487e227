//! A discrete simulation of farms on which the tool has not been run, with measured costs of jobs.
//!
//! `cargo run --release -p studies --bin scale_simulation` prints the tables of docs/scale.md. With the name of a file,
//! the program draws the chart to that file.

mod chart;
mod farm;
mod jobs;

use std::error::Error;

use farm::{Farm, Outcome};
use jobs::{Cache, actions};

/// Sizes of libraries and farms.
const COUNTS: [u64; 4] = [10_000, 100_000, 1_000_000, 10_000_000];
const WORKERS: [usize; 7] = [10, 32, 100, 320, 1000, 3200, 10_000];

/// Assumptions: a store of 100 Gbit/s, workers behind 1 Gbit/s, a scheduler of 1000 actions per second. The overhead
/// was measured on buildbox-casd.
const FARM: Farm = Farm { workers: 1000, store: 1.25e10, link: 1.25e8, dispatch: 1000.0, overhead: 0.12 };

/// Cost of a plan for each job: bytes in its file, and processor seconds and bytes of memory of each machine that reads
/// the plan.
const PLAN: (f64, f64, f64) = (2649.0, 15e-6, 10e3);
/// Bytes that the planning machine reads per second: 10 Gbit/s, an assumption.
const PLANNER: f64 = 1.25e9;

fn main() -> Result<(), Box<dyn Error>> {
    if let Some(path) = std::env::args().nth(1) {
        std::fs::write(path, chart::chart())?;
        return Ok(());
    }
    let (kept, inputs) = print_kinds();
    print_traffic(kept, inputs);
    print_plans(inputs);
    print_farms();
    print_variants();
    Ok(())
}

/// Prints the costs of a job of each kind. Returns the mean bytes of a job's cached outputs, and of its inputs.
fn print_kinds() -> (f64, f64) {
    let mean =
        |value: &dyn Fn(&jobs::Kind) -> f64| jobs::KINDS.iter().map(|kind| kind.share * value(kind)).sum::<f64>();
    let (bake, inputs, kept) = (mean(&|k| k.bake), mean(&|k| k.inputs), mean(&|k| k.kept));
    println!("| texels | share | bake, s | from a cache, s | input, MB | cached, MB |\n|---|---|---|---|---|---|");
    for kind in &jobs::KINDS {
        let (inputs, kept) = (kind.inputs / 1e6, kind.kept / 1e6);
        let jobs::Kind { name, share, bake, cached, .. } = kind;
        println!("| {name} | {share} | {bake} | {cached} | {inputs:.2} | {kept:.2} |");
    }
    println!("| mean | | {bake:.2} | | {:.2} | {:.2} |\n", inputs / 1e6, kept / 1e6);
    (kept, inputs)
}

/// Prints the bytes that cold and warm runs read from and write to the cache.
fn print_traffic(kept: f64, inputs: f64) {
    println!("| materials | cache | read, cold | written, cold | read, warm |\n|---|---|---|---|---|");
    for count in COUNTS {
        let bytes = |each: f64| size(each * count as f64);
        println!(
            "| {} | {} | {} | {} | {} |",
            number(count),
            bytes(kept),
            bytes(inputs),
            bytes(kept),
            bytes(inputs + kept)
        );
    }
}

/// Prints the cost of plans by the number of materials.
fn print_plans(inputs: f64) {
    println!("\n| materials | planning | plan | reading the plan, each machine | memory |\n|---|---|---|---|---|");
    for count in COUNTS {
        let (bytes, seconds, memory) = PLAN;
        let all = |each: f64| each * count as f64;
        let planning = time(all(inputs) / PLANNER);
        let (plan, memory) = (size(all(bytes)), size(all(memory)));
        println!("| {} | {planning} | {plan} | {} | {memory} |", number(count), time(all(seconds)));
    }
}

/// Prints the time of each number of materials on each number of workers.
fn print_farms() {
    for (title, cache) in [("cold", Cache::Cold), ("warm store", Cache::Warm), ("1 % changed", Cache::Changed)] {
        print!("\n| {title} |");
        WORKERS.iter().for_each(|workers| print!(" {} |", number(*workers as u64)));
        println!("\n|---{}|", "|---".repeat(WORKERS.len()));
        for count in COUNTS {
            print!("| {} |", number(count));
            for workers in WORKERS {
                let outcome = Farm { workers, ..FARM }.run(actions(count, cache));
                print!(" {}{} |", time(outcome.seconds), limit(&outcome));
            }
            println!();
        }
    }
}

/// Prints the time of a million materials under other assumptions.
fn print_variants() {
    println!("\n| 10^6 materials, cold, 1000 workers | time | busy |\n|---|---|---|");
    for (what, farm) in [
        ("as assumed", FARM),
        ("store of 10 Gbit/s", Farm { store: 1.25e9, ..FARM }),
        ("no overhead of actions (shards)", Farm { overhead: 0.0, ..FARM }),
        ("10 Gbit/s for each worker", Farm { link: 1.25e9, ..FARM }),
        ("100 actions per second", Farm { dispatch: 100.0, ..FARM }),
        ("16 actions per second", Farm { dispatch: 16.0, ..FARM }),
        ("10^4 workers", Farm { workers: 10_000, ..FARM }),
        ("10^4 workers, shards", Farm { workers: 10_000, dispatch: f64::INFINITY, overhead: 0.0, ..FARM }),
        (
            "10^4 workers, shards, store of 1 Tbit/s",
            Farm { workers: 10_000, store: 1.25e11, dispatch: f64::INFINITY, overhead: 0.0, ..FARM },
        ),
    ] {
        let outcome = farm.run(actions(1_000_000, Cache::Cold));
        let Outcome { workers, store, scheduler, seconds, .. } = outcome;
        let share = |share: f64| format!("{:.0} %", 100.0 * share);
        let (workers, store, scheduler) = (share(workers), share(store), share(scheduler));
        println!("| {what} | {} | workers {workers}, store {store}, scheduler {scheduler} |", time(seconds));
    }
}

/// Returns what limits a run: the store (S), the scheduler that assigns actions (D), the workers' links (L), or the
/// last worker (T). Nothing is returned where the work of the workers itself is the limit.
fn limit(outcome: &Outcome) -> &'static str {
    match outcome {
        Outcome { store, .. } if *store > 0.9 => " S",
        Outcome { scheduler, .. } if *scheduler > 0.9 => " D",
        Outcome { workers, links, .. } if workers + links < 0.5 => " T",
        Outcome { workers, links, .. } if links > workers => " L",
        _ => "",
    }
}

/// Formats powers of ten from 10^4 on.
fn number(count: u64) -> String {
    match count {
        0..10_000 => count.to_string(),
        _ => format!("10^{}", count.ilog10()),
    }
}

fn time(seconds: f64) -> String {
    match seconds {
        s if s < 10.0 => format!("{s:.1} s"),
        s if s < 100.0 => format!("{s:.0} s"),
        s if s < 6000.0 => format!("{:.0} min", s / 60.0),
        s if s < 200_000.0 => format!("{:.1} h", s / 3600.0),
        s => format!("{:.1} d", s / 86_400.0),
    }
}

fn size(bytes: f64) -> String {
    match bytes {
        b if b < 1e9 => format!("{:.0} MB", b / 1e6),
        b if b < 1e10 => format!("{:.1} GB", b / 1e9),
        b if b < 1e12 => format!("{:.0} GB", b / 1e9),
        b => format!("{:.1} TB", b / 1e12),
    }
}

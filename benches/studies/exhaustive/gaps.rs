//! Where the encoder loses against the floor.

use crate::format::Kind;
use crate::search::Found;

/// Where `best` loses total variation against the floor of its own objective.
#[derive(Clone, Copy, Default)]
pub struct Gaps {
    floor: f64,
    /// By endpoints, by the pattern or selector, and by the mode.
    lost: [f64; 3],
    /// Sums lost, by the mode of `best` and the mode of the floor.
    modes: [[(usize, f64); 19]; 19],
}

impl Gaps {
    /// Adds a `block` of `best` with the error `own`.
    pub fn add(&mut self, kinds: &[Kind], block: &[u8; 16], own: f64, found: &Found) {
        self.floor += f64::from(found.error);
        let Some(kind) = kinds.iter().position(|kind| kind.ends_of(block).is_some()) else { return };
        let least = |is_allowed: &dyn Fn(usize) -> bool| {
            let errors = found.by_kind.iter().enumerate().filter(|&(k, _)| is_allowed(k)).map(|(_, &error)| error);
            f64::from(errors.fold(f32::INFINITY, f32::min))
        };
        let mode = kinds[kind].mode;
        let [same, same_mode, any] = [least(&|k| k == kind), least(&|k| kinds[k].mode == mode), least(&|_| true)];
        for (lost, by) in self.lost.iter_mut().zip([own - same, same - same_mode, same_mode - any]) {
            *lost += by;
        }
        let (count, lost) = &mut self.modes[usize::from(mode)][usize::from(kinds[found.kind].mode)];
        *count += 1;
        *lost += own - any;
    }

    pub fn print(&self) {
        let share = |lost: f64| 100.0 * lost / self.floor;
        let [ends, pattern, mode] = self.lost.map(share);
        println!(
            "\n`best` is above the floor of its own objective by {ends:.1} % for its endpoints, {pattern:.1} % for its"
        );
        println!("pattern or selector, and {mode:.1} % for its mode.\n");
        println!("| mode of best | mode of floor | blocks | lost |\n|---|---|---|---|");
        for (own, modes) in self.modes.iter().enumerate() {
            for (floor, &(count, lost)) in modes.iter().enumerate().filter(|(_, found)| found.0 > 0) {
                println!("| {own} | {floor} | {count} | {:.2} % |", share(lost));
            }
        }
    }
}

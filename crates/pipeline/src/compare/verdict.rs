//! The verdict on a material in a few sentences.

use super::entry::BEST_LOBE;
use super::units::amount;
use super::{Axis, Entry, Kind};
use crate::report::LayerReport;
use crate::settings::Model;

/// Returns what `--model auto` chose for a layer, within the error bound `max_error`, and what that is worth. Returns
/// `None` if no entry is marked as chosen, or nothing was baked.
pub fn verdict(entries: &[Entry], layer: &LayerReport, max_error: f32) -> Option<String> {
    let chosen = entries.iter().find(|entry| entry.chosen)?;
    let choice = match (layer.model?, size(layer)) {
        (Model::None, _) => "plain mips".to_owned(),
        (model, size) => format!("{} lobes at {size} size", model.name()),
    };
    let first = match &layer.choice {
        Some(made) if made.misses.is_empty() => {
            format!("{} are the cheapest choice within {max_error} at every level", capitalised(&choice))
        }
        Some(_) => format!(
            "No choice is within {max_error} at every level; {choice} are the cheapest of those that come closest"
        ),
        None => format!("{} were chosen", capitalised(&choice)),
    };
    let cost = [Axis::GpuBytes, Axis::FileBytes]
        .into_iter()
        .filter_map(|axis| Some(format!(", {} {}", amount(axis, axis.value(&chosen.cost)?), axis.place())))
        .collect::<String>();
    let error = |wanted: &dyn Fn(&Entry) -> bool| entries.iter().find(|e| wanted(e)).map(|e| e.error);
    let plain = error(&|e| e.kind == Kind::Peer && e.name == "plain mips");
    let oracle = error(&|e| e.kind == Kind::Oracle);
    let peers = entries.iter().filter(|e| e.kind == Kind::Peer && e.error < chosen.error);
    let closer = peers.min_by(|a, b| a.error.total_cmp(&b.error)).map(|peer| (&*peer.name, peer.error));
    let others = [closer, plain.map(|e| ("plain mips", e)), oracle.map(|e| (BEST_LOBE, e))].into_iter().flatten();
    let others: String = others.map(|(name, e)| format!(" {}: {e:.2}.", capitalised(name))).collect();
    let plain_pictures = entries.iter().find(|e| e.name == "plain mips").and_then(|e| e.picture_error);
    let pictures = chosen.picture_error.zip(plain_pictures);
    let pictures = pictures
        .map_or(String::new(), |(ours, plain)| format!(" Picture error: {ours:.2}, with plain mips {plain:.2}."));
    Some(format!("{first}: mean error {:.2}{cost}.{others}{pictures}", chosen.error))
}

/// Returns the size of the chosen textures in words.
fn size(layer: &LayerReport) -> &'static str {
    let Some(choice) = &layer.choice else { return "full" };
    let finest = choice.candidates.iter().map(|candidate| candidate.first).min().unwrap_or(0);
    match choice.taken().map_or(0, |taken| taken.first - finest) {
        0 => "full",
        1 => "half",
        _ => "quarter",
    }
}

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

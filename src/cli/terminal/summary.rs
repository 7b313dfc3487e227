//! The outcome of an asset as lines of text.

use crate::gltf::material::LayerKind;
use crate::report::{AssetOutcome, Choice, LayerReport, Status};
use crate::text::printable;

/// Returns one line for the asset, then one line for each layer and each note. Without `is_verbose`, notes that ask for
/// nothing are left out.
pub fn summary(asset: &AssetOutcome, is_verbose: bool) -> String {
    let input = printable(&asset.input);
    let (megabytes, seconds) = (asset.bytes as f64 / 1e6, asset.seconds);
    let mut text = match asset.status {
        Status::Failed => return String::new(),
        Status::Cached => return format!("cached {input}: {megabytes:.1} MB, {seconds:.2} s\n"),
        Status::Copied => format!("copied {input}: no normal or height maps\n"),
        Status::Baked => {
            let textures = asset.report.textures.len();
            format!("baked {input}: {textures} texture(s), {megabytes:.1} MB, {seconds:.2} s\n")
        }
    };
    for layer in &asset.report.layers {
        text += &layer_line(layer);
        for note in layer.notes.iter().filter(|note| is_verbose || note.asks_for_action) {
            text += &format!("    note: {}\n", printable(&note.text));
        }
    }
    text
}

fn layer_line(layer: &LayerReport) -> String {
    let model = layer.model.map_or_else(|| "unchanged".to_owned(), |model| model.name().to_owned());
    let choice = layer.choice.as_ref().map(Choice::summary).unwrap_or_default();
    let kind = match layer.layer {
        LayerKind::Base => String::new(),
        kind => format!(", {}", kind.name()),
    };
    let finest = layer.finest.map_or_else(String::new, |finest| {
        format!(", sampled from level {} on, typically {}", finest.level, finest.typical_level)
    });
    format!("  {}{kind}: {model}{choice}{finest}\n", printable(&layer.material))
}

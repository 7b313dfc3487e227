//! The outcomes of assets as lines of text.

use std::collections::BTreeSet;
use std::time::Duration;

use crate::gltf::material::LayerKind;
use crate::report::{AssetOutcome, Choice, LayerReport, OutputSizes, Status};
use crate::text::{counted, printable};

/// Materials that a note names. Further materials are counted.
const MAX_NAMED: usize = 3;

/// Returns one line for the asset. If `is_verbose`, one line for each layer follows, with all of its notes.
pub fn summary(asset: &AssetOutcome, is_verbose: bool) -> String {
    let verb = match asset.status {
        Status::Failed => return String::new(),
        Status::Cached => "cached",
        Status::Copied => "copied",
        Status::Baked => "baked",
    };
    let mut text = format!("{verb} {}: ", printable(&asset.input));
    text += &Totals::of(asset).text(asset.seconds);
    if is_verbose {
        asset.report.layers.iter().for_each(|layer| text += &layer_lines(layer));
    }
    text
}

/// Returns one line for each different note on `assets` that asks for something, with the materials that have the note.
pub fn notes_to_act_on(assets: &[AssetOutcome]) -> String {
    let mut notes: Vec<(&str, Vec<String>)> = Vec::new();
    for asset in assets {
        for layer in &asset.report.layers {
            let name = if assets.len() == 1 { name(layer) } else { format!("{} ({})", asset.input, name(layer)) };
            for note in layer.notes.iter().filter(|note| note.asks_for_action) {
                match notes.iter_mut().find(|(text, _)| *text == note.text) {
                    Some((_, names)) => names.push(name.clone()),
                    None => notes.push((&note.text, vec![name.clone()])),
                }
            }
        }
    }
    let line = |(text, names): (&str, Vec<String>)| {
        let more = names.len().saturating_sub(MAX_NAMED);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let names = names.into_iter().take(MAX_NAMED).collect::<Vec<_>>().join("; ");
        format!("  note: {}{more}: {}\n", printable(&names), printable(text))
    };
    notes.into_iter().map(line).collect()
}

/// Returns a line on all `assets` together, whose run took `elapsed`; nothing if there are fewer than two.
pub fn total(assets: &[AssetOutcome], elapsed: Duration) -> String {
    let done: Vec<&AssetOutcome> = assets.iter().filter(|asset| asset.status != Status::Failed).collect();
    if assets.len() < 2 || done.is_empty() {
        return String::new();
    }
    let failed = match assets.len() - done.len() {
        0 => String::new(),
        failed => format!(" and {failed} failed"),
    };
    let totals = done.iter().copied().map(Totals::of).fold(Totals::default(), Totals::and);
    format!("total of {}{failed}: {}", counted(done.len(), "asset"), totals.text(elapsed.as_secs_f64()))
}

/// What was baked, and its sizes.
#[derive(Default)]
struct Totals {
    materials: usize,
    textures: usize,
    before: u64,
    after: u64,
    sizes: OutputSizes,
}

impl Totals {
    fn of(asset: &AssetOutcome) -> Self {
        let baked = asset.report.layers.iter().filter(|layer| layer.model.is_some());
        Self {
            materials: baked.map(|layer| layer.index).collect::<BTreeSet<_>>().len(),
            textures: asset.report.textures.len(),
            before: asset.input_bytes,
            after: asset.bytes,
            sizes: asset.report.sizes,
        }
    }

    fn and(self, other: Self) -> Self {
        Self {
            materials: self.materials + other.materials,
            textures: self.textures + other.textures,
            before: self.before.saturating_add(other.before),
            after: self.after.saturating_add(other.after),
            sizes: self.sizes + other.sizes,
        }
    }

    /// Returns for example `5 materials, 8 textures, 7.2 -> 9.1 MB (KTX2 1.9, geometry 7.2), 0.81 s`. The materials are
    /// those with baked bumps.
    fn text(&self, seconds: f64) -> String {
        let (divisor, unit) = if self.before.max(self.after) < 1_000_000 { (1e3, "kB") } else { (1e6, "MB") };
        let number = |bytes: u64| format!("{:.1}", bytes as f64 / divisor);
        let OutputSizes { ktx2, fallback, images, geometry, json, .. } = self.sizes;
        let named =
            [("KTX2", ktx2), ("PNG copies", fallback), ("images", images), ("geometry", geometry), ("JSON", json)];
        let parts: Vec<String> = named
            .into_iter()
            .map(|(name, bytes)| (name, number(bytes)))
            .filter(|(_, bytes)| bytes != "0.0")
            .map(|(name, bytes)| format!("{name} {bytes}"))
            .collect();
        let textures = counted(self.textures, "texture");
        let baked = match (self.materials, self.textures) {
            (0, 0) => "no normal or height maps".to_owned(),
            (0, _) => textures,
            (materials, _) => format!("{}, {textures}", counted(materials, "material")),
        };
        format!(
            "{baked}, {} -> {} {unit} ({}), {seconds:.2} s\n",
            number(self.before),
            number(self.after),
            parts.join(", ")
        )
    }
}

fn layer_lines(layer: &LayerReport) -> String {
    let model = layer.model.map_or_else(|| "no bumps".to_owned(), |model| model.name().to_owned());
    let choice = layer.choice.as_ref().map(Choice::summary).unwrap_or_default();
    let finest = layer.finest.map_or_else(String::new, |finest| {
        format!(", sampled from level {} on, typically {}", finest.level, finest.typical_level)
    });
    let notes = layer.notes.iter().map(|note| format!("    note: {}\n", printable(&note.text)));
    let line = format!("  {}: {model}{choice}{finest}\n", printable(&name(layer)));
    std::iter::once(line).chain(notes).collect()
}

/// Returns the name of the material, and of the layer if it is not the base layer.
fn name(layer: &LayerReport) -> String {
    match layer.layer {
        LayerKind::Base => layer.material.clone(),
        kind => format!("{}, {}", layer.material, kind.name()),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;
    use crate::digest::digest;
    use crate::report::AssetReport;

    fn layer(index: usize, notes: &[&str]) -> Value {
        let note = |text: &&str| json!({ "kind": "lossySource", "asksForAction": true, "text": text });
        let notes: Vec<Value> = notes.iter().map(note).collect();
        json!({ "index": index, "material": format!("M{index}"), "layer": "base", "model": "isotropic", "notes": notes })
    }

    fn asset(layers: Vec<Value>, sizes: [u64; 5], input_bytes: u64) -> AssetOutcome {
        let [ktx2, fallback, images, geometry, json] = sizes;
        let sizes = json!({ "ktx2": ktx2, "fallback": fallback, "images": images, "geometry": geometry, "json": json });
        let texture = json!({ "path": "a", "content": "normal", "width": 4, "height": 4, "levels": 3, "bytes": ktx2 });
        let report = json!({ "layers": layers, "textures": [texture, texture], "sizes": sizes });
        let report: AssetReport = serde_json::from_value(report).expect("a report");
        AssetOutcome {
            status: Status::Baked,
            input_bytes,
            bytes: report.sizes.total(),
            seconds: 0.5,
            error: None,
            report,
            ..AssetOutcome::failed("a.glb".to_owned(), Some(digest(b"")), 0.5, String::new(), false)
        }
    }

    #[test]
    fn an_asset_is_one_line_with_its_sizes_and_notes_are_told_once() {
        let layers = vec![layer(0, &["use another"]), layer(1, &[]), layer(2, &["use another"])];
        let asset = asset(layers, [1_900_000, 0, 3_000_000, 4_100_000, 20_000], 7_200_000);
        let expected =
            "baked a.glb: 3 materials, 2 textures, 7.2 -> 9.0 MB (KTX2 1.9, images 3.0, geometry 4.1), 0.50 s\n";
        assert_eq!(summary(&asset, false), expected);
        assert_eq!(notes_to_act_on(&[asset]), "  note: M0; M2: use another\n");
    }

    #[test]
    fn notes_on_several_assets_are_told_once() {
        let rock = asset(vec![layer(0, &["use another", "act"])], [0; 5], 0);
        let chair = AssetOutcome { input: "b.glb".to_owned(), ..asset(vec![layer(1, &["use another"])], [0; 5], 0) };
        let expected = "  note: a.glb (M0); b.glb (M1): use another\n  note: a.glb (M0): act\n";
        assert_eq!(notes_to_act_on(&[rock, chair]), expected);
    }

    #[test]
    fn an_asset_without_bumps_has_its_sizes_too() {
        let mut asset = asset(Vec::new(), [0, 0, 3_000_000, 0, 0], 3_100_000);
        let (textures, sizes) = ("2 textures", "3.1 -> 3.0 MB (images 3.0), 0.50 s\n");
        assert_eq!(summary(&asset, false), format!("baked a.glb: {textures}, {sizes}"));
        asset.report.textures.clear();
        asset.status = Status::Copied;
        assert_eq!(summary(&asset, false), format!("copied a.glb: no normal or height maps, {sizes}"));
    }

    #[test]
    fn small_assets_are_told_in_kilobytes_and_many_materials_are_counted() {
        let layers = (0..5).map(|index| layer(index, &["act"])).collect();
        let asset = asset(layers, [2_000, 1_000, 0, 0, 900], 500);
        let expected =
            "baked a.glb: 5 materials, 2 textures, 0.5 -> 3.9 kB (KTX2 2.0, PNG copies 1.0, JSON 0.9), 0.50 s\n";
        assert_eq!(summary(&asset, false), expected);
        assert_eq!(notes_to_act_on(&[asset]), "  note: M0; M1; M2 and 2 more: act\n");
    }

    #[test]
    fn several_assets_have_a_line_of_totals() {
        let asset = || asset(vec![layer(0, &[])], [600_000, 0, 0, 400_000, 0], 400_000);
        let failed = AssetOutcome::failed("b.glb".to_owned(), None, 0.0, "broken".to_owned(), false);
        assert_eq!(total(&[asset()], Duration::ZERO), "");
        let expected = "total of 2 assets and 1 failed: 2 materials, 4 textures, 0.8 -> 2.0 MB (KTX2 1.2, geometry 0.8), \
                        0.25 s\n";
        assert_eq!(total(&[asset(), failed, asset()], Duration::from_millis(250)), expected);
    }
}

//! Facts as text for people.

use serde_json::Value;

use super::document::{DocumentFacts, ImageFacts, MaterialFacts};
use super::texture::TextureFacts;
use crate::text::{counted, printable};

/// Lines of a text. Content comes from files, so each line is made printable and cannot add lines.
struct Lines(String);

impl Lines {
    fn push(&mut self, line: &str) {
        self.0 += &printable(line);
        self.0.push('\n');
    }
}

/// Formats all facts of a KTX2 file.
pub fn texture_text(name: &str, facts: &TextureFacts) -> String {
    let mut lines = Lines(String::new());
    lines.push(&format!("{name}: {}", summary(facts)));
    if let Some(d) = &facts.descriptor {
        let alpha = if d.alpha_premultiplied { "premultiplied" } else { "straight" };
        lines.push(&format!(
            "  descriptor: model {}, primaries {}, transfer {}, alpha {alpha}, blocks of {} x {} texels in {} bytes",
            d.model, d.primaries, d.transfer, d.block[0], d.block[1], d.block_bytes
        ));
    }
    lines.push("  level          size      offset      stored  uncompressed");
    for (index, level) in facts.levels.iter().enumerate() {
        let size = format!("{} x {}", level.width, level.height);
        lines.push(&format!(
            "  {index:>5} {size:>13} {:>11} {:>11} {:>13}",
            level.offset, level.stored_bytes, level.uncompressed_bytes
        ));
    }
    for entry in &facts.keys {
        lines.push(&format!("  {}: {}", entry.key, entry.value));
    }
    if let Some(provenance) = &facts.provenance {
        lines.push(&format!("  provenance: {} baked by version {}", provenance.content, provenance.version));
        for (key, value) in provenance.settings.as_object().into_iter().flatten() {
            lines.push(&format!("    {key}: {}", plain(value)));
        }
        if !provenance.lobe_errors.is_empty() {
            let errors: Vec<String> = provenance.lobe_errors.iter().map(|e| format!("{e:.2}")).collect();
            lines.push(&format!("    lobe error by level: {}", errors.join(" ")));
        }
        for source in &provenance.sources {
            lines.push(&format!("    source {} (BLAKE3 {})", source.uri, source.blake3));
        }
    }
    lines.0
}

/// Formats the facts of a glTF document: its materials and their textures.
pub fn document_text(name: &str, facts: &DocumentFacts) -> String {
    let list = |names: &[String]| if names.is_empty() { "none".to_owned() } else { names.join(", ") };
    let mut lines = Lines(String::new());
    lines.push(&format!("{name}: {}", counted(facts.materials.len(), "material")));
    lines.push(&format!("  extensions used: {}", list(&facts.extensions_used)));
    lines.push(&format!("  extensions required: {}", list(&facts.extensions_required)));
    for material in &facts.materials {
        add_material(material, &mut lines);
    }
    lines.0
}

fn add_material(material: &MaterialFacts, lines: &mut Lines) {
    lines.push(&format!("  {} (roughness factor {})", material.name, material.roughness_factor));
    if material.slots.is_empty() {
        lines.push("    no textures");
    }
    for slot in &material.slots {
        lines.push(&format!("    {}: textures[{}]", slot.slot, slot.texture));
        for image in &slot.images {
            lines.push(&format!("      {}: {}", image.named_by, image_text(image)));
        }
    }
    for (key, value) in material.pyramid.as_ref().and_then(Value::as_object).into_iter().flatten() {
        if !key.ends_with("Texture") {
            lines.push(&format!("    {key}: {}", plain(value)));
        }
    }
    for error in &material.errors {
        lines.push(&format!("    error: {error}"));
    }
}

fn image_text(image: &ImageFacts) -> String {
    let facts = match (&image.ktx2, &image.picture, &image.error) {
        (Some(ktx2), ..) => {
            let content = ktx2.provenance.as_ref().map(|p| format!("{}, ", p.content)).unwrap_or_default();
            format!("{content}{}", summary(ktx2))
        }
        (None, Some(p), _) => {
            let channels = counted(p.channels as usize, "channel");
            format!("{} x {}, {}, {channels} of {} bits", p.width, p.height, p.format, p.bits)
        }
        (None, None, error) => format!("error: {}", error.as_deref().unwrap_or_default()),
    };
    format!("{} ({facts})", image.location)
}

/// Formats size, format and levels in one line.
fn summary(facts: &TextureFacts) -> String {
    let model = facts.descriptor.as_ref().map_or("no descriptor", |d| d.model.as_str());
    let format = if facts.format == "UNDEFINED" { model } else { &facts.format };
    let transfer = facts.descriptor.as_ref().filter(|d| d.transfer == "SRGB").map_or("", |_| " sRGB");
    let stored: u64 = facts.levels.iter().map(|l| l.stored_bytes).sum();
    let mut text = format!("{} x {}", facts.width, facts.height);
    for (count, what) in [(facts.depth, "slices"), (facts.layers, "layers")] {
        if count > 0 {
            text += &format!(", {count} {what}");
        }
    }
    if facts.faces > 1 {
        text += &format!(", {} faces", facts.faces);
    }
    let levels = counted(facts.levels.len(), "level");
    text + &format!(", {format}{transfer}, supercompression {}, {levels}, {stored} bytes", facts.supercompression)
}

/// Formats a JSON value; strings have no quotes.
fn plain(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

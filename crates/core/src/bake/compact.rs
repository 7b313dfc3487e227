//! Removes what only replaced images needed from a document's binary chunk: their buffer views and their bytes.

use std::collections::BTreeSet;
use std::ops::Range;

use serde::Deserialize;
use serde_json::{Value, json};

use super::error::ContainerError;
use crate::gltf::extensions::are_known;
use crate::gltf::json::{Json, JsonError, escaped};

/// Bytes that stay keep their offset modulo this number. No accessor component and no table of an extension needs a
/// larger alignment.
const ALIGNMENT: usize = 8;

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct View {
    buffer: usize,
    #[serde(default)]
    byte_offset: usize,
    byte_length: usize,
}

/// Part of buffer 0 that an object of the document names.
struct Part {
    /// JSON pointer of the object that has a `byteOffset`.
    pointer: String,
    range: Range<usize>,
}

/// Removes buffer views that held images of `source` and that nothing in `json` refers to any more, and their bytes
/// from `bin`, which is buffer 0. Returns the bytes that stay. If none stay, the buffer is removed, too.
///
/// Views behind a removed view are renumbered. If the document has an unknown extension, which may refer to views in a
/// way of its own, a removed view stays as a view of one byte. If something other than a buffer view points into the
/// buffer, nothing is removed.
///
/// # Errors
/// [`ContainerError::Json`] if the document does not have the shape of a glTF.
pub fn compact(json: &mut Json, source: &Json, bin: Vec<u8>) -> Result<Option<Vec<u8>>, ContainerError> {
    let of_images = image_views(source)?;
    if of_images.is_empty() {
        return Ok(Some(bin));
    }
    let root: Value = json.value("")?.unwrap_or_default();
    let list = root.get("bufferViews").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let Ok(views) = list.iter().map(View::deserialize).collect::<Result<Vec<View>, _>>() else { return Ok(Some(bin)) };
    let Some(used) = used_views(&root) else { return Ok(Some(bin)) };
    let in_use: BTreeSet<usize> = used.iter().map(|(_, view)| *view).collect();
    let is_dead = |view: &usize| !in_use.contains(view) && views.get(*view).is_some_and(|view| view.buffer == 0);
    let dead: BTreeSet<usize> = of_images.into_iter().filter(is_dead).collect();
    let kept = parts(list, &views, &dead);
    let dead_ranges = dead.iter().filter_map(|view| views[*view].range());
    let all = kept.iter().map(|part| part.range.end).chain(dead_ranges.clone().map(|range| range.end));
    if dead.is_empty() || all.max().is_some_and(|end| end > bin.len()) {
        return Ok(Some(bin));
    }
    let runs = runs(&bin, merged(kept.iter().map(|part| part.range.clone())), merged(dead_ranges));
    let mut packed = Packed::new(&bin, &runs);
    move_parts(json, &kept, &packed)?;
    if are_known(&root) {
        remove_views(json, &used, &dead)?;
        let is_gone = packed.bytes.is_empty() && dead.len() == views.len();
        if is_gone && json.len("/buffers") == Some(1) {
            json.remove("/bufferViews")?;
            json.remove("/buffers")?;
            return Ok(None);
        }
    } else {
        for view in &dead {
            json.remove(&format!("/bufferViews/{view}/byteOffset"))?;
            json.set(&format!("/bufferViews/{view}/byteLength"), &1)?;
        }
    }
    // glTF demands a byte at least in each buffer.
    packed.bytes.resize(packed.bytes.len().max(1), 0);
    json.set("/buffers/0/byteLength", &packed.bytes.len())?;
    Ok(Some(packed.bytes))
}

/// Returns all references to buffer views, as pointers with the numbers of the views; `None` if something other than a
/// buffer view points into a buffer.
fn used_views(root: &Value) -> Option<Vec<(String, usize)>> {
    let mut used = Vec::new();
    for (key, value) in root.as_object().into_iter().flatten().filter(|(key, _)| *key != "bufferViews") {
        if points_into_buffer(value) {
            return None;
        }
        view_references(key, value, format!("/{}", escaped(key)), &mut used);
    }
    Some(used)
}

/// Writes the new offsets of the parts that stay.
fn move_parts(json: &mut Json, parts: &[Part], packed: &Packed) -> Result<(), JsonError> {
    for Part { pointer, range } in parts {
        let moved = packed.new_offset(range.start);
        if moved != range.start {
            json.set(&format!("{pointer}/byteOffset"), &moved)?;
        }
    }
    Ok(())
}

impl View {
    fn range(&self) -> Option<Range<usize>> {
        Some(self.byte_offset..self.byte_offset.checked_add(self.byte_length)?)
    }
}

/// Returns the parts of buffer 0 that stay: the ranges of views that are not `dead`, and the ranges that extensions of
/// these views name, such as `EXT_meshopt_compression`.
fn parts(list: &[Value], views: &[View], dead: &BTreeSet<usize>) -> Vec<Part> {
    let mut parts = Vec::new();
    let mut add = |pointer: String, view: &View| {
        if view.buffer == 0 {
            // A range whose end overflows ends beyond the buffer.
            parts.push(Part { pointer, range: view.range().unwrap_or(view.byte_offset..usize::MAX) });
        }
    };
    for (index, view) in views.iter().enumerate().filter(|(index, _)| !dead.contains(index)) {
        add(format!("/bufferViews/{index}"), view);
        let extensions = list[index].get("extensions").and_then(Value::as_object);
        for (name, extension) in extensions.into_iter().flatten() {
            if let Ok(view) = View::deserialize(extension) {
                add(format!("/bufferViews/{index}/extensions/{}", escaped(name)), &view);
            }
        }
    }
    parts
}

/// Sorts the ranges and joins those that overlap or touch.
fn merged(ranges: impl Iterator<Item = Range<usize>>) -> Vec<Range<usize>> {
    let mut ranges: Vec<_> = ranges.filter(|range| !range.is_empty()).collect();
    ranges.sort_unstable_by_key(|range| range.start);
    let mut merged: Vec<Range<usize>> = Vec::with_capacity(ranges.len());
    for range in ranges {
        match merged.last_mut() {
            Some(last) if range.start <= last.end => last.end = last.end.max(range.end),
            _ => merged.push(range),
        }
    }
    merged
}

/// Returns the runs of `bin` that stay: all bytes except those that are `dead` and not `kept`, and except zeros that
/// only aligned them.
fn runs(bin: &[u8], kept: Vec<Range<usize>>, dead: Vec<Range<usize>>) -> Vec<Range<usize>> {
    let mut borders: Vec<usize> =
        kept.iter().chain(&dead).flat_map(|r| [r.start, r.end]).chain([0, bin.len()]).collect();
    borders.sort_unstable();
    borders.dedup();
    let (mut kept, mut dead) = (kept.into_iter().peekable(), dead.into_iter().peekable());
    let mut runs: Vec<Range<usize>> = Vec::new();
    let mut follows_dead = false;
    for pair in borders.windows(2) {
        let piece = pair[0]..pair[1];
        while kept.next_if(|range| range.end <= piece.start).is_some() {}
        while dead.next_if(|range| range.end <= piece.start).is_some() {}
        let holds = |range: Option<&Range<usize>>| range.is_some_and(|range| range.start <= piece.start);
        let is_kept = holds(kept.peek());
        let is_dead = !is_kept && holds(dead.peek());
        // Bytes that no view names may belong to an application, unless they are padding beside dead bytes.
        let is_padding = !is_kept && piece.len() < ALIGNMENT && bin[piece.clone()].iter().all(|byte| *byte == 0);
        let precedes_dead = !is_kept && !is_dead && dead.peek().is_some_and(|range| range.start == piece.end);
        let is_last = piece.end == bin.len();
        if is_dead || (is_padding && (follows_dead || precedes_dead || is_last)) {
            follows_dead = true;
            continue;
        }
        follows_dead = false;
        match runs.last_mut() {
            Some(last) if last.end == piece.start => last.end = piece.end,
            _ => runs.push(piece),
        }
    }
    runs
}

/// The runs of a buffer, moved together.
struct Packed {
    bytes: Vec<u8>,
    /// The old range of each run, and its new offset.
    moves: Vec<(Range<usize>, usize)>,
}

impl Packed {
    fn new(bin: &[u8], runs: &[Range<usize>]) -> Self {
        let mut packed = Self { bytes: Vec::new(), moves: Vec::with_capacity(runs.len()) };
        for run in runs {
            let padding = (run.start - packed.bytes.len()) % ALIGNMENT;
            packed.bytes.resize(packed.bytes.len() + padding, 0);
            packed.moves.push((run.clone(), packed.bytes.len()));
            packed.bytes.extend_from_slice(&bin[run.clone()]);
        }
        packed
    }

    /// Returns the new offset of the byte that was at `offset`; 0 for a byte that was removed.
    fn new_offset(&self, offset: usize) -> usize {
        let after = self.moves.partition_point(|(run, _)| run.start <= offset);
        let run = after.checked_sub(1).and_then(|index| self.moves.get(index)).filter(|(run, _)| offset < run.end);
        run.map_or(0, |(run, moved)| moved + offset - run.start)
    }
}

/// Removes the views `dead` and renumbers `references` to those behind them.
fn remove_views(json: &mut Json, references: &[(String, usize)], dead: &BTreeSet<usize>) -> Result<(), JsonError> {
    let removed: Vec<usize> = dead.iter().copied().collect();
    for (pointer, view) in references {
        let before = removed.partition_point(|removed| removed < view);
        if before > 0 {
            json.set(pointer, &(view - before))?;
        }
    }
    json.retain("/bufferViews", |index| !dead.contains(&index))
}

/// Finds the numbers of buffer views in `value`: all members with the name `bufferView`. `value` is at the pointer `at`
/// and is the member `key` of its object.
fn view_references(key: &str, value: &Value, at: String, found: &mut Vec<(String, usize)>) {
    match value {
        Value::Object(members) => {
            for (key, member) in members {
                view_references(key, member, format!("{at}/{}", escaped(key)), found);
            }
        }
        Value::Array(elements) => {
            for (index, element) in elements.iter().enumerate() {
                view_references(key, element, format!("{at}/{index}"), found);
            }
        }
        _ if key == "bufferView" => {
            found.extend(value.as_u64().map(|view| (at, usize::try_from(view).unwrap_or(usize::MAX))));
        }
        _ => {}
    }
}

/// Returns whether an object in `value` names a buffer by its number, as buffer views do.
fn points_into_buffer(value: &Value) -> bool {
    match value {
        Value::Object(members) => {
            members.get("buffer").is_some_and(Value::is_number) || members.values().any(points_into_buffer)
        }
        Value::Array(elements) => elements.iter().any(points_into_buffer),
        _ => false,
    }
}

/// Returns the buffer views that images name.
fn image_views(json: &Json) -> Result<Vec<usize>, JsonError> {
    let images: Value = json.value("/images")?.unwrap_or(json!([]));
    let views = images.as_array().into_iter().flatten().filter_map(|image| image.get("bufferView")?.as_u64());
    Ok(views.filter_map(|view| usize::try_from(view).ok()).collect())
}

#[cfg(test)]
mod tests;

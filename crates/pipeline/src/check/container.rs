//! Checks of the levels and the key/value data of a KTX2 file. Names of sections are those of the KTX File Format
//! Specification 2.0.

use super::findings::{Code, Findings};
use crate::ktx2::{Ktx2, ReadError};

/// Checks section "Level Index": a full mip chain, stored smallest level first, each level aligned.
pub fn check_levels(file: &Ktx2<'_>, findings: &mut Findings) {
    let header = file.header();
    let largest = header.pixel_width.max(header.pixel_height).max(1);
    let full = largest.ilog2() + 1;
    if header.level_count != full {
        findings.add(
            Code::IncompleteChain,
            "header",
            format!(
                "expected {full} levels for {} x {} texels, found {}: engines show missing levels black; bake again",
                header.pixel_width, header.pixel_height, header.level_count
            ),
        );
    }
    let index = header.index;
    // "Mip Padding": the level data come last, so no other section may overlap them.
    let sections = [
        u64::from(index.dfd_byte_offset) + u64::from(index.dfd_byte_length),
        u64::from(index.kvd_byte_offset) + u64::from(index.kvd_byte_length),
        index.sgd_byte_offset.saturating_add(index.sgd_byte_length),
    ];
    let mut end = sections.into_iter().max().unwrap_or(0);
    for (level, facts) in file.levels().iter().enumerate().rev() {
        if facts.offset < end {
            findings.add(
                Code::LevelOrder,
                format!("level {level}"),
                format!(
                    "expected an offset of {end} or more, after the data before it, found {}; bake again",
                    facts.offset
                ),
            );
        }
        end = facts.offset.saturating_add(facts.length);
    }
    for level in 0..file.level_count() {
        if let Err(ReadError::LevelLength { expected, found, .. }) = file.check_length(level) {
            let message = format!("expected {expected} bytes, found {found}; bake again");
            findings.add(Code::LevelLength, format!("level {level}"), message);
        }
    }
    if header.supercompression_scheme.is_none() {
        check_alignment(file, findings);
    }
}

/// Checks section "Mip Padding": offsets are multiples of the least common multiple of the texel block size and 4.
fn check_alignment(file: &Ktx2<'_>, findings: &mut Findings) {
    let block = file.descriptor().map_or(0, |basic| u64::from(basic.bytes_planes[0]));
    let alignment = match block {
        0 => return,
        block if block % 4 == 0 => block,
        block if block % 2 == 0 => 2 * block,
        block => 4 * block,
    };
    for (level, facts) in file.levels().iter().enumerate() {
        if facts.offset % alignment != 0 {
            let message =
                format!("expected an offset that is a multiple of {alignment}, found {}; bake again", facts.offset);
            findings.add(Code::LevelAlignment, format!("level {level}"), message);
        }
    }
}

/// Checks section "Key/Value Data": well-formed entries, sorted by key, with the metadata that data textures may have.
pub fn check_keys(file: &Ktx2<'_>, bytes: &[u8], findings: &mut Findings) {
    let index = file.header().index;
    let start = index.kvd_byte_offset as usize;
    let section = bytes.get(start..start.saturating_add(index.kvd_byte_length as usize)).unwrap_or_default();
    let (entries, rest) = entries(section);
    if !rest.is_empty() {
        let at = start + section.len() - rest.len();
        let message = format!(
            "expected an entry (its length, a key that ends in NUL, a value), found other bytes at {at}; bake again"
        );
        findings.add(Code::KeyEntry, "key/value data", message);
    }
    for pair in entries.windows(2) {
        if let [(before, _), (key, _)] = pair
            && before >= key
        {
            let (before, key) = (String::from_utf8_lossy(before), String::from_utf8_lossy(key));
            findings.add(
                Code::KeyOrder,
                format!("key {key}"),
                format!("expected this key before {before}, found it after {before}; bake again"),
            );
        }
    }
    let value = |name: &str| {
        let (_, value) = entries.iter().find(|(key, _)| *key == name.as_bytes())?;
        Some(String::from_utf8_lossy(value.strip_suffix(b"\0").unwrap_or(value)))
    };
    if value("KTXwriter").is_none() {
        findings.add(
            Code::NoWriter,
            "key KTXwriter",
            "expected the writer's name, found none; bake without --no-provenance",
        );
    }
    // KHR_texture_basisu allows only these two values, or no key.
    let metadata = [(Code::Orientation, "KTXorientation", "rd"), (Code::Swizzle, "KTXswizzle", "rgba")];
    for (code, key, expected) in metadata {
        if let Some(found) = value(key).filter(|found| found != expected) {
            findings.add(
                code,
                format!("key {key}"),
                format!("expected {expected}, found {found}: engines ignore this key; bake again"),
            );
        }
    }
}

type Entry<'a> = (&'a [u8], &'a [u8]);

/// Returns keys and values in the file's order, and the bytes from the first malformed entry on.
fn entries(mut section: &[u8]) -> (Vec<Entry<'_>>, &[u8]) {
    let mut entries = Vec::new();
    while let Some((entry, rest)) = entry(section) {
        entries.push(entry);
        section = rest;
    }
    (entries, section)
}

fn entry(section: &[u8]) -> Option<(Entry<'_>, &[u8])> {
    let (length, rest) = section.split_first_chunk()?;
    let length = u32::from_le_bytes(*length) as usize;
    let (pair, rest) = rest.split_at_checked(length)?;
    let end = pair.iter().position(|b| *b == 0).filter(|end| *end > 0)?;
    let (key, value) = pair.split_at(end);
    std::str::from_utf8(key).ok()?;
    let padding = length.next_multiple_of(4) - length;
    let (padding, rest) = rest.split_at_checked(padding)?;
    padding.iter().all(|b| *b == 0).then_some(((key, &value[1..]), rest))
}

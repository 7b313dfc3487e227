//! OpenEXR: half, float and uint channels, scan lines and tiles, one layer out of many.
//!
//! A layer is a part of a multi-part file, or the text before the last dot of a channel's name (`diffuse.R`), or both
//! (`part.diffuse.R`). The image consists of the first of these sets of channels that the chosen layer has, in upper or
//! lower case: R, G, B and A if there is one; X, Y, Z; R, G; Y and A if there is one; its only channel. Other channels
//! must be named as `layer.channel`. The image is the data window, and the display window is ignored.

use std::collections::BTreeSet;
use std::io::Cursor;

use ::exr::block::{self, UncompressedBlock, reader::ChunksReader};
use ::exr::error::Error;
use ::exr::meta::attribute::{ChannelDescription, SampleType};
use ::exr::meta::header::Header;
use ::exr::prelude::f16;

use crate::image::decoded::{Image, Samples};
use crate::image::error::{DecodeError, listed};
use crate::image::format::FileFormat;
use crate::image::size::texels;
use crate::memory;

const FORMAT: FileFormat = FileFormat::Exr;

/// The channels that make an image, in the order in which they are interleaved.
struct Choice {
    header: usize,
    channels: Vec<usize>,
}

pub(super) fn decode(bytes: &[u8], limit: u64, layer: Option<&str>) -> Result<Image, DecodeError> {
    check_attributes(bytes)?;
    let reader = block::read(Cursor::new(bytes), false).map_err(failed)?;
    // The crate reads the block tables of every part, so the size of every part is checked.
    for header in reader.headers() {
        check_size(header, limit)?;
    }
    let choice = choose(reader.headers(), layer)?;
    let header = choice.header_of(reader.headers())?.clone();
    let (width, height) = (header.layer_size.0, header.layer_size.1);
    let channels = choice.channels.len();
    // The crate returns one chunk for each block of the level. If no block comes twice, all blocks have come.
    let mut seen = BTreeSet::new();

    let meta = reader.meta_data().clone();
    let mut chunks = reader
        .filter_chunks(false, |_, tile, block| {
            let level = tile.level_index;
            block.layer == choice.header && level.0 == 0 && level.1 == 0
        })
        .map_err(failed)?;
    // Here the file is known to have an offset for every block. Decompression holds a block two or three times.
    memory::check(block_bytes(&header).unwrap_or(u64::MAX).saturating_mul(3))?;
    let mut samples = memory::filled(width * height * channels, 0.0)?;
    while let Some(chunk) = chunks.read_next_chunk() {
        let chunk = chunk.map_err(failed)?;
        let block = UncompressedBlock::decompress_chunk(chunk, &meta, false).map_err(failed)?;
        // The offset table may point to a wrong block, or to one block twice.
        let (level, position) = (block.index.level, block.index.pixel_position);
        let is_foreign = block.index.layer != choice.header || level.0 != 0 || level.1 != 0;
        if is_foreign || !seen.insert((position.0, position.1)) {
            return Err(DecodeError::malformed(FORMAT, "offset table"));
        }
        for line in block.lines(&header.channels) {
            let at = line.location;
            let Some(c) = choice.channels.iter().position(|&c| c == at.channel) else {
                continue;
            };
            let start = (at.position.1 * width + at.position.0) * channels + c;
            let row = samples.get_mut(start..).unwrap_or_default().iter_mut().step_by(channels);
            let sample_type = header.channels.list[at.channel].sample_type;
            read_line(row.take(at.sample_count), line.value, sample_type);
        }
    }
    Ok(Image { width: width as u32, height: height as u32, channels: channels as u32, samples: Samples::F32(samples) })
}

/// Widens one line of one channel. The crate hands lines out in the machine's byte order.
fn read_line<'a>(row: impl Iterator<Item = &'a mut f32>, line: &[u8], sample_type: SampleType) {
    match sample_type {
        SampleType::F16 => {
            for (to, from) in row.zip(line.as_chunks().0) {
                *to = f16::from_ne_bytes(*from).to_f32();
            }
        }
        SampleType::F32 => {
            for (to, from) in row.zip(line.as_chunks().0) {
                *to = f32::from_ne_bytes(*from);
            }
        }
        SampleType::U32 => {
            for (to, from) in row.zip(line.as_chunks().0) {
                *to = u32::from_ne_bytes(*from) as f32;
            }
        }
    }
}

/// The memory that one block may always use, whatever the limit on the image.
const BLOCK_MEMORY: u64 = 64 << 20;

fn check_size(header: &Header, limit: u64) -> Result<(), DecodeError> {
    let size = header.layer_size;
    texels(FORMAT, size.0 as u64, size.1 as u64, limit)?;
    let bytes = block_bytes(header);
    // One tile may hold the whole image, with 4 floats for each texel.
    let most = limit.saturating_mul(16).max(BLOCK_MEMORY);
    if bytes.is_none_or(|bytes| bytes > most) {
        let block = header.max_block_pixel_size();
        let what = format!("blocks of {} x {} texels", block.0, block.1);
        return Err(DecodeError::unsupported(FORMAT, what));
    }
    Ok(())
}

/// Returns the bytes of the largest block of a part.
fn block_bytes(header: &Header) -> Option<u64> {
    let block = header.max_block_pixel_size();
    let texels = (block.0 as u64).checked_mul(block.1 as u64)?;
    texels.checked_mul(header.channels.bytes_per_pixel as u64)
}

/// The most attributes of all parts together. The crate needs 2 kB for each attribute, and renderers write dozens.
const MOST_ATTRIBUTES: usize = 10_000;

/// Counts the attributes of all headers before the crate reads them (OpenEXR file layout, "Header"). A truncated header
/// is accepted here, because the crate reports it.
fn check_attributes(bytes: &[u8]) -> Result<(), DecodeError> {
    let after_text = |rest: &'_ [u8]| rest.iter().position(|&byte| byte == 0).map(|end| end + 1);
    let (mut at, mut count) = (8, 0);
    while let Some(&first) = bytes.get(at) {
        if first == 0 {
            // This byte ends a header. In a file of several parts, one more such byte ends all headers.
            at += 1;
            let has_parts = bytes.get(5).is_some_and(|flags| flags & 0x10 != 0);
            if !has_parts || bytes.get(at) == Some(&0) {
                break;
            }
            continue;
        }
        count += 1;
        if count > MOST_ATTRIBUTES {
            return Err(DecodeError::unsupported(FORMAT, format!("more than {MOST_ATTRIBUTES} attributes")));
        }
        for _ in ["name", "type"] {
            let Some(length) = after_text(&bytes[at..]) else { return Ok(()) };
            at += length;
        }
        let Some(length) = bytes.get(at..).and_then(|rest| rest.first_chunk()) else { return Ok(()) };
        at = at.saturating_add(4).saturating_add(u32::from_le_bytes(*length) as usize);
    }
    Ok(())
}

impl Choice {
    /// Returns the part that holds the chosen channels, if its blocks can be read.
    fn header_of<'a>(&self, headers: &'a [Header]) -> Result<&'a Header, DecodeError> {
        let header = headers.get(self.header).ok_or_else(|| DecodeError::malformed(FORMAT, "no channels"))?;
        if header.deep {
            return Err(DecodeError::unsupported(FORMAT, "deep data"));
        }
        // The lines of a block are stored one after the other, so a shorter line would shift all lines after it.
        if header.channels.list.iter().any(is_subsampled) {
            return Err(DecodeError::unsupported(FORMAT, "subsampled channels"));
        }
        Ok(header)
    }
}

fn is_subsampled(channel: &ChannelDescription) -> bool {
    channel.sampling.0 != 1 || channel.sampling.1 != 1
}

/// A channel: its position in the file, and its name as layer and channel.
struct Channel {
    header: usize,
    index: usize,
    layer: String,
    name: String,
}

fn channels_of(headers: &[Header]) -> Vec<Channel> {
    let mut channels = Vec::new();
    for (header, facts) in headers.iter().enumerate() {
        let part = facts.own_attributes.layer_name.as_ref();
        for (index, channel) in facts.channels.list.iter().enumerate() {
            let name = channel.name.to_string();
            let full = match part.map(ToString::to_string) {
                Some(part) if !part.is_empty() && !name.starts_with(&format!("{part}.")) => {
                    format!("{part}.{name}")
                }
                _ => name,
            };
            let (layer, name) = full.rsplit_once('.').unwrap_or(("", &full));
            channels.push(Channel { header, index, layer: layer.to_owned(), name: name.to_owned() });
        }
    }
    channels
}

fn choose(headers: &[Header], asked: Option<&str>) -> Result<Choice, DecodeError> {
    let channels = channels_of(headers);
    let layer = match asked {
        Some(asked) => {
            if !channels.iter().any(|c| c.layer == asked) {
                return single(&channels, asked);
            }
            asked
        }
        None => {
            let unnamed = channels.iter().find(|c| c.layer.is_empty());
            let first = unnamed.or(channels.first());
            &first.ok_or_else(|| DecodeError::malformed(FORMAT, "no channels"))?.layer
        }
    };
    let members: Vec<&Channel> = channels.iter().filter(|c| c.layer == layer).collect();
    let set = image_channels(&members).ok_or_else(|| {
        let names = listed(members.iter().map(|c| c.name.as_str()));
        let what = format!("the layer \"{layer}\" has the channels {names}: name one");
        DecodeError::unsupported(FORMAT, what)
    })?;
    let header = set.first().map_or(0, |c| c.header);
    if set.iter().any(|c| c.header != header) {
        let what = format!("the layer \"{layer}\" is spread over several parts");
        return Err(DecodeError::unsupported(FORMAT, what));
    }
    Ok(Choice { header, channels: set.iter().map(|c| c.index).collect() })
}

/// Chooses the single channel whose full name is `asked`.
fn single(channels: &[Channel], asked: &str) -> Result<Choice, DecodeError> {
    let full_name = |c: &Channel| match c.layer.as_str() {
        "" => c.name.clone(),
        layer => format!("{layer}.{}", c.name),
    };
    if let Some(found) = channels.iter().find(|c| full_name(c) == asked) {
        return Ok(Choice { header: found.header, channels: vec![found.index] });
    }
    let (mut available, mut layers) = (Vec::new(), BTreeSet::new());
    for channel in channels {
        if !channel.layer.is_empty() && layers.insert(&channel.layer) {
            available.push(channel.layer.clone());
        }
        available.push(full_name(channel));
    }
    Err(DecodeError::MissingLayer { asked: asked.to_owned(), available })
}

/// Returns the channels of a layer that form an image, as described at the top of this file.
fn image_channels<'a>(members: &[&'a Channel]) -> Option<Vec<&'a Channel>> {
    const SETS: [&[&str]; 6] =
        [&["R", "G", "B", "A"], &["R", "G", "B"], &["X", "Y", "Z"], &["R", "G"], &["Y", "A"], &["Y"]];
    let find = |name: &&str| {
        let named = |c: &&&Channel| c.name.eq_ignore_ascii_case(name);
        members.iter().find(named).copied()
    };
    SETS.iter()
        .find_map(|set| set.iter().map(find).collect())
        .or_else(|| (members.len() == 1).then(|| members.to_vec()))
}

fn failed(error: Error) -> DecodeError {
    match error {
        Error::Io(error) => DecodeError::from_io(FORMAT, &error),
        Error::NotSupported(what) => DecodeError::unsupported(FORMAT, what),
        // The crate reports an unexpected end with this text.
        Error::Invalid(what) if what == "reference to missing bytes" => {
            DecodeError::Truncated { format: FORMAT, what: what.into() }
        }
        error => DecodeError::malformed(FORMAT, error),
    }
}

#[cfg(test)]
mod tests;

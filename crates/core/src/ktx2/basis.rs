//! Decoding of UASTC LDR and ETC1S by the `basisu` transcoder.
//!
//! The transcoder reads whole files. It is given a file made here that holds a single level. All lengths in that file
//! are checked and zstd is undone, so the transcoder never follows an offset from an untrusted file.

use basisu::{DecodeFlags, TargetFormat, Transcoder};
use ktx2::{ColorModel, Header, Index, LevelIndex, SupercompressionScheme};

use crate::image::Samples;

/// Lengths of the global data's header and of one image's entry, in bytes (KTX 2.0, section 3.12.2).
const GLOBAL_HEADER: usize = 20;
const IMAGE_ENTRY: usize = 20;

/// Bytes of a UASTC block.
const BLOCK: usize = 16;

/// Rows of blocks that are transcoded at a time. They are few because the transcoder holds them twice.
const BAND: u32 = 16;

/// Decodes the UASTC blocks of a level of `size` texels and keeps `channels` of its RGBA.
pub(super) fn uastc(payload: &[u8], (width, height): (u32, u32), channels: &[usize]) -> Option<Samples> {
    let mut values = Vec::with_capacity(width as usize * height as usize * channels.len());
    let bands = payload.chunks(width.div_ceil(4) as usize * BLOCK * BAND as usize);
    for (first, blocks) in (0..height).step_by(4 * BAND as usize).zip(bands) {
        let size = (width, (height - first).min(4 * BAND));
        // With RGBA declared in the descriptor, the transcoder returns all four channels unchanged.
        let file = single_level_file(None, &[3], &[], blocks, size)?;
        append_channels(&transcode(&file, size)?, channels, &mut values);
    }
    Some(Samples::U8(values))
}

/// Decodes level `level` of `levels`, of `size` texels, from its slices and the file's codebooks, and keeps `channels`
/// of its RGBA.
pub(super) fn etc1s(
    slices: &[u8],
    codebooks: &[u8],
    (level, levels): (u32, u32),
    size: (u32, u32),
    channels: &[usize],
) -> Option<Samples> {
    let header = codebooks.get(..GLOBAL_HEADER)?;
    let entries = IMAGE_ENTRY.checked_mul(levels as usize)?;
    let (entries, books) = codebooks.get(GLOBAL_HEADER..)?.split_at_checked(entries)?;
    let entry = entries.get(IMAGE_ENTRY * level as usize..)?;
    let entry = entry.first_chunk::<IMAGE_ENTRY>()?;
    let word = |bytes: &[u8], at: usize| {
        let bytes = bytes.get(at..at + 4)?.try_into().ok()?;
        Some(u32::from_le_bytes(bytes) as usize)
    };
    let books_length = word(header, 4)? + word(header, 8)? + word(header, 12)?;
    if books_length > books.len() {
        return None;
    }
    let has_alpha = channels.contains(&3);
    for (offset, length) in [(4, 8), (12, 16)] {
        if word(entry, offset)? + word(entry, length)? > slices.len() {
            return None;
        }
    }
    // The flags are cleared: they mark frames of videos, which cannot be decoded alone, and glTF has none.
    let global = [header, &[0; 4], &entry[4..], books].concat();
    let samples: &[u8] = if has_alpha { &[0, 15] } else { &[0] };
    let scheme = Some(SupercompressionScheme::BasisLZ);
    let file = single_level_file(scheme, samples, &global, slices, size)?;
    let rgba = transcode(&file, size)?;
    if channels.len() == 4 {
        return Some(Samples::U8(rgba));
    }
    let mut values = Vec::with_capacity(rgba.len() / 4 * channels.len());
    append_channels(&rgba, channels, &mut values);
    Some(Samples::U8(values))
}

/// Returns the texels of the one level of `file` as RGBA.
fn transcode(file: &[u8], size: (u32, u32)) -> Option<Vec<u8>> {
    let transcoder = Transcoder::new(file).ok()?;
    let rgba = transcoder.transcode(0, TargetFormat::Rgba32, DecodeFlags::NONE).ok()?;
    (rgba.len() as u64 == 4 * u64::from(size.0) * u64::from(size.1)).then_some(rgba)
}

/// Appends `channels` of each texel to `values`.
fn append_channels(rgba: &[u8], channels: &[usize], values: &mut Vec<u8>) {
    for texel in rgba.as_chunks::<4>().0 {
        values.extend(channels.iter().map(|&c| texel[c]));
    }
}

/// Returns a KTX2 file of one level. `samples` are the channel identifiers of the descriptor.
fn single_level_file(
    scheme: Option<SupercompressionScheme>,
    samples: &[u8],
    global: &[u8],
    payload: &[u8],
    (width, height): (u32, u32),
) -> Option<Vec<u8>> {
    let model = match scheme {
        Some(_) => ColorModel::ETC1S,
        None => ColorModel::UASTC,
    };
    let mut descriptor = vec![0; 4 + 24];
    let length = descriptor.len() + 16 * samples.len();
    descriptor[0] = length as u8;
    descriptor[8] = 2;
    descriptor[10] = (length - 4) as u8;
    descriptor[12] = model.value();
    descriptor[14] = ktx2::TransferFunction::Linear.value();
    descriptor[16..18].copy_from_slice(&[3, 3]);
    for &channel in samples {
        let mut sample = [0; 16];
        sample[3] = channel;
        descriptor.extend(sample);
    }
    let descriptor_at = Header::LENGTH + LevelIndex::LENGTH;
    let global_at = descriptor_at + descriptor.len();
    let payload_at = global_at + global.len();
    let header = Header {
        format: None,
        type_size: 1,
        pixel_width: width,
        pixel_height: height,
        pixel_depth: 0,
        layer_count: 0,
        face_count: 1,
        level_count: 1,
        supercompression_scheme: scheme,
        index: Index {
            dfd_byte_offset: u32::try_from(descriptor_at).ok()?,
            dfd_byte_length: u32::try_from(length).ok()?,
            kvd_byte_offset: 0,
            kvd_byte_length: 0,
            sgd_byte_offset: global_at as u64,
            sgd_byte_length: global.len() as u64,
        },
    };
    let level =
        LevelIndex { byte_offset: payload_at as u64, byte_length: payload.len() as u64, uncompressed_byte_length: 0 };
    let parts = [&header.as_bytes()[..], &level.as_bytes(), &descriptor, global, payload];
    Some(parts.concat())
}

//! Whole JPEGs are read; what lost any part of its image is refused.

use crate::image::jpeg::*;

/// Returns a photograph-like texel: waves with noise, so that blocks have codes of all lengths.
fn texel(x: usize, y: usize, c: usize) -> u8 {
    let noise = (x * 7919 + y * 104_729 + c * 31) % 97 % 29;
    (128.0 + 80.0 * ((x + 9 * c) as f32 / 11.0).sin() * (y as f32 / 7.0).cos()) as u8 ^ noise as u8
}

struct Kind {
    name: &'static str,
    grey: bool,
    progressive: bool,
    restart: u16,
    sampling: jpeg_encoder::SamplingFactor,
}

/// Files of 75 x 53 texels: neither side is whole in blocks, nor in MCUs.
fn files() -> Vec<(&'static str, Vec<u8>)> {
    use jpeg_encoder::SamplingFactor::{F_1_1, F_2_2, F_4_1};
    let kind = |name, grey, progressive, restart, sampling| Kind { name, grey, progressive, restart, sampling };
    let kinds = [
        kind("grey", true, false, 0, F_1_1),
        kind("baseline", false, false, 0, F_1_1),
        kind("4:2:0", false, false, 0, F_2_2),
        kind("4:1:1 with restarts", false, false, 3, F_4_1),
        kind("progressive", false, true, 0, F_2_2),
        kind("progressive with restarts", false, true, 4, F_1_1),
    ];
    let files = kinds.into_iter().map(|Kind { name, grey, progressive, restart, sampling }| {
        let (channels, color) =
            if grey { (1, jpeg_encoder::ColorType::Luma) } else { (3, jpeg_encoder::ColorType::Rgb) };
        let at = |i: usize| texel(i / channels % 75, i / channels / 75, i % channels);
        let texels: Vec<u8> = (0..75 * 53 * channels).map(at).collect();
        let mut file = Vec::new();
        let mut encoder = jpeg_encoder::Encoder::new(&mut file, 70);
        encoder.set_progressive(progressive);
        encoder.set_sampling_factor(sampling);
        if restart > 0 {
            encoder.set_restart_interval(restart);
        }
        encoder.encode(&texels, 75, 53, color).unwrap();
        (name, file)
    });
    // libjpeg's script: coefficients are refined by scans of their own, which jpeg-encoder does not write.
    files.chain([("refined", include_bytes!("files/progressive.jpg").to_vec())]).collect()
}

fn read(bytes: &[u8]) -> Result<Image, DecodeError> {
    decode(bytes, 1 << 20)
}

#[test]
fn whole_files_are_read() {
    for (name, file) in files() {
        let image = read(&file).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!((image.width, image.height), (75, 53), "{name}");
    }
}

#[test]
fn every_cut_is_refused_also_with_an_end_marker() {
    for (name, file) in files() {
        let whole = read(&file).unwrap();
        for end in 0..file.len() - 2 {
            let marked = [&file[..end], b"\xff\xd9"].concat();
            // The last bits of the last byte only fill it up, and a cut within a marker may leave a file that is whole.
            if end + 4 > file.len() {
                assert!(read(&marked).map_or(true, |found| found == whole), "{name} cut at {end}");
                continue;
            }
            assert!(read(&marked).is_err(), "{name} cut at {end} of {}", file.len());
            assert!(read(&file[..end]).is_err(), "{name} cut at {end} without a marker");
        }
    }
}

/// What is lost is longer than a block: within one, nothing tells that coefficients are missing.
#[test]
fn a_file_without_its_middle_is_refused() {
    for (name, file) in files() {
        for length in [120, 250, 400] {
            for start in (2..file.len() - length - 2).step_by(7) {
                let damaged = [&file[..start], &file[start + length..]].concat();
                assert!(read(&damaged).is_err(), "{name} without {length} bytes from {start} on");
            }
        }
    }
}

#[test]
fn what_follows_the_end_is_no_concern() {
    for (name, mut file) in files() {
        let whole = read(&file);
        file.extend([0; 3]);
        assert_eq!(read(&file), whole, "{name}");
        file.extend(b"\xff\xd8\xff\xe1 an image of another size");
        assert_eq!(read(&file), whole, "{name}");
    }
}

#[test]
fn filling_before_markers_is_no_concern() {
    for (name, file) in files() {
        let whole = read(&file);
        for filling in [&b"\xff\xff"[..], &[0; 5]] {
            let (data, end) = file.split_at(file.len() - 2);
            assert_eq!(read(&[data, filling, end].concat()), whole, "{name} {filling:?}");
        }
    }
}

/// Less data than a bit for each block.
#[test]
fn a_size_that_the_data_cannot_fill_is_refused_before_decoding() {
    for (name, mut file) in files() {
        let frame = file.windows(2).position(|marker| matches!(marker, [0xff, 0xc0 | 0xc2])).unwrap();
        file[frame + 5..frame + 9].copy_from_slice(&[0x40, 0, 0x40, 0]);
        let found = decode(&file, 1 << 28);
        assert!(
            matches!(found, Err(DecodeError::Truncated { .. } | DecodeError::Malformed { .. })),
            "{name}: {found:?}"
        );
    }
}

#[test]
fn messages_are_one_line() {
    for (name, file) in files() {
        for at in 2..file.len().min(700) {
            let mut changed = file.clone();
            changed[at] ^= 0x35;
            if let Err(error) = read(&changed) {
                assert_eq!(error.to_string().lines().count(), 1, "{name} changed at {at}: {error}");
            }
        }
    }
}

#[test]
fn real_files_are_whole() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data/");
    if !std::path::Path::new(folder).is_dir() {
        return crate::skip::skip(&format!("{folder} does not exist"));
    }
    for entry in walkdir::WalkDir::new(folder).into_iter().flatten() {
        let path = entry.path();
        if path.extension().is_some_and(|e| e == "jpg" || e == "jpeg") {
            assert_eq!(scans::check(&std::fs::read(path).unwrap()).err(), None, "{}", path.display());
        }
    }
}

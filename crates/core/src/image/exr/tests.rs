//! EXR: depths, blocks, layers and channels.

use ::exr::prelude::{Blocks, Compression, Encoding, FlatSamples, LineOrder};

use crate::image::decode::DecodeOptions;
use crate::image::decode::decode_raster as decode;
use crate::image::decoded::{Image, Samples};
use crate::image::error::DecodeError;
use crate::image::test_files::{ExrLayer, exr, exr_value, halves};

const SIZE: (usize, usize) = (21, 17);

fn encoding(compression: Compression, blocks: Blocks) -> Encoding {
    Encoding { compression, blocks, line_order: LineOrder::Increasing }
}

fn read(bytes: &[u8], layer: Option<&str>) -> Result<Image, DecodeError> {
    let options = DecodeOptions { layer: layer.map(str::to_owned), ..DecodeOptions::default() };
    decode(bytes, &options)
}

fn scan_lines(layers: Vec<ExrLayer>) -> Vec<u8> {
    exr(SIZE, encoding(Compression::ZIP16, Blocks::ScanLines), layers)
}

/// Returns the image whose channels are those of [`halves`] with these numbers.
fn of_channels(channels: &[usize]) -> Image {
    let samples = (0..SIZE.0 * SIZE.1).flat_map(|i| {
        let value = move |&c| exr_value(i % SIZE.0, i / SIZE.0, c);
        channels.iter().map(value)
    });
    Image {
        width: SIZE.0 as u32,
        height: SIZE.1 as u32,
        channels: channels.len() as u32,
        samples: Samples::F32(samples.collect()),
    }
}

fn channels<'a>(names: &[&'a str], first: usize) -> Vec<(&'a str, FlatSamples)> {
    let channel = |(i, &name)| (name, halves(SIZE.0, SIZE.1, first + i));
    names.iter().enumerate().map(channel).collect()
}

#[test]
fn lossless_compressions_in_lines_and_tiles() {
    let blocks = [Blocks::ScanLines, Blocks::Tiles((8, 8).into()), Blocks::Tiles((64, 5).into())];
    for compression in
        [Compression::Uncompressed, Compression::RLE, Compression::ZIP1, Compression::ZIP16, Compression::PIZ]
    {
        for blocks in blocks {
            let encoding = encoding(compression, blocks);
            let file = exr(SIZE, encoding, vec![(None, channels(&["R", "G", "B"], 0))]);
            let found = read(&file, None);
            assert_eq!(found, Ok(of_channels(&[0, 1, 2])), "{encoding:?}");
        }
    }
}

#[test]
fn floats_and_uints_with_nan_and_infinity() {
    let mut floats = vec![0.1f32; SIZE.0 * SIZE.1];
    floats[..3].copy_from_slice(&[f32::NAN, f32::INFINITY, f32::NEG_INFINITY]);
    let file = scan_lines(vec![(None, vec![("Y", FlatSamples::F32(floats))])]);
    let found = read(&file, None).unwrap();
    assert_eq!(found.channels, 1);
    assert!(found.sample(0, 0, 0).unwrap().is_nan());
    assert_eq!(found.sample(1, 0, 0), Some(f32::INFINITY));
    assert_eq!(found.sample(2, 0, 0), Some(f32::NEG_INFINITY));
    assert_eq!(found.sample(3, 0, 0), Some(0.1));

    let uints = FlatSamples::U32(vec![7; SIZE.0 * SIZE.1]);
    let file = scan_lines(vec![(None, vec![("Z", uints)])]);
    assert_eq!(read(&file, None).unwrap().sample(4, 4, 0), Some(7.0));
}

#[test]
fn the_channels_of_an_image_are_found_by_their_names() {
    for (names, expected) in [
        (&["B", "G", "R"][..], &[2, 1, 0][..]),
        (&["A", "B", "G", "R"], &[3, 2, 1, 0]),
        (&["X", "Y", "Z"], &[0, 1, 2]),
        (&["x", "y", "z"], &[0, 1, 2]),
        (&["G", "R"], &[1, 0]),
        (&["A", "Y"], &[1, 0]),
        (&["Y", "height"], &[0]),
        (&["bump"], &[0]),
    ] {
        let file = scan_lines(vec![(None, channels(names, 0))]);
        assert_eq!(read(&file, None), Ok(of_channels(expected)), "{names:?}");
    }
    let file = scan_lines(vec![(None, channels(&["U", "V"], 0))]);
    let refused = read(&file, None);
    assert!(matches!(refused, Err(DecodeError::Unsupported { .. })), "{refused:?}");
    assert_eq!(read(&file, Some("V")), Ok(of_channels(&[1])));
}

#[test]
fn layers_by_part_and_by_channel_name() {
    let parts = scan_lines(vec![
        (Some("colour"), channels(&["B", "G", "R"], 0)),
        (Some("normal"), channels(&["X", "Y", "Z"], 3)),
    ]);
    let prefixed = scan_lines(vec![(
        None,
        channels(&["colour.B", "colour.G", "colour.R", "normal.X", "normal.Y", "normal.Z"], 0),
    )]);
    for file in [&parts, &prefixed] {
        assert_eq!(read(file, None), Ok(of_channels(&[2, 1, 0])));
        assert_eq!(read(file, Some("normal")), Ok(of_channels(&[3, 4, 5])));
        assert_eq!(read(file, Some("normal.Y")), Ok(of_channels(&[4])));
        let Err(DecodeError::MissingLayer { asked, available }) = read(file, Some("depth")) else {
            panic!("there is no depth");
        };
        assert_eq!(asked, "depth");
        assert_eq!(available[..2], ["colour", "colour.B"]);
        assert_eq!(available[4..6], ["normal", "normal.X"]);
    }
    let mixed = scan_lines(vec![(None, channels(&["B", "G", "R", "a.X"], 0))]);
    assert_eq!(read(&mixed, None), Ok(of_channels(&[2, 1, 0])));
    assert_eq!(read(&mixed, Some("a")), Ok(of_channels(&[3])));
}

#[test]
fn the_largest_level_of_a_mip_mapped_file_is_read() {
    use ::exr::math::RoundingMode;
    use ::exr::prelude::{AnyChannel, AnyChannels, Layer, LayerAttributes, Levels, WritableImage};
    let (width, height) = (8, 8);
    let level = |size: usize| {
        let values = (0..size * size).map(|i| i as f32 + size as f32 * 100.0);
        FlatSamples::F32(values.collect())
    };
    let levels =
        Levels::Mip { rounding_mode: RoundingMode::Down, level_data: vec![level(8), level(4), level(2), level(1)] };
    let channel = AnyChannel::new("Y", levels);
    let layer = Layer::new(
        (width, height),
        LayerAttributes::default(),
        encoding(Compression::ZIP16, Blocks::Tiles((4, 4).into())),
        AnyChannels::sort([channel].into_iter().collect()),
    );
    let mut file = std::io::Cursor::new(Vec::new());
    ::exr::prelude::Image::from_layer(layer).write().non_parallel().to_buffered(&mut file).unwrap();
    let found = read(&file.into_inner(), None).unwrap();
    assert_eq!((found.width, found.height), (8, 8));
    assert_eq!(found.sample(7, 7, 0), Some(863.0));
    assert_eq!(found.sample(0, 0, 0), Some(800.0));
}

/// The header of a scan-line file up to its attributes.
const EXR_START: &[u8] = b"\x76\x2f\x31\x01\x02\0\0\0";

#[test]
fn messages_name_some_of_many_channels() {
    let names: Vec<String> = (0..5000).map(|i| format!("a rather long name of a channel {i}")).collect();
    let channels = names.iter().map(|name| (name.as_str(), FlatSamples::F32(vec![0.5]))).collect();
    let file = exr((1, 1), encoding(Compression::Uncompressed, Blocks::ScanLines), vec![(None, channels)]);
    for layer in [None, Some("absent")] {
        let error = read(&file, layer).unwrap_err().to_string();
        assert!(error.len() < 2000 && error.contains("more"), "{} bytes: {error:.100}", error.len());
    }
}

#[test]
fn more_attributes_than_anybody_writes_are_refused_unread() {
    let mut file = EXR_START.to_vec();
    for i in 0..300_000 {
        file.extend(format!("{i}\0int\0\x04\0\0\0\0\0\0\0").bytes());
    }
    file.extend([0; 100]);
    let error = read(&file, None).unwrap_err();
    assert!(matches!(&error, DecodeError::Unsupported { what, .. } if what.contains("attributes")), "{error}");
}

#[test]
fn attributes_of_all_parts_count_and_few_do_not() {
    let layers = || ["a", "b", "c"].map(|name| (Some(name), channels(&["Y"], 0))).to_vec();
    let file = exr(SIZE, encoding(Compression::Uncompressed, Blocks::ScanLines), layers());
    assert!(read(&file, Some("c")).is_ok());
}

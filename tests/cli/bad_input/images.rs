//! Images that are cut off, damaged, too large, or hold what no map holds.

use std::fs;
use std::path::Path;

use super::*;

/// Where the complaint must point for the normal texture of the bad asset.
const NORMAL: [&str; 3] = ["bad/brushed.gltf: ", "material Brushed steel, ", "texture brushed_normal."];

fn says_of_the_normal_map(line: &str, parts: &[&str]) {
    assert_says(line, &[NORMAL.as_slice(), parts].concat());
}

/// Puts `bytes` in the place of the normal map, in a file with extension `extension`.
fn with_normal_map(extension: &str, bytes: &[u8]) -> Scene {
    let scene = Scene::new();
    let name = format!("brushed_normal.{extension}");
    scene.edit("brushed_normal.png", &name);
    fs::write(scene.bad(&name), bytes).expect("a file");
    scene
}

fn halved(bytes: &[u8]) -> &[u8] {
    &bytes[..bytes.len() / 2]
}

#[test]
fn a_cut_off_png() {
    let scene = Scene::new();
    cut_in_half(&scene.bad("brushed_normal.png"));
    says_of_the_normal_map(&scene.complaint(&[]), &["PNG", "cut off"]);
}

#[test]
fn a_cut_off_roughness_map() {
    let scene = Scene::new();
    cut_in_half(&scene.bad("brushed_surface.png"));
    assert_says(&scene.complaint(&[]), &["bad/brushed.gltf", "Brushed steel", "brushed_surface.png", "cut off"]);
}

#[test]
fn a_cut_off_jpeg() {
    let mut bytes = Vec::new();
    let pixels: Vec<u8> = (0..64 * 64 * 3).map(|i| (i * 7919 % 251) as u8).collect();
    let encoder = jpeg_encoder::Encoder::new(&mut bytes, 90);
    encoder.encode(&pixels, 64, 64, jpeg_encoder::ColorType::Rgb).expect("a JPEG");
    says_of_the_normal_map(&with_normal_map("jpg", halved(&bytes)).complaint(&[]), &["JPEG", "cut off"]);
}

#[test]
fn a_cut_off_ktx2() {
    let bytes = baked_map("float");
    says_of_the_normal_map(&with_normal_map("ktx2", halved(&bytes)).complaint(&[]), &["KTX2"]);
    says_of_the_normal_map(&with_normal_map("ktx2", &bytes[..bytes.len() - 1]).complaint(&[]), &["KTX2"]);
}

/// A KTX2 file that does not say who wrote it.
fn baked_map(target: &str) -> Vec<u8> {
    let folder = tempdir().expect("a folder");
    let output = folder.path().join("map.ktx2");
    let image = fixtures().join("maps/vgroove_normal.png");
    let arguments = ["map".as_ref(), image.as_os_str(), "-o".as_ref(), output.as_os_str()];
    let options = ["--target", target, "--no-provenance"].map(AsRef::as_ref);
    let run = roughcast(arguments.into_iter().chain(options));
    assert_eq!((run.code, run.err.as_str()), (0, ""));
    fs::read(output).expect("a KTX2 file")
}

#[test]
fn a_cut_off_exr() {
    let bytes = fs::read(fixtures().join("maps/dunes_height.exr")).expect("a fixture");
    let line = map_complaint(halved(&bytes), &["--height"]);
    assert_says(&line, &["map.exr", "EXR", "cut off"]);
}

#[test]
fn an_empty_image() {
    says_of_the_normal_map(&with_normal_map("png", b"").complaint(&[]), &["expected"]);
}

#[test]
fn a_text_in_the_place_of_an_image() {
    says_of_the_normal_map(&with_normal_map("png", b"<!doctype html>").complaint(&[]), &["expected PNG"]);
}

#[test]
fn an_image_of_one_channel() {
    let grey = fs::read(fixtures().join("heights/heights.png")).expect("a fixture");
    says_of_the_normal_map(&with_normal_map("png", &grey).complaint(&[]), &["expected a normal map", "found"]);
}

/// A header may claim any size; nothing is allocated for it.
#[test]
fn an_image_beyond_the_limit() {
    let scene = Scene::new();
    let mut bytes = fs::read(scene.bad("brushed_normal.png")).expect("a fixture");
    bytes[16..24].copy_from_slice(&[0, 1, 0, 0, 0, 1, 0, 0]);
    let crc = crc32(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&crc.to_be_bytes());
    fs::write(scene.bad("brushed_normal.png"), bytes).expect("a file");
    says_of_the_normal_map(&scene.complaint(&[]), &["65536 x 65536", "limit is 268435456"]);
}

#[test]
fn an_image_beyond_a_limit_asked_for() {
    let scene = Scene::new();
    let run = scene.bake(&["--max-texels", "10000"]);
    assert_eq!(run.code, 1);
    let lines: Vec<_> = run.err.lines().collect();
    assert_eq!(lines.len(), 2, "{}", run.err);
    says_of_the_normal_map(lines[0], &["128 x 128", "limit is 10000"]);
    assert_says(lines[1], &["waves.glb", "Lake", "128 x 128", "limit is 10000"]);
    assert!(!scene.output().exists());
}

/// CRC-32 as PNG has it.
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, _| if crc & 1 == 1 { (crc >> 1) ^ 0xEDB8_8320 } else { crc >> 1 };
    !bytes.iter().fold(!0, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), step))
}

#[test]
fn heights_that_are_no_numbers() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let line = map_complaint(&exr_with(bad), &["--height"]);
        assert_says(&line, &["map.exr: expected finite values", "1 texel", "column 5, row 3"]);
    }
}

#[test]
fn heights_of_a_material_that_are_no_numbers() {
    let scene = with_normal_map("exr", &exr_with(f32::NAN));
    scene.edit(
        "\"normalTexture\": {\n        \"index\": 1\n      },",
        "\"extras\": { \"roughcast\": { \"heightTexture\": { \"index\": 1 } } },",
    );
    says_of_the_normal_map(&scene.complaint(&[]), &["expected finite values", "column 5, row 3"]);
}

/// A NaN in a roughness map would come out as a NaN in each of its levels.
#[test]
fn roughness_that_is_no_number() {
    let scene = Scene::new();
    fs::write(scene.bad("brushed_surface.exr"), exr_with(f32::NAN)).expect("a file");
    scene.edit("brushed_surface.png", "brushed_surface.exr");
    let line = scene.complaint(&[]);
    let says = ["Brushed steel", "brushed_surface.exr", "expected finite values", "column 5, row 3"];
    assert_says(&line, &says);
    let folder = tempdir().expect("a folder");
    let roughness = folder.path().join("rough.exr");
    fs::write(&roughness, exr_with(f32::INFINITY)).expect("a file");
    let (image, output) = (fixtures().join("maps/vgroove_normal.png"), folder.path().join("out.ktx2"));
    let paths = [image.as_os_str(), "-o".as_ref(), output.as_os_str(), "--roughness".as_ref(), roughness.as_os_str()];
    let run = roughcast(["map".as_ref()].into_iter().chain(paths));
    assert_says(&one_line(&run), &["rough.exr: expected finite values", "column 5, row 3"]);
}

/// Heights of 16 x 16 texels, one of them `bad`.
fn exr_with(bad: f32) -> Vec<u8> {
    use exr::prelude::{Encoding, Image, SpecificChannels, WritableImage};
    let pixel = |at: exr::math::Vec2<usize>| (if (at.x(), at.y()) == (5, 3) { bad } else { 0.5 },);
    let channels = SpecificChannels::build().with_channel("Y").with_pixel_fn(pixel);
    let image = Image::from_encoded_channels((16, 16), Encoding::UNCOMPRESSED, channels);
    let mut file = std::io::Cursor::new(Vec::new());
    image.write().to_buffered(&mut file).expect("an EXR");
    file.into_inner()
}

/// What `roughcast map` says of an EXR file of these bytes.
fn map_complaint(bytes: &[u8], options: &[&str]) -> String {
    let folder = tempdir().expect("a folder");
    let (image, output) = (folder.path().join("map.exr"), folder.path().join("out/map.ktx2"));
    fs::write(&image, bytes).expect("a file");
    let arguments = ["map".as_ref(), image.as_os_str(), "-o".as_ref(), output.as_os_str()];
    let run = roughcast(arguments.into_iter().chain(options.iter().map(AsRef::as_ref)));
    assert!(!Path::exists(&folder.path().join("out")), "something was written");
    one_line(&run)
}

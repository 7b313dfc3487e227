//! Images that are truncated, damaged, too large, or hold values that no map has.

use std::fs;
use std::path::Path;

use super::*;

/// What the error says about the place of the normal texture in the bad asset.
const NORMAL: [&str; 3] = ["bad/brushed.gltf: ", "material Brushed steel, ", "texture brushed_normal."];

fn assert_names_the_normal_map(line: &str, parts: &[&str]) {
    assert_contains(line, &[NORMAL.as_slice(), parts].concat());
}

/// Replaces the normal map by `bytes`, in a file with this extension.
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
fn rejects_a_truncated_png() {
    let scene = Scene::new();
    cut_in_half(&scene.bad("brushed_normal.png"));
    assert_names_the_normal_map(&scene.error_line(&[]), &["PNG", "cut off"]);
}

#[test]
fn rejects_a_truncated_roughness_map() {
    let scene = Scene::new();
    cut_in_half(&scene.bad("brushed_surface.png"));
    assert_contains(&scene.error_line(&[]), &["bad/brushed.gltf", "Brushed steel", "brushed_surface.png", "cut off"]);
}

#[test]
fn rejects_a_truncated_jpeg() {
    let mut bytes = Vec::new();
    let pixels: Vec<u8> = (0..64 * 64 * 3).map(|i| (i * 7919 % 251) as u8).collect();
    let encoder = jpeg_encoder::Encoder::new(&mut bytes, 90);
    encoder.encode(&pixels, 64, 64, jpeg_encoder::ColorType::Rgb).expect("a JPEG");
    assert_names_the_normal_map(&with_normal_map("jpg", halved(&bytes)).error_line(&[]), &["JPEG", "cut off"]);
}

#[test]
fn rejects_a_truncated_ktx2() {
    let bytes = baked_map("float");
    assert_names_the_normal_map(&with_normal_map("ktx2", halved(&bytes)).error_line(&[]), &["KTX2"]);
    assert_names_the_normal_map(&with_normal_map("ktx2", &bytes[..bytes.len() - 1]).error_line(&[]), &["KTX2"]);
}

/// Returns a KTX2 file without provenance.
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
fn rejects_a_truncated_exr() {
    let bytes = fs::read(fixtures().join("maps/dunes_height.exr")).expect("a fixture");
    let line = map_error(halved(&bytes), &["--height"]);
    assert_contains(&line, &["map.exr", "EXR", "cut off"]);
}

#[test]
fn rejects_an_empty_image() {
    assert_names_the_normal_map(&with_normal_map("png", b"").error_line(&[]), &["expected"]);
}

#[test]
fn rejects_a_text_instead_of_an_image() {
    assert_names_the_normal_map(&with_normal_map("png", b"<!doctype html>").error_line(&[]), &["expected PNG"]);
}

#[test]
fn rejects_a_normal_map_of_one_channel() {
    let grey = fs::read(fixtures().join("heights/heights.png")).expect("a fixture");
    assert_names_the_normal_map(&with_normal_map("png", &grey).error_line(&[]), &["expected a normal map", "found"]);
}

/// Headers may claim any size. Nothing is allocated for a size above the limit.
#[test]
fn rejects_an_image_beyond_the_default_limit() {
    let scene = Scene::new();
    let mut bytes = fs::read(scene.bad("brushed_normal.png")).expect("a fixture");
    bytes[16..24].copy_from_slice(&[0, 1, 0, 0, 0, 1, 0, 0]);
    let crc = crc32(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&crc.to_be_bytes());
    fs::write(scene.bad("brushed_normal.png"), bytes).expect("a file");
    assert_names_the_normal_map(&scene.error_line(&[]), &["65536 x 65536", "limit is 268435456"]);
}

#[test]
fn rejects_an_image_beyond_max_texels() {
    let scene = Scene::new();
    let run = scene.bake(&["--max-texels", "10000"]);
    assert_eq!(run.code, 1);
    let lines: Vec<_> = run.err.lines().collect();
    assert_eq!(lines.len(), 2, "{}", run.err);
    assert_names_the_normal_map(lines[0], &["128 x 128", "limit is 10000"]);
    assert_contains(lines[1], &["waves.glb", "Lake", "128 x 128", "limit is 10000"]);
    assert!(!scene.output().exists());
}

/// Returns the CRC-32 of PNG.
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, _| if crc & 1 == 1 { (crc >> 1) ^ 0xEDB8_8320 } else { crc >> 1 };
    !bytes.iter().fold(!0, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), step))
}

#[test]
fn rejects_heights_that_are_nan() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let line = map_error(&exr_with(bad), &["--height"]);
        assert_contains(&line, &["map.exr: expected finite values", "1 texel", "column 5, row 3"]);
    }
}

#[test]
fn rejects_heights_of_a_material_that_are_nan() {
    let scene = with_normal_map("exr", &exr_with(f32::NAN));
    scene.edit(
        "\"normalTexture\": {\n        \"index\": 1\n      },",
        "\"extras\": { \"roughcast\": { \"heightTexture\": { \"index\": 1 } } },",
    );
    assert_names_the_normal_map(&scene.error_line(&[]), &["expected finite values", "column 5, row 3"]);
}

/// A NaN in a roughness map would spread to every level.
#[test]
fn rejects_roughness_that_is_nan() {
    let scene = Scene::new();
    fs::write(scene.bad("brushed_surface.exr"), exr_with(f32::NAN)).expect("a file");
    scene.edit("brushed_surface.png", "brushed_surface.exr");
    let line = scene.error_line(&[]);
    let says = ["Brushed steel", "brushed_surface.exr", "expected finite values", "column 5, row 3"];
    assert_contains(&line, &says);
    let folder = tempdir().expect("a folder");
    let roughness = folder.path().join("rough.exr");
    fs::write(&roughness, exr_with(f32::INFINITY)).expect("a file");
    let (image, output) = (fixtures().join("maps/vgroove_normal.png"), folder.path().join("out.ktx2"));
    let paths = [image.as_os_str(), "-o".as_ref(), output.as_os_str(), "--roughness".as_ref(), roughness.as_os_str()];
    let run = roughcast(["map".as_ref()].into_iter().chain(paths));
    assert_contains(&one_line(&run), &["rough.exr: expected finite values", "column 5, row 3"]);
}

/// Returns heights of 16 x 16 texels, one of them `bad`.
fn exr_with(bad: f32) -> Vec<u8> {
    use exr::prelude::{Encoding, Image, SpecificChannels, WritableImage};
    let pixel = |at: exr::math::Vec2<usize>| (if (at.x(), at.y()) == (5, 3) { bad } else { 0.5 },);
    let channels = SpecificChannels::build().with_channel("Y").with_pixel_fn(pixel);
    let image = Image::from_encoded_channels((16, 16), Encoding::UNCOMPRESSED, channels);
    let mut file = std::io::Cursor::new(Vec::new());
    image.write().to_buffered(&mut file).expect("an EXR");
    file.into_inner()
}

/// Returns the error of `roughcast map` on an EXR file of these bytes.
fn map_error(bytes: &[u8], options: &[&str]) -> String {
    let folder = tempdir().expect("a folder");
    let (image, output) = (folder.path().join("map.exr"), folder.path().join("out/map.ktx2"));
    fs::write(&image, bytes).expect("a file");
    let arguments = ["map".as_ref(), image.as_os_str(), "-o".as_ref(), output.as_os_str()];
    let run = roughcast(arguments.into_iter().chain(options.iter().map(AsRef::as_ref)));
    assert!(!Path::exists(&folder.path().join("out")), "something was written");
    one_line(&run)
}

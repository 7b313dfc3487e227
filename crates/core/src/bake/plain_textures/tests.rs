use std::io::{self, Cursor};
use std::path::Path;

use image::{ImageFormat, RgbImage, RgbaImage};
use serde_json::{Value, json};

use crate::bake::{BakedAsset, Source, bake_asset, planned_files};
use crate::gltf::document::Document;
use crate::image::{Image, Rgba};
use crate::ktx2::{Ktx2, provenance};
use crate::mip::TexelRows;
use crate::settings::{Form, Model, Profile, Settings, SettingsError, Textures};

/// Columns and rows of all images: no powers of two.
const SIZE: (u32, u32) = (24, 20);

fn encoded(image: impl Into<image::DynamicImage>) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    image.into().write_to(&mut file, ImageFormat::Png).unwrap();
    file.into_inner()
}

fn png(texel: impl Fn(u32, u32) -> [u8; 3]) -> Vec<u8> {
    encoded(RgbImage::from_fn(SIZE.0, SIZE.1, |x, y| image::Rgb(texel(x, y))))
}

fn leaf() -> RgbaImage {
    RgbaImage::from_fn(SIZE.0, SIZE.1, |x, y| {
        // No row or column lies at the cutoff.
        let alpha = 127.5 + 127.5 * (0.4 * f64::from(x) + 0.2).sin() * (0.3 * f64::from(y)).cos();
        image::Rgba([(9 * x) as u8, 200, (12 * y) as u8, alpha as u8])
    })
}

fn read(path: &Path) -> io::Result<Vec<u8>> {
    match path.to_str() {
        Some("leaf.png") => Ok(encoded(leaf())),
        Some("occlusion.png") => Ok(png(|x, y| [(255 - 5 * x - 4 * y) as u8; 3])),
        Some("surface.png") => Ok(png(|x, y| [250, (60 + 7 * y) as u8, (10 * x) as u8])),
        Some("normal.png") => Ok(png(|x, y| [(118 + 20 * (x % 2)) as u8, (98 + 3 * y) as u8, 240])),
        _ => Err(io::ErrorKind::NotFound.into()),
    }
}

/// Returns a material of leaves with bumps, and one without. Base colour and emissive share an image; occlusion shares
/// one with the metalness of the second material only.
fn document() -> Value {
    let surface = json!({ "baseColorTexture": { "index": 0 }, "metallicRoughnessTexture": { "index": 2 } });
    json!({
        "asset": { "version": "2.0" },
        "images": [
            { "uri": "leaf.png" }, { "uri": "occlusion.png" }, { "uri": "surface.png" }, { "uri": "normal.png" },
        ],
        "textures": [{ "source": 0 }, { "source": 1 }, { "source": 2 }, { "source": 3 }],
        "materials": [
            {
                "alphaMode": "MASK",
                "normalTexture": { "index": 3 },
                "occlusionTexture": { "index": 1 },
                "emissiveTexture": { "index": 0 },
                "pbrMetallicRoughness": surface.clone(),
            },
            { "occlusionTexture": { "index": 2 }, "pbrMetallicRoughness": surface },
        ],
    })
}

fn bake_document(document: &Value, settings: &Settings) -> BakedAsset {
    let document = Document::parse(document.to_string().as_bytes()).unwrap();
    bake_asset(&Source::new("leaves", &document, &read), settings, &|_| {}).unwrap()
}

fn all() -> Settings {
    Settings::default().with_textures(Textures::All).with_gltf(Form::Strict)
}

/// Returns the contents of the textures, sorted.
fn contents(baked: &BakedAsset) -> Vec<&'static str> {
    let mut contents: Vec<_> = baked.report.textures.iter().map(|texture| texture.content.name()).collect();
    contents.sort_unstable();
    contents
}

fn index(document: &Value, pointer: &str) -> usize {
    document.pointer(pointer).unwrap()["index"].as_u64().unwrap() as usize
}

/// Returns the KTX2 file to which the `textureInfo` at `pointer` leads.
fn file<'b>(baked: &'b BakedAsset, pointer: &str) -> Ktx2<'b> {
    let document: Value = serde_json::from_slice(&baked.document).unwrap();
    let texture = &document["textures"][index(&document, pointer)];
    let image = texture["extensions"]["KHR_texture_basisu"]["source"].as_u64().unwrap() as usize;
    let uri = document["images"][image]["uri"].as_str().unwrap();
    let file = baked.files.iter().find(|file| file.path == Path::new(uri)).unwrap();
    Ktx2::parse(&file.bytes).unwrap()
}

const BASE_COLOUR: &str = "/materials/0/pbrMetallicRoughness/baseColorTexture";

#[test]
fn every_image_is_written_once_for_each_meaning() {
    let bumps = bake_document(&document(), &Settings::default().with_model(Model::Isotropic));
    assert_eq!(contents(&bumps), ["normal", "roughness"]);
    let baked = bake_document(&document(), &all().with_model(Model::Isotropic));
    // Colours with a mask, opaque colours for emissive and for the flat material, occlusion, and the flat surface.
    assert_eq!(contents(&baked), ["colour", "colour", "linear", "linear", "normal", "roughness"]);
    let document: Value = serde_json::from_slice(&baked.document).unwrap();
    assert!(document["textures"].as_array().unwrap().iter().all(|texture| texture.get("source").is_none()));
    let emissive = index(&document, "/materials/0/emissiveTexture");
    assert_eq!(emissive, index(&document, "/materials/1/pbrMetallicRoughness/baseColorTexture"));
    assert_ne!(emissive, index(&document, BASE_COLOUR));
    let surface = index(&document, "/materials/1/pbrMetallicRoughness/metallicRoughnessTexture");
    assert_eq!(surface, index(&document, "/materials/1/occlusionTexture"));
    assert!(baked.copies.is_empty(), "{:?}", baked.copies);
}

#[test]
fn colours_are_srgb_with_the_alpha_of_the_mask() {
    let baked = bake_document(&document(), &all());
    let colours = file(&baked, BASE_COLOUR);
    let basic = colours.descriptor().unwrap();
    assert_eq!(basic.transfer_function, Some(::ktx2::TransferFunction::SRGB));
    assert_eq!(basic.color_primaries, Some(::ktx2::ColorPrimaries::BT709));
    assert_eq!((basic.sample_information[0].channel_type, colours.level_count()), (3, 5));
    let record = provenance(&colours).unwrap();
    assert_eq!((record.content.as_str(), record.sources[0].uri.as_str()), ("colour", "leaf.png"));
    assert_eq!(record.settings["textures"], "all");
    let texels = |image: &Image| {
        let mut rows = vec![[0.0; 4]; (image.width * image.height) as usize];
        rows.chunks_mut(image.width as usize).zip(0..).for_each(|(row, y)| Rgba(image).row(y, row));
        rows
    };
    let level_0 = texels(&colours.decode_level(0).unwrap());
    let source = leaf();
    let error = level_0.iter().zip(source.pixels()).flat_map(|(found, wanted)| {
        found.iter().zip(wanted.0).map(|(found, wanted)| (255.0 * found - f32::from(wanted)).powi(2))
    });
    let rms = (error.sum::<f32>() / (4 * level_0.len()) as f32).sqrt();
    // Measured: 6.2. Red, blue and alpha change independently of each other.
    assert!(rms < 7.0, "{rms} levels");
    let share = |level: u32| {
        let texels = texels(&colours.decode_level(level).unwrap());
        texels.iter().filter(|texel| texel[3] >= 0.5).count() as f64 / texels.len() as f64
    };
    let passing = source.pixels().filter(|texel| texel.0[3] >= 128).count();
    let wanted = passing as f64 / level_0.len() as f64;
    // The levels have 480, 120 and 30 texels, and the encoding may move a few of them across the cutoff.
    for (level, tolerance) in [(0, 0.02), (1, 0.05), (2, 0.1)] {
        assert!((share(level) - wanted).abs() <= tolerance, "level {level}: {} of {wanted}", share(level));
    }
    let occlusion = file(&baked, "/materials/0/occlusionTexture");
    let basic = occlusion.descriptor().unwrap();
    assert_eq!((basic.transfer_function, basic.color_primaries), (Some(::ktx2::TransferFunction::Linear), None));
}

#[test]
fn textures_fit_the_largest_size_in_whole_blocks() {
    for (most, expected) in [(64, (24, 20)), (24, (24, 20)), (23, (12, 12)), (11, (8, 8)), (4, (4, 4))] {
        let baked = bake_document(&document(), &all().with_max_size(most).unwrap());
        for texture in &baked.report.textures {
            assert_eq!((texture.width, texture.height), expected, "{:?} within {most}", texture.content);
        }
    }
    assert!(Settings::default().with_max_size(3).is_err());
}

#[test]
fn fallbacks_have_the_alpha_of_their_texture() {
    let baked = bake_document(&document(), &all().with_gltf(Form::Fallback));
    let document: Value = serde_json::from_slice(&baked.document).unwrap();
    let source = document["textures"][index(&document, BASE_COLOUR)]["source"].as_u64().unwrap() as usize;
    let path = Path::new(document["images"][source]["uri"].as_str().unwrap());
    let png = &baked.files.iter().find(|file| file.path == path).unwrap().bytes;
    assert_eq!(image::load_from_memory(png).unwrap().to_rgba8(), leaf());
}

#[test]
fn ktx2_images_stay_and_documents_without_bumps_are_written() {
    let first = bake_document(&document(), &all());
    let image = file(&first, "/materials/1/pbrMetallicRoughness/baseColorTexture");
    assert_eq!(image.level_count(), 5);
    let uri = first.files.iter().find(|file| file.path.to_string_lossy().contains("leaf.colour.")).unwrap();
    let with_ktx2 = |path: &Path| if path == Path::new("done.ktx2") { Ok(uri.bytes.clone()) } else { read(path) };
    let flat = json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": ["KHR_texture_basisu"],
        "extensionsRequired": ["KHR_texture_basisu"],
        "images": [{ "uri": "done.ktx2" }, { "uri": "surface.png" }],
        "textures": [{ "extensions": { "KHR_texture_basisu": { "source": 0 } } }, { "source": 1 }],
        "materials": [{
            "pbrMetallicRoughness": {
                "baseColorTexture": { "index": 0 }, "metallicRoughnessTexture": { "index": 1 },
            },
        }],
    });
    let document = Document::parse(flat.to_string().as_bytes()).unwrap();
    let bake =
        |settings: &Settings| bake_asset(&Source::new("flat", &document, &with_ktx2), settings, &|_| {}).unwrap();
    let kept = bake(&Settings::default());
    assert_eq!((kept.document.as_slice(), kept.files.len()), (flat.to_string().as_bytes(), 0));
    let baked = bake(&all());
    assert_eq!(contents(&baked), ["linear"]);
    assert_eq!(baked.copies, [Path::new("done.ktx2")]);
    let planned = planned_files(&document).unwrap();
    let writes = |textures| planned.may_write_textures(Profile::Portable, textures);
    assert!(writes(Textures::All) && !writes(Textures::Bumps));
}

#[test]
fn other_payloads_are_refused() {
    let target = crate::codec::Target::Float;
    let refused = all().with_target(target).validate();
    assert_eq!(refused, Err(SettingsError::ColoursWithoutBasis { target }));
}

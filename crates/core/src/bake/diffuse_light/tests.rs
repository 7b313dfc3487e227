use std::io::{self, Cursor};
use std::path::Path;

use image::{ImageFormat, RgbImage};
use serde_json::{Value, json};

use super::*;
use crate::bake::{BakedAsset, Source, bake_asset};
use crate::gltf::document::Document;
use crate::image::{Rgba, srgb_to_linear};
use crate::ktx2::{Ktx2, provenance};
use crate::mip::TexelRows;
use crate::note::NoteKind;
use crate::report::Content;
use crate::settings::{Form, SettingsError, Textures};

const SIDE: u32 = 32;

fn png(texel: impl Fn(u32, u32) -> [u8; 3]) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let image = RgbImage::from_fn(SIDE, SIDE, |x, y| image::Rgb(texel(x, y)));
    image.write_to(&mut file, ImageFormat::Png).unwrap();
    file.into_inner()
}

fn read(path: &Path) -> io::Result<Vec<u8>> {
    match path.to_str() {
        Some("colour.png") => Ok(png(|x, y| [(180 + 2 * x) as u8, (120 + y) as u8, 90])),
        // x is 0.6 or -0.6, and z is 0.8: the mean normal has the length 0.8.
        Some("normal.png") => Ok(png(|x, _| [if x % 2 == 0 { 204 } else { 51 }, 128, 230])),
        // Rust in the left half, metal in the right.
        Some("surface.png") => Ok(png(|x, _| [255, 128, if x < SIDE / 2 { 0 } else { 255 }])),
        Some("colour.ktx2") => {
            let mut document = document(&[json!({ "emissiveTexture": { "index": 0 } })]);
            // Baking it must not read this file.
            document["images"].as_array_mut().unwrap().truncate(3);
            document["textures"].as_array_mut().unwrap().truncate(3);
            let baked = bake(&document, &suns());
            let file = baked.files.into_iter().find(|file| file.path.extension() == Some("ktx2".as_ref()));
            Ok(file.unwrap().bytes)
        }
        _ => Err(io::ErrorKind::NotFound.into()),
    }
}

fn document(materials: &[Value]) -> Value {
    json!({
        "asset": { "version": "2.0" },
        "images": [
            { "uri": "colour.png" }, { "uri": "normal.png" }, { "uri": "surface.png" }, { "uri": "colour.ktx2" },
        ],
        "textures": [
            { "source": 0 }, { "source": 1 }, { "source": 2 },
            { "extensions": { "KHR_texture_basisu": { "source": 3 } } },
        ],
        "materials": materials,
    })
}

fn material(surface: &Value) -> Value {
    json!({ "normalTexture": { "index": 1 }, "pbrMetallicRoughness": surface })
}

fn dielectric() -> Value {
    json!({ "baseColorTexture": { "index": 0 }, "metallicFactor": 0 })
}

fn suns() -> Settings {
    Settings::default().with_textures(Textures::All).with_diffuse_light(Light::Suns).with_gltf(Form::Strict)
}

fn bake(document: &Value, settings: &Settings) -> BakedAsset {
    let document = Document::parse(document.to_string().as_bytes()).unwrap();
    bake_asset(&Source::new("asset", &document, &read), settings, &|_| {}).unwrap()
}

/// Returns the texture that the reference at `pointer` leads to, and its file.
fn texture<'b>(baked: &'b BakedAsset, pointer: &str) -> (&'b crate::report::TextureReport, Ktx2<'b>) {
    let document: Value = serde_json::from_slice(&baked.document).unwrap();
    let index = |value: &Value| usize::try_from(value.as_u64().unwrap()).unwrap();
    let texture = &document["textures"][index(&document.pointer(pointer).unwrap()["index"])];
    let image = index(&texture["extensions"]["KHR_texture_basisu"]["source"]);
    let uri = document["images"][image]["uri"].as_str().unwrap();
    let report = baked.report.textures.iter().find(|texture| texture.path == uri).unwrap();
    let file = baked.files.iter().find(|file| file.path == Path::new(uri)).unwrap();
    (report, Ktx2::parse(&file.bytes).unwrap())
}

fn base_colour(material: usize) -> String {
    format!("/materials/{material}/pbrMetallicRoughness/baseColorTexture")
}

/// Returns the linear texels of a level.
fn texels(file: &Ktx2<'_>, level: u32) -> Vec<[f64; 3]> {
    let image = file.decode_level(level).unwrap();
    let mut rows = vec![[0.0; 4]; (image.width * image.height) as usize];
    rows.chunks_mut(image.width as usize).zip(0..).for_each(|(row, y)| Rgba(&image).row(y, row));
    rows.iter().map(|[red, green, blue, _]| [*red, *green, *blue].map(|c| srgb_to_linear(f64::from(c)))).collect()
}

/// Returns the light of `darkened` by that of `plain` over the columns from `first` to `end` of `level`.
fn ratio(darkened: &Ktx2<'_>, plain: &Ktx2<'_>, level: u32, columns: std::ops::Range<usize>) -> f64 {
    let width = (SIDE >> level) as usize;
    let sum = |file| -> f64 {
        let texels = texels(file, level);
        texels.chunks(width).flat_map(|row| &row[columns.clone()]).flatten().sum()
    };
    sum(darkened) / sum(plain)
}

#[test]
fn suns_darken_dielectrics_by_the_mean_normal_from_level_1_on() {
    let flat = json!({ "pbrMetallicRoughness": dielectric() });
    let baked = bake(&document(&[material(&dielectric()), flat]), &suns());
    let (report, darkened) = texture(&baked, &base_colour(0));
    let (plain_report, plain) = texture(&baked, &base_colour(1));
    assert_eq!((report.content, report.diffuse_light), (Content::Colour, Some(Light::Suns)));
    assert_eq!((plain_report.content, plain_report.diffuse_light), (Content::Colour, None));
    assert_eq!(texels(&darkened, 0), texels(&plain, 0));
    for level in 1..5 {
        let found = ratio(&darkened, &plain, level, 0..(SIDE >> level) as usize);
        assert!((found - 0.8).abs() < 0.01, "level {level}: {found}");
    }
    let record = provenance(&darkened).unwrap();
    let sources: Vec<&str> = record.sources.iter().map(|source| source.uri.as_str()).collect();
    assert_eq!((record.settings["diffuseLight"].as_str(), sources), (Some("suns"), vec!["colour.png", "normal.png"]));
}

#[test]
fn metal_beside_a_dielectric_keeps_its_colour() {
    let surface = json!({ "baseColorTexture": { "index": 0 }, "metallicRoughnessTexture": { "index": 2 } });
    let flat = json!({ "pbrMetallicRoughness": dielectric() });
    let baked = bake(&document(&[material(&surface), flat]), &suns());
    let (darkened, plain) = (texture(&baked, &base_colour(0)).1, texture(&baked, &base_colour(1)).1);
    // A block of level 3 has both halves.
    for level in 1..3 {
        let half = (SIDE >> level) as usize / 2;
        let (rust, metal) = (ratio(&darkened, &plain, level, 0..half), ratio(&darkened, &plain, level, half..2 * half));
        assert!((rust - 0.8).abs() < 0.01 && (metal - 1.0).abs() < 0.01, "level {level}: {rust}, {metal}");
    }
    let sources = provenance(&darkened).unwrap().sources;
    assert_eq!(sources.iter().map(|s| s.uri.as_str()).collect::<Vec<_>>(), ["colour.png", "normal.png", "surface.png"]);
}

#[test]
fn materials_share_a_base_colour_only_with_the_same_bumps_and_metalness() {
    let mut emissive = material(&dielectric());
    emissive["emissiveTexture"] = json!({ "index": 0 });
    let mut steeper = material(&dielectric());
    steeper["normalTexture"]["scale"] = json!(2.0);
    let metal = material(&json!({ "baseColorTexture": { "index": 0 } }));
    let baked = bake(&document(&[material(&dielectric()), emissive, steeper, metal]), &suns());
    let path = |pointer: &str| texture(&baked, pointer).0.path.clone();
    let first = path(&base_colour(0));
    assert_eq!(first, path(&base_colour(1)));
    assert!([&base_colour(2), &base_colour(3), "/materials/1/emissiveTexture"].iter().all(|p| path(p) != first));
    assert_eq!(texture(&baked, "/materials/1/emissiveTexture").0.diffuse_light, None);
}

#[test]
fn light_from_all_around_changes_nothing() {
    let document = document(&[material(&dielectric())]);
    let plain = bake(&document, &Settings::default().with_textures(Textures::All).with_gltf(Form::Strict));
    let (report, file) = texture(&plain, &base_colour(0));
    assert_eq!((report.diffuse_light, provenance(&file).unwrap().settings.get("diffuseLight")), (None, None));
    assert_eq!(provenance(&file).unwrap().sources.len(), 1);
}

/// Bakes a material for suns, and returns its notes on the base colour and whether its base colour was darkened.
fn unchanged(material: Value) -> (Vec<Note>, bool) {
    let baked = bake(&document(&[material]), &suns());
    let is_darkened = baked.report.textures.iter().any(|texture| texture.diffuse_light.is_some());
    let notes = baked.report.layers.into_iter().flat_map(|layer| layer.notes);
    (notes.filter(|note| note.kind == NoteKind::BaseColourUnchanged).collect(), is_darkened)
}

#[test]
fn a_note_says_why_a_base_colour_stays_as_it_is() {
    let with = |change: &dyn Fn(&mut Value)| {
        let mut material = material(&dielectric());
        change(&mut material);
        material
    };
    let pbr = "pbrMetallicRoughness";
    let surface_on_other_coordinates = json!({ "index": 2, "texCoord": 1 });
    let cases = [
        (with(&|m| m[pbr]["baseColorTexture"]["index"] = json!(3)), KeptColour::Ktx2),
        (with(&|m| m[pbr]["baseColorTexture"]["texCoord"] = json!(1)), KeptColour::OtherTexels),
        (
            with(&|m| m[pbr]["metallicRoughnessTexture"] = surface_on_other_coordinates.clone()),
            KeptColour::UnknownMetalness,
        ),
        (with(&|m| m[pbr] = json!({ "baseColorFactor": [0.5, 0.5, 0.5, 1.0] })), KeptColour::NoTexture),
        (with(&|m| m["extensions"] = json!({ "KHR_materials_unlit": {} })), KeptColour::Unlit),
        (
            with(&|m| m["extensions"] = json!({ "KHR_materials_pbrSpecularGlossiness": {} })),
            KeptColour::SpecularGlossiness,
        ),
    ];
    for (material, reason) in cases {
        assert_eq!(unchanged(material), (vec![note::base_colour_unchanged(reason)], false), "{reason:?}");
    }
    assert_eq!(unchanged(material(&dielectric())), (Vec::new(), true));
}

#[test]
fn suns_without_written_colours_are_refused() {
    assert_eq!(Settings::default().with_diffuse_light(Light::Suns).validate(), Err(SettingsError::SunsWithoutColours));
    assert_eq!(suns().validate(), Ok(()));
}

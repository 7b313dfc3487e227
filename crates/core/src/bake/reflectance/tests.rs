use std::collections::BTreeSet;
use std::io::{self, Cursor};
use std::path::Path;
use std::sync::Mutex;

use image::{ImageFormat, RgbImage, RgbaImage};
use serde_json::{Value, json};

use crate::bake::{BakedAsset, Source, bake_asset};
use crate::gltf::document::Document;
use crate::ktx2::{Ktx2, provenance};
use crate::note::{Note, NoteKind};
use crate::settings::{Model, Settings};

const SIDE: u32 = 32;

fn encoded(image: impl Into<image::DynamicImage>) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    image.into().write_to(&mut file, ImageFormat::Png).unwrap();
    file.into_inner()
}

/// Returns the PNG whose texel (x, y) has the channels that `texel` returns.
fn png(texel: impl Fn(u32, u32) -> [u8; 3]) -> Vec<u8> {
    encoded(RgbImage::from_fn(SIDE, SIDE, |x, y| image::Rgb(texel(x, y))))
}

/// The material of a test, and the files that its document names.
struct Asset {
    material: Value,
    /// Metalness of every second square of texels; elsewhere it is 0.
    metalness: u8,
    /// The file of the base colour; none if it is missing.
    colour: Option<Vec<u8>>,
}

impl Asset {
    /// Returns rust beside steel.
    fn new() -> Self {
        let colour = png(|x, y| if (x / 2 + y / 2) % 2 == 0 { [200; 3] } else { [90, 40, 20] });
        let material = json!({
            "normalTexture": { "index": 0 },
            "pbrMetallicRoughness": { "metallicRoughnessTexture": { "index": 1 }, "baseColorTexture": { "index": 2 } }
        });
        Self { material, metalness: 255, colour: Some(colour) }
    }

    /// Bakes the asset. Returns it with the names of the files that were read.
    fn bake(&self) -> (BakedAsset, BTreeSet<String>) {
        let names = ["normal.png", "orm.png", "colour.png", "specular.png"];
        let (images, textures) =
            (names.map(|name| json!({ "uri": name })), [0, 1, 2, 3].map(|i| json!({ "source": i })));
        let root = json!({
            "asset": { "version": "2.0" },
            "images": images,
            "textures": textures,
            "materials": [self.material],
        });
        let document = Document::parse(root.to_string().as_bytes()).unwrap();
        let is_metal = |x: u32, y: u32| (x / 2 + y / 2).is_multiple_of(2);
        let metalness = self.metalness;
        let read = Mutex::new(BTreeSet::new());
        let files = |path: &Path| -> io::Result<Vec<u8>> {
            let name = path.to_str().unwrap().to_owned();
            let bytes = match name.as_str() {
                "normal.png" => png(|x, y| [100 + 40 * (x % 2) as u8, 110 + 30 * (y % 2) as u8, 230]),
                "orm.png" => png(|x, y| if is_metal(x, y) { [9, 60, metalness] } else { [200, 220, 0] }),
                "colour.png" => self.colour.clone().ok_or(io::ErrorKind::NotFound)?,
                _ => encoded(RgbaImage::from_fn(SIDE, SIDE, |x, _| image::Rgba([255, 255, 255, 8 * x as u8]))),
            };
            read.lock().unwrap().insert(name);
            Ok(bytes)
        };
        let source = Source::new("a", &document, &files);
        let settings = Settings { model: Model::Isotropic, provenance: false, ..Settings::default() };
        let baked = bake_asset(&source, &settings, &|_| ()).unwrap();
        (baked, read.into_inner().unwrap())
    }

    fn reads(&self, name: &str) -> bool {
        self.bake().1.contains(name)
    }
}

/// Returns the bytes of the roughness texture.
fn roughness(baked: &BakedAsset) -> &[u8] {
    let texture = baked.files.iter().find(|file| file.path.to_str().unwrap().contains("roughness.ktx2"));
    &texture.expect("a roughness texture").bytes
}

fn notes(baked: &BakedAsset) -> Vec<&Note> {
    let notes = baked.report.layers.iter().flat_map(|layer| &layer.notes);
    notes.filter(|note| note.kind == NoteKind::UnknownReflectance).collect()
}

#[test]
fn metal_beside_a_dielectric_changes_the_roughness() {
    let (with, read) = Asset::new().bake();
    assert!(read.contains("colour.png") && notes(&with).is_empty());
    let dark = Asset { colour: Some(png(|_, _| [0; 3])), ..Asset::new() };
    assert!(roughness(&with) != roughness(&dark.bake().0));
}

#[test]
fn a_base_colour_that_cannot_be_read_is_a_note() {
    let mut truncated = Asset::new();
    truncated.colour.as_mut().unwrap().truncate(60);
    let missing = Asset { colour: None, ..Asset::new() };
    let mut wrong_index = Asset::new();
    wrong_index.material["pbrMetallicRoughness"]["baseColorTexture"]["index"] = json!(99);
    let mut wrong_factor = Asset::new();
    wrong_factor.material["pbrMetallicRoughness"]["baseColorFactor"] = json!("red");
    let mut wrong_extension = Asset::new();
    wrong_extension.material["extensions"] = json!({ "KHR_materials_specular": { "specularFactor": 1e300 } });
    let mut dielectric = Asset::new();
    dielectric.material["pbrMetallicRoughness"]["metallicFactor"] = json!(0);
    let (dielectric, _) = dielectric.bake();
    for asset in [truncated, missing, wrong_index, wrong_factor, wrong_extension] {
        let (baked, _) = asset.bake();
        let found = notes(&baked);
        assert_eq!(found.len(), 1, "{}", asset.material);
        assert!(found[0].asks_for_action && found[0].text.contains("counts by its area alone"), "{}", found[0]);
        assert!(roughness(&baked) == roughness(&dielectric), "{}: the reflectance is not constant", asset.material);
    }
}

#[test]
fn base_colour_is_read_where_metalness_is_above_0_only() {
    assert!(Asset::new().reads("colour.png"));
    assert!(!Asset { metalness: 0, ..Asset::new() }.reads("colour.png"));
    // Noise of compression.
    assert!(!Asset { metalness: 7, ..Asset::new() }.reads("colour.png"));
    let mut dielectric = Asset::new();
    dielectric.material["pbrMetallicRoughness"]["metallicFactor"] = json!(0);
    assert!(!dielectric.reads("colour.png"));
    let mut constant = Asset::new();
    constant.material["pbrMetallicRoughness"] = json!({ "baseColorTexture": { "index": 2 } });
    assert!(constant.reads("colour.png"), "the metal's base colour varies");
}

#[test]
fn specular_textures_are_read_where_there_are_dielectrics() {
    let mut asset = Asset { metalness: 0, ..Asset::new() };
    asset.material["extensions"] = json!({ "KHR_materials_specular": { "specularTexture": { "index": 3 } } });
    assert!(asset.reads("specular.png") && !asset.reads("colour.png"));
    assert!(roughness(&asset.bake().0) != roughness(&Asset { metalness: 0, ..Asset::new() }.bake().0));
    asset.material["pbrMetallicRoughness"] = json!({});
    assert!(!asset.reads("specular.png"), "all texels are metal");
}

#[test]
fn textures_with_other_coordinates_do_not_count() {
    for other in [
        json!({ "index": 2, "texCoord": 1 }),
        json!({ "index": 2, "extensions": { "KHR_texture_transform": { "scale": [2, 2] } } }),
    ] {
        let mut asset = Asset::new();
        asset.material["pbrMetallicRoughness"]["baseColorTexture"] = other;
        assert!(!asset.reads("colour.png"));
        let (white, _) = Asset { colour: Some(png(|_, _| [255; 3])), ..Asset::new() }.bake();
        assert!(roughness(&asset.bake().0) == roughness(&white), "the factor counts alone");
    }
}

#[test]
fn the_roughness_texture_records_the_base_colour() {
    let asset = Asset::new();
    let document = json!({
        "asset": { "version": "2.0" },
        "images": [{ "uri": "normal.png" }, { "uri": "orm.png" }, { "uri": "colour.png" }],
        "textures": [{ "source": 0 }, { "source": 1 }, { "source": 2 }],
        "materials": [asset.material],
    });
    let document = Document::parse(document.to_string().as_bytes()).unwrap();
    let files = |path: &Path| -> io::Result<Vec<u8>> {
        Ok(match path.to_str().unwrap() {
            "normal.png" => png(|x, _| [100 + 40 * (x % 2) as u8, 110, 230]),
            "orm.png" => png(|x, _| [9, 60, 255 * (x % 2) as u8]),
            _ => asset.colour.clone().unwrap(),
        })
    };
    let settings = Settings { model: Model::Isotropic, ..Settings::default() };
    let baked = bake_asset(&Source::new("a", &document, &files), &settings, &|_| ()).unwrap();
    let provenance = provenance(&Ktx2::parse(roughness(&baked)).unwrap()).unwrap();
    let uris: Vec<&str> = provenance.sources.iter().map(|source| source.uri.as_str()).collect();
    assert_eq!(uris, ["normal.png", "orm.png", "colour.png"]);
}

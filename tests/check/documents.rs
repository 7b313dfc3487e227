//! Tests with one damaged bake for each finding about documents, the extension and provenance.

use std::fs;

use base64::Engine;
use roughcast::check::{Code, Severity};
use roughcast::cli::Outcome;
use roughcast::gltf::document::Document;
use roughcast::gltf::json::Json;
use roughcast::gltf::roughness_pyramid::EXTENSION;
use roughcast::ktx2::Ktx2;
use serde_json::{Value, json};

use crate::fixture::{Bake, bake, findings, roughcast, write_asset};

const PYRAMID: &str = "/materials/0/extensions/ROUGHCAST_materials_roughness_pyramid";

const LEVEL_1: &str = "/materials/0/extensions/ROUGHCAST_materials_roughness_pyramid, level 1";

struct Fixture {
    code: Code,
    options: &'static [&'static str],
    damage: fn(&Bake),
    file: &'static str,
    place: &'static str,
    with_source: bool,
    is_deep: bool,
}

const fn fixture(code: Code, options: &'static [&'static str], place: &'static str, damage: fn(&Bake)) -> Fixture {
    Fixture { code, options, damage, file: "ridges.gltf", place, with_source: false, is_deep: false }
}

const fn with_source(code: Code, file: &'static str, place: &'static str, damage: fn(&Bake)) -> Fixture {
    Fixture { code, options: &[], damage, file, place, with_source: true, is_deep: false }
}

fn remove(value: &mut Value, key: &str) {
    value.as_object_mut().unwrap().remove(key);
}

fn scale_roughness(document: &mut Value, factor: f64) {
    for member in ["roughnessMin", "roughnessMax"] {
        let range = document.pointer_mut(PYRAMID).unwrap()[member].as_array_mut().unwrap();
        range.iter_mut().for_each(|value| *value = json!(value.as_f64().unwrap() * factor));
    }
}

/// Returns the index of the normal texture.
fn normal_texture(document: &Value) -> usize {
    document["materials"][0]["normalTexture"]["index"].as_u64().unwrap() as usize
}

const FIXTURES: &[Fixture] = &[
    fixture(Code::UnreadableDocument, &[], "", |b| fs::write(b.document(), "{\"asset\": ").unwrap()),
    fixture(Code::UnreadableDocument, &[], "", |b| b.edit(|d| d["images"] = json!(3))),
    fixture(Code::MissingFile, &[], "/images/0", |b| fs::remove_file(b.texture("bumps.normal.ktx2")).unwrap()),
    fixture(Code::MissingFile, &[], "/buffers/0", |b| fs::remove_file(b.baked.join("mesh.bin")).unwrap()),
    fixture(Code::BadReference, &[], "/textures/0/source", |b| b.edit(|d| d["textures"][0]["source"] = json!(99))),
    fixture(Code::BadReference, &[], "/materials/0/normalTexture/index", |b| {
        b.edit(|d| d["materials"][0]["normalTexture"]["index"] = json!(99));
    }),
    fixture(Code::BadReference, &[], "/images/0", |b| b.edit(|d| d["images"][0]["uri"] = json!("../up.png"))),
    fixture(Code::BadReference, &[], "/buffers/0", |b| fs::write(b.baked.join("mesh.bin"), [0; 95]).unwrap()),
    fixture(Code::NoImage, &[], "/textures/0", |b| b.edit(|d| d["textures"][0] = json!({}))),
    fixture(Code::DualSource, &["--gltf", "dual"], "/textures/0/source", |_| {}),
    fixture(Code::KtxMimeType, &["--gltf", "dual"], "/textures/0/source", |b| {
        b.edit(|d| {
            let image = d["textures"][0]["source"].as_u64().unwrap() as usize;
            d["images"][image]["mimeType"] = json!("image/ktx2");
        });
    }),
    fixture(Code::SourceFormat, &["--gltf", "dual"], "/textures/0/source", |b| {
        b.edit(|d| remove(&mut d["textures"][0], "extensions"));
    }),
    fixture(Code::NotDeclared, &[], "/extensionsUsed", |b| b.edit(|d| remove(d, "extensionsUsed"))),
    fixture(Code::NeedlesslyRequired, &["--gltf", "fallback"], "/extensionsRequired", |b| {
        b.edit(|d| d["extensionsRequired"] = json!(["KHR_texture_basisu"]));
    }),
    fixture(Code::NotRequired, &["--gltf", "strict"], "/textures/0", |b| b.edit(|d| remove(d, "extensionsRequired"))),
    fixture(Code::VendorRequired, &["--profile", "pyramid"], "/extensionsRequired", |b| {
        b.edit(|d| d["extensionsRequired"] = json!([EXTENSION]));
    }),
    fixture(Code::NoTangentSpace, &["--model", "anisotropic"], "/meshes/0/primitives/0", |b| {
        b.edit(|d| remove(&mut d["materials"][0], "normalTexture"));
    }),
    fixture(Code::ExtensionSchema, &["--profile", "pyramid"], PYRAMID, |b| {
        b.edit(|d| remove(d.pointer_mut(PYRAMID).unwrap(), "frame"));
    }),
    fixture(
        Code::ExtensionTexture,
        &["--profile", "pyramid"],
        "/materials/0/extensions/ROUGHCAST_materials_roughness_pyramid/offsetTexture",
        |b| {
            b.edit(|d| {
                let texture = d.pointer(PYRAMID).unwrap()["offsetTexture"]["index"].as_u64().unwrap() as usize;
                remove(&mut d["textures"][texture], "extensions");
            });
        },
    ),
    fixture(
        Code::ExtensionContent,
        &["--profile", "both"],
        "/materials/0/extensions/ROUGHCAST_materials_roughness_pyramid/offsetTexture",
        |b| {
            b.edit(|d| {
                let normals = normal_texture(d);
                d.pointer_mut(PYRAMID).unwrap()["offsetTexture"]["index"] = json!(normals);
            });
        },
    ),
    // The roughness texture has much more than the lost roughness.
    Fixture {
        is_deep: true,
        ..fixture(Code::PyramidLevel, &["--profile", "pyramid", "--model", "anisotropic"], LEVEL_1, |b| {
            b.edit(|d| scale_roughness(d, 6.0));
        })
    },
    Fixture {
        is_deep: true,
        ..fixture(Code::PyramidLevel, &["--profile", "pyramid", "--model", "isotropic"], LEVEL_1, |b| {
            b.edit(|d| scale_roughness(d, 12.0));
        })
    },
    // The lobes of level 1 are turned along v, where the bumps of level 0 are low.
    Fixture {
        is_deep: true,
        ..fixture(
            Code::PyramidLevel,
            &["--profile", "pyramid", "--model", "none", "--target", "float", "--gltf", "strict"],
            LEVEL_1,
            |b| {
                let texture = b.texture("bumps.offset.ktx2");
                let mut bytes = fs::read(&texture).unwrap();
                let level = Ktx2::parse(&bytes).unwrap().levels()[1];
                // The half floats 0.5, 0.8, 0.9 and 1: the unit normal (0, 0.6, 0.8).
                let texel = [0x00, 0x38, 0x66, 0x3A, 0x33, 0x3B, 0x00, 0x3C];
                let level = &mut bytes[level.offset as usize..][..level.length as usize];
                level.iter_mut().zip(texel.into_iter().cycle()).for_each(|(byte, new)| *byte = new);
                fs::write(texture, bytes).unwrap();
            },
        )
    },
    Fixture {
        file: "old.normal.ktx2",
        ..fixture(Code::LeftOver, &[], "", |b| {
            fs::copy(b.texture("bumps.normal.ktx2"), b.texture("old.normal.ktx2")).unwrap();
        })
    },
    with_source(Code::MissingSource, "ridges.gltf", "", |b| fs::remove_file(b.source.join("ridges.gltf")).unwrap()),
    with_source(Code::MissingSource, "bumps.normal.ktx2", "key roughcast", |b| {
        fs::remove_file(b.source.join("bumps.png")).unwrap();
    }),
    with_source(Code::Stale, "bumps.normal.ktx2", "key roughcast", |b| {
        fs::copy(b.source.join("surface.png"), b.source.join("bumps.png")).map(drop).unwrap();
    }),
    with_source(Code::Stale, "ridges.gltf", "", |b| edit_source(b, |text| text.replace("Ridges", "Grooves"))),
    with_source(Code::Stale, "ridges.gltf", "/asset/extras/roughcast", |b| {
        fs::write(b.source.join("mesh.bin"), [1; 96]).unwrap();
    }),
    with_source(Code::MissingSource, "ridges.gltf", "/asset/extras/roughcast", |b| {
        fs::remove_file(b.source.join("mesh.bin")).unwrap();
    }),
    with_source(Code::Untraceable, "ridges.gltf", "/asset/extras/roughcast", |b| {
        b.edit(|document| document["asset"]["extras"] = json!({ "roughcast": 1 }));
    }),
    with_source(Code::OtherSettings, "bumps.normal.ktx2", "key roughcast", |b| {
        fs::write(b.source.join("roughcast.toml"), "quality = 'best'").unwrap();
    }),
    with_source(Code::OtherSettings, "ridges.gltf", "", |b| {
        fs::write(b.source.join("roughcast.toml"), "glb = true").unwrap();
    }),
    // A source in the place of its output.
    with_source(Code::NothingBaked, "ridges.gltf", "", |b| {
        fs::remove_dir_all(b.texture("")).unwrap();
        for file in ["ridges.gltf", "bumps.png", "surface.png"] {
            fs::copy(b.source.join(file), b.baked.join(file)).unwrap();
        }
    }),
    with_source(Code::NoOutput, "later.gltf", "", |b| {
        fs::copy(b.source.join("ridges.gltf"), b.source.join("later.gltf")).map(drop).unwrap();
    }),
    Fixture {
        options: &["--no-provenance"],
        ..with_source(Code::Untraceable, "bumps.normal.ktx2", "key roughcast", |_| {})
    },
];

fn edit_source(bake: &Bake, edit: impl Fn(&str) -> String) {
    let path = bake.source.join("ridges.gltf");
    fs::write(&path, edit(&fs::read_to_string(&path).unwrap())).unwrap();
}

/// Returns the codes that have a fixture here.
pub fn codes() -> Vec<Code> {
    FIXTURES.iter().map(|f| f.code).collect()
}

#[test]
fn finds_each_damage_at_its_place() {
    for fixture in FIXTURES {
        let bake = bake(fixture.options);
        (fixture.damage)(&bake);
        let deep: &[&str] = if fixture.is_deep { &["--deep"] } else { &[] };
        let (outcome, report) = if fixture.with_source { bake.check_source(deep) } else { bake.check(deep) };
        let expected = (fixture.code.to_string(), fixture.file.to_owned(), fixture.place.to_owned());
        assert!(findings(&report).contains(&expected), "{expected:?}: {report:#}");
        let is_note = fixture.code.severity() == Severity::Note;
        assert_eq!(outcome, if is_note { Outcome::Done } else { Outcome::Findings }, "{expected:?}");
    }
}

/// Only the textures that were made from a changed source are stale.
#[test]
fn reports_staleness_of_the_right_textures() {
    let bake = bake(&[]);
    fs::copy(bake.source.join("bumps.png"), bake.source.join("surface.png")).unwrap();
    let (_, report) = bake.check_source(&[]);
    let stale: Vec<String> = findings(&report).into_iter().filter(|f| f.0 == "RC1505").map(|f| f.1).collect();
    assert!(!stale.is_empty() && stale.iter().all(|file| file.starts_with("surface.")), "{report}");
}

/// A bake copies an asset without bumps byte for byte, so any difference is a finding.
#[test]
fn compares_documents_without_bumps_byte_for_byte() {
    let bake = bake(&[]);
    edit_source(&bake, |text| text.replace("normalTexture", "occlusionTexture"));
    let paths = [bake.source.to_str().unwrap(), bake.baked.to_str().unwrap()];
    assert_eq!(roughcast(&["bake", paths[0], "-o", paths[1], "-q"]).0, Outcome::Done);
    assert!(!bake.texture("").exists(), "textures of the earlier bake are left");
    assert_eq!(findings(&bake.check_source(&[]).1), []);
    edit_source(&bake, |text| text.replace("Ridges", "Grooves"));
    let stale = ("RC1505".to_owned(), "ridges.gltf".to_owned(), String::new());
    assert_eq!(findings(&bake.check_source(&[]).1), [stale]);
}

/// Gives the source another material.
fn set_material(bake: &Bake, material: Value) {
    edit_source(bake, |text| {
        let mut document: Value = serde_json::from_str(text).unwrap();
        document["extensionsUsed"] = json!(["KHR_materials_clearcoat"]);
        document["materials"][0] = material.clone();
        document.to_string()
    });
}

/// The pyramid profile does not describe clearcoats, so that such an asset is copied.
#[test]
fn notes_a_clearcoat_that_is_not_baked() {
    let bake = bake(&[]);
    let coat = json!({ "clearcoatFactor": 1, "clearcoatNormalTexture": { "index": 0 } });
    set_material(&bake, json!({ "extensions": { "KHR_materials_clearcoat": coat } }));
    let paths = [bake.source.to_str().unwrap(), bake.baked.to_str().unwrap()];
    let (outcome, _, err) = roughcast(&["bake", paths[0], "-o", paths[1], "-q", "--profile", "pyramid"]);
    assert_eq!(outcome, Outcome::Done, "{err}");
    assert_eq!(fs::read(bake.document()).unwrap(), fs::read(bake.source.join("ridges.gltf")).unwrap());
    let nothing_baked = ("RC1512".to_owned(), "ridges.gltf".to_owned(), String::new());
    assert_eq!(findings(&bake.check_source(&[]).1), [nothing_baked]);
}

#[test]
fn notes_heights_that_are_not_baked() {
    let bake = bake(&[]);
    set_material(&bake, json!({ "extras": { "roughcast": { "heightTexture": { "index": 0 } } } }));
    let (outcome, out, err) = roughcast(&["check", bake.source.to_str().unwrap(), "--format", "json"]);
    assert_eq!(outcome, Outcome::Done, "{err}");
    let codes: Vec<String> = findings(&serde_json::from_str(&out).unwrap()).into_iter().map(|f| f.0).collect();
    assert_eq!(codes, ["RC1512"]);
}

/// Members of `extras` from other tools stay. If `extras` is no object, no provenance of the document is recorded.
#[test]
fn keeps_extras_of_other_tools() {
    for (extras, is_recorded) in [(json!({ "author": "me" }), true), (json!("mine"), false)] {
        let bake = bake(&[]);
        edit_source(&bake, |text| {
            let mut document: Value = serde_json::from_str(text).unwrap();
            document["asset"]["extras"] = extras.clone();
            document.to_string()
        });
        let paths = [bake.source.to_str().unwrap(), bake.baked.to_str().unwrap()];
        assert_eq!(roughcast(&["bake", paths[0], "-o", paths[1], "-q"]).0, Outcome::Done);
        let document: Value = serde_json::from_slice(&fs::read(bake.document()).unwrap()).unwrap();
        let found = &document["asset"]["extras"];
        if is_recorded {
            assert_eq!(found["author"], "me");
            assert_eq!(found["roughcast"]["files"][0]["uri"], "mesh.bin");
        } else {
            assert_eq!(*found, extras);
        }
        let codes: Vec<String> = findings(&bake.check_source(&[]).1).into_iter().map(|f| f.0).collect();
        assert_eq!(codes.is_empty(), is_recorded, "{codes:?}");
    }
}

/// The place of a texture inside a .glb is its image.
#[test]
fn names_embedded_textures_by_their_image() {
    let bake = bake(&["--glb", "--no-provenance"]);
    let (_, report) = bake.check_source(&[]);
    let places: Vec<_> = findings(&report).into_iter().filter(|f| f.0 == "RC1506").map(|f| (f.1, f.2)).collect();
    assert!(places.contains(&("ridges.glb".to_owned(), "/images/0, key roughcast".to_owned())), "{report}");
}

/// Sources may be buffer views of a .glb, or data URIs.
#[test]
fn compares_embedded_sources() {
    let folder = tempfile::tempdir().unwrap();
    let (source, baked) = (folder.path().join("source"), folder.path().join("baked"));
    write_asset(&source);
    let read = |name: &str| fs::read(source.join(name)).unwrap();
    let text = read("ridges.gltf");
    let embedded = |bumps: &str, surface: &str| {
        let mut document = Document::glb(Json::parse(&text).unwrap(), Some(read("mesh.bin")));
        document.json_mut().remove("/buffers/0/uri").unwrap();
        let (offset, length) = document.append_bin(&read(bumps)).unwrap();
        let json = document.json_mut();
        json.push("/bufferViews", &json!({ "buffer": 0, "byteOffset": offset, "byteLength": length })).unwrap();
        json.set("/images/0", &json!({ "bufferView": 1, "mimeType": "image/png" })).unwrap();
        let data = base64::engine::general_purpose::STANDARD.encode(read(surface));
        json.set("/images/1/uri", &format!("data:image/png;base64,{data}")).unwrap();
        document.to_bytes().unwrap()
    };
    let paths = [source.to_str().unwrap(), baked.to_str().unwrap()];
    let check = |bumps: &str, surface: &str| {
        fs::write(source.join("ridges.glb"), embedded(bumps, surface)).unwrap();
        let (_, out, _) = roughcast(&["check", paths[1], "--source", paths[0], "--format", "json"]);
        findings(&serde_json::from_str(&out).unwrap()).into_iter().map(|f| (f.0, f.1)).collect::<Vec<_>>()
    };
    fs::write(source.join("ridges.glb"), embedded("bumps.png", "surface.png")).unwrap();
    fs::remove_file(source.join("ridges.gltf")).unwrap();
    assert_eq!(roughcast(&["bake", paths[0], "-o", paths[1], "-q", "--glb=false"]).0, Outcome::Done);
    assert_eq!(check("bumps.png", "surface.png"), []);
    let stale = check("surface.png", "surface.png");
    assert!(stale.contains(&("RC1505".to_owned(), "image1.normal.ktx2".to_owned())), "{stale:?}");
    let stale = check("bumps.png", "bumps.png");
    assert!(!stale.is_empty() && stale.iter().all(|f| f.1 != "image1.normal.ktx2"), "{stale:?}");
}

/// The first bytes of an image in a buffer give its format, also if they are after the first 4096 bytes of the file.
#[test]
fn detects_formats_of_images_anywhere_in_a_buffer() {
    for (image, expected) in [(&b"\x89PNG\r\n"[..], false), (b"\xFF\xD8\xFF\xE0", false), (b"RIFF", true), (b"", true)]
    {
        let bake = bake(&[]);
        let mut bytes = fs::read(bake.baked.join("mesh.bin")).unwrap();
        bytes.resize(9000, 0);
        bytes[6000..][..image.len()].copy_from_slice(image);
        fs::write(bake.baked.join("mesh.bin"), bytes).unwrap();
        bake.edit(|d| {
            d["buffers"][0]["byteLength"] = json!(9000);
            let views = d["bufferViews"].as_array_mut().unwrap();
            views.push(json!({ "buffer": 0, "byteOffset": 6000, "byteLength": 3000 }));
            let view = views.len() - 1;
            let images = d["images"].as_array_mut().unwrap();
            images.push(json!({ "bufferView": view, "mimeType": "image/png" }));
            let image = images.len() - 1;
            d["textures"].as_array_mut().unwrap().push(json!({ "source": image }));
        });
        for options in [&[][..], &["--deep"]] {
            let codes: Vec<String> = findings(&bake.check(options).1).into_iter().map(|f| f.0).collect();
            assert_eq!(codes.contains(&"RC1207".to_owned()), expected, "{image:?} {options:?}: {codes:?}");
        }
    }
}

/// A check without `--deep` does not read levels, so it does not find a level that cannot be decoded.
#[test]
fn reads_levels_only_with_deep() {
    let bake = bake(&["--gltf", "strict"]);
    let texture = bake.texture("bumps.normal.ktx2");
    let mut bytes = fs::read(&texture).unwrap();
    let level = Ktx2::parse(&bytes).unwrap().levels()[0];
    bytes[level.offset as usize..][..level.length as usize].fill(0xFF);
    fs::write(&texture, bytes).unwrap();
    let (outcome, report) = bake.check_source(&[]);
    assert_eq!((outcome, findings(&report)), (Outcome::Done, vec![]), "{report}");
    let (outcome, report) = bake.check_source(&["--deep"]);
    let expected = ("RC1401".to_owned(), "bumps.normal.ktx2".to_owned(), "level 0".to_owned());
    assert_eq!((outcome, findings(&report)), (Outcome::Findings, vec![expected]), "{report}");
}

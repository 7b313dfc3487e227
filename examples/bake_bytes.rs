//! Bakes a document and a standalone map in memory, without a file system: `cargo run --release --example bake_bytes`.

use std::collections::HashMap;
use std::error::Error;
use std::io::{Cursor, ErrorKind};
use std::path::{Path, PathBuf};

use image::{ImageFormat, Rgb, RgbImage};
use roughcast::{Model, NormalLayout, Profile, Settings, bake_asset, bake_map, read_normal_map};

const GLTF: &str = r#"{
    "asset": { "version": "2.0" },
    "images": [{ "uri": "bumps.png" }],
    "textures": [{ "source": 0 }],
    "materials": [{
        "normalTexture": { "index": 0 },
        "pbrMetallicRoughness": { "roughnessFactor": 0.3 }
    }]
}"#;

fn main() -> Result<(), Box<dyn Error>> {
    let png = bumps()?;
    let settings = Settings::default().with_glb(true);
    let files = HashMap::from([(PathBuf::from("bumps.png"), png.clone())]);
    let read = |path: &Path| files.get(path).cloned().ok_or_else(|| ErrorKind::NotFound.into());
    let baked = bake_asset("plane", GLTF.as_bytes(), &read, &settings)?;
    println!("plane.glb: {} bytes", baked.document.len());
    for texture in &baked.report.textures {
        println!("  {:?}: {} x {}, {} levels", texture.content, texture.width, texture.height, texture.levels);
    }

    let map = read_normal_map(&png, NormalLayout::Auto, false)?;
    let settings = Settings::default().with_profile(Profile::Pyramid).with_model(Model::Anisotropic);
    for texture in bake_map(&map, None, &settings)?.textures {
        println!("{:?}: {} bytes of KTX2", texture.content, texture.ktx2.len());
    }
    Ok(())
}

/// Makes a normal map of ridges.
fn bumps() -> Result<Vec<u8>, image::ImageError> {
    let texel = |x: u32, _| Rgb([if x % 4 < 2 { 90 } else { 165 }, 128, 250]);
    let mut png = Cursor::new(Vec::new());
    RgbImage::from_fn(64, 64, texel).write_to(&mut png, ImageFormat::Png)?;
    Ok(png.into_inner())
}

//! glTF assets of any number of materials, each with its own normal map and roughness map.

use std::io;
use std::path::{Path, PathBuf};

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use serde_json::json;

use super::gltf::{Buffer, text};
use super::maps::{normals, surface};
use super::mesh::square;

/// Encodes an RGB PNG as tools write it: zlib's default level, and the filter chosen row by row.
pub fn png(texels: &[u8], size: usize) -> Vec<u8> {
    let mut file = Vec::new();
    PngEncoder::new_with_quality(&mut file, CompressionType::Default, FilterType::Adaptive)
        .write_image(texels, size as u32, size as u32, ExtendedColorType::Rgb8)
        .expect("texels fit the size");
    file
}

/// Writes `asset.gltf` with `materials` materials and maps of `size` x `size` texels to `folder`; returns its path. All
/// materials have the same texels in files of their own.
///
/// # Errors
/// The system's.
pub fn write(folder: &Path, size: usize, materials: usize) -> io::Result<PathBuf> {
    std::fs::create_dir_all(folder)?;
    let (normals, surface) = rayon::join(|| png(&normals(size), size), || png(&surface(size), size));
    let mut buffer = Buffer::default();
    let (mut images, mut textures, mut described) = (Vec::new(), Vec::new(), Vec::new());
    for index in 0..materials {
        buffer.add_mesh(&format!("square {index}"), &square(1.0), index);
        for (kind, bytes) in [("normal", &normals), ("surface", &surface)] {
            let uri = format!("{kind}{index}.png");
            std::fs::write(folder.join(&uri), bytes)?;
            textures.push(json!({ "source": images.len() }));
            images.push(json!({ "uri": uri }));
        }
        described.push(json!({
            "name": format!("material {index}"),
            "normalTexture": { "index": 2 * index },
            "pbrMetallicRoughness": { "metallicRoughnessTexture": { "index": 2 * index + 1 } },
        }));
    }
    let rest = json!({ "materials": described, "textures": textures, "images": images });
    let document = buffer.document(Some("asset.bin"), rest);
    std::fs::write(folder.join("asset.bin"), &buffer.bytes)?;
    let path = folder.join("asset.gltf");
    std::fs::write(&path, text(&document))?;
    Ok(path)
}

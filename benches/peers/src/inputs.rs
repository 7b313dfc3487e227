//! Makes the inputs, which are equal for equal data.

use std::fs::{self, File};
use std::io::BufWriter;
use std::path::Path;

use roughcast::decode::decode;
use roughcast::image::DecodeOptions;
use serde_json::{Value, json};

use crate::Failure;
use crate::mosaic::Mosaic;

/// Writes `count` assets of one material to `folder`, each with a normal map and a roughness map of `size` x `size`
/// texels. The maps of all assets are links to `normal.png` and `surface.png` in the folder `maps`.
///
/// # Errors
/// Errors of the system, and of maps that cannot be read.
pub fn assets(folder: &Path, size: u32, count: usize, data: Option<&Path>) -> Result<Value, Failure> {
    let maps = folder.join("maps");
    fs::create_dir_all(&maps)?;
    let (normals, surface) = (Mosaic::normals(data)?, Mosaic::surface());
    let file = |name: &str, mosaic| png(&maps.join(name), size, mosaic).map_err(|error| error.to_string());
    let (normals, surface) = rayon::join(|| file("normal.png", &normals), || file("surface.png", &surface));
    normals.and(surface)?;
    for index in 0..count {
        for kind in ["normal", "surface"] {
            let link = folder.join(format!("{index:04}_{kind}.png"));
            if !link.exists() {
                fs::hard_link(maps.join(format!("{kind}.png")), link)?;
            }
        }
        let image = |kind: &str| json!({ "uri": format!("{index:04}_{kind}.png") });
        let document = json!({
            "asset": { "version": "2.0" },
            "materials": [{
                "name": format!("material {index}"),
                "normalTexture": { "index": 0 },
                "pbrMetallicRoughness": { "metallicRoughnessTexture": { "index": 1 } },
            }],
            "textures": [{ "source": 0 }, { "source": 1 }],
            "images": [image("normal"), image("surface")],
        });
        fs::write(folder.join(format!("{index:04}.gltf")), document.to_string())?;
    }
    Ok(json!({ "size": size, "count": count }))
}

/// Writes an RGB PNG as tools do, with zlib's default level and the filter chosen row by row. The image is never whole
/// in memory.
fn png(path: &Path, size: u32, mosaic: &Mosaic) -> Result<(), Failure> {
    let mut encoder = png::Encoder::new(BufWriter::new(File::create(path)?), size, size);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Balanced);
    encoder.set_filter(png::Filter::Adaptive);
    let mut writer = encoder.write_header()?;
    let mut stream = writer.stream_writer()?;
    let mut row = vec![[0; 3]; size as usize];
    for y in 0..size as usize {
        mosaic.row(y, &mut row);
        std::io::Write::write_all(&mut stream, row.as_flattened())?;
    }
    stream.finish()?;
    writer.finish()?;
    Ok(())
}

/// Writes the image as a JPEG of quality 90.
///
/// # Errors
/// Errors of the system, and of an image that cannot be read.
pub fn jpeg(image: &Path, out: &Path) -> Result<Value, Failure> {
    let image = decode(&fs::read(image)?, &DecodeOptions::default())?;
    let encoder = jpeg_encoder::Encoder::new_file(out, 90)?;
    let (width, height) = (image.width.try_into()?, image.height.try_into()?);
    encoder.encode(&image.bytes(), width, height, jpeg_encoder::ColorType::Rgb)?;
    Ok(json!({}))
}

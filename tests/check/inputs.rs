//! Generated assets for every form of input: small maps as PNG, JPEG, WebP and KTX2, in files, in a buffer, in data
//! URIs and in a .glb; compressed geometry; layers, anisotropy, heights, and maps of one row or column.

use std::fs;
use std::io::Cursor;
use std::path::Path;

use base64::Engine;
use image::{DynamicImage, ImageFormat, RgbImage};
use roughcast::codec::uastc::{Effort, Metric};
use roughcast::codec::{PayloadFormat, Texels, encode};
use roughcast::gltf::document::Document;
use roughcast::gltf::json::Json;
use roughcast::ktx2::{Key, Ktx2Writer, StoredLevel};
use serde_json::{Value, json};

/// Number of assets that [`write_inputs`] writes.
pub const COUNT: usize = 16;

/// Writes the assets, each into its own folder below `folder`.
pub fn write_inputs(folder: &Path) {
    for (name, extension, encode) in [
        ("png", "png", png as fn(&RgbImage) -> Vec<u8>),
        ("jpeg", "jpg", jpeg as fn(&RgbImage) -> Vec<u8>),
        ("webp", "webp", webp as fn(&RgbImage) -> Vec<u8>),
        ("ktx2", "ktx2", ktx2 as fn(&RgbImage) -> Vec<u8>),
    ] {
        let mut files = Files::new(folder, name);
        let maps = maps();
        let uris = maps.iter().map(|(map, image)| files.add(&format!("{map} map.{extension}"), &encode(image)));
        let mut document = document(uris.map(|uri| json!({ "uri": uri })).collect());
        let sources = match name {
            "webp" => Some("EXT_texture_webp"),
            "ktx2" => Some("KHR_texture_basisu"),
            _ => None,
        };
        if let Some(extension) = sources {
            document["extensionsUsed"] = json!([extension]);
            document["extensionsRequired"] = json!([extension]);
            document["textures"] = (0..3).map(|i| json!({ "extensions": { extension: { "source": i } } })).collect();
        }
        files.document(&document);
    }
    webp_beside_png(folder);
    embedded(folder);
    compressed_geometry(folder);
    materials(folder);
    for (name, width, height) in [("pair", 2, 1), ("column", 1, 64), ("row", 17, 1)] {
        write_sized(folder, name, width, height);
    }
}

/// Writes an asset whose normal map is one row of `width` texels.
pub fn write_row(folder: &Path, width: u32) {
    write_sized(folder, "row", width, 1);
}

fn write_sized(folder: &Path, name: &str, width: u32, height: u32) {
    let mut files = Files::new(folder, name);
    let maps = [normals(width, height), surface(16, 16), colours(16, 16)];
    let uris = maps.iter().enumerate().map(|(i, map)| json!({ "uri": files.add(&format!("{i}.png"), &png(map)) }));
    let document = document(uris.collect());
    files.document(&document);
}

/// Writes an asset with WebP images and PNG fallbacks.
fn webp_beside_png(folder: &Path) {
    let mut files = Files::new(folder, "webp beside png");
    let mut images = Vec::new();
    for (map, image) in maps() {
        images.push(json!({ "uri": files.add(&format!("{map}.png"), &png(&image)) }));
        images.push(json!({ "uri": files.add(&format!("{map}.webp"), &webp(&image)) }));
    }
    let mut document = document(images);
    let texture = |i: usize| json!({ "source": 2 * i, "extensions": { "EXT_texture_webp": { "source": 2 * i + 1 } } });
    document["textures"] = (0..3).map(texture).collect();
    document["extensionsUsed"] = json!(["EXT_texture_webp"]);
    files.document(&document);
}

/// Writes assets with images in data URIs, in an external buffer and in the BIN chunk of a .glb. The colours are after
/// the first 4096 bytes, which a check reads of every file.
fn embedded(folder: &Path) {
    let maps = maps();
    let data = |(_, image): &(&str, RgbImage)| {
        let text = base64::engine::general_purpose::STANDARD.encode(png(image));
        json!({ "uri": format!("data:image/png;base64,{text}") })
    };
    Files::new(folder, "data").document(&document(maps.iter().map(data).collect()));

    let mut bytes = mesh();
    bytes.resize(5000, 0);
    let mut views = Vec::new();
    for (_, image) in &maps {
        let png = png(image);
        views.push(json!({ "buffer": 0, "byteOffset": bytes.len(), "byteLength": png.len() }));
        bytes.extend(png);
        bytes.resize(bytes.len().next_multiple_of(4), 0);
    }
    let image = |i: usize| json!({ "bufferView": 1 + i, "mimeType": "image/png" });
    let mut document = document((0..3).map(image).collect());
    document["bufferViews"].as_array_mut().unwrap().extend(views);
    document["buffers"][0]["byteLength"] = json!(bytes.len());
    let mut files = Files::new(folder, "buffer");
    files.add("mesh.bin", &bytes);
    files.document(&document);

    document["buffers"][0].as_object_mut().unwrap().remove("uri");
    let glb = Document::glb(Json::parse(document.to_string().as_bytes()).unwrap(), Some(bytes));
    Files::new(folder, "glb").add("glb.glb", &glb.to_bytes().unwrap());
}

/// Writes assets with compressed geometry. Its bytes are arbitrary, since a bake only copies them.
fn compressed_geometry(folder: &Path) {
    let mut files = Files::new(folder, "draco");
    let mut document = textured(&mut files);
    files.add("mesh.bin", &[0xD7; 64]);
    document["buffers"] = json!([{ "uri": "mesh.bin", "byteLength": 64 }]);
    document["bufferViews"] = json!([{ "buffer": 0, "byteLength": 64 }]);
    for accessor in document["accessors"].as_array_mut().unwrap() {
        accessor.as_object_mut().unwrap().remove("bufferView");
        accessor.as_object_mut().unwrap().remove("byteOffset");
    }
    let attributes = json!({ "POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2 });
    document["meshes"][0]["primitives"][0]["extensions"] =
        json!({ "KHR_draco_mesh_compression": { "bufferView": 0, "attributes": attributes } });
    declare(&mut document, "KHR_draco_mesh_compression");
    files.document(&document);

    let mut files = Files::new(folder, "meshopt");
    let mut document = textured(&mut files);
    files.add("mesh.bin", &[0xA0; 64]);
    document["buffers"] = json!([
        { "uri": "mesh.bin", "byteLength": 64 },
        { "byteLength": 96, "extensions": { "EXT_meshopt_compression": { "fallback": true } } }
    ]);
    document["bufferViews"] = json!([{
        "buffer": 1, "byteLength": 96, "extensions": { "EXT_meshopt_compression": {
            "buffer": 0, "byteLength": 64, "byteStride": 12, "count": 8, "mode": "ATTRIBUTES"
        } }
    }]);
    declare(&mut document, "EXT_meshopt_compression");
    files.document(&document);
}

/// Writes assets with clearcoats, anisotropy and heights.
fn materials(folder: &Path) {
    clearcoats(folder);
    brushed(folder);
    heights(folder);
}

/// Writes materials with a clearcoat as in KhronosGroup's ClearCoatTest: whole and partial coats, rough and smooth
/// coats, and coats with the normals of the base layer or with their own.
fn clearcoats(folder: &Path) {
    let mut files = Files::new(folder, "coats");
    let mut document = textured(&mut files);
    let wrap = files.add("wrap.png", &png(&wrinkles(64)));
    let coat = files.add("coat.png", &png(&surface(32, 32)));
    document["images"].as_array_mut().unwrap().extend([json!({ "uri": wrap }), json!({ "uri": coat })]);
    document["textures"].as_array_mut().unwrap().extend([json!({ "source": 3 }), json!({ "source": 4 })]);
    let plain = document["materials"][0].clone();
    let with = |clearcoat: Value| {
        let mut material = plain.clone();
        material["extensions"] = json!({ "KHR_materials_clearcoat": clearcoat });
        material
    };
    let smooth = json!({ "name": "Base without bumps", "extensions": { "KHR_materials_clearcoat": {
        "clearcoatFactor": 1, "clearcoatNormalTexture": { "index": 3 }
    } } });
    document["materials"] = json!([
        plain,
        with(json!({ "clearcoatFactor": 1 })),
        with(json!({ "clearcoatFactor": 1, "clearcoatTexture": { "index": 4 } })),
        with(json!({
            "clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.3, "clearcoatRoughnessTexture": { "index": 4 }
        })),
        with(json!({ "clearcoatFactor": 1, "clearcoatNormalTexture": { "index": 0 } })),
        with(json!({
            "clearcoatFactor": 1, "clearcoatTexture": { "index": 4 }, "clearcoatRoughnessFactor": 0.1,
            "clearcoatNormalTexture": { "index": 3, "scale": 0.5 }
        })),
        smooth,
    ]);
    let primitive = document["meshes"][0]["primitives"][0].clone();
    document["meshes"][0]["primitives"] = (0..7)
        .map(|material| {
            let mut primitive = primitive.clone();
            primitive["material"] = json!(material);
            primitive
        })
        .collect();
    document["extensionsUsed"] = json!(["KHR_materials_clearcoat"]);
    files.document(&document);
}

/// Writes a material with anisotropy in its base lobe.
fn brushed(folder: &Path) {
    let mut files = Files::new(folder, "brushed");
    let mut document = textured(&mut files);
    let axes = RgbImage::from_fn(16, 16, |x, y| image::Rgb([255 - 3 * y as u8, 128 + 4 * x as u8, 200]));
    let axes = files.add("axes.png", &png(&axes));
    document["images"].as_array_mut().unwrap().push(json!({ "uri": axes }));
    document["textures"].as_array_mut().unwrap().push(json!({ "source": 3 }));
    document["materials"][0]["extensions"] = json!({ "KHR_materials_anisotropy": {
        "anisotropyStrength": 0.7, "anisotropyRotation": 0.4, "anisotropyTexture": { "index": 3 }
    } });
    document["extensionsUsed"] = json!(["KHR_materials_anisotropy"]);
    files.document(&document);
}

/// Writes a material with a height map.
fn heights(folder: &Path) {
    let mut files = Files::new(folder, "heights");
    let mut document = textured(&mut files);
    let heights = image::ImageBuffer::from_fn(24, 20, |x, y| image::Luma([(3000 * (x % 7) + 2500 * (y % 5)) as u16]));
    let heights = files.add("heights.png", &written(&DynamicImage::ImageLuma16(heights), ImageFormat::Png));
    document["images"][0]["uri"] = json!(heights);
    let material = document["materials"][0].as_object_mut().unwrap();
    material.remove("normalTexture");
    material.insert("extras".into(), json!({ "roughcast": { "heightTexture": { "index": 0, "scale": 0.1 } } }));
    files.document(&document);
}

/// Returns a document whose three maps are PNG files.
fn textured(files: &mut Files) -> Value {
    let uris = maps().map(|(map, image)| json!({ "uri": files.add(&format!("{map}.png"), &png(&image)) }));
    document(uris.to_vec())
}

fn declare(document: &mut Value, extension: &str) {
    document["extensionsUsed"] = json!([extension]);
    document["extensionsRequired"] = json!([extension]);
}

/// The folder of an asset.
struct Files {
    folder: std::path::PathBuf,
    name: String,
}

impl Files {
    fn new(folder: &Path, name: &str) -> Self {
        let folder = folder.join(name);
        fs::create_dir_all(&folder).unwrap();
        Self { folder, name: name.to_owned() }
    }

    /// Writes a file and returns its URI.
    fn add(&mut self, name: &str, bytes: &[u8]) -> String {
        fs::write(self.folder.join(name), bytes).unwrap();
        name.replace(' ', "%20")
    }

    /// Writes the document, and the mesh if its file does not exist yet.
    fn document(mut self, document: &Value) {
        if !self.folder.join("mesh.bin").exists() {
            self.add("mesh.bin", &mesh());
        }
        let name = format!("{}.gltf", self.name);
        self.add(&name, serde_json::to_string_pretty(document).unwrap().as_bytes());
    }
}

/// Returns a triangle with normals along z and with rotated and stretched texture coordinates.
fn mesh() -> Vec<u8> {
    let positions = [[0., 0., 0.], [2., 0., 0.], [0., 1., 0.]];
    let normals = [[0., 0., 1.]; 3];
    let coordinates: [[f32; 2]; 3] = [[0., 1.], [1., 0.5], [0.2, 0.]];
    let floats = [positions, normals].concat().concat().into_iter().chain(coordinates.concat());
    floats.flat_map(f32::to_le_bytes).collect()
}

/// Returns a document of one material with the textures 0 (normals), 1 (surface) and 2 (colours).
fn document(images: Vec<Value>) -> Value {
    json!({
        "asset": { "version": "2.0" },
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "buffers": [{ "uri": "mesh.bin", "byteLength": 96 }],
        "bufferViews": [{ "buffer": 0, "byteLength": 96 }],
        "accessors": [
            {
                "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                "min": [0.0, 0.0, 0.0], "max": [2.0, 1.0, 0.0]
            },
            { "bufferView": 0, "byteOffset": 36, "componentType": 5126, "count": 3, "type": "VEC3" },
            { "bufferView": 0, "byteOffset": 72, "componentType": 5126, "count": 3, "type": "VEC2" }
        ],
        "meshes": [{
            "primitives": [{ "attributes": { "POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2 }, "material": 0 }]
        }],
        "images": images,
        "textures": [{ "source": 0 }, { "source": 1 }, { "source": 2 }],
        "materials": [{
            "name": "Rough",
            "normalTexture": { "index": 0 },
            "occlusionTexture": { "index": 1 },
            "pbrMetallicRoughness": { "metallicRoughnessTexture": { "index": 1 }, "baseColorTexture": { "index": 2 } }
        }]
    })
}

/// Returns the maps of a material with their names.
fn maps() -> [(&'static str, RgbImage); 3] {
    [("normal", normals(32, 32)), ("surface", surface(16, 16)), ("colour", colours(48, 48))]
}

/// Returns a pseudorandom 16-bit number that depends on `x` and `y` only.
fn noise(x: u32, y: u32) -> u32 {
    let mixed = (x.wrapping_mul(0x9E37_79B1) ^ y.wrapping_mul(0x85EB_CA77)).wrapping_mul(0xC2B2_AE3D);
    (mixed ^ mixed >> 15).wrapping_mul(0x27D4_EB2F) >> 16
}

/// Returns the normal map of the slopes that `slope` gives.
fn bump_map(width: u32, height: u32, slope: impl Fn(u32, u32) -> [f64; 2]) -> RgbImage {
    RgbImage::from_fn(width, height, |x, y| {
        let [u, v] = slope(x, y);
        let length = f64::sqrt(u * u + v * v + 1.0);
        image::Rgb([-u, -v, 1.0].map(|c| (127.5 * (c / length) + 127.5).round() as u8))
    })
}

/// Returns normals of ridges with some noise.
fn normals(width: u32, height: u32) -> RgbImage {
    bump_map(width, height, |x, y| {
        let noise = |seed: u32| f64::from(noise(x + seed, y)) / 65536.0 - 0.5;
        [if x % 2 == 0 { 0.6 } else { -0.5 } + 0.3 * noise(0), if y % 4 == 0 { 0.2 } else { -0.1 } + 0.2 * noise(99)]
    })
}

/// Returns normals of steep wrinkles a few texels wide, as in wrapping film.
fn wrinkles(size: u32) -> RgbImage {
    bump_map(size, size, |x, y| {
        let (x, y) = (f64::from(x), f64::from(y));
        let wave = (0.9 * x + 0.35 * y + 2.0 * (0.2 * y).sin()).sin();
        [2.5 * wave * wave * wave, 1.2 * (0.5 * y - 0.7 * x).sin()]
    })
}

/// Returns occlusion, roughness and metalness.
fn surface(width: u32, height: u32) -> RgbImage {
    RgbImage::from_fn(width, height, |x, y| {
        image::Rgb([255 - (noise(x, y) >> 11) as u8, 80 + 5 * x as u8, 7 * y as u8])
    })
}

/// Returns noise that no encoder can compress.
fn colours(width: u32, height: u32) -> RgbImage {
    RgbImage::from_fn(width, height, |x, y| image::Rgb([0, 1, 2].map(|c| (noise(x + 100 * c, y) >> 8) as u8)))
}

fn written(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    image.write_to(&mut file, format).unwrap();
    file.into_inner()
}

fn png(image: &RgbImage) -> Vec<u8> {
    written(&image.clone().into(), ImageFormat::Png)
}

fn webp(image: &RgbImage) -> Vec<u8> {
    written(&image.clone().into(), ImageFormat::WebP)
}

fn jpeg(image: &RgbImage) -> Vec<u8> {
    let mut file = Vec::new();
    let (width, height) = (image.width() as u16, image.height() as u16);
    jpeg_encoder::Encoder::new(&mut file, 90)
        .encode(image.as_raw(), width, height, jpeg_encoder::ColorType::Rgb)
        .unwrap();
    file
}

/// Encodes a texture of one level whose KTXwriter is another tool.
fn ktx2(image: &RgbImage) -> Vec<u8> {
    let row = |y: u32, out: &mut [[f32; 4]]| {
        for (x, texel) in out.iter_mut().enumerate() {
            let [r, g, b] = image.get_pixel(x as u32, y).0.map(|c| f32::from(c) / 255.0);
            *texel = [r, g, b, 1.0];
        }
    };
    let (width, height) = image.dimensions();
    let format = PayloadFormat::UastcRgb;
    let level = encode(&Texels { width, height, row: &row, lobes: None }, format, Metric::Rgb, Effort::Fast).unwrap();
    let keys = [Key { key: "KTXwriter".into(), value: "toktx v4.3".into() }];
    let levels = vec![StoredLevel::new(level, format, Effort::Fast).unwrap()];
    Ktx2Writer { format, width, height, levels, keys: &keys }.into_bytes().unwrap()
}

//! A plane with bumps, and its bakes.

use std::f32::consts::TAU;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use bevy::math::{Vec2, Vec3};
use serde_json::{Value, json};

/// Texels along a side of the normal map.
const SIZE: u32 = 64;
/// Repeats of the map over the plane. A pixel of the pictures covers four repeats, so the pictures show the last level.
const REPEATS: f32 = 256.0;
/// Roughness of the material.
pub const ROUGHNESS: f32 = 0.4;

/// A folder with `plane.gltf`: 2 x 2 units that face +Z, metal of [`ROUGHNESS`], and slopes that are wider along u.
pub struct Asset {
    folder: PathBuf,
    tool: PathBuf,
    /// Slopes of all texels, as the normal map holds them.
    pub slopes: Vec<Vec2>,
}

impl Asset {
    /// Writes the asset into `folder`, to be baked by `tool`.
    pub fn new(folder: &Path, tool: PathBuf) -> Self {
        // Sines of whole periods, so that the mean slope is 0.
        let slope = |x: u32, y: u32| {
            let [u, v] = [x, y].map(|i| TAU * (i as f32 + 0.5) / SIZE as f32);
            Vec2::new(0.35 * (5.0 * u + 3.0 * v).sin(), 0.3 * (5.0 * u + 3.0 * v).sin() + 0.1 * (7.0 * v).cos())
        };
        let map = image::RgbImage::from_fn(SIZE, SIZE, |x, y| {
            let normal = (-slope(x, y)).extend(1.0).normalize();
            image::Rgb(normal.to_array().map(|c| (127.5 * (c + 1.0)).round() as u8))
        });
        let slopes = map.pixels().map(|p| {
            let [x, y, z] = p.0.map(|c| f32::from(c) / 127.5 - 1.0);
            -Vec2::new(x, y) / z
        });
        fs::create_dir_all(folder).unwrap();
        map.save(folder.join("normal.png")).unwrap();
        let (document, bin) = plane();
        fs::write(folder.join("plane.gltf"), document.to_string()).unwrap();
        fs::write(folder.join("plane.bin"), bin).unwrap();
        Self { folder: folder.to_owned(), tool, slopes: slopes.collect() }
    }

    /// Bakes the asset in the dual form into the folder `name`, beside the asset.
    pub fn bake(&self, name: &str, options: &str) -> Baked {
        let output = self.folder.join(name);
        let mut tool = Command::new(&self.tool);
        tool.arg("bake").arg(self.folder.join("plane.gltf")).arg("-o").arg(&output).args(["--gltf", "dual", "--quiet"]);
        assert!(tool.arg("--no-config").args(options.split_whitespace()).status().unwrap().success(), "{options}");
        let document = fs::read(output.join("plane.gltf")).unwrap();
        Baked { path: format!("{name}/plane.gltf"), document: serde_json::from_slice(&document).unwrap() }
    }

    /// Returns the texel of the last level of the texture of `content`, as `roughcast inspect` decodes it.
    pub fn last_texel(&self, baked: &Baked, content: &str) -> Vec3 {
        let levels = self.folder.join(format!("levels of {content}"));
        let mut tool = Command::new(&self.tool);
        tool.arg("inspect").arg(self.folder.join(&baked.path)).arg("--extract").arg(&levels).stdout(Stdio::null());
        assert!(tool.status().unwrap().success());
        let last = format!(".level{}.png", SIZE.ilog2());
        let is_last = |path: &PathBuf| {
            let name = path.file_name().unwrap().to_string_lossy();
            name.contains(content) && name.ends_with(&last)
        };
        let path = fs::read_dir(levels).unwrap().map(|entry| entry.unwrap().path()).find(is_last).unwrap();
        Vec3::from(image::open(path).unwrap().to_rgb8().get_pixel(0, 0).0.map(|c| f32::from(c) / 255.0))
    }

    /// Writes the asset again as a matt dielectric, which reflects diffuse light alone.
    pub fn make_matt(&self) {
        let (mut document, _) = plane();
        document["materials"][0]["pbrMetallicRoughness"]["metallicFactor"] = json!(0);
        self.write_matt(document, "plane.gltf");
    }

    /// Writes the asset again with the same slope in all texels, and a lobe that is anisotropic along u.
    pub fn make_tilted(&self, slope: Vec2, strength: f32) {
        let normal = (-slope).extend(1.0).normalize().to_array().map(|c| (127.5 * (c + 1.0)).round() as u8);
        image::RgbImage::from_pixel(SIZE, SIZE, image::Rgb(normal)).save(self.folder.join("normal.png")).unwrap();
        let (mut document, _) = plane();
        document["materials"][0]["extensions"] =
            json!({ "KHR_materials_anisotropy": { "anisotropyStrength": strength } });
        document["extensionsUsed"] = json!(["KHR_materials_anisotropy"]);
        fs::write(self.folder.join("plane.gltf"), document.to_string()).unwrap();
    }

    /// Writes a plane of a matt dielectric without bumps, and returns its path.
    pub fn matt(&self, roughness: f32) -> String {
        let (mut document, _) = plane();
        document["materials"][0] =
            json!({ "pbrMetallicRoughness": { "metallicFactor": 0, "roughnessFactor": roughness } });
        self.write_matt(document, "matt.gltf");
        "matt.gltf".to_owned()
    }

    fn write_matt(&self, mut document: Value, name: &str) {
        document["materials"][0]["extensions"] = json!({ "KHR_materials_specular": { "specularFactor": 0 } });
        document["extensionsUsed"] = json!(["KHR_materials_specular"]);
        fs::write(self.folder.join(name), document.to_string()).unwrap();
    }

    /// Writes a plane without bumps whose lobe is anisotropic along u, and returns its path.
    pub fn anisotropic(&self, roughness: f32, strength: f32) -> String {
        let (mut document, _) = plane();
        document["materials"][0] = json!({
            "pbrMetallicRoughness": { "metallicFactor": 1, "roughnessFactor": roughness },
            "extensions": { "KHR_materials_anisotropy": { "anisotropyStrength": strength } },
        });
        document["extensionsUsed"] = json!(["KHR_materials_anisotropy"]);
        fs::write(self.folder.join("anisotropic.gltf"), document.to_string()).unwrap();
        "anisotropic.gltf".to_owned()
    }
}

/// A baked plane.
pub struct Baked {
    /// Path of the glTF, relative to the asset's folder.
    pub path: String,
    document: Value,
}

impl Baked {
    /// Returns c of the pyramid.
    pub fn correction_factor(&self) -> f32 {
        self.extension()["correctionFactor"].as_f64().unwrap() as f32
    }

    /// Returns the slope of a texel of the offset texture.
    pub fn slope(&self, texel: Vec3) -> Vec2 {
        let scale = self.extension()["offsetScale"].as_array().unwrap();
        let normal = 2.0 * texel - 1.0;
        -normal.truncate() / normal.z * Vec2::from([0, 1].map(|c| scale[c].as_f64().unwrap() as f32))
    }

    /// Returns D or lambda_1 of a texel of the roughness texture.
    pub fn roughness(&self, texel: Vec3) -> Vec3 {
        let bounds = |member: &str| {
            let values = self.extension()[member].as_array().unwrap();
            Vec3::from([0, 1, 2].map(|c| values.get(c).map_or(0.0, |value| value.as_f64().unwrap() as f32)))
        };
        let min = bounds("roughnessMin");
        min + texel * (bounds("roughnessMax") - min)
    }

    /// Returns the frame of the pyramid.
    pub fn frame(&self) -> &str {
        self.extension()["frame"].as_str().unwrap()
    }

    fn extension(&self) -> &Value {
        &self.document["materials"][0]["extensions"][bevy_roughcast::EXTENSION]
    }
}

fn plane() -> (Value, Vec<u8>) {
    let corners = [[-1.0_f32, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let positions = corners.iter().flat_map(|[x, y]| [*x, *y, 0.0]);
    let normals = corners.iter().flat_map(|_| [0.0, 0.0, 1.0]);
    let tangents = corners.iter().flat_map(|_| [1.0, 0.0, 0.0, 1.0]);
    let uvs = corners.iter().flat_map(|[x, y]| [(x + 1.0) * REPEATS / 2.0, (1.0 - y) * REPEATS / 2.0]);
    let vertices: Vec<f32> = positions.chain(normals).chain(tangents).chain(uvs).collect();
    let mut bin: Vec<u8> = vertices.iter().flat_map(|f| f.to_le_bytes()).collect();
    bin.extend([0_u16, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()));
    let view = |offset: u32, length: u32| json!({ "buffer": 0, "byteOffset": offset, "byteLength": length });
    let accessor =
        |view: u32, kind: &str| json!({ "bufferView": view, "componentType": 5126, "count": 4, "type": kind });
    let mut position = accessor(0, "VEC3");
    position["min"] = json!([-1, -1, 0]);
    position["max"] = json!([1, 1, 0]);
    let document = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{
            "attributes": { "POSITION": 0, "NORMAL": 1, "TANGENT": 2, "TEXCOORD_0": 3 }, "indices": 4, "material": 0,
        }] }],
        "materials": [{
            "normalTexture": { "index": 0 },
            "pbrMetallicRoughness": { "metallicFactor": 1, "roughnessFactor": ROUGHNESS },
        }],
        "textures": [{ "source": 0 }],
        "images": [{ "uri": "normal.png" }],
        "accessors": [
            position, accessor(1, "VEC3"), accessor(2, "VEC4"), accessor(3, "VEC2"),
            { "bufferView": 4, "componentType": 5123, "count": 6, "type": "SCALAR" },
        ],
        "bufferViews": [view(0, 48), view(48, 48), view(96, 64), view(160, 32), view(192, 12)],
        "buffers": [{ "uri": "plane.bin", "byteLength": bin.len() }],
    });
    (document, bin)
}

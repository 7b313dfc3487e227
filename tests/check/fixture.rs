//! A small generated asset that is baked in-process into a temporary folder.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Parser;
use roughcast::cli::{Cli, Outcome, run};
use serde_json::{Value, json};
use tempfile::TempDir;

/// The folders of sources and outputs of a bake.
pub struct Bake {
    _folder: TempDir,
    pub source: PathBuf,
    pub baked: PathBuf,
}

/// Runs a command line; returns its outcome, standard output and standard error.
pub fn roughcast(arguments: &[&str]) -> (Outcome, String, String) {
    let cli = Cli::try_parse_from(std::iter::once("roughcast").chain(arguments.iter().copied())).unwrap();
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let outcome = run(cli, &mut out, &mut err);
    (outcome, String::from_utf8(out).unwrap(), String::from_utf8(err).unwrap())
}

/// Bakes the asset with `options`.
pub fn bake(options: &[&str]) -> Bake {
    let folder = tempfile::tempdir().unwrap();
    let (source, baked) = (folder.path().join("source"), folder.path().join("baked"));
    write_asset(&source);
    let paths = [source.to_str().unwrap(), "-o", baked.to_str().unwrap(), "-q"];
    let (outcome, _, err) = roughcast(&[&["bake"], &paths[..], options].concat());
    assert_eq!(outcome, Outcome::Done, "{options:?}: {err}");
    Bake { _folder: folder, source, baked }
}

/// Writes a triangle with a bumpy material: 16 x 16 texels of normals, and of occlusion, roughness and metalness.
pub fn write_asset(folder: &Path) {
    fs::create_dir_all(folder).unwrap();
    // The slopes of the ridges vary more along x than along y, so the covariance is anisotropic.
    let normals = image::RgbImage::from_fn(16, 16, |x, y| {
        let (u, v) = (if x % 2 == 0 { 0.6 } else { -0.5 }, if y % 4 == 0 { 0.2 } else { -0.1 });
        let length = f64::sqrt(u * u + v * v + 1.0);
        image::Rgb([-u, -v, 1.0].map(|c| (127.5 * (c / length) + 127.5).round() as u8))
    });
    let surface = image::RgbImage::from_fn(16, 16, |x, y| image::Rgb([255, 80 + 5 * x as u8, 10 * y as u8]));
    normals.save(folder.join("bumps.png")).unwrap();
    surface.save(folder.join("surface.png")).unwrap();
    // Positions in the xy plane, normals along z, texture coordinates with v down.
    let floats: [f32; 24] =
        [0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 1., 0., 0., 1., 0., 1., 1., 1., 0., 0.];
    fs::write(folder.join("mesh.bin"), floats.iter().flat_map(|f| f.to_le_bytes()).collect::<Vec<u8>>()).unwrap();
    let document = json!({
        "asset": { "version": "2.0" },
        "buffers": [{ "uri": "mesh.bin", "byteLength": 96 }],
        "bufferViews": [{ "buffer": 0, "byteLength": 96 }],
        "accessors": [
            {
                "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                "min": [0.0, 0.0, 0.0], "max": [1.0, 1.0, 0.0]
            },
            { "bufferView": 0, "byteOffset": 36, "componentType": 5126, "count": 3, "type": "VEC3" },
            { "bufferView": 0, "byteOffset": 72, "componentType": 5126, "count": 3, "type": "VEC2" }
        ],
        "meshes": [{
            "primitives": [{ "attributes": { "POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2 }, "material": 0 }]
        }],
        "images": [{ "uri": "bumps.png" }, { "uri": "surface.png" }],
        "textures": [{ "source": 0 }, { "source": 1 }],
        "materials": [{
            "name": "Ridges",
            "normalTexture": { "index": 0 },
            "pbrMetallicRoughness": { "metallicRoughnessTexture": { "index": 1 } }
        }]
    });
    fs::write(folder.join("ridges.gltf"), serde_json::to_string_pretty(&document).unwrap()).unwrap();
}

impl Bake {
    /// Returns the path of the baked document.
    pub fn document(&self) -> PathBuf {
        self.baked.join("ridges.gltf")
    }

    /// Returns the path of a baked texture, such as `bumps.normal.ktx2`.
    pub fn texture(&self, name: &str) -> PathBuf {
        self.baked.join("ridges.roughcast").join(name)
    }

    /// Changes the baked document.
    pub fn edit(&self, edit: impl Fn(&mut Value)) {
        let mut document: Value = serde_json::from_slice(&fs::read(self.document()).unwrap()).unwrap();
        edit(&mut document);
        fs::write(self.document(), serde_json::to_vec(&document).unwrap()).unwrap();
    }

    /// Checks the output folder. Returns the outcome and the report.
    pub fn check(&self, options: &[&str]) -> (Outcome, Value) {
        let folder = self.baked.to_str().unwrap();
        let (outcome, out, err) = roughcast(&[&["check", folder, "--format", "json"], options].concat());
        assert_eq!(err, "");
        (outcome, serde_json::from_str(&out).unwrap())
    }

    /// Checks the output folder with `--source`.
    pub fn check_source(&self, options: &[&str]) -> (Outcome, Value) {
        self.check(&[&["--source", self.source.to_str().unwrap()], options].concat())
    }
}

/// Returns codes, file names and places of a report's findings, without RC1510: the ridges are too steep for the
/// default `--max-error`, so every roughness texture has that note.
pub fn findings(report: &Value) -> Vec<(String, String, String)> {
    let text = |finding: &Value, key: &str| finding[key].as_str().unwrap().to_owned();
    let file = |finding: &Value| Path::new(&text(finding, "file")).file_name().unwrap().to_str().unwrap().to_owned();
    let list = report["findings"].as_array().unwrap();
    list.iter().filter(|f| f["code"] != "RC1510").map(|f| (text(f, "code"), file(f), text(f, "place"))).collect()
}

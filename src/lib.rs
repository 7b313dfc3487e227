//! Roughcast bakes the roughness that mipmapped normal maps lose into textures.
//!
//! Filtering a normal map into mips removes bumps, and with them the roughness that the eye should see. [`bake_asset`]
//! takes a glTF document with normal or height maps, and returns KTX2 textures whose mip levels carry that roughness,
//! and a document that refers to them. [`bake_map`] bakes one map without a document: see [`read_normal_map`] and
//! [`read_height_map`]. Both take bytes and return bytes: the core of the library reads no files.
//!
//! # A file to a folder
//!
//! ```
//! use std::error::Error;
//! use std::{fs, path::Path};
//!
//! /// Bakes `plane.gltf` of the folder `source` into the folder `output`.
//! fn bake(source: &Path, output: &Path) -> Result<(), Box<dyn Error>> {
//!     let read = |path: &Path| fs::read(source.join(path));
//!     let document = read(Path::new("plane.gltf"))?;
//!     let baked = roughcast::bake_asset("plane", &document, &read, &roughcast::Settings::default())?;
//!     fs::create_dir_all(output.join("plane.roughcast"))?; // the folder of all new files
//!     fs::write(output.join("plane.gltf"), &baked.document)?;
//!     for file in &baked.files {
//!         fs::write(output.join(&file.path), &file.bytes)?;
//!     }
//!     Ok(())
//! }
//! # let folder = std::env::temp_dir().join(format!("roughcast-doc-{}", std::process::id()));
//! # fs::create_dir_all(&folder).unwrap();
//! # let texel = |x: u32, _| image::Rgb([if x % 2 == 0 { 90 } else { 165 }, 128, 250]);
//! # image::RgbImage::from_fn(8, 8, texel).save(folder.join("bumps.png")).unwrap();
//! # let gltf = r#"{ "asset": { "version": "2.0" }, "images": [{ "uri": "bumps.png" }], "textures": [{ "source": 0 }],
//! #     "materials": [{ "normalTexture": { "index": 0 }, "pbrMetallicRoughness": { "roughnessFactor": 0.3 } }] }"#;
//! # fs::write(folder.join("plane.gltf"), gltf).unwrap();
//! # let output = folder.join("baked");
//! # bake(&folder, &output).unwrap();
//! # assert!(output.join("plane.roughcast").read_dir().unwrap().count() > 1);
//! # fs::remove_dir_all(&folder).unwrap();
//! ```
//!
//! [`BakedAsset::copies`] lists the other files that the document refers to: they did not change, and may be copied.
//! `examples/bake_file.rs` does so.
//!
//! # Bytes to bytes
//!
//! ```
//! use std::collections::HashMap;
//! use std::io;
//! use std::path::{Path, PathBuf};
//!
//! use roughcast::{Settings, Target, bake_asset};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let texel = |x: u32, _| image::Rgb([if x % 2 == 0 { 90 } else { 165 }, 128, 250]);
//! # let mut png = io::Cursor::new(Vec::new());
//! # image::RgbImage::from_fn(8, 8, texel).write_to(&mut png, image::ImageFormat::Png)?;
//! # let png = png.into_inner();
//! let gltf = r#"{ "asset": { "version": "2.0" }, "images": [{ "uri": "bumps.png" }], "textures": [{ "source": 0 }],
//!     "materials": [{ "normalTexture": { "index": 0 }, "pbrMetallicRoughness": { "roughnessFactor": 0.3 } }] }"#;
//! let files = HashMap::from([(PathBuf::from("bumps.png"), png)]);
//! let read = |path: &Path| files.get(path).cloned().ok_or_else(|| io::ErrorKind::NotFound.into());
//! let settings = Settings::default().with_target(Target::Float).with_glb(true);
//! let baked = bake_asset("plane", gltf.as_bytes(), &read, &settings)?;
//! assert!(baked.document.starts_with(b"glTF") && baked.files.is_empty());
//! # Ok(())
//! # }
//! ```
//!
//! # A build script
//!
//! Add `roughcast` with `default-features = false` to `[build-dependencies]`; `examples/build_script.rs` is a whole
//! `build.rs` to copy. Cargo does not optimise build scripts by default, and without optimisation the encoder is slow
//! and overflows the stacks of its threads: set `opt-level = 3` in `[profile.dev.build-override]` and
//! `[profile.release.build-override]`.
//!
//! ```
//! use std::error::Error;
//! use std::{fs, path::Path};
//!
//! /// Bakes `assets/rock.glb` to `rock.glb`, one file, in the folder that Cargo names to build scripts as OUT_DIR.
//! fn build(package: &Path, out_dir: &Path) -> Result<(), Box<dyn Error>> {
//!     let folder = package.join("assets");
//!     let read = |path: &Path| {
//!         println!("cargo::rerun-if-changed={}", folder.join(path).display());
//!         fs::read(folder.join(path))
//!     };
//!     let settings = roughcast::Settings::default();
//!     let baked = roughcast::bake_asset("rock", &read(Path::new("rock.glb"))?, &read, &settings)?;
//!     fs::write(out_dir.join("rock.glb"), baked.document)?;
//!     Ok(())
//! }
//! # let folder = std::env::temp_dir().join(format!("roughcast-build-{}", std::process::id()));
//! # fs::create_dir_all(folder.join("assets")).unwrap();
//! # fs::write(folder.join("assets/rock.glb"), r#"{ "asset": { "version": "2.0" } }"#).unwrap();
//! # build(&folder, &folder).unwrap();
//! # fs::remove_dir_all(&folder).unwrap();
//! ```
//!
//! # Cargo features
//!
//! | feature | default | adds |
//! |---|---|---|
//! | `cli` | yes | the tool `roughcast`, and all modules that read and write files |
//! | `bc` | yes | [`Target::Bc`]: encoders of BC4, BC5 and BC7, the only C++ code |
//! | `remote` | no | `roughcast bake --remote`: jobs on a server of the Remote Execution API v2 |
//! | `object-store` | no | caches in S3, Google Cloud and Azure storage |
//!
//! # What is public
//!
//! The interface of the library is what this page lists. All other modules are public only for the tool, tests, benches
//! and examples of this repository: they are hidden from the documentation and not covered by semantic versioning.
//!
//! The theory is A. Schilling, "Antialiasing of Bump-Maps", WSI-97-15, 1997: "the paper" throughout. Where the code
//! departs from the paper, a test named `erratum_*` shows why. docs/architecture.md describes the layers of the code.

#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;

#[doc(hidden)]
pub use roughcast_core::{
    api, bake, bump, codec, decode, digest, foreign, gltf, image, ktx2, lobe, material, math, memory, metric, mip,
    note, report, select, settings,
};
#[cfg(feature = "cli")]
#[doc(hidden)]
pub use roughcast_pipeline::{
    cache, check, compare, input_file, inspect, output, pictures, project, readback, remote, render, run, standalone,
    text, viewer, watch,
};

#[doc(inline)]
pub use self::image::{Image, MapError, Samples};
#[doc(inline)]
pub use api::{
    BakedMap, BakedTexture, Error, bake_asset, bake_asset_with_progress, bake_map, read_height_map, read_normal_map,
    read_roughness_map,
};
#[doc(inline)]
pub use bake::{BakeError, BakedAsset, BaseRoughness, Files, NewFile};
#[doc(inline)]
pub use bump::{Frame, FrameKind, HeightMap, NormalLayout, NormalMap};
#[doc(inline)]
pub use codec::uastc::Effort;
#[doc(inline)]
pub use codec::{EncodeError, Target};
#[doc(inline)]
pub use decode::DecodeError;
#[doc(inline)]
pub use digest::Digest;
#[doc(inline)]
pub use gltf::document::{Container, DocumentError};
#[doc(inline)]
pub use gltf::material::LayerKind;
#[doc(inline)]
pub use lobe::{Distribution, Family};
#[doc(inline)]
pub use material::{BumpMap, Range};
#[doc(inline)]
pub use memory::OutOfMemory;
#[doc(inline)]
pub use mip::Wrap;
#[doc(inline)]
pub use note::{Note, NoteKind};
#[doc(inline)]
pub use report::{
    AssetReport as Report, Candidate, Choice, Content, LayerReport, Miss, Reason as MissReason, TextureReport,
};
#[doc(inline)]
pub use settings::{
    DiffuseLight, Finest, Form, MaxModel, Model, OwnAnisotropy, Profile, RecordedSettings, Settings, SettingsError,
    Textures, View,
};

//! Costs of a model: its shading and its storage.
//!
//! Operations and fetches are counted in whole compiled fragment shaders (`shading.json`, which the tests of
//! `plugins/three` measure again).

use std::collections::BTreeMap;
use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

use super::ours::Ours;
use crate::metric::Peer;
use crate::render::Texture;

/// Cost of shading a fragment of a metal with normal and metallic-roughness maps under one directional light and an
/// environment.
#[derive(Clone, Copy, Deserialize)]
struct Shading {
    operations: u32,
    fetches: u32,
}

#[derive(Default, Deserialize)]
struct Measured {
    shading: BTreeMap<String, Shading>,
}

static MEASURED: LazyLock<Measured> =
    LazyLock::new(|| serde_json::from_str(include_str!("shading.json")).unwrap_or_default());

fn shading(name: &str) -> Option<Shading> {
    MEASURED.shading.get(name).copied()
}

/// Bytes of a 4 x 4 block of UASTC, and of the BC7 and ASTC blocks that engines make of it on the GPU.
const BLOCK: u64 = 16;

/// Costs; `None` if a cost was not measured or does not exist.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Cost {
    /// Bytes on the GPU of all levels of all textures that a shader reads.
    pub gpu_bytes: Option<u64>,
    /// Bytes of the files that the bake wrote.
    pub file_bytes: Option<u64>,
    /// Seconds that the bake took. Varies from run to run.
    pub bake_seconds: Option<f64>,
    /// Texture fetches of the fragment shader.
    pub fetches: Option<u32>,
    /// Operations of the fragment shader.
    pub operations: Option<u32>,
}

/// The cost on the horizontal axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Bytes on the GPU.
    GpuBytes,
    /// Bytes of the files.
    FileBytes,
    /// Seconds of the bake.
    BakeSeconds,
    /// Texture fetches.
    Fetches,
    /// Operations in the shader.
    Operations,
}

impl Axis {
    /// All axes.
    pub const ALL: [Self; 5] = [Self::GpuBytes, Self::FileBytes, Self::BakeSeconds, Self::Fetches, Self::Operations];

    /// Returns the title of the axis.
    pub fn title(self) -> &'static str {
        match self {
            Self::GpuBytes => "Size on the GPU",
            Self::FileBytes => "Size of the files",
            Self::BakeSeconds => "Bake time (varies)",
            Self::Fetches => "Texture fetches",
            Self::Operations => "Operations in the shader",
        }
    }

    /// Returns what follows an amount in a sentence.
    pub fn place(self) -> &'static str {
        match self {
            Self::GpuBytes => "on the GPU",
            Self::FileBytes => "in files",
            Self::BakeSeconds => "to bake",
            Self::Fetches => "texture fetches",
            Self::Operations => "operations in the shader",
        }
    }

    /// Returns the value of the axis.
    pub fn value(self, cost: &Cost) -> Option<f64> {
        match self {
            Self::GpuBytes => cost.gpu_bytes.map(|n| n as f64),
            Self::FileBytes => cost.file_bytes.map(|n| n as f64),
            Self::BakeSeconds => cost.bake_seconds,
            Self::Fetches => cost.fetches.map(f64::from),
            Self::Operations => cost.operations.map(f64::from),
        }
    }
}

impl Cost {
    /// Returns the cost of one of our bakes.
    pub fn of_bake(ours: &Ours) -> Self {
        let shading = shading(if ours.material.anisotropy.is_some() { "anisotropic" } else { "isotropic" });
        Self {
            gpu_bytes: Some(ours.material.textures().map(|texture| blocks(texture) * BLOCK).sum()),
            file_bytes: Some(ours.file_bytes),
            bake_seconds: Some(ours.seconds),
            fetches: shading.map(|s| s.fetches),
            operations: shading.map(|s| s.operations),
        }
    }

    /// Returns the cost of a peer: its maps of bumps are as large as `normals`, and its roughness texture is as large
    /// as `finest`. `plain` is the cost of plain mips. Bakes of other tools are not timed, and their files are not
    /// written.
    pub fn of_peer(peer: Peer, normals: &Texture, finest: &Texture, has_roughness: bool, plain: &Self) -> Self {
        let bumps = BLOCK * blocks(normals);
        let roughness = BLOCK * blocks(finest);
        let base_roughness = if has_roughness { roughness } else { 0 };
        let (gpu_bytes, shading) = match peer {
            Peer::PlainMips => return Self { file_bytes: None, bake_seconds: None, ..plain.clone() },
            // Offsets, lambda_1 or D, and the roughness of the base lobe.
            Peer::Lambda1 => (2 * bumps + base_roughness, shading("lambda1")),
            Peer::D => (2 * bumps + base_roughness, shading("factor")),
            // Five moments in two textures of four channels (LEAN mapping, section 4). Its shader was not measured.
            Peer::LeanHalf => (base_roughness + texels(normals) * 16, None),
            Peer::LeanFloat => (base_roughness + texels(normals) * 32, None),
            _ => (bumps + roughness, shading("isotropic")),
        };
        Self {
            gpu_bytes: Some(gpu_bytes),
            fetches: shading.map(|s| s.fetches),
            operations: shading.map(|s| s.operations),
            file_bytes: None,
            bake_seconds: None,
        }
    }
}

fn levels(texture: &Texture) -> impl Iterator<Item = (u64, u64)> {
    (0..texture.level_count()).map(|level| texture.size(level)).map(|(w, h)| (w.into(), h.into()))
}

fn blocks(texture: &Texture) -> u64 {
    levels(texture).map(|(w, h): (u64, u64)| w.div_ceil(4) * h.div_ceil(4)).sum()
}

fn texels(texture: &Texture) -> u64 {
    levels(texture).map(|(w, h)| w * h).sum()
}

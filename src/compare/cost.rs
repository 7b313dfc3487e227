//! What a model costs where it is shaded and stored.
//!
//! Fetches count the textures that a shader reads for the normal and the lobe. Operations count the scalar additions,
//! multiplications, divisions and square roots of one light, once, from the formulas named at each constant; they rank
//! models, compilers will do with fewer.

use serde::Serialize;

use super::Ours;
use crate::judge::Peer;
use crate::render::{Bumps, Material, Texture};

/// glTF 2.0, appendix B.3: N.H, N.L, N.V 15, alpha^2 2, D 7, V (height-correlated Smith) 13.
const ISOTROPIC: u32 = 37;
/// `KHR_materials_anisotropy`, "Implementation": direction decoded, rotated and normalised 16, alphas 5, T and B 18,
/// nine dot products 45, D 13, V 20.
const ANISOTROPIC: u32 = 117;
/// A lobe given by A itself: nine dot products 45, D 20 (determinant 3, slopes 4, quadratic form 8, the rest 5), V 22.
const MATRIX: u32 = 87;
/// alpha^2 + 2 lambda_1^2.
const LAMBDA_1: u32 = ISOTROPIC + 3;
/// A + 2 D D^T.
const FACTOR: u32 = MATRIX + 11;
/// A + 2 (M - m m^T): LEAN mapping, equation 6.
const LEAN: u32 = MATRIX + 12;
/// Bytes of a 4 x 4 block of UASTC, and of the BC7 and ASTC that it becomes on the GPU.
const BLOCK: u64 = 16;

/// Costs; `None` where nothing was measured or there is nothing to measure.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Cost {
    /// Bytes of all levels of all textures that a shader reads, on the GPU.
    pub gpu_bytes: Option<u64>,
    /// Bytes of the files that the bake wrote.
    pub file_bytes: Option<u64>,
    /// Seconds that the bake took. Varies from run to run.
    pub bake_seconds: Option<f64>,
    /// Textures fetched.
    pub fetches: Option<u32>,
    /// Scalar operations in the shader.
    pub operations: Option<u32>,
}

/// What is read off the horizontal axis.
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
    /// All of them.
    pub const ALL: [Self; 5] = [Self::GpuBytes, Self::FileBytes, Self::BakeSeconds, Self::Fetches, Self::Operations];

    /// Its heading.
    pub fn title(self) -> &'static str {
        match self {
            Self::GpuBytes => "Bytes on the GPU",
            Self::FileBytes => "Bytes in the files",
            Self::BakeSeconds => "Bake time in seconds (varies)",
            Self::Fetches => "Texture fetches",
            Self::Operations => "Operations in the shader",
        }
    }

    /// Its value.
    pub fn of(self, cost: &Cost) -> Option<f64> {
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
    /// Of a bake of ours.
    pub fn of_ours(ours: &Ours) -> Self {
        let read = textures(&ours.material);
        Self {
            gpu_bytes: Some(read.iter().map(|texture| blocks(texture) * BLOCK).sum()),
            file_bytes: Some(ours.file_bytes),
            bake_seconds: Some(ours.seconds),
            fetches: Some(read.len() as u32),
            operations: Some(if ours.material.anisotropy.is_some() { ANISOTROPIC } else { ISOTROPIC }),
        }
    }

    /// Of a peer whose maps are as large as `grid`; `plain` is the cost of plain mips. Other tools' bakes are not timed
    /// and their files not written.
    pub fn of_peer(peer: Peer, grid: &Texture, has_roughness: bool, plain: &Self) -> Self {
        let own = u32::from(has_roughness);
        let encoded = |n: u32| u64::from(n) * BLOCK * blocks(grid);
        let (gpu_bytes, fetches, operations) = match peer {
            Peer::PlainMips => return Self { file_bytes: None, bake_seconds: None, ..plain.clone() },
            // Offsets and lambda_1 or D, beside the material's own roughness.
            Peer::Lambda1 => (encoded(2 + own), 2 + own, LAMBDA_1),
            Peer::D => (encoded(2 + own), 2 + own, FACTOR),
            // Five moments in two textures of four channels: LEAN mapping, section 4.
            Peer::LeanHalf => (encoded(own) + texels(grid) * 16, 2 + own, LEAN),
            Peer::LeanFloat => (encoded(own) + texels(grid) * 32, 2 + own, LEAN),
            _ => (encoded(2), 2, ISOTROPIC),
        };
        Self {
            gpu_bytes: Some(gpu_bytes),
            fetches: Some(fetches),
            operations: Some(operations),
            file_bytes: None,
            bake_seconds: None,
        }
    }
}

fn textures(material: &Material) -> Vec<&Texture> {
    let normals = match &material.bumps {
        Bumps::Normals { texture, .. } => Some(texture),
        Bumps::Offsets(ranged) => Some(&ranged.texture),
        Bumps::Flat => None,
    };
    let anisotropy = material.anisotropy.as_ref().and_then(|a| a.texture.as_ref());
    [normals, material.roughness.as_ref(), anisotropy].into_iter().flatten().collect()
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

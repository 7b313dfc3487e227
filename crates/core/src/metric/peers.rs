//! Lobes that other tools and papers make of a footprint, by their own formulas. Their quantisation is left out, since
//! it would only add to their errors, except for LEAN mapping, where storage matters.

use half::f16;

use crate::lobe::Family;
use crate::math::symmetric::{self, MohrCircle};
use crate::metric::density::Lobe;
use crate::metric::footprint::FootprintMoments;

/// Another way to make a lobe from a footprint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Peer {
    /// Averaged and renormalised normals, with unchanged roughness.
    PlainMips,
    /// M. Toksvig, "Mipmapping normal maps", 2005.
    Toksvig,
    /// Filament's `roughness-prefilter`.
    Filament,
    /// Godot's import with a normal map (`roughness/mode`).
    Godot,
    /// A von Mises-Fisher lobe, as Filament and Godot fit it, but with the constant and the space that are right for
    /// GGX: alpha'^2 = alpha^2 + 2 / kappa.
    CorrectedVmf,
    /// Unreal's composite texture, with a power of 1.
    Unreal,
    /// EA's TextureSets.
    Ea,
    /// The paper's isotropic model, uncorrected: alpha'^2 = alpha^2 + 2 lambda_1^2.
    Lambda1,
    /// The paper's D, uncorrected: A' = A + 2 K.
    D,
    /// M. Olano, D. Baker, "LEAN mapping", 2010: raw moments stored as half floats, covariance by subtraction.
    LeanHalf,
    /// LEAN mapping with moments stored as single floats.
    LeanFloat,
}

impl Peer {
    /// All peers, in the order of tables.
    pub const ALL: [Self; 11] = [
        Self::PlainMips,
        Self::Toksvig,
        Self::Filament,
        Self::Godot,
        Self::CorrectedVmf,
        Self::Unreal,
        Self::Ea,
        Self::Lambda1,
        Self::D,
        Self::LeanHalf,
        Self::LeanFloat,
    ];

    /// Returns the name that tables show.
    pub fn name(self) -> &'static str {
        match self {
            Self::PlainMips => "plain mips",
            Self::Toksvig => "Toksvig",
            Self::Filament => "Filament vMF",
            Self::Godot => "Godot vMF",
            Self::CorrectedVmf => "corrected vMF",
            Self::Unreal => "Unreal composite",
            Self::Ea => "EA TextureSets",
            Self::Lambda1 => "lambda_1, c = 1",
            Self::D => "D, c = 1",
            Self::LeanHalf => "LEAN, half",
            Self::LeanFloat => "LEAN, float",
        }
    }

    /// Returns whether the peer makes isotropic lobes of isotropic base lobes.
    pub fn is_isotropic(self) -> bool {
        !matches!(self, Self::D | Self::LeanHalf | Self::LeanFloat)
    }

    /// Returns the lobe that an engine shows, with alphas of at most 1. Peers start from the mean roughness, as mips of
    /// a roughness texture have it, and isotropic peers from the isotropic lobe of this roughness.
    pub fn lobe(self, family: Family, m: &FootprintMoments) -> Lobe {
        let [uu, uv, vv] = m.base;
        let a2 = symmetric::determinant(m.base).max(0.0).sqrt();
        let roughened = |[ku, kv, kw]: [f64; 3]| at_most_one([uu + 2.0 * ku, uv + 2.0 * kv, vv + 2.0 * kw]);
        match self {
            Self::D => Lobe::new(family, m.slope_normal(), roughened(m.covariance)),
            Self::LeanHalf => lean(family, m, &roughened, |v| {
                let largest = f64::from(f16::MAX);
                f16::from_f64(v.clamp(-largest, largest)).to_f64()
            }),
            Self::LeanFloat => lean(family, m, &roughened, |v| f64::from(v as f32)),
            Self::Lambda1 => {
                let [larger, _] = MohrCircle::from(m.covariance).eigenvalues();
                Lobe::isotropic(family, m.slope_normal(), (a2 + 2.0 * larger).min(1.0).sqrt())
            }
            _ => {
                let r = self.roughness(a2.sqrt().sqrt(), m.length()).clamp(0.0, 1.0);
                Lobe::isotropic(family, m.normal(), r * r)
            }
        }
    }

    /// Returns the perceptual roughness of the peers that know only `r` and the length of the mean normal, and `r` for
    /// the others. The formulas are those of the peers' sources (test `peers_follow_their_formulas` has values).
    pub fn roughness(self, r: f64, length: f64) -> f64 {
        let a2 = r * r * r * r;
        // A. Banerjee et al., "Clustering on the unit hypersphere using von Mises-Fisher distributions", 2005, eq. 4.4.
        let spread = (1.0 - length * length) / (length * (3.0 - length * length)).max(1e-12);
        match self {
            Self::Toksvig => {
                // ft = |N| / (|N| + s (1 - |N|)) scales the Blinn-Phong exponent s = 2 / alpha^2 - 2.
                let s = 2.0 / a2.max(1e-12) - 2.0;
                let factor = length / (length + s * (1.0 - length)).max(1e-12);
                (2.0 / (factor * s + 2.0)).sqrt().sqrt()
            }
            Self::Filament => (r * r + 2.0 * spread).sqrt(),
            Self::Godot => (r * r + (0.75 * spread).min(0.16)).sqrt(),
            Self::CorrectedVmf => (a2 + 2.0 * spread).sqrt().sqrt(),
            Self::Ea => (a2 + spread).sqrt().sqrt(),
            Self::Unreal => {
                let variance = ((1.0 - length) / length.max(1e-12) - 4e-5).max(0.0);
                let b = 2.0 * variance * (a2 - 1.0);
                ((b - a2) / (b - 1.0)).max(0.0).sqrt().sqrt()
            }
            Self::PlainMips | Self::Lambda1 | Self::D | Self::LeanHalf | Self::LeanFloat => r,
        }
    }
}

/// Returns what a LEAN shader makes of moments that went through `store`. A covariance that subtraction made negative
/// counts as 0.
fn lean(
    family: Family,
    m: &FootprintMoments,
    roughened: &dyn Fn([f64; 3]) -> [f64; 3],
    store: impl Fn(f64) -> f64,
) -> Lobe {
    let [u, v] = m.mean.map(&store);
    let [uu, uv, vv] = m.second.map(&store);
    let (ku, kw) = ((uu - u * u).max(0.0), (vv - v * v).max(0.0));
    let bound = (ku * kw).sqrt();
    Lobe::new(family, [-u, -v, 1.0], roughened([ku, (uv - u * v).clamp(-bound, bound), kw]))
}

/// Returns `a` with eigenvalues clamped to at most 1.
fn at_most_one(a: [f64; 3]) -> [f64; 3] {
    let circle = MohrCircle::from(a);
    let [major, minor] = circle.eigenvalues();
    if major <= 1.0 { a } else { circle.matrix_with([1.0, minor.clamp(0.0, 1.0)]) }
}

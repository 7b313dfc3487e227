//! What a search minimises: the total variation between the lobes about the wanted and about the decoded normal.
//!
//! Between GGX lobes of equal squared alphas A at an offset d it is sqrt(q / (q + 4)) with q = d^T A^-1 d.

use roughcast::codec::uastc::Lobe;

/// How a decoded colour becomes a normal.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Reading {
    /// The vector is normalised, and its length does not matter: as most engines read it. Offsets are exact.
    Normalised,
    /// As the encoder measures it: a quarter of engines rebuilds z from x and y, lengths other than 1 cost, the wanted
    /// normal has 8 bits, and offsets are linear in x and y (`crates/uastc/src/direction.rs` and `lobe.rs`).
    Encoder,
}

/// A texel as two rows whose squared products with a vector give q, after division by the squared product with `n`.
#[derive(Clone, Copy)]
pub struct Target {
    pub rows: [[f32; 3]; 2],
    pub n: [f32; 3],
    /// What the cost of a vector's length counts in q.
    pub factor: f32,
    /// The levels of the wanted normal, for first guesses.
    pub levels: [f32; 3],
}

/// A colour of a palette as [`Target`]s need it: a vector and the cost of its length.
pub type Entry = ([f32; 3], f32);

impl Reading {
    /// Returns the target of a texel: its vector in [-1, 1] and the lobe about it.
    pub fn target(self, texel: [f32; 3], lobe: Lobe) -> Target {
        let levels = texel.map(|c| 127.5 * f64::from(c) + 127.5);
        let vector = if self == Self::Encoder { levels.map(f64::round) } else { levels };
        let [x, y, z] = unit(vector.map(|level| level - 127.5));
        let n = [x, y, z];
        let least = if self == Self::Encoder { 127.5_f64.powi(-2) } else { 1e-8 };
        let (uu, uv, vv) = (f64::from(lobe.uu).max(least), f64::from(lobe.uv), f64::from(lobe.vv).max(least));
        let determinant = (uu * vv - uv * uv).max(uu * vv * 4e-4);
        // The inverse of A as M^T M with an upper triangle M.
        let m = [(vv / determinant).sqrt(), -uv / (vv * determinant).sqrt(), 1.0 / vv.sqrt()];
        let s = (1.0 - x * x).max(0.01).sqrt();
        let rows = match self {
            Self::Normalised => {
                let t = [s, -x * y / s, -x * z / s];
                let b = [y * t[2] - z * t[1], z * t[0] - x * t[2], x * t[1] - y * t[0]];
                [[0, 1, 2].map(|c| m[0] * t[c] + m[1] * b[c]), b.map(|b| m[2] * b)]
            }
            Self::Encoder => {
                // A change (dx, dy) of a unit normal moves it by dx / s along T.
                // It moves it by (x y dx + s^2 dy) / (s z) along B.
                let z = z.max(0.1);
                let b = [x * y / (s * z), s / z];
                let [p, q] = [[m[0] / s + m[1] * b[0], m[1] * b[1]], [m[2] * b[0], m[2] * b[1]]];
                [p, q].map(|[dx, dy]| [dx, dy, -dx * x - dy * y])
            }
        };
        Target {
            rows: rows.map(|row| row.map(|c| c as f32)),
            n: if self == Self::Encoder { [0.0, 0.0, 1.0] } else { n.map(|c| c as f32) },
            factor: determinant.sqrt().recip() as f32,
            levels: levels.map(|level| level as f32),
        }
    }

    /// Returns the entry of a decoded colour.
    pub fn entry(self, colour: [u8; 3]) -> Entry {
        let [x, y, z] = colour.map(|level| (f32::from(level) - 127.5) / 127.5);
        if self == Self::Normalised {
            return ([x, y, z], 0.0);
        }
        const REBUILT: f32 = 0.25;
        let flat = x * x + y * y;
        let length = (flat + z * z).sqrt();
        let rebuilt = [x, y, (1.0 - flat).max(0.0).sqrt()];
        let read = [x / length, y / length, z / length];
        let between: f32 = (0..3).map(|c| (read[c] - rebuilt[c]).powi(2)).sum();
        let penalty = if length < 1.0 { 0.4 } else { 0.1 };
        let loss = penalty * (length - 1.0).powi(2) + REBUILT * (1.0 - REBUILT) * between;
        let [x, y] = [0, 1].map(|c| (1.0 - REBUILT) * read[c] + REBUILT * rebuilt[c]);
        ([x, y, 1.0], loss)
    }
}

impl Target {
    /// Returns q of an entry.
    #[inline(always)]
    pub fn squared(&self, &(v, loss): &Entry) -> f32 {
        let dot = |row: &[f32; 3]| row[0] * v[0] + row[1] * v[1] + row[2] * v[2];
        let (p, q, along) = (dot(&self.rows[0]), dot(&self.rows[1]), dot(&self.n).max(1e-3));
        (p * p + q * q + loss * self.factor) / (along * along)
    }
}

/// Returns the total variation at squared distance `q`.
#[inline(always)]
pub fn total_variation(q: f32) -> f32 {
    (q / (q + 4.0)).sqrt()
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = v.iter().map(|c| c * c).sum::<f64>().sqrt();
    v.map(|c| c / length)
}

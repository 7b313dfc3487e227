//! Synthetic distributions of offsets, to which the correction tables are fitted.

/// A small generator of random numbers (G. Steele et al., "Fast splittable pseudorandom number generators", 2014).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns a number distributed evenly in (low, high).
    pub fn range(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.bits() >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    fn normal(&mut self) -> f64 {
        let (radius, angle) = (self.range(0.0, 1.0), self.range(0.0, std::f64::consts::TAU));
        (-2.0 * libm::log(radius)).sqrt() * libm::cos(angle)
    }

    /// Returns a number of Student's t distribution: a normal number over the root of a chi square over its degrees of
    /// freedom.
    fn student(&mut self, degrees: usize) -> f64 {
        let chi: f64 = (0..degrees).map(|_| self.normal().powi(2)).sum();
        self.normal() / (chi / degrees as f64).sqrt()
    }
}

/// A distribution along one axis, with its parameters drawn.
enum Family {
    Normal,
    Uniform,
    /// Slopes of a sine wave.
    Sine,
    /// Two slopes, the second one with this probability, each blurred: V-grooves and facets.
    TwoPoint {
        second: f64,
        blur: f64,
    },
    /// A long gentle ramp and a short steep return, blurred.
    SawTooth {
        steep: f64,
        blur: f64,
    },
    Student {
        degrees: usize,
    },
    Laplace,
    /// Smooth with this probability, else rough: scratches and pores.
    Mixture {
        rough: f64,
        smooth: f64,
    },
    /// Smooth with this probability, else rough with an offset mean: grooves lit from one side, edges of bricks.
    Lopsided {
        rough: f64,
        smooth: f64,
        spread: f64,
        offset: f64,
    },
}

impl Family {
    fn draw(r: &mut Random) -> Self {
        match r.below(9) {
            0 => Self::Normal,
            1 => Self::Uniform,
            2 => Self::Sine,
            3 => Self::TwoPoint { second: r.range(0.05, 0.95), blur: r.range(0.1, 0.6) },
            4 => Self::SawTooth { steep: r.range(0.02, 0.5), blur: r.range(0.2, 0.6) },
            5 => Self::Student { degrees: [3, 4, 6, 10][r.below(4)] },
            6 => Self::Laplace,
            7 => Self::Mixture { rough: r.range(0.03, 0.6), smooth: r.range(0.15, 0.6) },
            _ => Self::Lopsided {
                rough: r.range(0.03, 0.5),
                smooth: r.range(0.15, 0.7),
                spread: r.range(0.0, 1.0),
                offset: r.range(0.0, 3.0),
            },
        }
    }

    fn sample(&self, r: &mut Random) -> f64 {
        match *self {
            Self::Normal => r.normal(),
            Self::Uniform => r.range(-1.0, 1.0),
            Self::Sine => libm::sin(r.range(0.0, std::f64::consts::TAU)),
            Self::TwoPoint { second, blur } => f64::from(r.range(0.0, 1.0) < second) + blur * r.normal(),
            Self::SawTooth { steep, blur } => {
                let slope = if r.range(0.0, 1.0) < steep { 1.0 - 1.0 / steep } else { 1.0 };
                slope + blur * r.normal()
            }
            Self::Student { degrees } => r.student(degrees),
            Self::Laplace => libm::log(r.range(0.0, 1.0)) * if r.below(2) == 0 { 1.0 } else { -1.0 },
            Self::Mixture { rough, smooth } => r.normal() * if r.range(0.0, 1.0) < rough { 1.0 } else { smooth },
            Self::Lopsided { rough, smooth, spread, offset } => {
                if r.range(0.0, 1.0) < rough {
                    offset + spread * r.normal()
                } else {
                    smooth * r.normal()
                }
            }
        }
    }
}

/// Draws the offsets of one footprint, of mean 0, and of deviations 1 and at most 1 along rotated axes. Half of the
/// footprints have independent axes, and half have one roughness for both axes.
pub fn footprint(r: &mut Random) -> Vec<[f64; 2]> {
    let count = [16, 64, 64, 256, 256][r.below(5)];
    let mut offsets: Vec<[f64; 2]> = if r.below(2) == 0 {
        let families = [Family::draw(r), Family::draw(r)];
        (0..count).map(|_| [families[0].sample(r), families[1].sample(r)]).collect()
    } else {
        // Each texel has a scale; the rougher half may lean to one side.
        let lean = if r.below(5) < 3 { [0.0; 2] } else { [r.range(-2.0, 2.0), r.range(-2.0, 2.0)] };
        let scales: Vec<f64> = match r.below(4) {
            0 => vec![1.0; count],
            1 => {
                let degrees = [3, 4, 6, 10][r.below(4)];
                (0..count).map(|_| r.student(degrees).abs()).collect()
            }
            2 => (0..count).map(|_| -libm::log(r.range(0.0, 1.0))).collect(),
            _ => {
                let (rough, smooth) = (r.range(0.03, 0.6), r.range(0.15, 0.6));
                (0..count).map(|_| r.normal().abs() * if r.range(0.0, 1.0) < rough { 1.0 } else { smooth }).collect()
            }
        };
        let mut sorted = scales.clone();
        sorted.sort_by(f64::total_cmp);
        let median = sorted[count / 2];
        let leaning = |scale: f64, axis: usize| if scale > median { lean[axis] } else { 0.0 };
        scales.iter().map(|s| [s * r.normal() + leaning(*s, 0), s * r.normal() + leaning(*s, 1)]).collect()
    };
    let minor = libm::pow(10.0, r.range(-1.5, 0.0));
    for (axis, length) in [1.0, minor].into_iter().enumerate() {
        let mean = offsets.iter().map(|o| o[axis]).sum::<f64>() / count as f64;
        let variance = offsets.iter().map(|o| (o[axis] - mean).powi(2)).sum::<f64>() / count as f64;
        let scale = if variance > 1e-12 { length / variance.sqrt() } else { 0.0 };
        offsets.iter_mut().for_each(|o| o[axis] = (o[axis] - mean) * scale);
    }
    let (sin, cos) = libm::sincos(r.range(0.0, std::f64::consts::PI));
    offsets.into_iter().map(|[x, y]| [x * cos - y * sin, x * sin + y * cos]).collect()
}

/// Offset, in any unit, at a probability.
type Quantile = fn(f64) -> f64;

/// Distributions with a column of their own, by their quantiles.
pub const COLUMNS: [(&str, Quantile); 2] = [("normal", normal_quantile), ("uniform", |p| p - 0.5)];

/// Inverts the distribution function by bisection.
fn normal_quantile(p: f64) -> f64 {
    let below = |x: f64| 0.5 * libm::erfc(-x / std::f64::consts::SQRT_2);
    let (mut low, mut high) = (-8.0, 8.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if below(middle) < p { low = middle } else { high = middle }
    }
    low
}

//! Filtering of the surroundings by a lobe.

use std::f64::consts::PI;

use super::environment::{Environment, Radiance};
use super::shade::{EnvironmentFilter, Reflection, View, Weight};
use crate::math::symmetric::Symmetric2;
use crate::math::vector::{Vector, combine, dot, normalised};

/// Facets of [`EnvironmentFilter::Facets`].
const FACETS: u32 = 32;

/// Blur of a facet's look-up, in deviations of a disc with its share of the lobe. With less the facets show apart, and
/// with more a sharp lobe is too wide.
const BLUR: f64 = 1.4;

/// Maximum number of look-ups along the ellipse.
const MAX_TAPS: f64 = 16.0;

/// Scales of the normal distributions whose mixture approximates GGX. GGX slopes are bivariate Student t with 2 degrees
/// of freedom: normal variables divided by the square root of an exponential variable. Each scale is 1 over the mean of
/// that variable within one of its quarters.
const GGX_SCALES: [f32; 4] = [7.302, 2.098, 1.0, 0.4191];

impl View<'_> {
    /// Returns the radiance that the point reflects from the surroundings, filtered by the lobe. `to_world` rotates
    /// directions from the tangent frame into the world.
    pub fn from_environment(&self, environment: &Environment, to_world: &impl Fn(Vector) -> Vector) -> Radiance {
        match self.shader.filter {
            EnvironmentFilter::Facets => self.filter_by_facets(environment, to_world),
            EnvironmentFilter::Ellipse => {
                self.mean_over_scales(|k| self.filter_along_ellipse(k, environment, to_world))
            }
            EnvironmentFilter::Lambda1 => self.mean_over_scales(|k| {
                let lambda_1 = f64::from(k.eigen().major.max(0.0)).sqrt();
                self.look_up([0.0; 2], 2.0 * lambda_1, environment, to_world)
            }),
        }
    }

    /// Returns the mean of `filtered(K)` over the normal distributions whose mixture is the lobe.
    fn mean_over_scales(&self, filtered: impl Fn(Symmetric2) -> Radiance) -> Radiance {
        let scales = match self.shader.reflection {
            Reflection::Ggx => GGX_SCALES.as_slice(),
            _ => &[1.0],
        };
        let mut sum = [0.0; 3];
        for &scale in scales {
            let value = filtered(scale * self.k);
            sum = [0, 1, 2].map(|i| sum[i] + value[i] / scales.len() as f64);
        }
        sum
    }

    /// Filters the surroundings along the ellipse of reflected rays. A slope s turns the reflection by 2 s in the plane
    /// of view and normal, and by 2 (n.v) s across that plane.
    fn filter_along_ellipse(
        &self,
        k: Symmetric2,
        environment: &Environment,
        to_world: &impl Fn(Vector) -> Vector,
    ) -> Radiance {
        let [x, y] = [dot(self.view, self.axes[0]), dot(self.view, self.axes[1])];
        let length = (x * x + y * y).sqrt();
        let [x, y] = if length > 1e-9 { [x / length, y / length] } else { [1.0, 0.0] };
        let (uu, uv, vv) = (f64::from(k.uu), f64::from(k.uv), f64::from(k.vv));
        // K in the plane of view and normal, and across that plane.
        let plane = uu * x * x + 2.0 * uv * x * y + vv * y * y;
        let mixed = (vv - uu) * x * y + uv * (x * x - y * y);
        let across = uu * y * y - 2.0 * uv * x * y + vv * x * x;
        let c = self.facing;
        let rays = Symmetric2::new((4.0 * plane) as f32, (4.0 * c * mixed) as f32, (4.0 * c * c * across) as f32);
        let ellipse = rays.eigen();
        let (long, short) = (f64::from(ellipse.major.max(0.0)).sqrt(), f64::from(ellipse.minor).sqrt());
        let count = (2.0 * long / short.max(1e-9)).ceil().clamp(1.0, MAX_TAPS) as u32;
        if count <= 2 {
            return self.look_up([0.0; 2], long, environment, to_world);
        }
        // The blur is at least the distance of the taps.
        let blur = short.max(2.5 * long / f64::from(count));
        let spread = (long * long - blur * blur).max(0.0).sqrt();
        let [a, b] = ellipse.axis.map(f64::from);
        // The slope that turns a ray by a unit along the longer axis of the ellipse.
        let (in_plane, beside) = (0.5 * a, 0.5 * b / c);
        let slope = [in_plane * x - beside * y, in_plane * y + beside * x];
        let mut sum = [0.0; 3];
        for tap in 0..count {
            let t = spread * normal_quantile((f64::from(tap) + 0.5) / f64::from(count));
            let value = self.look_up([t * slope[0], t * slope[1]], blur, environment, to_world);
            sum = [0, 1, 2].map(|i| sum[i] + value[i] / f64::from(count));
        }
        sum
    }

    /// Returns the radiance that a facet with this slope about the normal reflects from the surroundings. The blur is
    /// that of facets whose slopes turn reflections by `deviation`, as long as the slopes are small.
    fn look_up(
        &self,
        [u, v]: [f64; 2],
        deviation: f64,
        environment: &Environment,
        to_world: &impl Fn(Vector) -> Vector,
    ) -> Radiance {
        let facet = normalised(combine([u, v, 1.0], self.axes));
        let deviation = 2.0 * libm::atan(0.5 * deviation);
        self.reflect(facet, |d| environment.filtered(to_world(d), deviation), Weight::AllFacets)
    }

    /// Samples facets from the lobe and looks up what each reflects. The blur of a look-up is that of a disc with the
    /// solid angle that one sample stands for (J. Křivánek, M. Colbert, "Real-time shading with filtered importance
    /// sampling", 2008).
    fn filter_by_facets(&self, environment: &Environment, to_world: &impl Fn(Vector) -> Vector) -> Radiance {
        let visible = self.visible_facets();
        let mut sum = [0.0; 3];
        for i in 0..FACETS {
            // The points of Hammersley.
            let azimuth = f64::from(i.reverse_bits()) / (1u64 << 32) as f64;
            let at = [(f64::from(i) + 0.5) / f64::from(FACETS), azimuth];
            let (facet, weight) = match self.shader.reflection {
                Reflection::Ggx => (visible.sample(at), Weight::VisibleFacets),
                _ => (self.lobe.sample(at), Weight::AllFacets),
            };
            let seen = dot(self.view, facet).max(0.0);
            let all = self.lobe.density(facet);
            let density = match weight {
                Weight::AllFacets => all,
                Weight::VisibleFacets => all * seen / (dot(facet, self.axes[2]) * self.facing * (1.0 + self.hidden)),
            };
            // Reflection spreads the solid angle of facets by 4 (v.h) (Walter et al., eq. 14).
            let solid_angle = 4.0 * seen / (f64::from(FACETS) * density.max(1e-12));
            let deviation = (0.5 * (solid_angle / PI).sqrt()).min(1.0);
            let value = self.reflect(facet, |d| environment.filtered(to_world(d), BLUR * deviation), weight);
            sum = [0, 1, 2].map(|c| sum[c] + value[c] / f64::from(FACETS));
        }
        sum
    }
}

/// Returns the quantile of the standard normal distribution with an error below 4.5e-4 (M. Abramowitz, I. Stegun,
/// "Handbook of mathematical functions", 26.2.23).
fn normal_quantile(p: f64) -> f64 {
    let t = (-2.0 * libm::log(p.min(1.0 - p))).sqrt();
    let x = t - (2.515517 + t * (0.802853 + t * 0.010328)) / (1.0 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
    if p < 0.5 { -x } else { x }
}

//! Shading by lobes: what a point sends to the eye of a light, and of the surroundings.
//!
//! GGX and Beckmann as glTF 2.0, appendix B has them for metals: D F G / (4 (n.l) (n.v)) (n.l), with Schlick's Fresnel
//! term and Smith's height-correlated shadowing, stretched as in E. Heitz, "Understanding the masking-shadowing function
//! in microfacet-based BRDFs", 2014, sections 5.3 and 6.1. Everything is in the tangent frame (T, B, N) of a point.

use super::environment::{Environment, Radiance};
use super::material::Point;
use crate::lobe::Factor;
use crate::lobe::Family;
use crate::lobe::blinn_phong::{elliptical_cos2, printed_cos2};
use crate::math::symmetric::Symmetric2;
use crate::math::vector::{Vector, combine, cross, dot, frame, normalised};
use crate::metric::Lobe;

/// Which lobe reflects.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Reflection {
    /// GGX, as glTF prescribes.
    #[default]
    Ggx,
    /// Beckmann: normally distributed slopes.
    Beckmann,
    /// The paper's modified Blinn-Phong with the ellipse's own radius (its appendix A, corrected), without Fresnel and
    /// shadowing terms.
    BlinnPhong,
    /// The same with the angle as the paper prints it.
    BlinnPhongPrinted,
}

/// What of a lobe filters the surroundings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum EnvironmentFilter {
    /// lambda_1 picks the level: one look-up, as blurred along every axis as the lobe is along its longest.
    Lambda1,
    /// D: several look-ups along the longer axis of the ellipse of reflected rays, as blurred as its shorter axis asks.
    #[default]
    Ellipse,
}

/// How points are shaded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shader {
    /// The lobe.
    pub reflection: Reflection,
    /// What filters the surroundings.
    pub filter: EnvironmentFilter,
    /// Reflectance at normal incidence: 0.9 for a metal, 0.02 for water.
    pub f0: f64,
}

/// Least cosine between a normal and the direction of the eye. Normals of bumps that face away are turned this far towards
/// it: what is seen there are other bumps, and engines, too, go on shading.
const MIN_FACING: f64 = 1e-3;

/// Most look-ups along the ellipse.
const MAX_TAPS: f64 = 16.0;

/// GGX is a mixture of normal distributions: slopes are a bivariate Student t with 2 degrees of freedom, normal ones over
/// the square root of an exponential variable. These are 1 over its means within its quarters.
const GGX_SCALES: [f32; 4] = [7.302, 2.098, 1.0, 0.4191];

/// A point with its lobe, as seen from one direction.
pub struct View<'a> {
    shader: &'a Shader,
    lobe: Lobe,
    /// K of the lobe: half its squared alphas.
    k: Symmetric2,
    axes: [Vector; 3],
    view: Vector,
    /// n.v
    facing: f64,
}

/// How a facet was drawn, which decides on its weight.
#[derive(Clone, Copy)]
enum Weight {
    /// From D(h) (n.h): F G (v.h) / ((n.v) (n.h)) (B. Walter et al., "Microfacet models for refraction through rough
    /// surfaces", 2007, eq. 41).
    OfAll,
    /// From the facets that the eye sees: F G / G1.
    OfVisible,
}

impl Shader {
    /// `point` seen along the unit vector `view`, which points to the eye.
    pub fn view(&self, point: &Point, view: Vector) -> View<'_> {
        let family = match self.reflection {
            Reflection::Ggx => Family::Ggx,
            _ => Family::Beckmann,
        };
        let lack = (MIN_FACING - dot(point.normal, view)).max(0.0);
        let normal = normalised([0, 1, 2].map(|i| point.normal[i] + lack * view[i]));
        let lobe = Lobe::new(family, normal, point.squared_alpha);
        let [uu, uv, vv] = lobe.squared_alpha().map(|a| (0.5 * a) as f32);
        let facing = dot(normal, view).max(1e-6);
        View { shader: self, lobe, k: Symmetric2::new(uu, uv, vv), axes: frame(normal), view, facing }
    }
}

impl View<'_> {
    /// What the eye sees of the facet of a bump, in parts of the area that it lies over: (n.v) / (n.N). Microfacet lobes are
    /// means over facets with these weights (Heitz, eq. 8 to 15: they are what D G / (n.v) stands for), so the mean over bumps
    /// that a lobe is compared with must have them, too: without, bumps at grazing angles that other bumps hide outshine
    /// all others. 1 for the paper's Blinn-Phong, which knows no visibility.
    pub fn visible_area(&self) -> f64 {
        match self.shader.reflection {
            Reflection::Ggx | Reflection::Beckmann => self.facing / self.axes[2][2].max(MIN_FACING),
            Reflection::BlinnPhong | Reflection::BlinnPhongPrinted => 1.0,
        }
    }

    /// Share of the light from the unit vector `light` that goes to the eye, per steradian, times the cosine.
    pub fn of_light(&self, light: Vector) -> f64 {
        let lit = dot(self.axes[2], light);
        if lit <= 0.0 {
            return 0.0;
        }
        let half = normalised([0, 1, 2].map(|i| self.view[i] + light[i]));
        let cosine = dot(half, self.axes[2]);
        match self.shader.reflection {
            Reflection::Ggx | Reflection::Beckmann => {
                let distribution = self.lobe.density(half) / cosine;
                distribution * self.fresnel(half) * self.unshadowed(light, lit) / (4.0 * self.facing)
            }
            Reflection::BlinnPhong | Reflection::BlinnPhongPrinted => {
                // f(cos^2) = exp(-tan^2/2) makes highlights normal densities of slopes; 1/(2 pi sqrt|K|) keeps their
                // light alike at every roughness, and a quarter of it per half-vector goes to a light's direction.
                let d = [dot(half, self.axes[0]), dot(half, self.axes[1])].map(|c| c as f32);
                let (cos2, factor) = ((cosine * cosine) as f32, Factor::of(self.k));
                let modified = if self.shader.reflection == Reflection::BlinnPhong {
                    elliptical_cos2(cos2, d, factor)
                } else {
                    printed_cos2(cos2, d, factor)
                };
                let highlight = libm::exp(-0.5 * (1.0 / f64::from(modified) - 1.0));
                let peak = 1.0 / (std::f64::consts::TAU * f64::from(self.k.determinant()).sqrt());
                0.25 * peak * highlight * lit
            }
        }
    }

    /// What the surroundings send to the eye, filtered as the lobe asks. `to_world` turns directions.
    pub fn of_environment(&self, environment: &Environment, to_world: &dyn Fn(Vector) -> Vector) -> Radiance {
        let scales = match self.shader.reflection {
            Reflection::Ggx => GGX_SCALES.as_slice(),
            _ => &[1.0],
        };
        let mut sum = [0.0; 3];
        for &scale in scales {
            let k = scale * self.k;
            let value = match self.shader.filter {
                EnvironmentFilter::Lambda1 => {
                    let lambda_1 = f64::from(k.eigen().major.max(0.0)).sqrt();
                    self.look_up([0.0; 2], 2.0 * lambda_1, environment, to_world)
                }
                EnvironmentFilter::Ellipse => self.along_the_ellipse(k, environment, to_world),
            };
            sum = [0, 1, 2].map(|i| sum[i] + value[i] / scales.len() as f64);
        }
        sum
    }

    /// The ellipse of reflected rays: a slope s turns the reflection by 2 s in the plane of view and normal, and by
    /// 2 (n.v) s across it.
    fn along_the_ellipse(
        &self,
        k: Symmetric2,
        environment: &Environment,
        to_world: &dyn Fn(Vector) -> Vector,
    ) -> Radiance {
        let [x, y] = [dot(self.view, self.axes[0]), dot(self.view, self.axes[1])];
        let length = (x * x + y * y).sqrt();
        let [x, y] = if length > 1e-9 { [x / length, y / length] } else { [1.0, 0.0] };
        let (uu, uv, vv) = (f64::from(k.uu), f64::from(k.uv), f64::from(k.vv));
        // K in the plane of view and normal, and across it.
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
        // No narrower than taps are apart.
        let blur = short.max(2.5 * long / f64::from(count));
        let spread = (long * long - blur * blur).max(0.0).sqrt();
        let [a, b] = ellipse.axis.map(f64::from);
        // Back from a turn of the ray to the slope that causes it.
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

    /// What a facet of this slope about the normal reflects of the surroundings, blurred by facets whose slopes turn
    /// reflections by `deviation` as long as they are small.
    fn look_up(
        &self,
        [u, v]: [f64; 2],
        deviation: f64,
        environment: &Environment,
        to_world: &dyn Fn(Vector) -> Vector,
    ) -> Radiance {
        let facet = normalised(combine([u, v, 1.0], self.axes));
        let deviation = 2.0 * libm::atan(0.5 * deviation);
        self.by_facet(facet, &|d| environment.filtered(to_world(d), deviation), Weight::OfAll)
    }

    /// The exact counterpart of [`Self::of_environment`] for one facet, drawn from the lobe by a point of the unit square:
    /// the mean over even points is the integral.
    pub fn of_environment_at(
        &self,
        at: [f64; 2],
        environment: &Environment,
        to_world: &dyn Fn(Vector) -> Vector,
    ) -> Radiance {
        let radiance = |d: Vector| environment.radiance(to_world(d));
        match self.shader.reflection {
            Reflection::Ggx => self.by_facet(self.visible_facet(at), &radiance, Weight::OfVisible),
            _ => self.by_facet(self.lobe.sample(at), &radiance, Weight::OfAll),
        }
    }

    /// A facet of a GGX lobe drawn from those that the eye sees (E. Heitz, "Sampling the GGX distribution of visible
    /// normals", 2018), for any factor S of A = S S^T in the place of diag(alpha_x, alpha_y). Half-vectors drawn from D
    /// would weigh F G (v.h) / ((n.v) (n.h)), which has no bound near grazing views.
    fn visible_facet(&self, [radial, turn]: [f64; 2]) -> Vector {
        let [uu, uv, vv] = self.lobe.squared_alpha();
        let l = uu.sqrt();
        let (m, r) = (uv / l, (vv - uv * uv / uu).max(0.0).sqrt());
        let [x, y, z] = self.axes.map(|axis| dot(axis, self.view));
        let eye = normalised([l * x + m * y, r * y, z]);
        let length = (eye[0] * eye[0] + eye[1] * eye[1]).sqrt();
        let first = if length > 0.0 { [-eye[1] / length, eye[0] / length, 0.0] } else { [1.0, 0.0, 0.0] };
        let second = cross(eye, first);
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * turn);
        let (p, q) = (radial.sqrt() * cos, radial.sqrt() * sin);
        let share = 0.5 * (1.0 + eye[2]);
        let q = (1.0 - share) * (1.0 - p * p).max(0.0).sqrt() + share * q;
        let facet = combine([p, q, (1.0 - p * p - q * q).max(0.0).sqrt()], [first, second, eye]);
        let [x, y, z] = [l * facet[0], m * facet[0] + r * facet[1], facet[2].max(1e-6)];
        normalised(combine([x, y, z], self.axes))
    }

    /// What `facet` reflects to the eye, weighted for how it was drawn.
    fn by_facet(&self, facet: Vector, radiance: &dyn Fn(Vector) -> Radiance, weight: Weight) -> Radiance {
        let seen = dot(self.view, facet);
        let light = [0, 1, 2].map(|i| 2.0 * seen * facet[i] - self.view[i]);
        let lit = dot(light, self.axes[2]);
        if seen <= 0.0 || lit <= 0.0 {
            return [0.0; 3];
        }
        let weight = match (self.shader.reflection, weight) {
            (Reflection::BlinnPhong | Reflection::BlinnPhongPrinted, _) => 1.0,
            (_, Weight::OfAll) => {
                self.fresnel(facet) * self.unshadowed(light, lit) * seen / (self.facing * dot(facet, self.axes[2]))
            }
            (_, Weight::OfVisible) => {
                let visible = 1.0 / (1.0 + self.lambda(self.view, self.facing));
                self.fresnel(facet) * self.unshadowed(light, lit) / visible
            }
        };
        radiance(light).map(|r| weight * r)
    }

    /// C. Schlick, "An inexpensive BRDF model for physically-based rendering", 1994, eq. 15.
    fn fresnel(&self, half: Vector) -> f64 {
        let x = (1.0 - dot(self.view, half)).clamp(0.0, 1.0);
        self.shader.f0 + (1.0 - self.shader.f0) * (x * x) * (x * x) * x
    }

    /// Smith's height-correlated G = 1 / (1 + Lambda(v) + Lambda(l)) (Heitz, eq. 99).
    fn unshadowed(&self, light: Vector, lit: f64) -> f64 {
        1.0 / (1.0 + self.lambda(self.view, self.facing) + self.lambda(light, lit))
    }

    /// Heitz, eq. 72 for GGX; for Beckmann the rational fit beside it, with a = 1 / (alpha tan).
    fn lambda(&self, d: Vector, cosine: f64) -> f64 {
        let (x, y) = (dot(d, self.axes[0]), dot(d, self.axes[1]));
        let [uu, uv, vv] = self.lobe.squared_alpha();
        let squared = (uu * x * x + 2.0 * uv * x * y + vv * y * y) / (cosine * cosine);
        match self.shader.reflection {
            Reflection::Ggx => 0.5 * ((1.0 + squared).sqrt() - 1.0),
            _ => {
                let a = 1.0 / squared.max(1e-12).sqrt();
                if a < 1.6 { (1.0 - 1.259 * a + 0.396 * a * a) / (3.535 * a + 2.181 * a * a) } else { 0.0 }
            }
        }
    }
}

/// Quantile of the standard normal distribution, its error below 4.5e-4 (M. Abramowitz, I. Stegun, "Handbook of mathematical
/// functions", 26.2.23).
fn normal_quantile(p: f64) -> f64 {
    let t = (-2.0 * libm::log(p.min(1.0 - p))).sqrt();
    let x = t - (2.515517 + t * (0.802853 + t * 0.010328)) / (1.0 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
    if p < 0.5 { -x } else { x }
}

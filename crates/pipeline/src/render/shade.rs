//! Shading by lobes: the light that a point reflects to the eye from a light and from the surroundings.
//!
//! GGX and Beckmann follow glTF 2.0, appendix B, for metals: D F G / (4 (n.l) (n.v)) (n.l), with Schlick's Fresnel term
//! and Smith's height-correlated masking-shadowing. Anisotropic lobes are stretched as in E. Heitz, "Understanding the
//! masking-shadowing function in microfacet-based BRDFs", 2014, sections 5.3 and 6.1. All directions are in the tangent
//! frame (T, B, N) of a point.

use super::environment::{Environment, Radiance};
use super::material::Point;
use crate::lobe::Factor;
use crate::lobe::Family;
use crate::lobe::blinn_phong::{elliptical_cos2, printed_cos2};
use crate::math::symmetric::Symmetric2;
use crate::math::vector::{Vector, combine, cross, dot, frame, normalised};
use crate::metric::Lobe;

/// The reflecting lobe.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, clap::ValueEnum)]
pub enum Reflection {
    /// GGX, as glTF prescribes.
    #[default]
    Ggx,
    /// Beckmann: normally distributed slopes.
    #[value(help = "Normally distributed slopes")]
    Beckmann,
    /// The paper's modified Blinn-Phong with the radius of the ellipse (its appendix A, corrected), without Fresnel and
    /// masking-shadowing terms.
    #[value(help = "The paper's modified Blinn-Phong with the ellipse's own radius")]
    BlinnPhong,
    /// The paper's modified Blinn-Phong with the angle as the paper prints it.
    #[value(help = "The same with the angle as the paper prints it, which is wrong unless the lobe is isotropic")]
    BlinnPhongPrinted,
}

/// The part of a lobe that filters the surroundings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, clap::ValueEnum)]
pub enum EnvironmentFilter {
    /// Facets are sampled from the lobe, and each has the blur of its share of the lobe. No shape of the lobe is
    /// assumed, so that the result is close to the exact integral.
    #[default]
    #[value(help = "Facets sampled from the whole lobe, close to the exact integral")]
    Facets,
    /// lambda_1 selects the level of one look-up, which blurs every axis as much as the longest axis of the lobe.
    #[value(help = "lambda_1 picks the mip level of the environment")]
    Lambda1,
    /// D gives several look-ups along the longer axis of the ellipse of reflected rays. The shorter axis gives their
    /// blur.
    #[value(help = "D spreads taps along the ellipse of reflected rays")]
    Ellipse,
}

/// How points are shaded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shader {
    /// The lobe.
    pub reflection: Reflection,
    /// The filter of the surroundings.
    pub filter: EnvironmentFilter,
    /// Reflectance at normal incidence: 0.9 for a metal, 0.02 for water.
    pub f0: f64,
}

/// Smallest cosine between a normal and the direction to the eye. A normal that faces away is turned until it has this
/// cosine: the eye sees other bumps in such a place, and engines shade it, too.
pub(super) const MIN_FACING: f64 = 1e-3;

/// A point with its lobe, as seen from one direction.
pub struct View<'a> {
    pub(super) shader: &'a Shader,
    pub(super) lobe: Lobe,
    /// K of the lobe: half its squared alphas.
    pub(super) k: Symmetric2,
    pub(super) axes: [Vector; 3],
    pub(super) view: Vector,
    /// n.v
    pub(super) facing: f64,
    /// Lambda of the direction to the eye: how much of the surface other bumps hide.
    pub(super) hidden: f64,
}

/// The distribution that a facet was sampled from, which gives its weight.
#[derive(Clone, Copy)]
pub(super) enum Weight {
    /// All facets, D(h) (n.h). The weight is F G (v.h) / ((n.v) (n.h)) (B. Walter et al., "Microfacet models for
    /// refraction through rough surfaces", 2007, eq. 41).
    AllFacets,
    /// Facets that are visible to the eye. The weight is F G / G1.
    VisibleFacets,
}

impl Shader {
    /// Prepares shading of `point` for the unit vector `view` to the eye.
    pub fn view(&self, point: &Point, view: Vector) -> View<'_> {
        let family = match self.reflection {
            Reflection::Ggx => Family::Ggx,
            _ => Family::Beckmann,
        };
        let missing = (MIN_FACING - dot(point.normal, view)).max(0.0);
        let normal = match missing {
            0.0 => point.normal,
            _ => normalised([0, 1, 2].map(|i| point.normal[i] + missing * view[i])),
        };
        let lobe = Lobe::new(family, normal, point.squared_alpha);
        let [uu, uv, vv] = lobe.squared_alpha().map(|a| (0.5 * a) as f32);
        let facing = dot(normal, view).max(1e-6);
        let k = Symmetric2::new(uu, uv, vv);
        let view = View { shader: self, lobe, k, axes: frame(normal), view, facing, hidden: 0.0 };
        View { hidden: view.lambda(view.view, facing), ..view }
    }
}

impl View<'_> {
    /// Returns the projected area of a bump's facet towards the eye, relative to the area under the bump: (n.v) /
    /// (n.N).
    ///
    /// Microfacet lobes are means over facets with these weights (Heitz, eq. 8 to 15: D G / (n.v) contains them). The
    /// mean over bumps that a lobe is compared with needs the same weights: without them, bumps at grazing angles that
    /// other bumps hide outshine all others. The weight is 1 for the paper's Blinn-Phong, which has no visibility.
    pub fn visible_area(&self) -> f64 {
        match self.shader.reflection {
            Reflection::Ggx | Reflection::Beckmann => self.facing / self.axes[2][2].max(MIN_FACING),
            Reflection::BlinnPhong | Reflection::BlinnPhongPrinted => 1.0,
        }
    }

    /// Returns the BRDF for the unit vector `light` to the light (per steradian), times the cosine.
    pub fn from_light(&self, light: Vector) -> f64 {
        let lit = dot(self.axes[2], light);
        if lit <= 0.0 {
            return 0.0;
        }
        let half = normalised([0, 1, 2].map(|i| self.view[i] + light[i]));
        let cosine = dot(half, self.axes[2]);
        match self.shader.reflection {
            Reflection::Ggx | Reflection::Beckmann => {
                let distribution = self.lobe.density(half) / cosine;
                distribution * self.fresnel(half) * self.masking_shadowing(light, lit) / (4.0 * self.facing)
            }
            Reflection::BlinnPhong | Reflection::BlinnPhongPrinted => {
                // f(cos^2) = exp(-tan^2/2) makes highlights normal densities of slopes. The factor 1/(2 pi sqrt|K|)
                // keeps their energy the same at every roughness. From half-vectors to light directions it is 1/4.
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

    /// Returns the unfiltered radiance that one facet reflects from the surroundings. The point `at` of the unit square
    /// samples the facet from the lobe; the mean over evenly spread points is the exact value of
    /// [`Self::from_environment`].
    pub fn sample_environment(
        &self,
        at: [f64; 2],
        environment: &Environment,
        to_world: &impl Fn(Vector) -> Vector,
    ) -> Radiance {
        let radiance = |d: Vector| environment.radiance(to_world(d));
        match self.shader.reflection {
            Reflection::Ggx => self.reflect(self.visible_facets().sample(at), radiance, Weight::VisibleFacets),
            _ => self.reflect(self.lobe.sample(at), radiance, Weight::AllFacets),
        }
    }

    /// Prepares to sample facets of a GGX lobe from those that the eye sees. Half-vectors sampled from D would have the
    /// weight F G (v.h) / ((n.v) (n.h)), which is unbounded near grazing views.
    pub(super) fn visible_facets(&self) -> VisibleFacets<'_> {
        let [uu, uv, vv] = self.lobe.squared_alpha();
        let l = uu.sqrt();
        let (m, r) = (uv / l, (vv - uv * uv / uu).max(0.0).sqrt());
        let [x, y, z] = self.axes.map(|axis| dot(axis, self.view));
        let eye = normalised([l * x + m * y, r * y, z]);
        let length = (eye[0] * eye[0] + eye[1] * eye[1]).sqrt();
        let first = if length > 0.0 { [-eye[1] / length, eye[0] / length, 0.0] } else { [1.0, 0.0, 0.0] };
        VisibleFacets { axes: &self.axes, stretch: [l, m, r], stretched: [first, cross(eye, first), eye] }
    }

    /// Returns the radiance that `facet` reflects to the eye, weighted for the distribution that it was sampled from.
    pub(super) fn reflect(&self, facet: Vector, radiance: impl Fn(Vector) -> Radiance, weight: Weight) -> Radiance {
        let seen = dot(self.view, facet);
        let light = [0, 1, 2].map(|i| 2.0 * seen * facet[i] - self.view[i]);
        let lit = dot(light, self.axes[2]);
        if seen <= 0.0 || lit <= 0.0 {
            return [0.0; 3];
        }
        let weight = match (self.shader.reflection, weight) {
            (Reflection::BlinnPhong | Reflection::BlinnPhongPrinted, _) => 1.0,
            (_, Weight::AllFacets) => {
                self.fresnel(facet) * self.masking_shadowing(light, lit) * seen
                    / (self.facing * dot(facet, self.axes[2]))
            }
            (_, Weight::VisibleFacets) => {
                let visible = 1.0 / (1.0 + self.hidden);
                self.fresnel(facet) * self.masking_shadowing(light, lit) / visible
            }
        };
        radiance(light).map(|r| weight * r)
    }

    /// Returns the Fresnel term (C. Schlick, "An inexpensive BRDF model for physically-based rendering", 1994, eq. 15).
    fn fresnel(&self, half: Vector) -> f64 {
        let x = (1.0 - dot(self.view, half)).clamp(0.0, 1.0);
        self.shader.f0 + (1.0 - self.shader.f0) * (x * x) * (x * x) * x
    }

    /// Returns Smith's height-correlated G = 1 / (1 + Lambda(v) + Lambda(l)) (Heitz, eq. 99).
    fn masking_shadowing(&self, light: Vector, lit: f64) -> f64 {
        1.0 / (1.0 + self.hidden + self.lambda(light, lit))
    }

    /// Returns Lambda: Heitz, eq. 72, for GGX, and for Beckmann the rational fit next to it, with a = 1 / (alpha tan).
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

/// The facets of a GGX lobe that the eye sees (E. Heitz, "Sampling the GGX distribution of visible normals", 2018),
/// with any factor S of A = S S^T instead of diag(alpha_x, alpha_y).
pub(super) struct VisibleFacets<'a> {
    axes: &'a [Vector; 3],
    /// S: its diagonal is (l, r), and m is below l.
    stretch: [f64; 3],
    /// The frame whose third axis points to the eye after the lobe is stretched to a hemisphere.
    stretched: [Vector; 3],
}

impl VisibleFacets<'_> {
    /// Samples a facet by a point of the unit square.
    pub(super) fn sample(&self, [radial, azimuth]: [f64; 2]) -> Vector {
        let [l, m, r] = self.stretch;
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * azimuth);
        let (p, q) = (radial.sqrt() * cos, radial.sqrt() * sin);
        let share = 0.5 * (1.0 + self.stretched[2][2]);
        let q = (1.0 - share) * (1.0 - p * p).max(0.0).sqrt() + share * q;
        let facet = combine([p, q, (1.0 - p * p - q * q).max(0.0).sqrt()], self.stretched);
        let [x, y, z] = [l * facet[0], m * facet[0] + r * facet[1], facet[2].max(1e-6)];
        normalised(combine([x, y, z], *self.axes))
    }
}

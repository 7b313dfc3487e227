//! The expected pixels: GGX with the masking term of docs/extension/README.md, and the multiple scattering of Bevy's
//! shader.

use std::f32::consts::PI;

use bevy::math::{Mat2, Vec2, Vec3};

use crate::renderer::{LIGHT, Picture, SIZE};

/// A lobe about a normal: squared alphas in (T, B), which are x and y.
#[derive(Clone, Copy, Debug)]
pub struct Lobe {
    /// Squared alphas.
    pub a: Mat2,
    /// The part of the bumps in them. Bumps do not hide each other.
    pub bumps: Mat2,
    /// Mean slope.
    pub slope: Vec2,
}

impl Lobe {
    /// Makes an isotropic lobe.
    pub fn isotropic(alpha: f32) -> Self {
        Self { a: Mat2::from_diagonal(Vec2::splat(alpha * alpha)), bumps: Mat2::ZERO, slope: Vec2::ZERO }
    }

    /// Returns the radiance toward `view` of a metal that reflects everything, over the radiance of the light, times
    /// pi.
    fn radiance(self, view: Vec3) -> f32 {
        let n = (-self.slope).extend(1.0).normalize();
        let t = (Vec3::X - n.x * n).normalize();
        let b = n.cross(t);
        let local = |d: Vec3| Vec3::new(d.dot(t), d.dot(b), d.dot(n));
        let (v, l, h) = (local(view), local(LIGHT.normalize()), local((view + LIGHT.normalize()).normalize()));
        if v.z <= 0.0 || l.z <= 0.0 {
            return 0.0;
        }
        let slope = Vec2::new(h.x, h.y) / h.z;
        let q = 1.0 + slope.dot(self.a.inverse() * slope);
        let d = 1.0 / (PI * self.a.determinant().sqrt() * q * q * h.z.powi(4));
        PI * d * self.visibility(v, l, h) / self.reflected_once(v.z)
    }

    /// Returns the term of visibility times the cosine with the light, of directions in the frame of the normal: that
    /// of the base lobe of one bump, which stands for all bumps that reflect `l` to `v` (docs/extension/README.md,
    /// "Lights").
    fn visibility(self, v: Vec3, l: Vec3, h: Vec3) -> f32 {
        let (centre, radius) = self.mean_and_radius();
        let axis = Vec2::from_angle(0.5 * (2.0 * self.a.x_axis.y).atan2(self.a.x_axis.x - self.a.y_axis.y));
        let along = |d: Vec3| Vec3::new(axis.dot(d.truncate()), axis.perp_dot(d.truncate()), d.z);
        let (v, l, h) = (along(v), along(l), along(h));
        let bumps = Vec2::new(axis.dot(self.bumps * axis), axis.perp().dot(self.bumps * axis.perp()));
        let squared = Vec2::new(centre + radius, centre - radius);
        let shares = bumps / squared;
        let g = (shares * shares * h.truncate() / h.z).extend(1.0).normalize();
        let t = (Vec3::X - g.x * g).normalize();
        let (v, l) = [v, l].map(|d| Vec3::new(t.dot(d), g.cross(t).dot(d), g.dot(d).max(0.0))).into();
        let length = |d: Vec3| ((squared - bumps).dot(d.truncate() * d.truncate()) + d.z * d.z).sqrt();
        0.5 * l.z * g.z / (l.z * length(v) + v.z * length(l))
    }

    /// Returns the sum of Bevy's F_AB, a polynomial of Unreal Engine 4, for the base lobe. Multiple scattering adds
    /// what is missing to 1.
    fn reflected_once(self, n_dot_v: f32) -> f32 {
        let (centre, radius) = Self { a: self.a - self.bumps, ..self }.mean_and_radius();
        let roughness = (centre - radius).powf(0.25);
        let r = [-1.0, -0.0275, -0.572, 0.022].map(|c| c * roughness);
        let r = [r[0] + 1.0, r[1] + 0.0425, r[2] + 1.04, r[3] - 0.04];
        let a004 = (r[0] * r[0]).min((-9.28 * n_dot_v).exp2()) * r[0] + r[1];
        (-1.04 * a004 + r[2]) + (1.04 * a004 + r[3])
    }

    /// Returns the mean of the squared alphas along the axes, and half their difference.
    pub fn mean_and_radius(self) -> (f32, f32) {
        let (uu, uv, vv) = (self.a.x_axis.x, self.a.x_axis.y, self.a.y_axis.y);
        (0.5 * (uu + vv), (0.5 * (uu - vv)).hypot(uv))
    }

    /// Returns the picture of this lobe.
    pub fn picture(self) -> Picture {
        mean(&[self])
    }
}

/// Returns the picture of many lobes that each cover an equal part of every pixel.
pub fn mean(lobes: &[Lobe]) -> Picture {
    pixels().map(|view| lobes.iter().map(|lobe| lobe.radiance(view)).sum::<f32>() / lobes.len() as f32).collect()
}

/// Returns the direction to the eye for each pixel.
fn pixels() -> impl Iterator<Item = Vec3> {
    let at = |i: u32| 2.0 * (i as f32 + 0.5) / SIZE as f32 - 1.0;
    (0..SIZE).flat_map(move |y| (0..SIZE).map(move |x| Vec3::new(-at(x), at(y), 1.0).normalize()))
}

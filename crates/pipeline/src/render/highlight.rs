//! Comparison of Phong and Blinn-Phong on a plane: the paper's figure 14.

use rayon::prelude::*;

use super::camera::Camera;
use super::draw::Picture;
use super::shape::Shape;
use crate::math::vector::{Vector, dot, normalised};

/// Exponent of Blinn-Phong. Phong measures an angle twice as large, about the mirror direction, so its exponent is a
/// quarter.
const EXPONENT: f64 = 300.0;
const LIGHT: Vector = [0.0, 9.0, 1.0];

/// Draws a plane under a low light, `width` pixels wide: (r.v)^(m/4) in the first picture, (n.h)^m in the second. Both
/// pictures show the outline at which Blinn-Phong falls to half. At a grazing angle Phong's highlight is round, but the
/// highlight of facets is stretched towards the eye, as on a wet road.
pub fn highlight(width: u32) -> [Picture; 2] {
    let size = [width.max(1), (width as f64 * 1.1).max(1.0) as u32];
    let camera = Camera::new([0.0, 0.0, 1.0], [0.0, 1.0, 0.72], 0.36, size);
    let shape = Shape::Plane { repeats: 1.0 };
    let values = |x: f64, y: f64| {
        let ray = camera.ray(x, y);
        shape.hit(camera.eye, ray).map(|hit| {
            let light = normalised([0, 1, 2].map(|i| LIGHT[i] - hit.position[i]));
            let mirrored = dot([-light[0], -light[1], light[2]], ray.map(|c| -c)).max(0.0);
            let half = normalised([0, 1, 2].map(|i| light[i] - ray[i]));
            [libm::pow(mirrored, 0.25 * EXPONENT), libm::pow(half[2].max(0.0), EXPONENT)]
        })
    };
    let pixel = |i: u32| {
        let (x, y) = (f64::from(i % size[0]) + 0.5, f64::from(i / size[0]) + 0.5);
        values(x, y).map(|value| {
            // The outline crosses a pixel if the value is above one half on one side and below on another.
            let above = [[-0.7, 0.0], [0.7, 0.0], [0.0, -0.7], [0.0, 0.7]]
                .map(|[dx, dy]| values(x + dx, y + dy).is_some_and(|v| v[1] > 0.5));
            (value, above.contains(&true) && above.contains(&false))
        })
    };
    let pixels: Vec<_> = (0..size[0] * size[1]).into_par_iter().map(pixel).collect();
    [0, 1].map(|which| Picture {
        size,
        pixels: pixels
            .iter()
            .map(|pixel| match pixel {
                None => [0.35, 0.45, 0.60],
                Some((_, true)) => [2.0, 0.25, 0.1],
                Some((value, false)) => [0.02 + value[which] as f32; 3],
            })
            .collect(),
        coverage: pixels.iter().map(|pixel| f32::from(u8::from(pixel.is_some()))).collect(),
    })
}

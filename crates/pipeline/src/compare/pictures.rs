//! Picture errors: how far pictures of each model are from a supersampled picture.
//!
//! The lobe error judges texels one by one, and every level alike. A picture also has lights, surroundings, filtering
//! between texels and levels, and the eye's choice of levels.

use rayon::prelude::*;

use super::ours::Ours;
use crate::lobe::Family;
use crate::metric::{FootprintMoments, Peer, Surface, base_of_roughness, roughness_of_base};
use crate::mip::{Level, build};
use crate::render::{
    Advance, EnvironmentFilter, Filter, LostBumps, Material, Reflection, SceneName, Shader, Texel, Texture, filtered,
    relative_l1, supersampled,
};

/// The scene of the pictures, which shows a surface at all angles.
const SCENE: SceneName = SceneName::Sphere;
/// Samples per pixel of the supersampled picture. Its noise is part of the report.
const SAMPLES: u32 = 512;
/// The longest side of the peers' textures. At the distances of the scene, pictures up to [`MAX_PICTURE_WIDTH`] do not
/// show finer levels, whatever the size of the map.
const FINEST: u32 = 512;

/// The widest picture, in pixels.
pub const MAX_PICTURE_WIDTH: u32 = 512;

/// The picture errors of a material.
pub struct PictureErrors {
    /// Relative L1 of each of our models, then of each peer: the mean over distances.
    pub errors: Vec<f64>,
    /// Expected relative L1 of a perfect picture, since the supersampled picture has finitely many samples.
    pub noise: f64,
}

/// Draws spheres `width` pixels wide with each of `ours` and each peer, at the distances of `render`, and compares them
/// with `truth`, whose level 0 is `surface`. `advance` receives the finished share of the work.
pub fn picture_errors(
    truth: &Material,
    surface: &Surface,
    ours: &[Ours],
    width: u32,
    advance: Advance<'_>,
) -> Option<PictureErrors> {
    let distances = SCENE.distances();
    let count = distances.len() as f64;
    let mut views = Vec::new();
    for (done, distance) in distances.iter().enumerate() {
        let scene = SCENE.scene(width, *distance)?;
        let shader = Shader { reflection: Reflection::Ggx, filter: EnvironmentFilter::Facets, f0: scene.f0 };
        let advance = |share: f32| advance((done as f32 + share) / distances.len() as f32);
        let truth = supersampled(&scene, truth, &shader, SAMPLES, &advance);
        views.push((scene, shader, truth));
    }
    let error = |material: &Material| {
        let errors = views.iter().map(|(scene, shader, truth)| {
            relative_l1(&filtered(scene, material, shader, Filter::Anisotropic, &|_| {}), &truth.picture)
        });
        errors.sum::<f64>() / count
    };
    let (finest, tail) = moments(surface, (surface.width().min(FINEST), surface.height().min(FINEST)));
    let mut peer = Material { roughness: None, anisotropy: None, ..ours.first()?.material.clone() };
    let mut errors: Vec<f64> = ours.iter().map(|ours| error(&ours.material)).collect();
    for formula in Peer::ALL {
        let tail = tail.iter().map(|level| lobes(level, formula)).collect();
        peer.lost = LostBumps::Lobes(Texture::new(lobes(&finest, formula), tail));
        errors.push(error(&peer));
    }
    let noise = views.iter().map(|(.., truth)| relative_l1(&truth.half, &truth.picture)).sum::<f64>() / count;
    Some(PictureErrors { errors, noise })
}

/// Mean normal, mean slopes, E\[f_u^2\], E\[f_u f_v\], E\[f_v^2\], and the base lobe as [`roughness_of_base`] returns
/// it.
type Moments = [f32; 11];

/// Returns the moments of `surface` for the texels of a level of `size` texels, and of all coarser levels.
fn moments(surface: &Surface, size: (u32, u32)) -> (Level<Moments>, Vec<Level<Moments>>) {
    let moments = |x: u32, y: u32| -> Moments {
        let FootprintMoments { mean_normal: [x, y, z], mean: [u, v], second: [uu, uv, vv], base, .. } =
            surface.footprint(size, (x, y)).moments();
        let [a, b, c] = roughness_of_base(base);
        [x, y, z, u, v, uu, uv, vv, a, b, c].map(|m| m as f32)
    };
    let texels = (0..size.1).into_par_iter().flat_map_iter(|y| (0..size.0).map(move |x| moments(x, y))).collect();
    let finest = Level { width: size.0, height: size.1, texels };
    let tail = build(&finest);
    (finest, tail)
}

/// Returns the squared alphas that `peer` makes of the texels of a level.
fn lobes(level: &Level<Moments>, peer: Peer) -> Level<Texel> {
    let lobe = |moments: &Moments| {
        let [x, y, z, u, v, uu, uv, vv, a, b, c] = moments.map(f64::from);
        let moments = FootprintMoments {
            mean_normal: [x, y, z],
            mean: [u, v],
            second: [uu, uv, vv],
            covariance: [(uu - u * u).max(0.0), uv - u * v, (vv - v * v).max(0.0)],
            base: base_of_roughness([a, b, c]),
        };
        let [uu, uv, vv] = peer.lobe(Family::Ggx, &moments).squared_alpha().map(|a| a as f32);
        [uu, uv, vv, 1.0]
    };
    Level { width: level.width, height: level.height, texels: level.texels.par_iter().map(lobe).collect() }
}

//! A layer whose roughness data are to be chosen.

use crate::material::{BumpMap, Normals, Roughening};
use crate::mip::{Area, Pyramid, Wrap};
use crate::settings::{Model, Settings};

/// What is to be judged.
pub struct Candidates<'a, 'f, 'r> {
    /// The material's lobe and its bumps.
    pub roughening: &'a Roughening<'f>,
    /// The bound, the model asked for and the target.
    pub settings: &'a Settings,
    /// Where the texels of the portable profile point, where it is written.
    pub normals: Option<&'a Normals<'a>>,
    /// Bumps and c of the pyramid profile, where it is written.
    pub pyramid: Option<(&'a Pyramid<Area<&'r BumpMap>>, f32)>,
    /// The sampler's mode, across and down.
    pub wrap: [Wrap; 2],
    /// The fullest model that the layer can have.
    pub widest: Model,
    /// The finest level that can be sampled.
    pub finest: usize,
    /// The finest level that is written.
    pub first: usize,
}

/// Errors of one candidate by site.
pub(super) type Errors = Vec<f64>;

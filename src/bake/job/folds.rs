//! The job's textures of the portable profile that hold folded lobes.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use super::{Job, JobError, JobOutput, JobTexture, LayerOutcome};
use crate::bake::plan::LayerPlan;
use crate::gltf::material::LayerKind;
use crate::gltf::texture::TextureSource;
use crate::image::{Image, Rgba};
use crate::material::{
    Base, BaseAnisotropy, BaseLevels, BaseRows, BumpMap, Bumps, Encoding, Normals, Roughening, base_lobe, grid, notes,
};
use crate::mip::Rows;
use crate::report::{Choice, Content};
use crate::select::Candidates;
use crate::settings::Model;

impl Job<'_> {
    /// Folds the bumps into each distinct lobe, choosing its model on the way. Normals point where the lobes do that are
    /// folded first on their grid. `own` is the first layer's.
    pub(super) fn portable<'r>(
        &self,
        bump_map: &'r BumpMap,
        bumps: &Bumps<'r>,
        mut own: Option<BaseMaps>,
        output: &mut JobOutput,
    ) -> Result<(), JobError> {
        let layers = &self.plan.layers;
        let is_portable = self.settings.profile.is_portable();
        // For layers that come after those whose lobes they follow.
        let mut normals = None;
        let mut normal_texture = None;
        let normal_encoding = Encoding::of_normals(self.settings).starting_at(self.first_level(layers, bumps.size()));
        let groups = groups(layers);
        for (group, users) in groups.iter().enumerate() {
            let layer = &layers[users[0]];
            let has_later = group + 1 < groups.len();
            let BaseMaps { images, size: own_size, levels } =
                own.take().map_or_else(|| self.own(layer, Some(bump_map)), Ok)?;
            let size = self.grid(&images, Some(bump_map))?;
            let base = self.base(layer, &images, size);
            let base = if own_size == size { Base::with_levels(base, levels) } else { Base::new(base) };
            let is_base = layer.layer.kind == LayerKind::Base;
            let correction = (self.settings.profile.has_pyramid() && is_base)
                .then(|| bumps.correction(layer.slope_scale, self.settings, base_lobe(&base.whole())));
            // The extension describes the base lobe only.
            let roughening = (layer.own.is_ok() && (is_portable || is_base)).then(|| {
                let resampled = (size != bumps.size()).then(|| Bumps::new(bump_map, size));
                Roughening::new(base, resampled.as_ref().unwrap_or(bumps), layer.slope_scale, self.settings)
            });
            let leads = |f: &&Roughening<'_>| {
                is_portable && normal_texture.is_none() && layer.slope_scale != 0.0 && f.sizes()[0] == bumps.size()
            };
            let lobes = roughening.as_ref().filter(leads).map(Roughening::lobes);
            let led = lobes.map(|lobes| Normals::of_lobes(bumps, lobes));
            let widest = match layer.layer.kind {
                LayerKind::Base => Model::Anisotropic,
                // glTF's clearcoat has no anisotropy.
                LayerKind::Clearcoat => Model::Isotropic,
            };
            let used_by = || users.iter().map(|user| &layers[*user]);
            let first = self.first_level(used_by(), size);
            let means = (is_portable && normals.is_none() && led.is_none()).then(|| Normals::of_means(bumps));
            let candidates = roughening.as_ref().map(|roughening| Candidates {
                roughening,
                settings: self.settings,
                normals: normals.as_ref().or(led.as_ref()).or(means.as_ref()),
                pyramid: correction.map(|c| (bumps.moments(), c)),
                wrap: self.plan.source.wrap,
                widest,
                finest: self.finest_level(used_by(), size),
                first,
            });
            // The trial waits for its slowest texels more than once: normals are encoded meanwhile.
            let (encoded, choice) = rayon::join(
                || led.as_ref().map(|led| led.bake(normal_encoding)).transpose(),
                || candidates.map(|candidates| candidates.run()).transpose(),
            );
            normal_texture = encoded?.or(normal_texture);
            let choice = choice?;
            if let Some(lobes) = lobes.filter(|_| has_later) {
                normals = Some(Normals::kept(bumps, lobes));
            }
            let (model, first) = match (choice.as_ref().and_then(Choice::taken), self.settings.model) {
                (Some(taken), _) => (taken.model, taken.first),
                // Without its own lobe nothing tells how much of the ellipse will be seen: keep all of it.
                (None, Model::Auto) => (widest, first),
                (None, model) => (model.min(widest), first),
            };
            let roughening = roughening.filter(|_| is_portable && model != Model::None);
            let folding = Encoding::of(self.settings, 3).starting_at(first);
            let roughened = roughening.as_ref().map(|f| f.bake(model, folding)).transpose()?;
            let roughening_notes = roughening.map_or_else(Vec::new, |roughening| {
                let notes = notes::of_roughening(&roughening, model, bump_map.noise());
                roughening.drop_all();
                notes
            });
            for user in users {
                let LayerOutcome {
                    report,
                    model: chosen,
                    first: start,
                    correction: c,
                    unit_factor,
                    anisotropy,
                    dropped_anisotropy,
                    ..
                } = &mut output.layers[*user];
                (*chosen, *start, *c) = (model, first, correction.unwrap_or(1.0));
                report.model = Some(model);
                report.choice.clone_from(&choice);
                if let (Err(reason), true) = (&layer.own, is_portable) {
                    if !self.settings.profile.has_pyramid() {
                        report.model = Some(Model::None);
                    }
                    report.notes.push(reason.clone());
                }
                report.notes.extend(choice.as_ref().and_then(|c| c.warning(self.settings)));
                report.notes.extend(roughening_notes.iter().cloned());
                if let Some(roughened) = &roughened {
                    if model == Model::Isotropic && layers[*user].layer.anisotropy.is_some() {
                        *dropped_anisotropy = Some(layers[*user].pointer("extensions/KHR_materials_anisotropy"));
                        report
                            .notes
                            .push("a circle took the place of the material's own anisotropy, as asked for".into());
                    }
                    *unit_factor = Some(layers[*user].roughness_factor_pointer());
                    *anisotropy = roughened
                        .anisotropy
                        .is_some()
                        .then(|| layers[*user].pointer("extensions/KHR_materials_anisotropy"));
                }
            }
            let Some(roughened) = roughened else { continue };
            let [roughness, anisotropy] = layer.base_textures();
            let stem = roughness.map_or_else(|| layer.name.clone(), TextureSource::stem);
            let sources = self.hashed([&self.plan.source.location].into_iter().chain(layer.base_locations()));
            let texture = |content, mip_chain, sampler, slots| JobTexture {
                content,
                mip_chain,
                range: None,
                stem: stem.clone(),
                sources: sources.clone(),
                slots,
                sampler,
                model,
                lobe_errors: choice.as_ref().and_then(Choice::taken).map(|c| c.errors.clone()).unwrap_or_default(),
            };
            let sampler = |own: Option<&TextureSource>| own.map_or(self.plan.source.sampler, |own| own.sampler);
            output.textures.push(texture(
                Content::Roughness,
                roughened.roughness,
                sampler(roughness),
                users.iter().flat_map(|u| layers[*u].roughness_slots()).collect(),
            ));
            if let Some(mip_chain) = roughened.anisotropy {
                output.textures.push(texture(
                    Content::Anisotropy,
                    mip_chain,
                    sampler(anisotropy),
                    users.iter().map(|u| layers[*u].anisotropy_slot()).collect(),
                ));
            }
        }
        if is_portable {
            let mip_chain = normal_texture.map_or_else(|| Normals::of_means(bumps).bake(normal_encoding), Ok)?;
            let texture = JobTexture {
                content: Content::Normal,
                mip_chain,
                range: None,
                stem: self.plan.source.stem(),
                sources: self.hashed([&self.plan.source.location]),
                slots: layers.iter().map(LayerPlan::normal_slot).collect(),
                sampler: self.plan.source.sampler,
                model: Model::None,
                lobe_errors: Vec::new(),
            };
            output.textures.insert(0, texture);
        }
        Ok(())
    }

    /// The layer's own lobe. Without `relief`, which may not be there yet, its levels are on the grid of its own images, which
    /// the bumps most often share.
    pub(super) fn own(&self, layer: &LayerPlan, bump_map: Option<&BumpMap>) -> Result<BaseMaps, JobError> {
        let image = |texture: Option<&TextureSource>| texture.map(|t| self.image(t, &layer.name)).transpose();
        let [roughness, anisotropy] = layer.base_textures();
        let images = BaseImages { roughness: image(roughness)?, anisotropy: image(anisotropy)? };
        let size = self.grid(&images, bump_map)?;
        let levels = BaseLevels::new(&self.base(layer, &images, size));
        Ok(BaseMaps { images, size, levels })
    }

    /// A grid that holds the layer's own lobe and, where they are given, the bumps.
    fn grid(&self, own: &BaseImages, bump_map: Option<&BumpMap>) -> Result<(u32, u32), JobError> {
        let sizes = [&own.roughness, &own.anisotropy].into_iter().flatten().map(|i| (i.width, i.height));
        Ok(grid(self.settings, sizes.chain(bump_map.map(|r| (r.width(), r.height()))))?)
    }

    /// The layer's own lobe on a grid of `width` x `height` texels.
    fn base<'r>(&self, layer: &LayerPlan, own: &'r BaseImages, (width, height): (u32, u32)) -> BaseRows<'r> {
        let anisotropy = layer.layer.anisotropy.as_ref().map(|a| {
            let rotation = f64::from(a.rotation);
            BaseAnisotropy {
                texture: own.anisotropy.as_ref().map(Rgba),
                strength: a.strength,
                rotation: [libm::cos(rotation) as f32, libm::sin(rotation) as f32],
            }
        });
        let roughness = own.roughness.as_ref().map(Rgba);
        BaseRows::new(width, height, roughness, layer.layer.roughness_factor, anisotropy, self.plan.source.wrap)
    }
}

/// The layers that share each folded lobe, in the order of their first. A layer that nothing can be folded into is
/// alone.
fn groups(layers: &[LayerPlan]) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let mut places: HashMap<_, usize> = HashMap::new();
    for (index, layer) in layers.iter().enumerate() {
        match layer.roughened_lobe_key().map(|key| places.entry(key)) {
            Some(Entry::Occupied(place)) => {
                let place = *place.get();
                groups[place].push(index);
                continue;
            }
            Some(Entry::Vacant(place)) => drop(place.insert(groups.len())),
            None => {}
        }
        groups.push(vec![index]);
    }
    groups
}

/// A layer's own lobe.
pub(super) struct BaseMaps {
    images: BaseImages,
    size: (u32, u32),
    /// Levels 1 and coarser on a grid of `size`.
    levels: BaseLevels,
}

/// Images of a layer's own lobe.
struct BaseImages {
    roughness: Option<Image>,
    anisotropy: Option<Image>,
}

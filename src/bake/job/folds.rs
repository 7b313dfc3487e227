//! The job's textures of the portable profile that hold folded lobes.

use super::{Job, JobError, JobOutput, JobTexture, LayerOutcome, ReliefPyramid};
use crate::bake::base::{BaseAnisotropy, BaseRows};
use crate::bake::chain::{Encoding, grid};
use crate::bake::fold::Fold;
use crate::bake::plan::{LayerPlan, OwnTextures};
use crate::bake::relief::Relief;
use crate::bake::report::Content;
use crate::bake::settings::Model;
use crate::gltf::material::LayerKind;
use crate::gltf::texture::TextureSource;
use crate::map::{Image, Rgba, decode_colours};
use crate::pyramid::{Area, Pyramid, Rows};

impl Job<'_> {
    /// Folds the bumps into each distinct lobe, choosing its model on the way.
    pub(super) fn folds<'r>(
        &self,
        relief: &'r Relief,
        moments: &ReliefPyramid<'r>,
        output: &mut JobOutput,
    ) -> Result<(), JobError> {
        let layers = &self.plan.layers;
        for (first, layer) in layers.iter().enumerate() {
            let is_done = layers[..first].iter().any(|earlier| earlier.folds_like(layer));
            if is_done {
                continue;
            }
            let users: Vec<usize> =
                (first..layers.len()).filter(|i| *i == first || layer.folds_like(&layers[*i])).collect();
            let none = OwnTextures { roughness: None, anisotropy: None };
            let own = layer.own.as_ref().unwrap_or(&none);
            let images = OwnImages {
                roughness: own.roughness.as_ref().map(|t| self.image(t, &layer.name, decode_colours)).transpose()?,
                anisotropy: own.anisotropy.as_ref().map(|t| self.image(t, &layer.name, decode_colours)).transpose()?,
            };
            let base = self.base(relief, layer, &images)?;
            let size = (base.width(), base.height());
            let resampled = (size != moments.sizes()[0]).then(|| Pyramid::new(Area::new(relief, size.0, size.1)));
            let moments = resampled.as_ref().unwrap_or(moments);
            let fold = Fold::new(base, moments, layer.slope_scale, self.settings.distribution.correction());
            let widest = match layer.layer.kind {
                LayerKind::Base => Model::Anisotropic,
                // glTF's clearcoat has no anisotropy.
                LayerKind::Clearcoat => Model::Isotropic,
            };
            let (model, loss) = match (&layer.own, self.settings.model) {
                // Without its own lobe nothing tells how much of the ellipse will be seen: keep all of it.
                (Err(_), Model::Auto) => (widest, None),
                _ => fold.model(self.settings, widest),
            };
            let folded = match &layer.own {
                Ok(_) if self.settings.profile.is_portable() && model != Model::None => {
                    let first = self.first_level(users.iter().map(|user| &layers[*user]), size);
                    Some(fold.bake(model, Encoding::of(self.settings, 3).starting_at(first))?)
                }
                _ => None,
            };
            let too_wide = if folded.is_some() { fold.texels_above_one(model) } else { 0 };
            for user in &users {
                let LayerOutcome { report, model: chosen, unit_factor, anisotropy, circle, .. } =
                    &mut output.layers[*user];
                *chosen = model;
                report.model = Some(model);
                report.loss = loss;
                if let (Err(reason), true) = (&layer.own, self.settings.profile.is_portable()) {
                    if !self.settings.profile.has_pyramid() {
                        report.model = Some(Model::None);
                    }
                    report.notes.push(reason.clone());
                }
                if let Some(loss) = loss.filter(|l| model == Model::Isotropic && l.isotropic > self.settings.max_error)
                {
                    report.notes.push(format!(
                        "glTF's clearcoat has no anisotropy: a circle in the ellipse's place loses {:.3}",
                        loss.isotropic
                    ));
                }
                if too_wide > 0 {
                    report.notes.push(format!(
                        "{too_wide} texels over all levels are rougher than an engine can show: alpha is clamped to 1"
                    ));
                }
                if let Some(folded) = &folded {
                    if model == Model::Isotropic && layers[*user].layer.anisotropy.is_some() {
                        *circle = Some(layers[*user].pointer("extensions/KHR_materials_anisotropy"));
                        report
                            .notes
                            .push("a circle took the place of the material's own anisotropy, as asked for".into());
                    }
                    *unit_factor = Some(layers[*user].roughness_factor_pointer());
                    *anisotropy = folded
                        .anisotropy
                        .is_some()
                        .then(|| layers[*user].pointer("extensions/KHR_materials_anisotropy"));
                }
            }
            let Some(folded) = folded else { continue };
            let own_location = own.roughness.as_ref().map(|t| t.location.clone());
            let named_after = own_location.ok_or_else(|| layer.name.clone());
            let mut sources = vec![self.plan.source.location.clone()];
            sources.extend(layer.own_locations().into_iter().cloned());
            let texture = |content, chain, sampler, slots| JobTexture {
                content,
                chain,
                range: None,
                named_after: named_after.clone(),
                sources: sources.clone(),
                slots,
                sampler,
                model,
            };
            let sampler = |own: &Option<TextureSource>| own.as_ref().unwrap_or(&self.plan.source).sampler;
            output.textures.push(texture(
                Content::Roughness,
                folded.roughness,
                sampler(&own.roughness),
                users.iter().flat_map(|u| layers[*u].roughness_slots()).collect(),
            ));
            if let Some(chain) = folded.anisotropy {
                output.textures.push(texture(
                    Content::Anisotropy,
                    chain,
                    sampler(&own.anisotropy),
                    users.iter().map(|u| layers[*u].anisotropy_slot()).collect(),
                ));
            }
        }
        Ok(())
    }

    /// The layer's own lobe on a grid that holds it and the bumps.
    fn base<'r>(&self, relief: &Relief, layer: &LayerPlan, own: &'r OwnImages) -> Result<BaseRows<'r>, JobError> {
        let sizes = [&own.roughness, &own.anisotropy].into_iter().flatten().map(|i| (i.width, i.height));
        let (width, height) = grid(self.settings, sizes.chain([(relief.width(), relief.height())]))?;
        let anisotropy = layer.layer.anisotropy.as_ref().map(|a| {
            let rotation = f64::from(a.rotation);
            BaseAnisotropy {
                texture: own.anisotropy.as_ref().map(Rgba),
                strength: a.strength,
                rotation: [libm::cos(rotation) as f32, libm::sin(rotation) as f32],
            }
        });
        let roughness = own.roughness.as_ref().map(Rgba);
        Ok(BaseRows::new(width, height, roughness, layer.layer.roughness_factor, anisotropy, self.plan.source.wrap))
    }
}

struct OwnImages {
    roughness: Option<Image>,
    anisotropy: Option<Image>,
}

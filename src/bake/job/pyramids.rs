//! The job's textures of the pyramid profile.

use super::{Job, JobError, JobOutput, JobTexture, PyramidUse};
use crate::bake::extension::BaseLobe;
use crate::bake::plan::LayerPlan;
use crate::bump::{Frame, FrameTransform};
use crate::gltf::material::LayerKind;
use crate::material::{BumpMap, Bumps, Encoding, Framed, Quantity, Ranged, Reading, bake_quantity, filter_loss, notes};
use crate::mip::{Area, Pyramid, Rows};
use crate::report::{Choice, Content};
use crate::settings::Model;

/// Root mean square deviation of triangles up to which they count as turned alike: 6 degrees.
const MAX_ROTATION_DEVIATION: f32 = 0.1;

/// Index of a texture and what the user should know of it.
type Made = (usize, Option<String>);

impl Job<'_> {
    /// Offsets and D or lambda_1 for the base layers.
    pub(super) fn pyramids(
        &self,
        bump_map: &BumpMap,
        bumps: &Bumps<'_>,
        output: &mut JobOutput,
    ) -> Result<(), JobError> {
        let mut made: Vec<(Reading, Quantity, usize, Made)> = Vec::new();
        let first_offset = self.first_level(&self.plan.layers, bumps.size());
        for (index, layer) in self.plan.layers.iter().enumerate() {
            let outcome = &mut output.layers[index];
            if layer.layer.kind == LayerKind::Clearcoat {
                outcome.report.notes.push(
                    "the extension describes the base lobe only: no pyramid was written for the clearcoat".to_owned(),
                );
                continue;
            }
            let (frame, reading) = self.reading(bump_map, layer).unwrap_or_else(|reason| {
                outcome.report.notes.push(reason);
                (Frame::Unit, Reading::Uniform(FrameTransform::IDENTITY))
            });
            let roughness = match outcome.model {
                Model::Anisotropic => Some(Quantity::Factor),
                Model::Isotropic => Some(Quantity::Lambda1),
                Model::None | Model::Auto => None,
            };
            let (own_first, correction) = (outcome.first, outcome.correction);
            let lobe_errors = outcome.report.choice.as_ref().and_then(Choice::taken).map(|c| c.errors.clone());
            let mut find_or_make = |quantity: Quantity| {
                let first = match quantity {
                    Quantity::Offset => first_offset,
                    Quantity::Factor | Quantity::Lambda1 => own_first,
                };
                if let Some((.., made)) = made.iter().find(|(r, q, f, _)| (r, *q, *f) == (&reading, quantity, first)) {
                    return Ok(made.clone());
                }
                let (mut texture, note) = self.pyramid(bump_map, bumps, &reading, quantity, first)?;
                if quantity != Quantity::Offset {
                    texture.lobe_errors = lobe_errors.clone().unwrap_or_default();
                }
                output.textures.push(texture);
                let new = (output.textures.len() - 1, note);
                made.push((reading.clone(), quantity, first, new.clone()));
                Ok::<_, JobError>(new)
            };
            let (offset, _) = find_or_make(Quantity::Offset)?;
            let (roughness, note) = roughness.map(find_or_make).transpose()?.unzip();
            let outcome = &mut output.layers[index];
            outcome.report.notes.extend(note.flatten());
            outcome.pyramid = Some(PyramidUse {
                pointer: layer.pointer("extensions/ROUGHCAST_materials_roughness_pyramid"),
                offset,
                roughness,
                slope_scale: layer.slope_scale,
                mapping: layer.layer.bumps.texture().mapping.clone(),
                frame,
                correction,
                base_lobe: outcome.unit_factor.is_some().then(|| BaseLobe::new(&layer.layer)),
            });
        }
        Ok(())
    }

    fn pyramid(
        &self,
        bump_map: &BumpMap,
        bumps: &Bumps<'_>,
        reading: &Reading,
        quantity: Quantity,
        first: usize,
    ) -> Result<(JobTexture, Option<String>), JobError> {
        let encoding = Encoding::of(self.settings, quantity.channels() as u32).starting_at(first);
        let is_factor = quantity == Quantity::Factor;
        let (Ranged { mip_chain, range }, loss) = if *reading == Reading::Uniform(FrameTransform::IDENTITY) {
            (bake_quantity(bumps.moments(), quantity, encoding)?, is_factor.then(|| filter_loss(bumps.moments())))
        } else {
            let (width, height) = bumps.size();
            let framed = Pyramid::new(Area::new(Framed { bump_map, reading }, width, height));
            (bake_quantity(&framed, quantity, encoding)?, is_factor.then(|| filter_loss(&framed)))
        };
        let (content, model) = match quantity {
            Quantity::Offset => (Content::Offset, Model::None),
            Quantity::Factor => (Content::Factor, Model::Anisotropic),
            Quantity::Lambda1 => (Content::Lambda1, Model::Isotropic),
        };
        let texture = JobTexture {
            content,
            mip_chain,
            range: Some(range),
            stem: self.plan.source.stem(),
            sources: self.hashed([&self.plan.source.location]),
            slots: Vec::new(),
            sampler: self.plan.source.sampler,
            model,
            lobe_errors: Vec::new(),
        };
        Ok((texture, loss.and_then(notes::of_factor)))
    }

    /// How to read the bumps in the frame asked for, or why this layer cannot have it.
    fn reading(&self, bump_map: &BumpMap, layer: &LayerPlan) -> Result<(Frame, Reading), String> {
        let frame = self.settings.frame;
        let layout = layer.layout.as_ref();
        match (frame, layout) {
            (Frame::Unit, _) => Ok((frame, Reading::Uniform(FrameTransform::IDENTITY))),
            (_, None) => Err("no mesh shows how the texture lies on it: offsets are in the unit frame".to_owned()),
            (Frame::Natural, Some(layout)) => {
                let [p_u, p_v] = layout.units_per_repeat;
                Ok((frame, Reading::Uniform(FrameTransform::natural(p_u, p_v))))
            }
            (Frame::MainDirection(_), Some(layout)) if layout.rotation_deviation <= MAX_ROTATION_DEVIATION => {
                let [cos, sin] = layout.turn;
                Ok((frame, Reading::Uniform(FrameTransform::rotation(cos, sin))))
            }
            (Frame::MainDirection(_), Some(layout)) => {
                let mapping = &layer.layer.bumps.texture().mapping;
                let turns = self.geometry.rotation_map(layer.material, mapping, [bump_map.width(), bump_map.height()]);
                match turns {
                    Some(turns) if turns.conflict <= MAX_ROTATION_DEVIATION => Ok((frame, Reading::PerTexel(turns))),
                    turns => Err(format!(
                        "the tangent does not keep its angle to the main direction over the mesh (deviation {:.2}), and \
                         parts of the map are used in several directions (deviation {:.2}): one offset map cannot serve, \
                         so offsets are in the unit frame",
                        layout.rotation_deviation,
                        turns.map_or(2.0, |t| t.conflict)
                    )),
                }
            }
        }
    }
}

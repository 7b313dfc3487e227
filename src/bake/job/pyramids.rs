//! The job's textures of the pyramid profile.

use super::{Job, JobError, JobOutput, JobTexture, PyramidUse};
use crate::bake::chain::Encoding;
use crate::bake::pyramids::{Quantity, Ranged, bake_quantity};
use crate::bake::report::Content;
use crate::bake::settings::Model;
use crate::bump::{Frame, FrameTransform};
use crate::gltf::geometry::Layout;
use crate::gltf::material::LayerKind;
use crate::pyramid::{Moments, Pyramid, Rows};

impl Job<'_> {
    /// Offsets and D or lambda_1 for the base layers.
    pub(super) fn pyramids<R: Rows<Texel = Moments>>(
        &self,
        moments: &Pyramid<R>,
        output: &mut JobOutput,
    ) -> Result<(), JobError> {
        let mut made: Vec<(FrameTransform, Quantity, usize)> = Vec::new();
        for (index, layer) in self.plan.layers.iter().enumerate() {
            let outcome = &mut output.layers[index];
            if layer.layer.kind == LayerKind::Clearcoat {
                outcome.report.notes.push(
                    "the extension describes the base lobe only: no pyramid was written for the clearcoat".to_owned(),
                );
                continue;
            }
            let (frame, transform) = match self.frame(layer.layout.as_ref()) {
                Ok(frame) => frame,
                Err(reason) => {
                    outcome.report.notes.push(reason);
                    (Frame::Unit, FrameTransform::IDENTITY)
                }
            };
            let quantity = match outcome.report.model {
                Some(Model::Anisotropic) => Some(Quantity::Factor),
                Some(Model::Isotropic) => Some(Quantity::Lambda1),
                _ => None,
            };
            let mut texture = |quantity: Quantity| -> Result<usize, JobError> {
                if let Some((.., index)) = made.iter().find(|(t, q, _)| (*t, *q) == (transform, quantity)) {
                    return Ok(*index);
                }
                let encoding = Encoding::of(self.settings, quantity.channels() as u32);
                let Ranged { chain, range } = bake_quantity(moments, transform, quantity, encoding)?;
                output.textures.push(JobTexture {
                    content: match quantity {
                        Quantity::Offset => Content::Offset,
                        Quantity::Factor => Content::Factor,
                        Quantity::Lambda1 => Content::Lambda1,
                    },
                    chain,
                    range: Some(range),
                    named_after: Ok(self.plan.source.location.clone()),
                    sources: vec![self.plan.source.location.clone()],
                    slots: Vec::new(),
                    sampler: self.plan.source.sampler,
                    model: Model::None,
                });
                made.push((transform, quantity, output.textures.len() - 1));
                Ok(output.textures.len() - 1)
            };
            let offset = texture(Quantity::Offset)?;
            let roughness = quantity.map(&mut texture).transpose()?;
            output.layers[index].pyramid = Some(PyramidUse {
                pointer: layer.pointer("extensions/ROUGHCAST_materials_roughness_pyramid"),
                offset,
                roughness,
                slope_scale: layer.slope_scale,
                mapping: layer.layer.bumps.texture().mapping.clone(),
                frame,
            });
        }
        Ok(())
    }

    /// The frame asked for, or why this layer cannot have it.
    fn frame(&self, layout: Option<&Layout>) -> Result<(Frame, FrameTransform), String> {
        /// 6 degrees, root mean square.
        const MAX_TURN_DEVIATION: f32 = 0.1;
        let frame = self.settings.frame;
        match (frame, layout) {
            (Frame::Unit, _) => Ok((frame, FrameTransform::IDENTITY)),
            (_, None) => Err("no mesh shows how the texture lies on it: offsets are in the unit frame".to_owned()),
            (Frame::Natural, Some(layout)) => {
                let [p_u, p_v] = layout.units_per_repeat;
                Ok((frame, FrameTransform::natural(p_u, p_v)))
            }
            (Frame::MainDirection(_), Some(layout)) if layout.turn_deviation <= MAX_TURN_DEVIATION => {
                let [cos, sin] = layout.turn;
                Ok((frame, FrameTransform::rotation(cos, sin)))
            }
            (Frame::MainDirection(_), Some(layout)) => Err(format!(
                "the tangent does not keep its angle to the main direction over the mesh (deviation {:.2}): one offset map \
                 cannot serve, so offsets are in the unit frame",
                layout.turn_deviation
            )),
        }
    }
}

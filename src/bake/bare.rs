//! A bare map baked: no document, no material.

use crate::codec::EncodeError;
use crate::image::{Image, Rgba};
use crate::material::{
    Base, BaseRows, BumpMap, Bumps, Encoding, GridError, MipChain, Normals, Quantity, Range, Ranged, Roughening,
    bake_quantity, filter_loss, grid, notes,
};
use crate::mip::Rows;
use crate::report::{Choice, Content};
use crate::select::Candidates;
use crate::settings::{Form, Model, Settings};

/// The roughness that a bare map's surface has by itself.
pub struct BaseRoughness {
    /// Green is roughness (a grey image is grey in green); constant 1 when absent.
    pub image: Option<Image>,
    /// Multiplies it.
    pub factor: f32,
}

/// A texture made from a bare map.
pub struct MapTexture {
    /// What its texels are.
    pub content: Content,
    /// The encoded levels.
    pub mip_chain: MipChain,
    /// What texels of 0 and 1 stand for, in the pyramid profile.
    pub range: Option<Range>,
}

/// Why a bare map is not baked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BakeMapError {
    /// Maps whose common grid is too large.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// A texture cannot be encoded.
    #[error(transparent)]
    Encode(#[from] EncodeError),
}

/// What a bare map became.
pub struct BakedMap {
    /// The first is the bump map: normals or offsets.
    pub textures: Vec<MapTexture>,
    /// What is modelled of the lost bumps.
    pub model: Model,
    /// The candidates that were judged, where the surface's own lobe is known.
    pub choice: Option<Choice>,
    /// What is not as exact as it could be, and why.
    pub notes: Vec<String>,
}

/// Bakes `relief`. The portable profile writes roughness only where `own` tells what to fold the bumps into.
pub fn bake_map(
    bump_map: &BumpMap,
    own: Option<&BaseRoughness>,
    settings: &Settings,
) -> Result<BakedMap, BakeMapError> {
    // No document refers to PNGs.
    let settings = &Settings { form: Form::Strict, ..*settings };
    let size = (bump_map.width(), bump_map.height());
    let bumps = Bumps::new(bump_map, grid(settings, [size])?);
    let mut textures = Vec::new();
    let mut notes = notes::of_bump_map(bump_map, bumps.size());
    let plain = |content, mip_chain| MapTexture { content, mip_chain, range: None };
    // Without a lobe of its own nothing tells how much of the ellipse will be seen: keep all of it.
    let (mut model, mut first, mut choice) = match settings.model {
        Model::Auto => (Model::Anisotropic, 0, None),
        model => (model, 0, None),
    };
    let is_portable = settings.profile.is_portable();
    let roughening = own.map(|own| {
        let image = own.image.as_ref();
        let (width, height) = grid(settings, image.map(|i| (i.width, i.height)).into_iter().chain([size]))?;
        let base = Base::new(BaseRows::new(width, height, image.map(Rgba), own.factor, None, bump_map.wrap()));
        let resampled = ((width, height) != bumps.size()).then(|| Bumps::new(bump_map, (width, height)));
        let has_own_grid = resampled.is_some();
        Ok::<_, BakeMapError>((
            Roughening::new(base, resampled.as_ref().unwrap_or(&bumps), 1.0, settings),
            has_own_grid,
        ))
    });
    let roughening = roughening.transpose()?;
    let lobes = roughening.as_ref().filter(|(_, has_own_grid)| !has_own_grid).map(|(roughening, _)| roughening.lobes());
    let normals = is_portable.then(|| match lobes {
        Some(lobes) => Normals::of_lobes(&bumps, lobes),
        None => Normals::of_means(&bumps),
    });
    if let Some(normals) = &normals {
        textures.push(plain(Content::Normal, normals.bake(Encoding::of_normals(settings))?));
    }
    if let Some((roughening, _)) = &roughening {
        let pyramid = || (bumps.moments(), bumps.correction(1.0, settings, roughening.base_lobe()));
        let candidates = Candidates {
            roughening,
            settings,
            normals: normals.as_ref(),
            pyramid: settings.profile.has_pyramid().then(pyramid),
            wrap: bump_map.wrap(),
            widest: Model::Anisotropic,
            finest: 0,
            first: 0,
        };
        let judged = candidates.run()?;
        if let Some(taken) = judged.taken() {
            (model, first) = (taken.model, taken.first);
        }
        notes.extend(judged.warning(settings));
        choice = Some(judged);
        if is_portable && model != Model::None {
            let roughened = roughening.bake(model, Encoding::of(settings, 3).starting_at(first))?;
            notes.extend(notes::of_roughening(roughening, model, bump_map.noise()));
            textures.push(plain(Content::Roughness, roughened.roughness));
            textures.extend(roughened.anisotropy.map(|mip_chain| plain(Content::Anisotropy, mip_chain)));
        }
    }
    if settings.profile.has_pyramid() {
        let roughness = match model {
            Model::Anisotropic => Some((Content::Factor, Quantity::Factor)),
            Model::Isotropic => Some((Content::Lambda1, Quantity::Lambda1)),
            Model::None | Model::Auto => None,
        };
        for (content, quantity) in [(Content::Offset, Quantity::Offset)].into_iter().chain(roughness) {
            let first = if quantity == Quantity::Offset { 0 } else { first };
            let encoding = Encoding::of(settings, quantity.channels() as u32).starting_at(first);
            let Ranged { mip_chain, range } = bake_quantity(bumps.moments(), quantity, encoding)?;
            if quantity == Quantity::Factor {
                notes.extend(notes::of_factor(filter_loss(bumps.moments())));
            }
            textures.push(MapTexture { content, mip_chain, range: Some(range) });
        }
    }
    let is_modelled = textures.len() > 1;
    Ok(BakedMap { model: if is_modelled { model } else { Model::None }, textures, choice, notes })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bump::{NormalLayout, NormalMap};
    use crate::image::Samples;

    #[test]
    fn pngs_are_not_made_where_no_document_refers_to_them() {
        let image = Image { width: 8, height: 8, samples: Samples::U8(vec![128; 3 * 64]), channels: 3 };
        let bump_map = BumpMap::Normals(NormalMap::new(image, NormalLayout::Xyz, false).unwrap());
        let settings = Settings { form: Form::Fallback, ..Settings::default() };
        let own = BaseRoughness { image: None, factor: 0.5 };
        let baked = bake_map(&bump_map, Some(&own), &settings).unwrap();
        assert!(baked.textures.iter().all(|texture| texture.mip_chain.fallback.is_none()));
    }
}

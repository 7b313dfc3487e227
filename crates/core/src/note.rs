//! Notes to the user: what a bake left unchanged or cannot make exact, and why. Each function returns the note of one
//! kind with its sentence. docs/stability.md lists the kinds.

use std::fmt::{self, Display};

use serde::{Deserialize, Serialize};

use crate::bump::MAX_SLOPE;

/// A note to the user on a layer of a material, or on a standalone map.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
#[non_exhaustive]
pub struct Note {
    /// What the note is about.
    pub kind: NoteKind,
    /// Whether another source, document or setting can improve the result. The command line prints other notes with
    /// `--verbose` only.
    pub asks_for_action: bool,
    /// The note as a sentence.
    pub text: String,
}

/// What a [`Note`] is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
#[non_exhaustive]
pub enum NoteKind {
    /// The material has no normal or height map.
    NoBumpMap,
    /// The chosen model exceeds the error bound at some levels.
    MissedBound,
    /// The format of the bump map changes the bumps, such as JPEG.
    LossySource,
    /// Rounding of the bump map roughens the surface.
    SmallDepth,
    /// Normals point along the surface or below it.
    NormalsBelowSurface,
    /// Texels of a normal map with black parts hold no normal.
    UnusedTexels,
    /// Slopes are beyond the clamp.
    SteepSlopes,
    /// The map has another size than its textures.
    Resampled,
    /// Lobes are wider than an engine can show.
    AlphaAboveOne,
    /// Directions of anisotropy point away from those of neighbours.
    OpposedDirections,
    /// Filtering of D loses variance that filtering of K would keep.
    FilterLoss,
    /// The sampler of the bump map never reads mips.
    SamplerWithoutMips,
    /// The levels that the view can sample are not known.
    UnknownTexelSize,
    /// The size of a repeat of a height map is not known.
    UnknownRepeatSize,
    /// How the bump map lies on the mesh is not known.
    UnknownLayout,
    /// The meshes of the material are compressed, and the settings need their triangles.
    CompressedMesh,
    /// Parts of the bump map are used in several directions.
    ConflictingRotations,
    /// A texture of the base lobe has other texture coordinates than the bump map.
    OtherTextureCoordinates,
    /// A texture of the base lobe has another wrap mode than the bump map.
    OtherWrapMode,
    /// The reflectance of the material cannot be read.
    UnknownReflectance,
    /// The material has glossiness besides roughness.
    SpecularGlossiness,
    /// The material's anisotropy was dropped.
    AnisotropyDropped,
    /// The anisotropy of a material and its roughness stayed as they were.
    AnisotropyKept,
    /// The pyramid profile describes no layer but the base layer.
    LayerWithoutPyramid,
    /// The engine widens lobes a second time for bumps that the bake has counted.
    EngineLimiter,
    /// The engine does not show the mips of the container.
    MipsDropped,
    /// Lobes are anisotropic, and no engine was named.
    UnnamedEngine,
    /// The base colour was not darkened for suns.
    BaseColourUnchanged,
    /// The roughness of a standalone map is not known.
    NoBaseRoughness,
}

impl NoteKind {
    /// Returns whether notes of this kind ask the user for something. [`missed_bound`], [`normals_below_surface`],
    /// [`anisotropy_dropped`] and [`base_colour_unchanged`] decide for each of their notes.
    fn asks_for_action(self) -> bool {
        match self {
            // Another source file is better.
            Self::LossySource | Self::SmallDepth | Self::UnknownReflectance => true,
            // The document or the command line does not fit the purpose.
            Self::SamplerWithoutMips
            | Self::UnknownTexelSize
            | Self::OtherTextureCoordinates
            | Self::CompressedMesh
            | Self::NoBaseRoughness => true,
            // A setting of the engine or the bake is better.
            Self::EngineLimiter | Self::MipsDropped | Self::UnnamedEngine => true,
            Self::NoBumpMap
            | Self::MissedBound
            | Self::NormalsBelowSurface
            | Self::UnusedTexels
            | Self::SteepSlopes
            | Self::Resampled
            | Self::AlphaAboveOne
            | Self::OpposedDirections
            | Self::FilterLoss
            | Self::UnknownRepeatSize
            | Self::UnknownLayout
            | Self::ConflictingRotations
            | Self::OtherWrapMode
            | Self::SpecularGlossiness
            | Self::AnisotropyDropped
            | Self::AnisotropyKept
            | Self::LayerWithoutPyramid
            | Self::BaseColourUnchanged => false,
        }
    }
}

impl Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

fn note(kind: NoteKind, text: impl Into<String>) -> Note {
    Note { kind, asks_for_action: kind.asks_for_action(), text: text.into() }
}

/// Returns the note on a material without bumps.
pub fn no_bump_map() -> Note {
    note(NoteKind::NoBumpMap, "no normal or height map: no roughness is added")
}

/// Returns the note `text` on levels that exceed the error bound. `is_avoidable` if another setting comes closer to the
/// bound.
pub fn missed_bound(text: String, is_avoidable: bool) -> Note {
    Note { kind: NoteKind::MissedBound, asks_for_action: is_avoidable, text }
}

/// Returns the note on a bump map that is `format`, such as "a JPEG".
pub fn lossy_source(format: &str) -> Note {
    let text =
        format!("the bump map is {format}, and errors of its compression become roughness; use a lossless source");
    note(NoteKind::LossySource, text)
}

/// Returns the note on rounding of a bump map that moves the lobes of a smooth surface. `error` is the lobe error of
/// rounding alone.
pub fn small_depth(error: f32) -> Note {
    let text = format!(
        "the depth of the bump map is too small for so smooth a surface: rounding alone moves its lobes by {error:.3}; \
         use a map with more bits"
    );
    note(NoteKind::SmallDepth, text)
}

/// Returns the note on a normal map of `texels` texels, `count` of which have no slope. The note asks for action from
/// one texel in a thousand on: fewer are hardly seen.
pub fn normals_below_surface(count: u64, texels: u64) -> Note {
    let text = format!(
        "{count} of {texels} normals point along the surface or below it: they are baked with a slope of {MAX_SLOPE} \
         and roughen what is around them; remove them from the source"
    );
    Note { asks_for_action: count.saturating_mul(1000) >= texels, ..note(NoteKind::NormalsBelowSurface, text) }
}

/// Returns the note on a normal map of `texels` texels with black parts, where `count` texels hold no normal.
pub fn unused_texels(count: u64, texels: u64) -> Note {
    let text = format!(
        "{count} of {texels} texels are black, which is no normal, or point below the surface in a map with black \
         parts: they get normals of the texels around them"
    );
    note(NoteKind::UnusedTexels, text)
}

/// Returns the note on a bump map of `texels` texels, `count` of which have slopes beyond the clamp.
pub fn steep_slopes(count: u64, texels: u64) -> Note {
    let text = format!("{count} of {texels} texels are steeper than {MAX_SLOPE}: they are baked with that slope");
    note(NoteKind::SteepSlopes, text)
}

/// Returns the note on a map that was resampled from `source` to `grid` (columns, rows).
pub fn resampled(source: (u32, u32), grid: (u32, u32)) -> Note {
    let text = format!(
        "the map of {} x {} texels was resampled to {} x {}: block formats need multiples of 4",
        source.0, source.1, grid.0, grid.1
    );
    note(NoteKind::Resampled, text)
}

/// Returns the note on about `texels` texels over all levels whose lobes are wider than an engine can show.
pub fn alpha_above_one(texels: u64) -> Note {
    let text =
        format!("about {texels} texels over all levels are rougher than an engine can show: alpha is clamped to 1");
    note(NoteKind::AlphaAboveOne, text)
}

/// Returns the note on the share of texels whose direction of anisotropy points away from a neighbour's.
pub fn opposed_directions(share: f32) -> Note {
    let text = format!(
        "{:.1} % of the directions of anisotropy point away from a neighbour's, as around the centre of circular \
         grooves: filtering loses the direction there",
        100.0 * share
    );
    note(NoteKind::OpposedDirections, text)
}

/// Returns the note on a texture of D that loses the share `loss` of the variance under bilinear filtering.
pub fn filter_loss(loss: f32) -> Note {
    let text = format!(
        "halfway between texels, filtering D loses up to {:.0} % of the variance that filtering K would keep: \
         neighbours differ that much",
        100.0 * loss
    );
    note(NoteKind::FilterLoss, text)
}

/// Returns the note on a sampler whose minFilter has no mips.
pub fn sampler_without_mips() -> Note {
    let text = "the minFilter of the texture's sampler never reads mips: the bake has no effect in engines that obey \
                it; set one with mips";
    note(NoteKind::SamplerWithoutMips, text)
}

/// Returns the note on a material whose texels on the meshes have an unknown size.
pub fn unknown_texel_size(reason: &impl Display) -> Note {
    let text = format!(
        "{reason}, so that the levels which the view can sample are not known: every level counts as seen, and none is \
         left out; put the mesh into a scene with a fixed size, or bake without a view"
    );
    note(NoteKind::UnknownTexelSize, text)
}

/// Returns the note on heights whose unit on the mesh is not known.
pub fn unknown_repeat_size() -> Note {
    let text = "no mesh shows how large a repeat of the height map is: heights are taken in widths of a repeat";
    note(NoteKind::UnknownRepeatSize, text)
}

/// Returns the note on offsets that are in the unit frame because no mesh has the material.
pub fn unknown_layout() -> Note {
    let text = "no mesh shows how the texture lies on it: offsets are in the unit frame";
    note(NoteKind::UnknownLayout, text)
}

/// What a bake does not know of a material whose meshes are compressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unread {
    /// The size of texels, by which a view finds the levels that it can sample.
    TexelSize,
    /// The size of a repeat of a height map.
    RepeatSize,
    /// How the bump map lies on the meshes, on which frames other than the unit frame depend.
    Layout,
}

/// Returns the note on a material whose meshes `extension` compresses.
pub fn compressed_mesh(extension: &str, unread: Unread) -> Note {
    let cost = match unread {
        Unread::TexelSize => {
            "the levels which the view can sample are not known: every level counts as seen, and none is left out"
        }
        Unread::RepeatSize => {
            "the size of a repeat of the height map is not known: heights are taken in widths of a repeat"
        }
        Unread::Layout => "how the texture lies on them is not known: offsets are in the unit frame",
    };
    let text = format!(
        "meshes that show the material are compressed by {extension}, which the bake does not read, so that {cost}; \
         bake the asset before its meshes are compressed"
    );
    note(NoteKind::CompressedMesh, text)
}

/// Returns the note on offsets that are in the unit frame because the tangent rotation is not unique. `over_mesh` and
/// `over_map` are its deviations over the mesh and over texels that several triangles use.
pub fn conflicting_rotations(over_mesh: f32, over_map: f32) -> Note {
    let text = format!(
        "the tangent does not keep its angle to the main direction over the mesh (deviation {over_mesh:.2}), and parts \
         of the map are used in several directions (deviation {over_map:.2}): one offset map cannot serve, so offsets \
         are in the unit frame"
    );
    note(NoteKind::ConflictingRotations, text)
}

/// Returns the note on a texture of the base lobe, `roughness` or `anisotropy`, whose texels do not lie over those of
/// the bump map.
pub fn other_texture_coordinates(texture: &str) -> Note {
    let text = format!(
        "the {texture} texture has other texture coordinates or another KHR_texture_transform than the bumps: their \
         texels do not lie over each other, so the {texture} texture was left unchanged and lacks the roughness of \
         lost bumps; give both textures the same coordinates"
    );
    note(NoteKind::OtherTextureCoordinates, text)
}

/// Returns the note on a texture of the base lobe, `roughness` or `anisotropy`, whose wrap mode is not that of the bump
/// map.
pub fn other_wrap_mode(texture: &str) -> Note {
    let text = format!(
        "the sampler of the {texture} texture has another wrap mode than the sampler of the bumps: the texture was left \
         unchanged"
    );
    note(NoteKind::OtherWrapMode, text)
}

/// Returns the note on a material whose reflectance cannot be read for `reason`.
pub fn unknown_reflectance(reason: &impl Display) -> Note {
    let text = format!(
        "the base colour or KHR_materials_specular cannot be read, so that every texel counts by its area alone, \
         whatever its reflectance: {reason}"
    );
    note(NoteKind::UnknownReflectance, text)
}

/// Returns the note on a material with glossiness, which engines may read instead of roughness.
pub fn specular_glossiness() -> Note {
    let text = "the material has KHR_materials_pbrSpecularGlossiness, and engines that know it read glossiness: the \
                roughness was left unchanged";
    note(NoteKind::SpecularGlossiness, text)
}

/// Returns the note on an anisotropic material that was baked with the isotropic model because of `setting`. If
/// `is_seen`, the engine may read the anisotropy, and what was dropped is seen.
pub fn anisotropy_dropped(setting: &str, is_seen: bool) -> Note {
    let mut text = format!("the material's anisotropy was dropped because of `{setting}`");
    if is_seen {
        text += ": engines that read KHR_materials_anisotropy show another highlight than before; \
                 `--own-anisotropy keep` keeps it, without the roughness of lost bumps";
    }
    Note { kind: NoteKind::AnisotropyDropped, asks_for_action: is_seen, text }
}

/// Returns the note on a material whose anisotropy and roughness stay as they are.
pub fn anisotropy_kept() -> Note {
    let text = "the material's anisotropy and roughness were left unchanged (`--own-anisotropy keep`, which `--engine` \
                sets for engines that read anisotropy): these engines take the axes of the highlight from the surface, \
                so that bumps hardly move it";
    note(NoteKind::AnisotropyKept, text)
}

/// Returns the note on a layer of a material that the extension of the pyramid profile does not describe.
pub fn layer_without_pyramid(layer: &str) -> Note {
    let text = format!("the extension describes the base lobe only: no pyramid was written for the {layer}");
    note(NoteKind::LayerWithoutPyramid, text)
}

/// Returns the note on `engine`, which widens lobes by default for the bumps that it shades. `switch` says how its user
/// turns that off.
pub fn engine_limiter(engine: &str, switch: &str) -> Note {
    let text =
        format!("{engine} widens baked lobes a second time wherever normals differ from pixel to pixel: {switch}");
    note(NoteKind::EngineLimiter, text)
}

/// Returns the note on a .glb for `engine`, which drops the mips of images inside a .glb.
pub fn mips_dropped(engine: &str) -> Note {
    let text = format!(
        "{engine} drops the mips of images inside a .glb, and with them the baked roughness: write a .gltf (`-o \
         NAME.gltf`, without `--glb`)"
    );
    note(NoteKind::MipsDropped, text)
}

/// Returns the note on anisotropic lobes in a bake for no engine in particular.
pub fn unnamed_engine() -> Note {
    let text = "some lobes are anisotropic, and no engine of `--engine` shades these right: name your engine by \
                `--engine`; for an engine that shades them right, set `--max-model anisotropic`";
    note(NoteKind::UnnamedEngine, text)
}

/// Why a base colour was not darkened for suns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeptColour {
    /// It is a KTX2, which the bake does not change.
    Ktx2,
    /// Its texels do not lie over those of the bump map.
    OtherTexels,
    /// The metalness of its texels is not known.
    UnknownMetalness,
    /// It is a factor without a texture.
    NoTexture,
    /// No light falls on it.
    Unlit,
    /// Engines may read another colour.
    SpecularGlossiness,
}

/// Returns the note on a base colour that was not darkened for suns.
pub fn base_colour_unchanged(reason: KeptColour) -> Note {
    let (asks_for_action, reason) = match reason {
        KeptColour::Ktx2 => (true, "it is a KTX2 already; bake its PNG or JPEG"),
        KeptColour::OtherTexels => (
            true,
            "its texture coordinates, KHR_texture_transform or wrap mode are not those of the bumps; give both \
             textures the same",
        ),
        KeptColour::UnknownMetalness => (
            true,
            "its metalness is not known texel by texel; give the bumps and the textures of roughness and anisotropy \
             the same texture coordinates and wrap mode",
        ),
        KeptColour::NoTexture => (false, "it is a factor without a texture, and has no mips"),
        KeptColour::Unlit => (false, "the material has KHR_materials_unlit, so that no light falls on it"),
        KeptColour::SpecularGlossiness => (
            false,
            "the material has KHR_materials_pbrSpecularGlossiness, and engines that know it read another colour",
        ),
    };
    let text = format!("the base colour was not darkened for suns: {reason}");
    Note { kind: NoteKind::BaseColourUnchanged, asks_for_action, text }
}

/// Returns the note on a standalone map whose surface has no known roughness.
pub fn no_base_roughness() -> Note {
    let text = "the roughness of the surface is not known, so that no texture holds the roughness of lost bumps; give \
                --roughness-factor R, or --roughness IMAGE";
    note(NoteKind::NoBaseRoughness, text)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn notes_on_sources_and_documents_ask_for_action() {
        let asking = [
            lossy_source("a JPEG"),
            small_depth(0.1),
            normals_below_surface(1, 1000),
            no_base_roughness(),
            sampler_without_mips(),
            unknown_texel_size(&"the material is in no scene"),
            other_texture_coordinates("roughness"),
            engine_limiter("Godot", "turn its limiter off"),
            mips_dropped("Godot"),
            unnamed_engine(),
            compressed_mesh("KHR_draco_mesh_compression", Unread::Layout),
            unknown_reflectance(&"the image is damaged"),
            base_colour_unchanged(KeptColour::Ktx2),
            base_colour_unchanged(KeptColour::OtherTexels),
            base_colour_unchanged(KeptColour::UnknownMetalness),
            missed_bound("level 2 misses --max-error 0.1".to_owned(), true),
        ];
        asking.iter().for_each(|note| assert!(note.asks_for_action, "{note:?}"));
    }

    #[test]
    fn notes_that_only_explain_ask_for_nothing() {
        let explaining = [
            no_bump_map(),
            normals_below_surface(1, 1001),
            unused_texels(1, 4),
            steep_slopes(1, 4),
            resampled((61, 47), (64, 48)),
            alpha_above_one(3),
            opposed_directions(0.1),
            filter_loss(0.2),
            unknown_repeat_size(),
            unknown_layout(),
            conflicting_rotations(0.5, 0.5),
            other_wrap_mode("anisotropy"),
            specular_glossiness(),
            anisotropy_dropped("--model isotropic", false),
            anisotropy_kept(),
            layer_without_pyramid("clearcoat"),
            base_colour_unchanged(KeptColour::NoTexture),
            base_colour_unchanged(KeptColour::Unlit),
            base_colour_unchanged(KeptColour::SpecularGlossiness),
            missed_bound("level 2 misses --max-error 0.1".to_owned(), false),
        ];
        explaining.iter().for_each(|note| assert!(!note.asks_for_action, "{note:?}"));
        assert!(anisotropy_dropped("--model isotropic", true).asks_for_action, "the engine may read anisotropy");
    }

    #[test]
    fn a_note_is_an_object_of_the_report_and_reads_back() {
        let note = resampled((61, 47), (64, 48));
        let json = json!({
            "kind": "resampled",
            "asksForAction": false,
            "text": "the map of 61 x 47 texels was resampled to 64 x 48: block formats need multiples of 4",
        });
        assert_eq!(serde_json::to_value(&note).expect("JSON"), json);
        assert_eq!(serde_json::from_value::<Note>(json).expect("a note"), note);
    }
}

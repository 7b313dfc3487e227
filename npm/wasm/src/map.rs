//! The bake of a standalone map.

use std::path::Path;

use roughcast_core::api::{BumpTexels, MapProvenance, encode_map, read_base_roughness, read_bump_map};
use roughcast_core::bake::{BaseRoughness, output_stem_of};
use roughcast_core::bump::NormalLayout;
use roughcast_core::digest::digest;
use roughcast_core::image::DecodeOptions;
use roughcast_core::ktx2::SourceDigest;
use roughcast_core::material::notes;
use roughcast_core::mip::Wrap;
use roughcast_core::report::MapReport;
use roughcast_core::settings::Settings;
use roughcast_core::settings::values::Values;
use serde::Deserialize;

use crate::command::{Refusal, Reply, Response, first, settings};
use crate::message::File;

/// The header of a request, whose names are those of the flags of `roughcast map`.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Request {
    /// The name of the first output, which ends in .ktx2.
    output: String,
    settings: Values,
    /// Heights instead of normals.
    #[serde(default)]
    height: bool,
    /// The distance between heights 0 and 1, in widths of the map.
    height_scale: f32,
    /// The wrap mode of the sampler, across and down.
    #[serde(default)]
    wrap: [Wrap; 2],
    /// The channels that hold the normal.
    #[serde(default)]
    channels: NormalLayout,
    /// Green points down the image.
    #[serde(default)]
    green_down: bool,
    /// The layer of an EXR file.
    #[serde(default)]
    layer: Option<String>,
    /// The roughness of the base lobe, or the factor of its map.
    #[serde(default)]
    roughness_factor: Option<f32>,
}

impl Request {
    fn texels(&self) -> BumpTexels {
        if self.height {
            BumpTexels::Heights { scale: self.height_scale, wrap: self.wrap }
        } else {
            BumpTexels::Normals { layout: self.channels, is_green_down: self.green_down }
        }
    }
}

/// Bakes the first of `files`, with the second one as roughness map.
pub fn bake(request: &Request, files: &[File<'_>]) -> Result<Response, Refusal> {
    let image = first(files)?;
    let settings = settings(&request.settings).map_err(|error| error.to_string())?;
    let options = |file: &File<'_>, layer| decode_options(file.path, layer, &settings);
    let failed = |file: &File<'_>, error: roughcast_core::api::Error| format!("{}: {error}", file.path);
    let bump_map = read_bump_map(image.bytes, &request.texels(), &options(&image, request.layer.clone()))
        .map_err(|error| failed(&image, error))?;
    let factor = request.roughness_factor.unwrap_or(1.0);
    let base = match files.get(1) {
        Some(file) => {
            Some(read_base_roughness(file.bytes, factor, &options(file, None)).map_err(|error| failed(file, error))?)
        }
        None => request.roughness_factor.map(|factor| BaseRoughness { image: None, factor }),
    };
    let mut baked = encode_map(&bump_map, base.as_ref(), &settings).map_err(|error| error.to_string())?;
    baked.notes.extend(notes::of_file(image.bytes));
    let provenance = MapProvenance {
        texels: request.texels(),
        layer: request.layer.as_deref(),
        roughness_factor: request.roughness_factor,
        sources: files.iter().map(source).collect(),
    };
    let output = Path::new(&request.output);
    let (mut outputs, mut textures) = (Vec::new(), Vec::new());
    for (index, mut texture) in baked.textures.into_iter().enumerate() {
        let keys = provenance.keys(&texture, baked.model, &settings);
        let bytes = texture.mip_chain.take_ktx2(&keys).map_err(|error| error.to_string())?;
        let path = if index == 0 {
            request.output.clone()
        } else {
            format!("{}.{}.ktx2", output_stem_of(output), texture.content.name())
        };
        textures.push(texture.report(path.clone(), bytes.len()));
        outputs.push((path, bytes));
    }
    let report = MapReport::new(baked.model, baked.choice, baked.notes, textures);
    Ok((Reply::Map { report }, outputs))
}

fn decode_options(path: &str, layer: Option<String>, settings: &Settings) -> DecodeOptions {
    let extension = Path::new(path).extension().map(|extension| extension.to_string_lossy().into_owned());
    DecodeOptions { max_pixels: settings.max_texels, layer, extension }
}

fn source(file: &File<'_>) -> SourceDigest {
    let uri = Path::new(file.path).file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    SourceDigest { uri, blake3: digest(file.bytes) }
}

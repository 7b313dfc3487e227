//! Step 8: encoded levels become KTX2 files, with provenance.

use std::sync::Arc;

use rayon::prelude::*;

use crate::bake::decode::describe;
use crate::bake::group_output::GroupTexture;
use crate::codec::EncodeError;
use crate::digest::Digest;
use crate::gltf::texture::ImageLocation;
use crate::ktx2::{Provenance, SourceDigest};
use crate::settings::{RecordedSettings, Settings};

/// Makes the KTX2 files of `textures`, in parallel.
///
/// # Errors
/// [`EncodeError`] if there is no memory for a file.
pub fn ktx2_files(
    textures: Vec<GroupTexture>,
    settings: &Settings,
) -> Result<Vec<(GroupTexture, Vec<u8>)>, EncodeError> {
    let with_file = |mut texture: GroupTexture| {
        let keys = if settings.provenance { provenance(&texture, settings).keys() } else { Vec::new() };
        let ktx2 = texture.texture.mip_chain.take_ktx2(&keys)?;
        Ok((texture, ktx2))
    };
    textures.into_par_iter().map(with_file).collect()
}

fn provenance(texture: &GroupTexture, settings: &Settings) -> Provenance<RecordedSettings> {
    let source =
        |(location, blake3): &(Arc<ImageLocation>, Digest)| SourceDigest { uri: describe(location), blake3: *blake3 };
    Provenance {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        content: texture.texture.content.name().to_owned(),
        settings: RecordedSettings::new(settings, texture.texture.model),
        lobe_errors: texture.texture.lobe_errors.clone(),
        sources: texture.sources.iter().map(source).collect(),
    }
}

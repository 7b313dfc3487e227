//! The levels of a bake in memory, as an engine decodes them.

use std::error::Error;

use roughcast::bake::EncodedMap;
use roughcast::image::Image;
use roughcast::ktx2::Ktx2;
use roughcast::metric::Decoded;
use roughcast::report::Content;

/// Returns the KTX2 files of a bake, each with the content of its texture.
pub fn files_of(baked: &EncodedMap) -> Vec<(Content, Vec<u8>)> {
    baked.textures.iter().map(|t| (t.content, t.mip_chain.to_ktx2(&[]).unwrap())).collect()
}

/// Decodes a level of the files of a bake.
pub fn decoded(files: &[(Content, Vec<u8>)], level: u32) -> Result<Decoded, Box<dyn Error>> {
    let of = |content| -> Result<Option<Image>, Box<dyn Error>> {
        let file = files.iter().find(|f| f.0 == content);
        file.map(|(_, bytes)| Ok(Ktx2::parse(bytes)?.decode_level(level)?)).transpose()
    };
    Ok(Decoded {
        normal: of(Content::Normal)?.ok_or("the bake has no normals")?,
        roughness: of(Content::Roughness)?,
        roughness_factor: 1.0,
        anisotropy: of(Content::Anisotropy)?,
    })
}

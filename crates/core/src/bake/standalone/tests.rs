use super::*;
use crate::bump::{NormalLayout, NormalMap};
use crate::image::Samples;

#[test]
fn standalone_maps_have_no_png_fallbacks() {
    let image = Image { width: 8, height: 8, samples: Samples::U8(vec![128; 3 * 64]), channels: 3 };
    let bump_map = BumpMap::Normals(NormalMap::new(image, NormalLayout::Xyz, false).unwrap());
    let settings = Settings { gltf: Form::Fallback, ..Settings::default() };
    let base = BaseRoughness { image: None, factor: 0.5 };
    let baked = bake_map(&bump_map, Some(&base), &settings).unwrap();
    assert!(baked.textures.iter().all(|texture| texture.mip_chain.fallback.is_none()));
}

use super::*;
use crate::mip::Level;

fn constant(texel: [f32; 4]) -> Texture {
    Texture::with_mips(Level { width: 1, height: 1, texels: vec![texel] })
}

fn ranged(texel: [f32; 4], min: [f64; 3], max: [f64; 3]) -> RangedTexture {
    RangedTexture { texture: constant(texel), min, max }
}

fn read(texture: &Texture) -> [f64; 4] {
    texture.nearest([0.5, 0.5])
}

/// Roughness 0.5 is alpha 0.25; D = [[0.2, 0.1], [0, 0.3]] is K = [[0.05, 0.03], [0.03, 0.09]].
#[test]
fn pyramid_profile_applies_range_and_correction_factor() {
    let material = Material {
        // The unit normal (-0.6, 0, 0.8) of a slope of 0.75, of which two thirds are shown.
        bumps: Bumps::Offsets { texture: constant([0.2, 0.5, 0.9, 0.0]), scale: [2.0 / 3.0, 5.0], has_z: true },
        roughness: Some(constant([0.0, 0.5, 0.0, 0.0])),
        roughness_factor: 1.0,
        anisotropy: None,
        lost: LostBumps::Factor(ranged([0.5, 0.75, 0.75, 0.0], [0.0, -0.2, 0.0], [0.4, 0.2, 0.4]), 0.9),
    };
    let point = material.point(&read);
    let expected = normalised([-0.5, 0.0, 1.0]);
    let a = [0.0625 + 1.8 * 0.05, 1.8 * 0.03, 0.0625 + 1.8 * 0.09];
    for i in 0..3 {
        assert!((point.normal[i] - expected[i]).abs() < 1e-6, "{point:?}");
        assert!((point.squared_alpha[i] - a[i]).abs() < 1e-6, "{point:?}");
    }
    let bumps = Bumps::Offsets { texture: constant([0.2, 0.5, 0.0, 0.0]), scale: [2.0 / 3.0, 5.0], has_z: false };
    let rebuilt = Material { bumps, ..material.clone() }.point(&read);
    assert!((0..3).all(|i| (rebuilt.normal[i] - expected[i]).abs() < 1e-6), "{rebuilt:?}");
    let lost = LostBumps::Lambda1(ranged([0.5, 0.0, 0.0, 0.0], [0.0; 3], [0.4; 3]), 0.9);
    let point = Material { lost, ..material }.point(&read);
    assert!((point.squared_alpha[0] - 0.0625 - 1.8 * 0.04).abs() < 1e-6);
    assert_eq!(point.squared_alpha[0], point.squared_alpha[2]);
}

#[test]
fn gltf_textures_give_the_lobe_that_gltf_defines() {
    // Strength sqrt(1/3) and alpha 0.25 give 0.5 along the direction, which is rotated by 90 degrees.
    let material = Material {
        bumps: Bumps::Normals { texture: constant([0.8, 0.5, 0.9, 1.0]), scale: 0.5, has_z: true },
        roughness: None,
        roughness_factor: 0.5,
        anisotropy: Some(BaseAnisotropy { texture: None, strength: (1f64 / 3.0).sqrt(), rotation: [0.0, 1.0] }),
        lost: LostBumps::RoughenedTextures,
    };
    let point = material.point(&read);
    assert!((point.normal[0] - 0.3 / (0.09f64 + 0.64).sqrt()).abs() < 1e-6, "{point:?}");
    assert!((point.squared_alpha[0] - 0.0625).abs() < 1e-6 && (point.squared_alpha[2] - 0.25).abs() < 1e-6);
}

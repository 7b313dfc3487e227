use super::*;
use crate::image::{Image, Samples, srgb_to_linear};
use crate::lobe::reflectance::LUMINANCE;
use crate::material::{Factored, Metalness, ReflectanceSource};

/// Returns an image with constant red and blue, or with another red in its last texel.
fn surface(width: u32, height: u32, channels: u32, is_constant: bool) -> Image {
    let texel = |i: u32| [51, (i * 37 % 251) as u8, 102, 9];
    let mut bytes: Vec<u8> = (0..width * height).flat_map(|i| texel(i).into_iter().take(channels as usize)).collect();
    if !is_constant {
        let last = bytes.len() - channels as usize;
        bytes[last] = 52;
    }
    Image { width, height, channels, samples: Samples::U8(bytes) }
}

#[test]
fn constant_red_and_blue_do_not_change_the_lobes() {
    for (image, size) in
        [(surface(16, 8, 3, true), (16, 8)), (surface(7, 5, 4, true), (7, 5)), (surface(4, 4, 3, true), (16, 8))]
    {
        let rows = || BaseRows::new(size.0, size.1, Some(Rgba(&image)), 0.7, None, [Wrap::Repeat; 2]);
        let constant = Base::new(rows());
        assert!(
            matches!(constant.levels.texels, TexelLevels::ConstantRedBlue { red_blue: [0.2, 0.4], .. })
                && constant.has_constant_red_blue()
        );
        let texels = TexelLevels::Isotropic(MipTail::new(&IsotropicRows(&rows())));
        let isotropic = Base::with_levels(rows(), BaseLevels { texels, metalness: None });
        for (level, (width, height)) in constant.sizes().into_iter().enumerate() {
            for y in 0..height {
                let texels = [&constant, &isotropic].map(|base| {
                    let mut texels = vec![BaseTexel::default(); width as usize];
                    base.row(level, y, &mut texels);
                    texels
                });
                let red_blue = [&constant, &isotropic].map(|base| {
                    let mut red_blue = vec![[0.0; 2]; width as usize];
                    base.red_blue(level, y, &mut red_blue);
                    red_blue
                });
                for x in 0..width as usize {
                    let [a, b] = [texels[0][x], texels[1][x]];
                    assert_eq!(a[..3], b[..3], "level {level}, texel {x}, {y}");
                    let is_near = |(a, b): (&f32, &f32)| (a - b).abs() < 1e-6;
                    assert!(a.iter().zip(&b).all(is_near) && red_blue[0][x].iter().zip(&red_blue[1][x]).all(is_near));
                    assert!(red_blue[1][x].iter().zip(&b[3..]).all(is_near));
                }
            }
        }
    }
}

#[test]
fn one_other_red_is_not_constant() {
    let image = surface(16, 8, 3, false);
    let base = Base::new(BaseRows::new(16, 8, Some(Rgba(&image)), 1.0, None, [Wrap::Repeat; 2]));
    assert!(matches!(base.levels.texels, TexelLevels::Isotropic(_)) && !base.has_constant_red_blue());
    let anisotropy = || Some(BaseAnisotropy { texture: None, strength: 0.5, rotation: [1.0, 0.0] });
    for is_constant in [true, false] {
        let image = surface(16, 8, 3, is_constant);
        let rows = BaseRows::new(16, 8, Some(Rgba(&image)), 1.0, anisotropy(), [Wrap::Repeat; 2]);
        assert_eq!(Base::new(rows).has_constant_red_blue(), is_constant);
    }
    assert!(Base::new(BaseRows::new(4, 4, None, 1.0, None, [Wrap::Repeat; 2])).has_constant_red_blue());
}

/// At every level, the mean luminance of the base colour times the metalness is the mean of their product at level 0.
/// Black texels have the plain mean of metalness.
#[test]
fn metalness_counts_by_base_colour() {
    let image = |channel: fn(u32) -> u32, width: u32, height: u32| {
        let bytes = (0..width * height).flat_map(|i| [channel(i) as u8; 3]).collect();
        Image { width, height, channels: 3, samples: Samples::U8(bytes) }
    };
    for (width, height) in [(16, 8), (7, 5)] {
        let roughness = image(|i| i * 37 % 251, width, height);
        let colours = image(|i| i * 37 % 251 * (i % 3).min(1), width, height);
        let source = ReflectanceSource {
            roughness: Some(&roughness),
            metalness: Metalness::new(Some(&roughness), 0.8),
            base_colour: Factored { image: Some(&colours), factor: [1.0, 0.9, 0.5] },
            specular: Factored { image: None, factor: 1.0 },
            specular_colour: Factored { image: None, factor: [1.0; 3] },
        };
        let wrap = [Wrap::Repeat; 2];
        let reflectance = ReflectanceRows::new(&source, (width, height), wrap);
        let rows = BaseRows::new(width, height, Some(Rgba(&roughness)), 1.0, None, wrap).with_reflectance(reflectance);
        let base = Base::new(rows);
        let Samples::U8(metal) = &roughness.samples else { unreachable!() };
        let Samples::U8(colour) = &colours.samples else { unreachable!() };
        let factor: f64 = LUMINANCE.iter().zip([1.0, 0.9, 0.5]).map(|(l, f)| f64::from(*l) * f).sum();
        let luminance = |i: usize| factor * srgb_to_linear(f64::from(colour[3 * i]) / 255.0);
        let count = (width * height) as usize;
        let total: f64 = (0..count).map(luminance).sum();
        let product: f64 = (0..count).map(|i| luminance(i) * f64::from(metal[3 * i]) / 255.0).sum();
        let metalness = f64::from(base.coarsest()[4]);
        assert!((metalness - product / total).abs() < 1e-5, "{metalness} {}", product / total);
        let plain = (0..count).map(|i| f64::from(metal[3 * i]) / 255.0).sum::<f64>() / count as f64;
        assert!((metalness - plain).abs() > 0.01, "{metalness} {plain}");
        let (mut texels, mut level_0) = (vec![BaseTexel::default(); width as usize], vec![[0.0; 2]; width as usize]);
        base.row(0, 1, &mut texels);
        base.red_blue(0, 1, &mut level_0);
        for (x, texel) in texels.iter().enumerate() {
            assert_eq!(texel[4], f32::from(metal[3 * (width as usize + x)]) / 255.0);
            assert_eq!(texel[3..], level_0[x]);
        }
    }
}

use super::*;
use crate::image::{Image, Samples};

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
            matches!(constant.tail, BaseLevels::ConstantRedBlue { red_blue: [0.2, 0.4], .. })
                && constant.has_constant_red_blue()
        );
        let isotropic = Base::with_levels(rows(), BaseLevels::Isotropic(MipTail::new(&IsotropicRows(&rows()))));
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
    assert!(matches!(base.tail, BaseLevels::Isotropic(_)) && !base.has_constant_red_blue());
    let anisotropy = || Some(BaseAnisotropy { texture: None, strength: 0.5, rotation: [1.0, 0.0] });
    for is_constant in [true, false] {
        let image = surface(16, 8, 3, is_constant);
        let rows = BaseRows::new(16, 8, Some(Rgba(&image)), 1.0, anisotropy(), [Wrap::Repeat; 2]);
        assert_eq!(Base::new(rows).has_constant_red_blue(), is_constant);
    }
    assert!(Base::new(BaseRows::new(4, 4, None, 1.0, None, [Wrap::Repeat; 2])).has_constant_red_blue());
}

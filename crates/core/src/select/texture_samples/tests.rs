use crate::codec::Target;
use crate::ktx2::Ktx2;
use crate::material::{LevelRows, encode_mip_chain};
use crate::mip::level_sizes;
use crate::select::texture_samples::*;
use crate::settings::Settings;

/// Writes values that no block holds exactly.
fn values(level: usize, y: u32, out: &mut [[f32; 4]]) {
    for (x, texel) in out.iter_mut().enumerate() {
        let wave = |scale: f32| 0.5 + 0.4 * (scale * (x as f32 + 3.0 * y as f32) + level as f32).sin();
        *texel = [wave(0.7), wave(1.1), wave(0.3), 1.0];
    }
}

/// Writes lobes of several widths and shapes.
fn lobes(level: usize, y: u32, out: &mut [Lobe]) {
    for (x, lobe) in out.iter_mut().enumerate() {
        let alpha = |scale: f32| 0.1 + 0.08 * (scale * (x as f32 + 2.0 * y as f32) + level as f32).sin();
        let (a, b) = (alpha(0.4), alpha(0.9));
        *lobe = Lobe { uu: a * a, uv: 0.3 * a * b, vv: b * b };
    }
}

/// Every texel equals that of the whole texture, encoded and decoded.
#[test]
fn texels_are_those_of_the_encoded_texture() {
    for target in [
        Target::Basis,
        Target::Float,
        #[cfg(feature = "bc")]
        Target::Bc,
    ] {
        for (width, height) in [(36, 20), (4, 8), (12, 1)] {
            if target != Target::Float && height == 1 {
                continue;
            }
            let sizes = level_sizes(width, height);
            let settings = Settings { target, ..Settings::default() };
            let rows = LevelRows { values: &values, lobes: None };
            let normals = LevelRows { lobes: Some(&lobes), ..rows };
            let channels = (1..=3).map(|channels| (Encoding::of(&settings, channels), rows, channels));
            for (encoding, rows, channels) in channels.chain([(Encoding::of_normals(&settings), normals, 2)]) {
                let mip_chain = encode_mip_chain(&sizes, encoding, rows).unwrap();
                let texture =
                    TextureSampler { sizes: &sizes, first: 0, encoding: Some(encoding), rows, wrap: [Wrap::Repeat; 2] };
                let file = mip_chain.to_ktx2(&[]).unwrap();
                let file = Ktx2::parse(&file).unwrap();
                for (level, &size) in sizes.iter().enumerate() {
                    let image = file.decode_level(level as u32).unwrap();
                    let points: Vec<LevelTexel> =
                        (0..size.1).flat_map(|y| (0..size.0).map(move |x| LevelTexel { level, x, y })).collect();
                    for (&LevelTexel { x, y, .. }, texel) in points.iter().zip(texture.at(&sizes, &points).unwrap()) {
                        for c in 0..channels {
                            let whole = image.sample(x, y, c).unwrap();
                            assert_eq!(texel[c as usize], whole, "{target:?} {channels} {level} {x} {y}");
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn missing_levels_are_magnified_as_a_sampler_does() {
    let sizes = level_sizes(8, 8);
    let row = |level: usize, y: u32, out: &mut [[f32; 4]]| {
        for (x, texel) in out.iter_mut().enumerate() {
            *texel = [level as f32, x as f32, y as f32, 1.0];
        }
    };
    let rows = LevelRows { values: &row, lobes: None };
    let point = |(level, x, y)| LevelTexel { level, x, y };
    let at = |first, wrap, texel| {
        let texture = TextureSampler { sizes: &sizes, first, encoding: None, rows, wrap: [wrap; 2] };
        texture.at(&sizes, &[point(texel)]).unwrap()[0]
    };
    assert_eq!(at(0, Wrap::Repeat, (0, 5, 3)), [0.0, 5.0, 3.0, 1.0]);
    assert_eq!(at(1, Wrap::Repeat, (1, 2, 3)), [1.0, 2.0, 3.0, 1.0]);
    // The centre of texel 3 of 8 lies at 3.5 / 2 - 1/2 = 1.25 of 4.
    assert_eq!(at(1, Wrap::Repeat, (0, 3, 3)), [1.0, 1.25, 1.25, 1.0]);
    // That of texel 0 at -1/4: three quarters of texel 0, a quarter of texel 3 or of texel 0 again.
    assert_eq!(at(1, Wrap::Repeat, (0, 0, 3)), [1.0, 0.75, 1.25, 1.0]);
    assert_eq!(at(1, Wrap::Clamp, (0, 0, 3)), [1.0, 0.0, 1.25, 1.0]);
    // A texture of half the size holds its level 0 where the grid has level 1.
    let small = TextureSampler { sizes: &sizes[1..], first: 0, encoding: None, rows, wrap: [Wrap::Repeat; 2] };
    assert_eq!(
        small.at(&sizes, &[point((1, 2, 3)), point((3, 0, 0))]).unwrap(),
        [[0.0, 2.0, 3.0, 1.0], [2.0, 0.0, 0.0, 1.0]]
    );
}

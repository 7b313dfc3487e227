use super::*;

/// Makes 64 x 64 texels whose red is the column and whose green is the row.
fn ramp() -> Texture {
    let texel = |i: u32| [(i % 64) as f32 + 0.5, (i / 64) as f32 + 0.5, 0.0, 1.0];
    Texture::with_mips(Level { width: 64, height: 64, texels: (0..64 * 64).map(texel).collect() })
}

/// Linear interpolation of a linear ramp, and of its box mips, is the ramp.
#[test]
fn sampling_a_linear_ramp_returns_the_ramp() {
    let texture = ramp();
    for filter in [Filter::Trilinear, Filter::Anisotropic] {
        for (across, down) in [(0.1, 0.1), (3.0, 1.0), (1.0, 7.3), (4.0, 4.0)] {
            let footprint = Footprint { across: [across / 64.0, 0.0], down: [0.0, down / 64.0] };
            for uv in [[0.5, 0.5], [0.37, 0.61], [0.44, 0.5]] {
                let found = texture.sample(uv, &footprint, filter);
                assert!((found[0] - 64.0 * uv[0]).abs() < 1e-4, "{filter:?} {found:?}");
                assert!((found[1] - 64.0 * uv[1]).abs() < 1e-4, "{filter:?} {found:?}");
            }
        }
    }
}

#[test]
fn known_footprints_have_known_levels() {
    let texture = ramp();
    let of = |across: [f64; 2], down: [f64; 2], filter| {
        let taps = texture.taps(&Footprint { across, down }, filter);
        (taps.count, taps.level)
    };
    let texel = 1.0 / 64.0;
    assert_eq!(of([4.0 * texel, 0.0], [0.0, 4.0 * texel], Filter::Trilinear), (1, 2.0));
    assert_eq!(of([texel, 0.0], [0.0, 8.0 * texel], Filter::Trilinear), (1, 3.0));
    assert_eq!(of([texel, 0.0], [0.0, 8.0 * texel], Filter::Anisotropic), (8, 0.0));
    assert_eq!(of([2.0 * texel, 0.0], [0.0, 16.0 * texel], Filter::Anisotropic), (8, 1.0));
    // More than 16 taps take a coarser level. Levels stay between the first and the last.
    assert_eq!(of([0.0, 0.0], [0.0, 32.0 * texel], Filter::Anisotropic), (16, 1.0));
    assert_eq!(of([100.0, 0.0], [0.0, 100.0], Filter::Anisotropic), (1, 6.0));
    assert_eq!(of([0.0; 2], [0.0; 2], Filter::Anisotropic), (1, 0.0));
}

/// A footprint of 1 texel by 8 over stripes one texel wide: anisotropic filtering averages along the long side and
/// keeps stripes that are parallel to it.
#[test]
fn anisotropic_taps_average_along_the_footprint_only() {
    let stripes = |horizontal: bool| {
        let value = |i: u32| if horizontal { (i / 64 % 2) as f32 } else { (i % 2) as f32 };
        let texels = (0..64 * 64).map(|i| [value(i); 4]).collect();
        Texture::with_mips(Level { width: 64, height: 64, texels })
    };
    let footprint = Footprint { across: [1.0 / 64.0, 0.0], down: [0.0, 8.0 / 64.0] };
    let uv = [9.5 / 64.0, 0.5];
    let under = stripes(true).sample(uv, &footprint, Filter::Anisotropic)[0];
    assert!((under - 0.5).abs() < 0.07, "{under}");
    assert_eq!(stripes(false).sample(uv, &footprint, Filter::Anisotropic)[0], 1.0);
    assert_eq!(stripes(false).sample(uv, &footprint, Filter::Trilinear)[0], 0.5);
}

#[test]
fn textures_repeat() {
    let texture = ramp();
    let footprint = Footprint::default();
    let here = texture.sample([0.3, 0.8], &footprint, Filter::Trilinear);
    let there = texture.sample([5.3, -3.2], &footprint, Filter::Trilinear);
    for (a, b) in here.iter().zip(there) {
        assert!((a - b).abs() < 1e-6);
    }
    assert_eq!(texture.nearest([-1e-18, 1.0])[..2], [63.5, 0.5]);
}

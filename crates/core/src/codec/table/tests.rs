use half::f16;

use super::*;

const FORMATS: [PayloadFormat; 9] = [
    PayloadFormat::UastcRgb,
    PayloadFormat::UastcSrgb,
    PayloadFormat::UastcSrgbAlpha,
    PayloadFormat::Bc4,
    PayloadFormat::Bc5,
    PayloadFormat::Bc7,
    PayloadFormat::R16Float,
    PayloadFormat::Rg16Float,
    PayloadFormat::Rgba16Float,
];

#[test]
fn every_format_has_a_row() {
    assert_eq!(TABLE.len(), FORMATS.len());
    for format in FORMATS {
        let codec = format.codec();
        assert_eq!(codec.format, format);
        let model = match codec.identity {
            Identity::Vulkan(_) => None,
            Identity::Transcodable(descriptor) => descriptor().color_model,
        };
        let found = Codec::of_file(format.vulkan(), model).map(|codec| codec.format);
        // The colour model of UASTC does not tell colours from data, and both round alike.
        let expected = if codec.target == Target::Basis { PayloadFormat::UastcRgb } else { format };
        assert_eq!(found, Some(expected));
    }
    let srgb = Codec::of_file(Some(ktx2::Format::BC7_SRGB_BLOCK), None);
    assert_eq!(srgb.map(|codec| codec.format), Some(PayloadFormat::Bc7));
    assert!(Codec::of_file(Some(ktx2::Format::BC1_RGB_UNORM_BLOCK), None).is_none());
}

#[test]
fn every_target_has_a_format_for_each_number_of_channels() {
    let formats = |target: Target| [1, 2, 3].map(|channels| target.format(channels));
    assert_eq!(formats(Target::Basis), [PayloadFormat::UastcRgb; 3]);
    assert_eq!(formats(Target::Bc), [PayloadFormat::Bc4, PayloadFormat::Bc5, PayloadFormat::Bc7]);
    assert_eq!(formats(Target::Float), [PayloadFormat::R16Float, PayloadFormat::Rg16Float, PayloadFormat::Rgba16Float]);
}

#[test]
fn only_uastc_has_formats_for_colours() {
    assert_eq!(Target::Basis.colour_format(false), Some(PayloadFormat::UastcSrgb));
    assert_eq!(Target::Basis.colour_format(true), Some(PayloadFormat::UastcSrgbAlpha));
    assert!(PayloadFormat::UastcSrgbAlpha.has_alpha() && !PayloadFormat::UastcSrgb.has_alpha());
    assert!([Target::Bc, Target::Float].iter().all(|target| target.colour_format(false).is_none()));
}

#[cfg(feature = "cli")]
#[test]
fn every_target_has_formats_of_its_own_and_one_for_normals() {
    for &target in <Target as clap::ValueEnum>::value_variants() {
        assert!((1..=3).all(|channels| target.format(channels).codec().target == target), "{target:?}");
        assert_eq!(TABLE.iter().filter(|codec| codec.target == target && codec.holds_normals).count(), 1, "{target:?}");
    }
}

#[test]
fn normals_without_z_are_those_of_two_channels() {
    assert_eq!(Target::Bc.normal_format(), PayloadFormat::Bc5);
    assert!(!PayloadFormat::Bc5.has_z());
    assert!(Target::Basis.normal_format().has_z() && Target::Float.normal_format().has_z());
}

#[test]
fn halves_keep_the_sign_and_fill_alpha() {
    let texels = Texels { width: 1, height: 1, row: &|_, out| out[0] = [-1.5, 2.0, 0.25, 9.0], lobes: None };
    let bytes = encode(&texels, PayloadFormat::Rgba16Float, Metric::Rgb, Effort::Fast).unwrap();
    let halves: Vec<f32> = bytes.chunks(2).map(|b| f16::from_le_bytes([b[0], b[1]]).to_f32()).collect();
    assert_eq!(halves, [-1.5, 2.0, 0.25, 1.0]);
    assert_eq!(encode(&texels, PayloadFormat::Rg16Float, Metric::Rgb, Effort::Fast).unwrap(), bytes[..4]);
    assert_eq!(encode(&texels, PayloadFormat::R16Float, Metric::Rgb, Effort::Fast).unwrap(), bytes[..2]);
}

#[test]
fn halves_are_finite_or_an_error() {
    for value in [f32::NAN, f32::INFINITY, -1e5] {
        let texels = Texels { width: 1, height: 1, row: &|_, out| out[0] = [0.0, value, 0.0, 0.0], lobes: None };
        let found = encode(&texels, PayloadFormat::Rg16Float, Metric::Rgb, Effort::Fast);
        assert_eq!(found, Err(EncodeError::NotFinite { width: 1, height: 1 }));
        assert!(encode(&texels, PayloadFormat::R16Float, Metric::Rgb, Effort::Fast).is_ok());
    }
}

#[test]
fn every_format_fills_its_blocks() {
    let texels = Texels { width: 5, height: 3, row: &|y, out| out.fill([0.1 * y as f32; 4]), lobes: None };
    for format in FORMATS {
        match encode(&texels, format, Metric::Rgb, Effort::Fast) {
            Ok(bytes) => assert_eq!(bytes.len(), format.level_bytes(5, 3), "{format:?}"),
            Err(e) => assert!(!cfg!(feature = "bc") && e == EncodeError::WithoutBc, "{e}"),
        }
    }
}

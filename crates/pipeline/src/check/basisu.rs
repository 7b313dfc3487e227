//! Requirements of `KHR_texture_basisu` on a KTX2 file (section "KTX v2 Images with Basis Universal Supercompression").

use ktx2::dfd::DataFormatFlags;
use ktx2::{ColorModel, SupercompressionScheme};

use super::descriptor::Values;
use super::findings::{Code, Findings};
use crate::ktx2::Ktx2;

/// Checks the payload of a file whose texels are `values`. If `required`, the extension names the file, which must then
/// be Basis Universal.
pub fn check_basisu(file: &Ktx2<'_>, required: bool, values: Values, findings: &mut Findings) {
    let header = file.header();
    if header.pixel_height == 0 || header.pixel_depth > 0 || header.layer_count > 0 || header.face_count != 1 {
        let message = "expected a plain 2D texture, found a 1D, 3D, cube or array one; bake again";
        findings.add(Code::NotPlain2d, "header", message);
    }
    let Some(basic) = file.descriptor() else { return };
    if basic.flags.contains(DataFormatFlags::ALPHA_PREMULTIPLIED) {
        let message = "expected straight alpha, found the flag of premultiplied alpha; bake again";
        findings.add(Code::AlphaPremultiplied, "data format descriptor", message);
    }
    let scheme = header.supercompression_scheme;
    let is_uastc = match basic.color_model.filter(|_| header.format.is_none()) {
        Some(ColorModel::UASTC) => true,
        Some(ColorModel::ETC1S) => false,
        _ => {
            if required {
                let message = format!(
                    "expected UASTC, found {}: three.js and Godot load the texture, other engines do not; bake with \
                     --target basis",
                    file.format_name()
                );
                findings.add(Code::NotBasis, "header", message);
            }
            return;
        }
    };
    let allowed = match scheme {
        None | Some(SupercompressionScheme::Zstandard) => is_uastc,
        Some(SupercompressionScheme::BasisLZ) => !is_uastc,
        Some(_) => false,
    };
    if !allowed {
        let expected = if is_uastc { "none or Zstandard" } else { "BasisLZ" };
        let found = scheme.map_or_else(|| "none".to_owned(), |s| format!("{s:?}"));
        findings.add(Code::Scheme, "header", format!("expected {expected}, found {found}; bake again"));
    }
    if !is_uastc {
        let message =
            "expected UASTC, found ETC1S: Bevy refuses ETC1S, which is too coarse for data; bake with --target basis";
        findings.add(Code::NotUastc, "header", message);
    }
    // Channel 0 is RGB in both models, and channel 3 of UASTC is RGBA.
    let channels: Vec<u8> = basic.sample_information.iter().map(|s| s.channel_type).collect();
    if channels != [0] && !(values == Values::Colours && channels == [3]) {
        let message = format!(
            "expected the RGB channel (0), found {channels:?}: engines read other channels differently; bake again"
        );
        findings.add(Code::Channels, "data format descriptor", message);
    }
    if !(header.pixel_width.is_multiple_of(4) && header.pixel_height.is_multiple_of(4)) {
        let size = (header.pixel_width, header.pixel_height);
        let message =
            format!("expected multiples of 4, found {} x {}: WebGPU and S3TC refuse this; bake again", size.0, size.1);
        findings.add(Code::SizeMultiple, "header", message);
    }
}

//! Checks of the data format descriptor: it matches the format, and describes colours or data as its content says.

use ktx2::dfd::Basic;
use ktx2::{ColorModel, ColorPrimaries, TransferFunction};

use super::findings::{Code, Findings};
use crate::ktx2::Ktx2;
use crate::text::name_of;

const PLACE: &str = "data format descriptor";

/// What the texels of a file are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Values {
    /// sRGB colours, which may have alpha.
    Colours,
    /// Linear data without alpha.
    Data,
}

/// Checks model, blocks, samples, typeSize, transfer function and primaries.
pub fn check_descriptor(file: &Ktx2<'_>, values: Values, findings: &mut Findings) {
    let Some(found) = file.descriptor() else {
        findings.add(Code::Descriptor, PLACE, "expected a basic descriptor block, found none; bake again");
        return;
    };
    let header = file.header();
    let expected = header.format.and_then(|format| Basic::from_format(format).ok());
    let type_size = match (&expected, header.format) {
        (Some((_, size)), _) => Some(*size),
        // "typeSize": 1 for VK_FORMAT_UNDEFINED.
        (None, None) => Some(1),
        (None, Some(_)) => None,
    };
    if let Some(expected) = type_size.filter(|size| *size != header.type_size) {
        findings.add(Code::TypeSize, "header", format!("expected {expected}, found {}; bake again", header.type_size));
    }
    let supercompressed = header.supercompression_scheme.is_some();
    let mismatch = match (expected, header.format) {
        (Some((expected, _)), _) => mismatch(&expected, found, supercompressed),
        (None, None) => basis_mismatch(found, supercompressed),
        (None, Some(_)) => None,
    };
    if let Some(what) = mismatch {
        findings.add(Code::Descriptor, PLACE, format!("{what} for {}; bake again", file.format_name()));
    }
    let (transfer, primaries, effect) = match values {
        Values::Data => (TransferFunction::Linear, None, "engines would decode the data as colours"),
        Values::Colours => {
            (TransferFunction::SRGB, Some(ColorPrimaries::BT709), "engines would show the colours too bright")
        }
    };
    if found.transfer_function != Some(transfer) {
        let (expected, found) = (name_of(Some(&transfer)), name_of(found.transfer_function.as_ref()));
        let message = format!("expected {expected}, found {found}: {effect}; bake again");
        findings.add(Code::Transfer, PLACE, message);
    }
    if found.color_primaries != primaries {
        let (expected, found) = (name_of(primaries.as_ref()), name_of(found.color_primaries.as_ref()));
        findings.add(Code::Primaries, PLACE, format!("expected {expected}, found {found}; bake again"));
    }
}

/// Compares bytes of a plane. By "BITS_PER_PLANE", supercompressed files from before KTX 2.0.4 have 0.
fn is_plane(found: u8, expected: u8, supercompressed: bool) -> bool {
    found == expected || supercompressed && found == 0
}

fn mismatch(expected: &Basic, found: &Basic, supercompressed: bool) -> Option<String> {
    if found.color_model != expected.color_model {
        let (expected, found) = (name_of(expected.color_model.as_ref()), name_of(found.color_model.as_ref()));
        return Some(format!("expected colour model {expected}, found {found}"));
    }
    if found.texel_block_dimensions != expected.texel_block_dimensions {
        let sizes = (expected.texel_block_dimensions, found.texel_block_dimensions);
        return Some(format!("expected texel blocks of {:?}, found {:?}", sizes.0, sizes.1));
    }
    let planes = (expected.bytes_planes[0], found.bytes_planes[0]);
    if !is_plane(planes.1, planes.0, supercompressed) {
        return Some(format!("expected {} bytes a block, found {}", planes.0, planes.1));
    }
    (found.sample_information != expected.sample_information).then(|| {
        format!(
            "expected {} samples with the format's bits and channels, found others",
            expected.sample_information.len()
        )
    })
}

/// Returns how a Basis Universal descriptor differs from Khronos Data Format 1.3, section 5.6: blocks are 4 x 4, UASTC
/// has one sample of 128 bits, ETC1S one or two samples of 64 bits.
fn basis_mismatch(found: &Basic, supercompressed: bool) -> Option<String> {
    let (bits, plane) = match found.color_model {
        Some(ColorModel::UASTC) => (128, 16),
        Some(ColorModel::ETC1S) => (64, 0),
        model => return Some(format!("expected a Basis Universal colour model, found {}", name_of(model.as_ref()))),
    };
    if found.texel_block_dimensions.map(|size| size.get()) != [4, 4, 1, 1] {
        return Some(format!("expected texel blocks of [4, 4, 1, 1], found {:?}", found.texel_block_dimensions));
    }
    if !is_plane(found.bytes_planes[0], plane, supercompressed) {
        return Some(format!("expected {plane} bytes a block, found {}", found.bytes_planes[0]));
    }
    let samples = &found.sample_information;
    let count = if bits == 128 { 1..=1 } else { 1..=2 };
    let fits = count.contains(&samples.len()) && samples.iter().all(|s| s.bit_length.get() == bits);
    (!fits).then(|| format!("expected samples of {bits} bits, found {} samples of other sizes", samples.len()))
}

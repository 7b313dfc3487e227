//! Mutations of bytes, images, KTX2 headers and glTF trees.

use serde_json::{Value, json};

use super::random::Random;

/// Largest case, since mutations that repeat bytes could grow a case without bound.
const MAX_BYTES: usize = 1 << 18;

/// Changes some bytes, or removes or repeats a piece.
pub fn bytes(random: &mut Random, case: &mut Vec<u8>) {
    if case.is_empty() {
        return case.push(random.bits() as u8);
    }
    let at = random.below(case.len());
    let length = 1 + random.below((case.len() - at).min(64));
    match random.below(7) {
        0 => case[at] ^= 1 << random.below(8),
        1 => case[at] = *random.pick(&[0, 1, 0x7f, 0x80, 0xff, b'"', b'{', b'/', b'.']),
        2 => case.truncate(at),
        3 => drop(case.drain(at..at + length)),
        4 if case.len() < MAX_BYTES => {
            let piece = case[at..at + length].to_vec();
            let to = random.below(case.len());
            case.splice(to..to, piece);
        }
        5 => case[at..at + length].fill(random.bits() as u8),
        _ => {
            let number = *random.pick(&[0_u32, 1, 0x7fff_ffff, 0x8000_0000, 0xffff_ffff, 0x0001_0000, 16384]);
            let bytes = if random.below(2) == 0 { number.to_le_bytes() } else { number.to_be_bytes() };
            let end = case.len().min(at + 4);
            case[at..end].copy_from_slice(&bytes[..end - at]);
        }
    }
}

/// Changes bytes of an image after its first byte, which selects the format. The checksums of most PNGs are updated, so
/// that the damage reaches the decoder.
pub fn image(random: &mut Random, case: &mut Vec<u8>) {
    let mut rest = case.split_off(1.min(case.len()));
    bytes(random, &mut rest);
    if random.below(4) > 0 {
        update_png_checksums(&mut rest);
    }
    case.append(&mut rest);
}

/// Writes the correct CRC after every chunk of a PNG whose length is still valid.
fn update_png_checksums(file: &mut [u8]) {
    let mut at = 8;
    while file.starts_with(b"\x89PNG") && at + 12 <= file.len() {
        let length = u32::from_be_bytes([file[at], file[at + 1], file[at + 2], file[at + 3]]) as usize;
        let Some(end) = (at + 8).checked_add(length).filter(|end| end + 4 <= file.len()) else { return };
        let crc = crc32(&file[at + 4..end]);
        file[end..end + 4].copy_from_slice(&crc.to_be_bytes());
        at = end + 4;
    }
}

/// Returns the CRC-32 of PNG (ISO 3309).
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, byte: &u8| {
        let bit = |crc: u32, _| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 };
        (0..8).fold(crc ^ u32::from(*byte), bit)
    };
    !bytes.iter().fold(!0, step)
}

/// Changes a field of a KTX2 header or level index to an extreme value, or arbitrary bytes.
pub fn texture(random: &mut Random, case: &mut Vec<u8>) {
    if random.below(3) == 0 || case.len() < 104 {
        return bytes(random, case);
    }
    // The header has 32-bit fields from byte 12 on, and the level index 64-bit fields from byte 80 on (KTX 2.0, section
    // 3).
    let length = case.len() as u64;
    let value =
        *random.pick(&[0, 1, 2, 3, 1 << 14, 1 << 31, u64::from(u32::MAX), 1 << 62, u64::MAX, length, length - 1]);
    if random.below(2) == 0 {
        let at = 12 + 4 * random.below(17);
        case[at..at + 4].copy_from_slice(&(value as u32).to_le_bytes());
    } else {
        let at = 80 + 8 * random.below(3);
        case[at..at + 8].copy_from_slice(&value.to_le_bytes());
    }
}

/// Changes the JSON tree of a .gltf or .glb, or its bytes.
pub fn document(random: &mut Random, case: &mut Vec<u8>) {
    if random.below(4) == 0 {
        return bytes(random, case);
    }
    let is_glb = case.starts_with(b"glTF") && case.len() > 20;
    let text = if is_glb {
        let length = u32::from_le_bytes([case[12], case[13], case[14], case[15]]) as usize;
        case.get(20..20_usize.saturating_add(length))
    } else {
        Some(&case[..])
    };
    let Some(mut tree) = text.and_then(|text| serde_json::from_slice::<Value>(text).ok()) else {
        return bytes(random, case);
    };
    for _ in 0..=random.below(3) {
        value(random, &mut tree);
    }
    let mut json = tree.to_string().into_bytes();
    if is_glb {
        json.resize(json.len().next_multiple_of(4), b' ');
        let old = u32::from_le_bytes([case[12], case[13], case[14], case[15]]) as usize;
        let rest = case.get(20_usize.saturating_add(old)..).unwrap_or_default().to_vec();
        let total = 20 + json.len() + rest.len();
        let mut head = case[..8].to_vec();
        head.extend((total as u32).to_le_bytes());
        head.extend((json.len() as u32).to_le_bytes());
        *case = [&head, &b"JSON"[..], &json, &rest].concat();
    } else {
        *case = json;
    }
}

/// Follows a random path down the tree and changes the value at its end.
fn value(random: &mut Random, tree: &mut Value) {
    let descends = random.below(8) > 0;
    match tree {
        Value::Object(members) if descends && !members.is_empty() => {
            let key = members.keys().nth(random.below(members.len())).cloned().unwrap_or_default();
            if random.below(12) == 0 {
                members.remove(&key);
            } else if let Some(member) = members.get_mut(&key) {
                value(random, member);
            }
        }
        Value::Array(items) if descends && !items.is_empty() => {
            let index = random.below(items.len());
            match random.below(12) {
                0 => drop(items.remove(index)),
                1 if items.len() < 1000 => items.push(items[index].clone()),
                _ => value(random, &mut items[index]),
            }
        }
        other => *other = extreme(random),
    }
}

fn extreme(random: &mut Random) -> Value {
    let values = [
        json!(null),
        json!(true),
        json!(0),
        json!(1),
        json!(-1),
        json!(7),
        json!(4_294_967_295_u64),
        json!(u64::MAX),
        json!(1e300),
        json!(-1e-300),
        json!(0.5),
        json!(""),
        json!("../up.png"),
        json!("/etc/hostname"),
        json!("a%2F..%2F..%2Fb.png"),
        json!("data:image/png;base64,iVBORw0KGgo="),
        json!("data:,"),
        json!("\u{1b}]0;title\u{7}\n::error::"),
        json!("image/ktx2"),
        json!([]),
        json!({}),
        json!([[[]]]),
        json!({ "index": 0, "texCoord": 1, "scale": 1e38, "strength": -1 }),
        json!({ "KHR_texture_transform": { "offset": [1e38, 0], "rotation": 1e38, "scale": [0, 0] } }),
    ];
    random.pick(&values).clone()
}

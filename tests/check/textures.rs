//! Tests with one damaged KTX2 for each finding about textures.

use std::fs;
use std::sync::LazyLock;

use roughcast::check::{Code, Findings, Scope, Usage, check_texture};
use roughcast::codec::uastc::{Effort, Metric};
use roughcast::codec::{PayloadFormat, Texels, encode};
use roughcast::ktx2::{Key, Ktx2, Ktx2Writer, PROVENANCE_KEY, Provenance, StoredLevel};
use semver::Version;
use serde_json::json;

use crate::fixture::bake;

/// Offsets of the header (KTX 2.0, "File Structure").
const TYPE_SIZE: usize = 16;
const WIDTH: usize = 20;
const LAYERS: usize = 32;
const LEVELS: usize = 40;
const SCHEME: usize = 44;
const DESCRIPTOR: usize = 48;
const KEYS: usize = 56;
const INDEX: usize = 80;

/// A UASTC normal texture of 16 x 16, and one of half floats.
static UASTC: LazyLock<Vec<u8>> = LazyLock::new(|| fs::read(bake(&[]).texture("bumps.normal.ktx2")).unwrap());
static FLOAT: LazyLock<Vec<u8>> =
    LazyLock::new(|| fs::read(bake(&["--target", "float"]).texture("bumps.normal.ktx2")).unwrap());

fn word(file: &[u8], at: usize) -> usize {
    u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize
}

fn set(file: &mut [u8], at: usize, value: u32) {
    file[at..at + 4].copy_from_slice(&value.to_le_bytes());
}

/// Sets a byte of the descriptor's block: 8 is the colour model, 9 primaries, 10 transfer, 11 flags, 27 the channel.
fn set_descriptor(file: &mut [u8], byte: usize, value: u8) {
    let at = word(file, DESCRIPTOR) + 4 + byte;
    file[at] = value;
}

/// Replaces the first `from` by the equally long `to`.
fn replace(file: &mut [u8], from: &[u8], to: &[u8]) {
    assert_eq!(from.len(), to.len());
    let at = file.windows(from.len()).position(|w| w == from).unwrap();
    file[at..at + to.len()].copy_from_slice(to);
}

/// Returns offset and stored length of level 0.
fn level_0(file: &[u8]) -> (usize, usize) {
    (word(file, INDEX), word(file, INDEX + 8))
}

fn write(format: PayloadFormat, size: u32, levels: &[Vec<u8>], keys: &[Key]) -> Vec<u8> {
    let levels: Vec<_> =
        levels.iter().map(|level| StoredLevel::new(level.clone(), format, Effort::Fast).unwrap()).collect();
    Ktx2Writer { format, width: size, height: size, levels, keys }.into_bytes().unwrap()
}

fn normals(texel: [f32; 4], format: PayloadFormat) -> Vec<u8> {
    let level = |size| {
        let row = |_: u32, out: &mut [[f32; 4]]| out.fill(texel);
        encode(&Texels { width: size, height: size, row: &row, lobes: None }, format, Metric::Rgb, Effort::Fast)
            .unwrap()
    };
    write(format, 4, &[level(4), level(2), level(1)], &provenance().keys())
}

fn provenance() -> Provenance {
    Provenance {
        version: "0.1.0".into(),
        content: "normal".into(),
        settings: json!({}),
        lobe_errors: vec![],
        sources: vec![],
    }
}

/// Returns normals in half floats whose first component is NaN. Our writer would refuse to encode them.
fn not_finite() -> Vec<u8> {
    let level = |size: usize| [0x7e00_u16, 0x3800, 0x3c00, 0x3c00].map(u16::to_le_bytes).concat().repeat(size * size);
    let (format, keys) = (PayloadFormat::Rgba16Float, provenance().keys());
    write(format, 4, &[level(4), level(2), level(1)], &keys)
}

fn with_key(file: &[u8], key: &str, value: &str) -> Vec<u8> {
    let parsed = Ktx2::parse(file).unwrap();
    let levels: Vec<Vec<u8>> = (0..parsed.level_count()).map(|l| parsed.level_bytes(l).unwrap().into_owned()).collect();
    write(PayloadFormat::UastcRgb, 16, &levels, &[Key { key: key.into(), value: value.into() }])
}

/// Returns the provenance of a roughness texture with `maxError` 0.1.
fn roughness_provenance(lobe_errors: &[f32]) -> String {
    json!({
        "version": "0.1.0", "content": "roughness", "settings": { "maxError": 0.1 }, "lobeErrors": lobe_errors,
        "sources": []
    })
    .to_string()
}

type Damage = fn() -> Vec<u8>;

fn uastc(change: impl FnOnce(&mut Vec<u8>)) -> Vec<u8> {
    let mut file = UASTC.clone();
    change(&mut file);
    file
}

/// A damaged file for each finding, and the expected place of the finding.
pub const FIXTURES: &[(Code, &str, Damage)] = &[
    (Code::UnreadableTexture, "", || uastc(|f| f.truncate(100))),
    (Code::IncompleteChain, "header", || uastc(|f| set(f, LEVELS, 4))),
    (Code::LevelOrder, "level 0", || {
        uastc(|f| {
            let second = word(f, INDEX + 24);
            set(f, INDEX, second as u32);
        })
    }),
    (Code::LevelAlignment, "level 0", || {
        let mut file = FLOAT.clone();
        let moved = level_0(&file).0 as u32 + 4;
        set(&mut file, INDEX, moved);
        file.extend([0; 4]);
        file
    }),
    (Code::LevelLength, "level 2", || uastc(|f| set(f, INDEX + 2 * 24 + 16, 32))),
    (Code::KeyOrder, "key AAAwriter", || uastc(|f| replace(f, b"KTXwriter", b"AAAwriter"))),
    (Code::KeyEntry, "key/value data", || {
        uastc(|f| {
            let keys = word(f, KEYS);
            set(f, keys, u32::MAX);
        })
    }),
    (Code::NoWriter, "key KTXwriter", || uastc(|f| replace(f, b"KTXwriter", b"KTXwritex"))),
    (Code::Orientation, "key KTXorientation", || uastc(|f| replace(f, b"orientation\0rd", b"orientation\0ru"))),
    (Code::Swizzle, "key KTXswizzle", || with_key(&UASTC, "KTXswizzle", "bgra")),
    (Code::Descriptor, "data format descriptor", || uastc(|f| set_descriptor(f, 8, 1))),
    (Code::TypeSize, "header", || uastc(|f| set(f, TYPE_SIZE, 2))),
    (Code::Transfer, "data format descriptor", || uastc(|f| set_descriptor(f, 10, 2))),
    (Code::Primaries, "data format descriptor", || uastc(|f| set_descriptor(f, 9, 1))),
    (Code::NotBasis, "header", || FLOAT.clone()),
    (Code::NotUastc, "header", || uastc(|f| set_descriptor(f, 8, 163))),
    (Code::Scheme, "header", || uastc(|f| set(f, SCHEME, 3))),
    (Code::Channels, "data format descriptor", || uastc(|f| set_descriptor(f, 27, 3))),
    (Code::SizeMultiple, "header", || uastc(|f| set(f, WIDTH, 18))),
    (Code::NotPlain2d, "header", || uastc(|f| set(f, LAYERS, 1))),
    (Code::AlphaPremultiplied, "data format descriptor", || uastc(|f| set_descriptor(f, 11, 1))),
    (Code::UndecodableLevel, "level 0", || {
        uastc(|f| {
            let (offset, length) = level_0(f);
            f[offset..offset + length].fill(0xFF);
        })
    }),
    // The normal is (0, 0, 1/2).
    (Code::NormalLength, "level 1", || normals([0.5, 0.5, 0.75, 1.0], PayloadFormat::UastcRgb)),
    (Code::NotFinite, "level 0", not_finite),
    (Code::NoProvenance, "key roughcast", || with_key(&UASTC, "KTXwriter", "roughcast 0.1.0")),
    (Code::BadProvenance, "key roughcast", || uastc(|f| replace(f, b"{\"version\"", b"[\"version\""))),
    (Code::NewerVersion, "key roughcast", || uastc(|f| replace(f, b"\"version\":\"0.1.0\"", b"\"version\":\"0.1.1\""))),
    (Code::OldVersion, "key roughcast", || uastc(|f| replace(f, b"\"version\":\"0.1.0\"", b"\"version\":\"0.0.4\""))),
    (Code::BadProvenance, "key roughcast", || {
        uastc(|f| replace(f, b"\"version\":\"0.1.0\"", b"\"version\":\"0.1.x\""))
    }),
    (Code::LobeError, "key roughcast", || with_key(&UASTC, PROVENANCE_KEY, &roughness_provenance(&[0.05, 0.11]))),
    (Code::OtherVersion, "key roughcast", || uastc(|f| replace(f, b"\"version\":\"0.1.0\"", b"\"version\":\"0.0.9\""))),
];

fn check(file: &[u8]) -> Vec<(Code, String)> {
    check_to(true, file)
}

fn check_to(is_deep: bool, file: &[u8]) -> Vec<(Code, String)> {
    let mut findings = Findings::new("file.ktx2");
    let min_version = Version::new(0, 0, 5);
    let scope = Scope { is_deep, min_version: Some(&min_version), ..Scope::default() };
    check_texture(file, Usage { by_basisu: true, ..Usage::default() }, &scope, &mut findings);
    findings.into_list().into_iter().map(|f| (f.code, f.place)).collect()
}

#[test]
fn whole_textures_are_clean() {
    assert_eq!(check(&UASTC), []);
    assert_eq!(check(&normals([0.5, 0.5, 1.0, 1.0], PayloadFormat::UastcRgb)), []);
}

#[test]
fn colours_are_srgb_and_may_have_alpha() {
    for format in [PayloadFormat::UastcSrgb, PayloadFormat::UastcSrgbAlpha] {
        let of = |content: &str| {
            let level = |size| {
                let row = |_: u32, out: &mut [[f32; 4]]| out.fill([0.2, 0.4, 0.6, 0.5]);
                let texels = Texels { width: size, height: size, row: &row, lobes: None };
                encode(&texels, format, Metric::Rgba, Effort::Fast).unwrap()
            };
            let provenance = Provenance { content: content.into(), ..provenance() };
            check(&write(format, 4, &[level(4), level(2), level(1)], &provenance.keys()))
        };
        assert_eq!(of("colour"), []);
        let found: Vec<Code> = of("linear").into_iter().map(|(code, _)| code).collect();
        let has_alpha = format == PayloadFormat::UastcSrgbAlpha;
        let expected = [Code::Transfer, Code::Primaries].into_iter().chain(has_alpha.then_some(Code::Channels));
        assert_eq!(found, expected.collect::<Vec<_>>());
    }
    let linear = Provenance { content: "colour".into(), ..provenance() };
    let level = |size: u32| vec![0; 16 * size.div_ceil(4).pow(2) as usize];
    let file = write(PayloadFormat::UastcRgb, 4, &[level(4), level(2), level(1)], &linear.keys());
    let found: Vec<Code> = check_to(false, &file).into_iter().map(|(code, _)| code).collect();
    assert_eq!(found, [Code::Transfer, Code::Primaries]);
}

#[test]
fn finds_each_damage_at_its_place() {
    for (code, place, damage) in FIXTURES {
        let found = check(&damage());
        assert!(found.contains(&(*code, (*place).to_owned())), "{code} {place}: {found:?}");
    }
}

/// Returns whether a finding needs decoded levels: 14xx.
fn is_of_texels(code: Code) -> bool {
    (1400..1500).contains(&(code as u16))
}

/// Without `--deep`, levels are not used: zeros in their place make no difference, and all other findings are reported.
#[test]
fn finds_all_but_texel_errors_without_the_levels() {
    for (code, place, damage) in FIXTURES {
        let file = damage();
        let found = check_to(false, &file);
        assert_eq!(found.contains(&(*code, (*place).to_owned())), !is_of_texels(*code), "{code} {place}: {found:?}");
        let expected: Vec<_> = check(&file).into_iter().filter(|(code, _)| !is_of_texels(*code)).collect();
        assert_eq!(found, expected, "{code}");
        let Ok(parsed) = Ktx2::parse(&file) else { continue };
        let mut head = file.clone();
        for level in parsed.levels() {
            head[level.offset as usize..][..level.length as usize].fill(0);
        }
        // If a level overlaps another section, zeros would damage that section.
        if *code != Code::LevelOrder {
            assert_eq!(check_to(false, &head), found, "{code}");
        }
    }
}

#[test]
fn lobe_errors_within_the_bound_are_no_finding() {
    let found = check(&with_key(&UASTC, PROVENANCE_KEY, &roughness_provenance(&[0.05, 0.1])));
    assert!(found.iter().all(|(code, _)| *code != Code::LobeError), "{found:?}");
}

/// A truncated file has an error and causes no panic.
#[test]
fn every_truncation_is_an_error() {
    for length in 0..UASTC.len() {
        let found = check(&UASTC[..length]);
        assert!(found.iter().any(|(code, _)| code.severity() == roughcast::check::Severity::Error), "{length}");
    }
}

/// No changed byte causes a panic.
#[test]
fn survives_every_changed_byte() {
    for at in 0..UASTC.len().min(600) {
        for value in [0, 1, 0x7F, 0xFF] {
            check(&uastc(|f| f[at] = value));
        }
    }
}

/// A file of another writer has no findings unless it cannot be read.
#[test]
fn only_reads_textures_of_other_writers() {
    let mut file = with_key(&UASTC, "KTXwriter", "toktx v4.3");
    set_descriptor(&mut file, 10, 2);
    assert_eq!(check(&file), []);
    assert_eq!(check(&file[..file.len() - 1]), [(Code::UnreadableTexture, String::new())]);
}

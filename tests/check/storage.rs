//! Tests of the bounds of storage errors: defects are found as soon as they are larger than the format explains.

use std::fs;

use roughcast::check::{Code, Finding, Findings, Scope, Usage, check_texture};
use roughcast::cli::Outcome;
use roughcast::codec::uastc::{Effort, Metric};
use roughcast::codec::{PayloadFormat, Texels, encode};
use roughcast::ktx2::{Key, Ktx2, Ktx2Writer, StoredLevel, provenance};
use serde_json::Value;

use crate::fixture::{Bake, bake, roughcast};

const EXTENSION: &str = "/materials/0/extensions/ROUGHCAST_materials_roughness_pyramid";

/// Returns the formats of offset textures that this build writes.
fn formats() -> Vec<PayloadFormat> {
    let mut formats = vec![PayloadFormat::UastcRgb, PayloadFormat::Rgba16Float];
    formats.extend(cfg!(feature = "bc").then_some(PayloadFormat::Bc5));
    formats
}

/// Encodes a texture of 16 x 16. `texel` gives texels in [0, 1] by level, column and row.
fn texture(
    format: PayloadFormat,
    metric: Metric,
    keys: &[Key],
    texel: impl Fn(u32, u32, u32) -> [f64; 3] + Sync,
) -> Vec<u8> {
    let level = |level: u32| {
        let row = |y: u32, out: &mut [[f32; 4]]| {
            for (x, out) in out.iter_mut().enumerate() {
                let [r, g, b] = texel(level, x as u32, y).map(|c| c as f32);
                *out = [r, g, b, 1.0];
            }
        };
        let size = 16 >> level;
        let payload =
            encode(&Texels { width: size, height: size, row: &row, lobes: None }, format, metric, Effort::Fast)
                .unwrap();
        StoredLevel::new(payload, format, Effort::Fast).unwrap()
    };
    Ktx2Writer { format, width: 16, height: 16, levels: (0..5).map(level).collect(), keys }.into_bytes().unwrap()
}

/// Returns the keys of a texture that this tool has written.
fn keys(bytes: &[u8]) -> Vec<Key> {
    provenance(&Ktx2::parse(bytes).unwrap()).unwrap().keys()
}

/// Returns the levels of the findings of kind `code`.
fn levels(findings: &[Finding], code: Code) -> Vec<u32> {
    let found = findings.iter().filter(|f| f.code == code);
    found.map(|f| f.place.rsplit(' ').next().unwrap().parse().unwrap()).collect()
}

/// Returns the number after `label` in a message.
fn number(message: &str, label: &str) -> f64 {
    let (_, rest) = message.split_once(label).unwrap_or_else(|| panic!("{label}: {message}"));
    let end = rest.find(|c: char| !matches!(c, '0'..='9' | '.' | '+' | '-')).unwrap_or(rest.len());
    rest[..end].trim_end_matches('.').parse().unwrap()
}

fn check_normals(format: PayloadFormat, normal: impl Fn(u32, u32, u32) -> [f64; 3] + Sync) -> Vec<Finding> {
    let keys = keys(&fs::read(bake(&[]).texture("bumps.normal.ktx2")).unwrap());
    let texel = |level, x, y| normal(level, x, y).map(|c| 0.5 * c + 0.5);
    let file = texture(format, Metric::Direction, &keys, texel);
    let mut findings = Findings::new("normal.ktx2");
    let scope = Scope { is_deep: true, ..Scope::default() };
    check_texture(&file, Usage { normals: true, ..Usage::default() }, &scope, &mut findings);
    findings.into_list()
}

/// Returns rough slopes that differ from texel to texel.
fn slope(x: u32, y: u32) -> [f64; 2] {
    let noise =
        |seed: u32| f64::from((x * 7919 + y * 104_729 + seed).wrapping_mul(2_654_435_761) >> 16) / 65536.0 - 0.5;
    [2.0 * noise(1), 1.6 * noise(77)]
}

fn unit([u, v]: [f64; 2]) -> [f64; 3] {
    let length = f64::sqrt(u * u + v * v + 1.0);
    [-u / length, -v / length, 1.0 / length]
}

/// Returns the mean of `value` over the footprint of a texel.
fn mean<const N: usize>(level: u32, x: u32, y: u32, value: impl Fn(u32, u32) -> [f64; N]) -> [f64; N] {
    let edge = 1 << level;
    let mut sum = [0.0; N];
    for (dx, dy) in (0..edge).flat_map(|dy| (0..edge).map(move |dx| (dx, dy))) {
        let value = value(x * edge + dx, y * edge + dy);
        sum.iter_mut().zip(value).for_each(|(sum, value)| *sum += value / f64::from(edge * edge));
    }
    sum
}

/// Unit normals are clean in every format. Averaged normals are found at every level except the first in floats, but
/// only at the last level in blocks: at the other levels, texels of a block are so far apart, and endpoints have so few
/// levels, that storage explains the defect.
#[test]
fn finds_averaged_normals_but_no_unit_normals() {
    for (format, expected) in [(PayloadFormat::UastcRgb, vec![4]), (PayloadFormat::Rgba16Float, vec![1, 2, 3, 4])] {
        let normalised = |level, x, y| unit(mean(level, x, y, slope));
        assert_eq!(levels(&check_normals(format, normalised), Code::NormalLength), [] as [u32; 0], "{format:?}");
        let averaged = |level, x, y| mean(level, x, y, |x, y| unit(slope(x, y)));
        let found = check_normals(format, averaged);
        assert_eq!(levels(&found, Code::NormalLength), expected, "{format:?}: {found:?}");
    }
}

/// Equal normals are found as soon as they are shorter than rounding explains.
#[test]
fn finds_lengths_just_outside_the_bound() {
    for (format, step) in [(PayloadFormat::UastcRgb, 2.0 / 255.0), (PayloadFormat::Rgba16Float, 0.002)] {
        let check = |length: f64| check_normals(format, |_, _, _| unit([0.5, -0.3]).map(|c| c * length));
        let lengths = (0..40).map(|n| 1.0 - 0.25 * step * f64::from(n));
        let found = lengths.map(check).find(|findings| !levels(findings, Code::NormalLength).is_empty()).unwrap();
        let message = &found.iter().find(|f| f.code == Code::NormalLength).unwrap().message;
        let (deviation, limit) = (-number(message, "off by "), number(message, "storage explains "));
        // Printed numbers are rounded.
        assert!(deviation > limit - 1e-4 && deviation < limit + 2.0 * step, "{format:?}: {message}");
    }
}

/// Bakes a pyramid and replaces its offset texture by one of `normal`, encoded as `format`.
fn with_offsets(format: PayloadFormat, normal: impl Fn(u32, u32, u32) -> [f64; 3] + Sync) -> Bake {
    let bake = bake(&["--profile", "pyramid", "--model", "none", "--gltf", "strict"]);
    let path = bake.texture("bumps.offset.ktx2");
    let keys = keys(&fs::read(&path).unwrap());
    let texel = |level, x, y| normal(level, x, y).map(|c| 0.5 * c + 0.5);
    fs::write(&path, texture(format, Metric::Direction, &keys, texel)).unwrap();
    bake.edit(|document| {
        let extension = document.pointer_mut(EXTENSION).unwrap();
        extension["offsetChannels"] = serde_json::json!(if format.has_z() { 3 } else { 2 });
    });
    bake
}

fn level_messages(bake: &Bake) -> Vec<String> {
    let (_, report) = bake.check(&["--deep"]);
    let findings = report["findings"].as_array().unwrap().iter().filter(|f| f["code"] == "RC1404");
    findings.map(|f| f["message"].as_str().unwrap().to_owned()).collect()
}

/// Rounded mean slopes are clean. Offsets are found if they are just further from the mean than rounding explains.
#[test]
fn finds_directions_just_outside_the_bound() {
    for format in formats() {
        let rough = with_offsets(format, |level, x, y| unit(mean(level, x, y, slope)));
        assert_eq!(level_messages(&rough), [] as [String; 0], "{format:?}");
        let step = if format == PayloadFormat::Rgba16Float { 0.001 } else { 2.0 / 255.0 };
        let turned =
            |turn: f64| with_offsets(format, move |level, _, _| unit([0.2, -0.1 - turn * f64::from(level.min(1))]));
        let found = (0..32).map(|n| level_messages(&turned(0.5 * step * f64::from(n)))).find(|found| !found.is_empty());
        let message = &found.unwrap()[0];
        let (distance, limit) = (number(message, "found "), number(message, "within "));
        // Printed numbers are rounded.
        assert!(distance > limit - 1e-4 && distance < limit + 3.0 * step, "{format:?}: {message}");
    }
}

/// D that is scaled up has more variance than all bumps of the first level. It is found as soon as it has twice their
/// variance and what storage explains. The ridges are one texel wide, and most of their variance vanishes where
/// samplers interpolate them: D has to be scaled by more than 2.
#[test]
fn finds_lobes_just_wider_than_the_bound() {
    let targets: &[&str] = if cfg!(feature = "bc") { &["basis", "bc", "float"] } else { &["basis", "float"] };
    for target in targets {
        let options = ["--profile", "pyramid", "--model", "anisotropic", "--gltf", "strict", "--target", target];
        let scaled = |factor: f64| {
            let bake = bake(&options);
            bake.edit(|document| {
                for member in ["roughnessMin", "roughnessMax"] {
                    let range = document.pointer_mut(EXTENSION).unwrap()[member].as_array_mut().unwrap();
                    range.iter_mut().for_each(|v: &mut Value| *v = serde_json::json!(v.as_f64().unwrap() * factor));
                }
            });
            level_messages(&bake)
        };
        assert_eq!(scaled(1.0), [] as [String; 0], "{target}");
        let factors = (1..100).map(|n| 1.0 + 0.05 * f64::from(n));
        let (factor, found) = factors.map(|f| (f, scaled(f))).find(|(_, found)| !found.is_empty()).unwrap();
        assert!(factor < 5.0, "{target}: {factor}: {found:?}");
        let message = &found[0];
        let [limit, found, bumps, storage] =
            ["at most ", "found ", "level have ", "storage explains "].map(|label| number(message, label));
        assert!((limit - std::f64::consts::SQRT_2 * bumps - storage).abs() < 3e-4, "{target}: {message}");
        assert!(found > limit - 1e-4 && found < 1.1 * limit, "{target}: {message}");
    }
}

/// `--fix` bakes textures with wrong levels or lengths again, and the new bake is clean.
#[test]
fn a_bake_fixes_levels_and_lengths() {
    let bake = bake(&["--profile", "both", "--model", "anisotropic"]);
    for name in ["bumps.offset.ktx2", "bumps.normal.ktx2"] {
        let path = bake.texture(name);
        let keys = keys(&fs::read(&path).unwrap());
        let short = texture(PayloadFormat::UastcRgb, Metric::Rgb, &keys, |level, _, _| {
            [0.5, 0.3 + 0.1 * f64::from(level), 0.6]
        });
        fs::write(path, short).unwrap();
    }
    let codes = |report: &Value| {
        let findings = report["findings"].as_array().unwrap().iter().filter(|f| f["severity"] == "error");
        let mut codes: Vec<String> = findings.map(|f| f["code"].as_str().unwrap().to_owned()).collect();
        codes.dedup();
        codes
    };
    let settings = ["--profile", "both", "--model", "anisotropic"];
    let (_, report) = bake.check_source(&[&["--deep"], &settings[..]].concat());
    assert_eq!(codes(&report), ["RC1404", "RC1402"], "{report:#}");
    let baked = bake.baked.to_str().unwrap();
    let fix = ["check", baked, "--source", bake.source.to_str().unwrap(), "--deep", "--fix"];
    let (outcome, _, err) = roughcast(&[&fix[..], &settings[..]].concat());
    assert!(outcome == Outcome::Done && err.starts_with("baked again: "), "{err}");
    let (outcome, report) = bake.check_source(&[&["--deep"], &settings[..]].concat());
    assert_eq!((outcome, codes(&report)), (Outcome::Done, vec![]), "{report:#}");
}

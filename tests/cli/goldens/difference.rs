//! What changed between two files: values of texels, lines of documents, sizes.

use std::slice;

use roughcast::decode::decode;
use roughcast::image::{DecodeOptions, Image};
use roughcast::ktx2::Ktx2;

/// Most lines of a document that are described.
const MAX_LINES: usize = 30;

/// Describes what changed from `old` to `new` in lines that are indented by two spaces.
pub fn describe(path: &str, old: &[u8], new: &[u8]) -> String {
    let mut text = format!("  {} -> {} bytes\n", old.len(), new.len());
    if path.ends_with(".gltf") {
        let [old, new] = [old, new].map(String::from_utf8_lossy);
        let lines = changed_lines(&old, &new);
        lines.iter().take(MAX_LINES).for_each(|line| text += &format!("  {line}\n"));
        if lines.len() > MAX_LINES {
            text += &format!("  ... {} more lines\n", lines.len() - MAX_LINES);
        }
    } else if path.ends_with(".ktx2") || path.ends_with(".png") {
        text += &match (levels(path, old), levels(path, new)) {
            (Ok(old), Ok(new)) => describe_levels(&old, &new),
            (Err(error), _) | (_, Err(error)) => format!("  cannot be decoded: {error}\n"),
        };
    }
    text
}

/// Returns whether all levels of two textures have equal sizes and differ by at most `mean` on average and `worst` at
/// a texel.
pub fn is_within(path: &str, old: &[u8], new: &[u8], mean: f64, worst: f64) -> bool {
    let (Ok(old), Ok(new)) = (levels(path, old), levels(path, new)) else { return false };
    let is_close = |(old, new): (&Image, &Image)| {
        difference(old, new).is_some_and(|difference| difference.mean <= mean && difference.worst <= worst)
    };
    old.len() == new.len() && old.iter().zip(&new).all(is_close)
}

/// Decodes all levels of a KTX2 file, or the image of another file.
fn levels(path: &str, bytes: &[u8]) -> Result<Vec<Image>, String> {
    if !path.ends_with(".ktx2") {
        return decode(bytes, &DecodeOptions::default()).map(|image| vec![image]).map_err(|error| error.to_string());
    }
    let file = Ktx2::parse(bytes).map_err(|error| error.to_string())?;
    (0..file.level_count()).map(|level| file.decode_level(level).map_err(|error| error.to_string())).collect()
}

fn describe_levels(old: &[Image], new: &[Image]) -> String {
    let mut text = String::new();
    if old.len() != new.len() {
        text += &format!("  {} -> {} levels\n", old.len(), new.len());
    }
    for (level, (old, new)) in old.iter().zip(new).enumerate() {
        text += &match difference(old, new) {
            None => {
                let shape = |image: &Image| format!("{} x {} x {}", image.width, image.height, image.channels);
                format!("  level {level}: {} -> {}\n", shape(old), shape(new))
            }
            Some(Difference { worst: 0.0, .. }) => continue,
            Some(Difference { mean, worst, x, y, channel }) => {
                format!(
                    "  level {level}: mean difference {mean:.6}, worst {worst:.6} at ({x}, {y}), channel {channel}\n"
                )
            }
        };
    }
    if text.is_empty() { "  all texels are equal\n".to_owned() } else { text }
}

/// Absolute differences between the values of two images.
#[derive(Debug, PartialEq)]
struct Difference {
    mean: f64,
    worst: f64,
    /// Column, row and channel of the worst difference.
    x: usize,
    y: usize,
    channel: usize,
}

/// Returns how much two images differ, or `None` if they have different sizes.
fn difference(old: &Image, new: &Image) -> Option<Difference> {
    let shape = |image: &Image| (image.width, image.height, image.channels);
    if shape(old) != shape(new) {
        return None;
    }
    let value = |image: &Image, i| f64::from(image.samples.get(i).unwrap_or(f32::NAN));
    let count = old.samples.len();
    let (mut sum, mut worst, mut at) = (0.0, 0.0, 0);
    for i in 0..count {
        let difference = (value(old, i) - value(new, i)).abs();
        sum += difference;
        // NaN on one side only is the worst difference.
        if difference > worst || difference.is_nan() {
            (worst, at) = (difference, i);
        }
    }
    let (width, channels) = (old.width as usize, old.channels as usize);
    let (texel, channel) = (at / channels, at % channels);
    Some(Difference { mean: sum / count as f64, worst, x: texel % width, y: texel / width, channel })
}

/// Returns the lines of `old` that are missing in `new`, marked `-`, and the new ones, marked `+`, in their order. The
/// others are a longest common subsequence.
fn changed_lines(old: &str, new: &str) -> Vec<String> {
    let (old, new): (Vec<&str>, Vec<&str>) = (old.lines().collect(), new.lines().collect());
    // common[i][j]: length of the longest common subsequence of old[i..] and new[j..].
    let mut common = vec![vec![0_u32; new.len() + 1]; old.len() + 1];
    for i in (0..old.len()).rev() {
        for j in (0..new.len()).rev() {
            common[i][j] = match old[i] == new[j] {
                true => common[i + 1][j + 1] + 1,
                false => common[i + 1][j].max(common[i][j + 1]),
            };
        }
    }
    let (mut i, mut j, mut lines) = (0, 0, Vec::new());
    while i < old.len() || j < new.len() {
        if i < old.len() && j < new.len() && old[i] == new[j] {
            (i, j) = (i + 1, j + 1);
        } else if j == new.len() || (i < old.len() && common[i + 1][j] >= common[i][j + 1]) {
            lines.push(format!("- {}", old[i].trim()));
            i += 1;
        } else {
            lines.push(format!("+ {}", new[j].trim()));
            j += 1;
        }
    }
    lines
}

#[test]
fn the_worst_texel_is_found() {
    let image =
        |values: Vec<u8>| Image { width: 3, height: 2, channels: 2, samples: roughcast::image::Samples::U8(values) };
    let old = image(vec![0; 12]);
    let new = image(vec![0, 0, 0, 0, 0, 51, 0, 0, 0, 255, 0, 0]);
    let found = difference(&old, &new).expect("equal sizes");
    assert!((found.mean - 0.1).abs() < 1e-6 && (found.worst - 1.0).abs() < 1e-6, "{found:?}");
    assert_eq!((found.x, found.y, found.channel), (1, 1, 1));
    assert_eq!(difference(&old, &Image { width: 1, height: 1, ..old.clone() }), None);
    assert_eq!(describe_levels(slice::from_ref(&old), slice::from_ref(&old)), "  all texels are equal\n");
    assert!(describe_levels(&[old], &[new]).contains("worst 1.000000 at (1, 1), channel 1"));
}

#[test]
fn changed_lines_are_found() {
    assert_eq!(changed_lines("a\nb\nc\nd", "a\nc\n  x\nd\ne"), ["- b", "+ x", "+ e"]);
    assert!(changed_lines("a\nb", "a\nb").is_empty());
}

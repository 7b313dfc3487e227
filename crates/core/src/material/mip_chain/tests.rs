use super::*;
use crate::codec::Target;

/// Writes values that no block holds exactly.
fn varied(level: usize, y: u32, out: &mut [[f32; 4]]) {
    for (x, texel) in out.iter_mut().enumerate() {
        let value = |k: usize| ((k * x + 7 * y as usize + level) % 61) as f32 / 61.0;
        *texel = [value(3), value(5), value(11), 1.0];
    }
}

#[test]
fn far_levels_are_searched_thoroughly() {
    let sizes = level_sizes(128, 128);
    let rows = LevelRows { values: &varied, lobes: None };
    let file = |quality, level: usize| {
        let encoding = Encoding::of(&Settings { quality, ..Settings::default() }, 3).with_orm_metric();
        let levels = encode_levels(&sizes[level..=level], level, encoding, 1 << 20, rows).unwrap();
        let (width, height) = sizes[level];
        let writer = Ktx2Writer { format: encoding.format, width, height, levels, keys: &[] };
        let file = writer.into_bytes().unwrap();
        let image = crate::ktx2::Ktx2::parse(&file).unwrap().decode_level(0).unwrap();
        (0..width * height).map(|i| [0, 1, 2].map(|c| image.sample(i % width, i / width, c))).collect::<Vec<_>>()
    };
    for level in 0..5 {
        let is_equal = file(Effort::Fast, level) == file(Effort::Best, level);
        assert_eq!(is_equal, level >= THOROUGH_LEVEL, "level {level}");
    }
}

#[test]
fn bands_encode_the_bytes_of_the_whole_level() {
    let sizes = level_sizes(52, 36);
    for target in [Target::Basis, Target::Float] {
        let settings = Settings { target, ..Settings::default() };
        for encoding in [Encoding::of(&settings, 3), Encoding::of_normals(&settings)] {
            let file = |max_bytes| {
                let levels =
                    encode_levels(&sizes, 0, encoding, max_bytes, LevelRows { values: &varied, lobes: None }).unwrap();
                Ktx2Writer { format: encoding.format, width: 52, height: 36, levels, keys: &[] }.into_bytes().unwrap()
            };
            let whole = file(1 << 20);
            for max_bytes in [1, 500, 3000] {
                assert!(file(max_bytes) == whole, "{target:?}, bands of {max_bytes} bytes");
            }
        }
    }
}

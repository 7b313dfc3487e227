use super::*;
use crate::codec::Target;

#[test]
fn bands_encode_the_bytes_of_the_whole_level() {
    let row = |level: usize, y: u32, out: &mut [[f32; 4]]| {
        for (x, texel) in out.iter_mut().enumerate() {
            let value = |k: usize| ((k * x + 7 * y as usize + level) % 61) as f32 / 61.0;
            *texel = [value(3), value(5), value(11), 1.0];
        }
    };
    let sizes = level_sizes(52, 36);
    for target in [Target::Basis, Target::Float] {
        let settings = Settings { target, ..Settings::default() };
        for encoding in [Encoding::of(&settings, 3), Encoding::of_normals(&settings)] {
            let file = |max_bytes| {
                let levels =
                    encode_levels(&sizes, 0, encoding, max_bytes, LevelRows { values: &row, lobes: None }).unwrap();
                Ktx2Writer { format: encoding.format, width: 52, height: 36, levels, keys: &[] }.into_bytes().unwrap()
            };
            let whole = file(1 << 20);
            for max_bytes in [1, 500, 3000] {
                assert!(file(max_bytes) == whole, "{target:?}, bands of {max_bytes} bytes");
            }
        }
    }
}

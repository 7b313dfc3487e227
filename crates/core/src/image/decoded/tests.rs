use super::*;

#[test]
fn steps_are_those_of_the_depth() {
    let step = |samples| Image { width: 1, height: 2, channels: 1, samples }.step();
    assert_eq!(step(Samples::U8(vec![0, 7])), 1.0 / 255.0);
    assert_eq!(step(Samples::U16(vec![0, 7])), 1.0 / 65535.0);
    // 1024 and 1025 are neighbours among half floats, and 1024 + 2^-13 follows 1024 among single ones.
    assert_eq!(step(Samples::F32(vec![1024.0, -0.5])), 1.0);
    assert_eq!(step(Samples::F32(vec![-1024.0, 0.1])), f32::from_bits(1024f32.to_bits() + 1) - 1024.0);
    assert_eq!(step(Samples::F32(vec![0.0, 0.0])), 0.0);
}

use super::*;

#[test]
fn bytes_round_to_the_nearest_step_and_clamp() {
    let values = [-0.5, 0.0, 0.4999 / 255.0, 0.5001 / 255.0, 1.0, 7.0, f32::NAN];
    assert_eq!(values.map(unorm8), [0, 0, 0, 1, 255, 255, 0]);
    // 127.5 steps.
    assert_eq!(unorm8(0.5), 128);
    for step in 0..255u8 {
        let at = |fraction: f32| unorm8((f32::from(step) + fraction) / 255.0);
        assert_eq!([at(0.0), at(0.499), at(0.501)], [step, step, step + 1]);
    }
}

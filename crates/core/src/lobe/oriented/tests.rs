use super::*;

#[test]
fn offsets_survive() {
    for (u, v) in [(0.0, 0.0), (0.5, -2.0), (-15.0, 3.0)] {
        let back = OrientedLobe::new(Offset { u, v }, SquaredAlpha::default()).offset();
        assert!((back.u - u).abs() < 1e-4 * u.abs().max(1.0) && (back.v - v).abs() < 1e-4 * v.abs().max(1.0));
    }
}

use super::*;

#[test]
fn a_rotation_by_90_degrees_moves_u_to_v() {
    let moments = Moments { mean: Offset { u: 1.0, v: 0.0 }, covariance: Symmetric2::diagonal(0.5, 0.0) };
    let rotated = FrameTransform::rotation(0.0, 1.0).apply(moments);
    assert_eq!(rotated.mean, Offset { u: 0.0, v: 1.0 });
    assert_eq!(rotated.covariance, Symmetric2::diagonal(0.0, 0.5));
}

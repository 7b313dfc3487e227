use super::*;

#[test]
fn natural_offsets_are_heights_per_repeat() {
    // Slope 0.5 on a surface where one repeat spans 4 units: the height rises by 2 per repeat.
    let moments = Moments { mean: Offset { u: 0.5, v: -0.25 }, covariance: Symmetric2::new(0.1, 0.02, 0.3) };
    let natural = FrameTransform::natural(4.0, 2.0).apply(moments);
    assert_eq!(natural.mean, Offset { u: 2.0, v: -0.5 });
    assert_eq!(natural.covariance, moments.covariance.scaled([4.0, 2.0]));
}

#[test]
fn a_rotation_by_90_degrees_moves_u_to_v() {
    let moments = Moments { mean: Offset { u: 1.0, v: 0.0 }, covariance: Symmetric2::diagonal(0.5, 0.0) };
    let rotated = FrameTransform::rotation(0.0, 1.0).apply(moments);
    assert_eq!(rotated.mean, Offset { u: 0.0, v: 1.0 });
    assert_eq!(rotated.covariance, Symmetric2::diagonal(0.0, 0.5));
}

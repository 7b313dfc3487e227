use super::*;

#[test]
fn eigen_of_hand_computed_matrices() {
    // [[5, 2], [2, 2]]: eigenvalues 6 and 1, major axis (2, 1)/sqrt 5.
    let e = Symmetric2::new(5.0, 2.0, 2.0).eigen();
    assert!((e.major - 6.0).abs() < 1e-6 && (e.minor - 1.0).abs() < 1e-6);
    assert!((e.axis[0] - 2.0 / 5f32.sqrt()).abs() < 1e-6);
    assert!((e.axis[1] - 1.0 / 5f32.sqrt()).abs() < 1e-6);
}

#[test]
fn eigen_of_degenerate_matrices() {
    let zero = Symmetric2::ZERO.eigen();
    assert_eq!((zero.major, zero.minor, zero.axis), (0.0, 0.0, [1.0, 0.0]));
    let line = Symmetric2::outer([3.0, -4.0]).eigen();
    assert!((line.major - 25.0).abs() < 1e-5);
    assert!(line.minor.abs() < 1e-5);
    assert!((line.axis[0] * -4.0 - line.axis[1] * 3.0).abs() < 1e-5);
    assert_eq!(Symmetric2::diagonal(0.0, 2.0).eigen().axis, [0.0, 1.0]);
}

#[test]
fn mohr_circle_in_double_precision_agrees() {
    let circle = MohrCircle::from([5.0, 2.0, 2.0]);
    assert_eq!(circle.eigenvalues(), [6.0, 1.0]);
    assert_eq!(circle.axis(), [4.0, 2.0]);
    assert_eq!(circle.doubled_axis(), [0.6, 0.8]);
    assert_eq!(circle.matrix_with([6.0, 1.0]), [5.0, 2.0, 2.0]);
    assert_eq!(MohrCircle::from([3.0, 0.0, 3.0]).doubled_axis(), [1.0, 0.0]);
}

#[test]
fn axes_rebuild_the_matrix() {
    let m = Symmetric2::new(0.3, -0.12, 0.11);
    let e = m.eigen();
    let back = Symmetric2::from_axes(e.major, e.minor, e.axis);
    for (a, b) in [(m.uu, back.uu), (m.uv, back.uv), (m.vv, back.vv)] {
        assert!((a - b).abs() < 1e-6, "{a} {b}");
    }
}

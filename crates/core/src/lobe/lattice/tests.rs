use super::*;

#[test]
fn nodes_are_where_they_are_named() {
    assert_eq!(LatticePoint::new(1.0, 0.25, 4.0), LatticePoint { node: [0, 0], share: [0.0, 0.0] });
    assert_eq!(LatticePoint::new(4.0, 4.0, 1.0), LatticePoint { node: [3, 4], share: [0.0, 0.0] });
    let far = LatticePoint::new(1e9, 1.0, 0.0);
    assert_eq!(far, LatticePoint { node: [RATIOS - 2, KURTOSES - 2], share: [1.0, 1.0] });
    let flat = LatticePoint::new(3.0, 0.0, 0.01);
    assert_eq!((flat.node[0], flat.share[0]), (0, 0.0));
}

#[test]
fn interpolation_is_linear() {
    let mut lattice = [[0.0; KURTOSES]; RATIOS];
    for (i, row) in lattice.iter_mut().enumerate() {
        for (j, value) in row.iter_mut().enumerate() {
            *value = 3.0 * i as f32 + j as f32;
        }
    }
    let point = LatticePoint { node: [2, 5], share: [0.25, 0.5] };
    assert!((point.interpolate(&lattice) - (3.0 * 2.25 + 5.5)).abs() < 1e-5);
}

use super::*;
use crate::math::vector::{cross, normalised};

#[test]
fn frames_are_orthonormal_and_right_handed() {
    let eye = [3.0, -2.0, 1.5];
    let ray = normalised([-0.95, 0.7, -0.4]);
    for shape in [Shape::Plane { repeats: 2.0 }, Shape::Sphere { repeats: 8.0 }] {
        let hit = shape.hit(eye, ray).expect("a hit");
        let [t, b, n] = hit.frame;
        let side = cross(t, b);
        assert!((dot(side, n) - 1.0).abs() < 1e-9 && dot(t, b).abs() < 1e-9, "{shape:?}");
        assert!(dot(ray, n) < 0.0);
    }
    assert_eq!(Shape::Plane { repeats: 1.0 }.hit(eye, [0.0, 1.0, 0.0]), None);
    assert_eq!(Shape::Sphere { repeats: 1.0 }.hit(eye, [0.0, 0.0, 1.0]), None);
}

/// From straight above at height 1, a picture 2 wide with 100 pixels has pixels 0.02 wide.
#[test]
fn footprints_have_known_sizes() {
    let camera = Camera::new([0.0, 0.0, 1.0], [0.0; 3], 1.0, [100, 100]);
    let hit = Shape::Plane { repeats: 3.0 }.hit(camera.eye, camera.ray(50.0, 50.0)).expect("a hit");
    let Footprint { across, down } = hit.footprint(&camera, 50.0, 50.0);
    assert!((across[0] - 0.06).abs() < 1e-9 && across[1].abs() < 1e-9, "{across:?}");
    assert!((down[1] - 0.06).abs() < 1e-9 && down[0].abs() < 1e-9, "{down:?}");
    // The equator of a sphere with 8 repeats around, from afar: 8 / tau repeats per unit.
    let camera = Camera::new([0.0, -1001.0, 0.0], [0.0; 3], 0.001, [100, 100]);
    let hit = Shape::Sphere { repeats: 8.0 }.hit(camera.eye, camera.ray(50.0, 50.0)).expect("a hit");
    let Footprint { across, down } = hit.footprint(&camera, 50.0, 50.0);
    assert!((across[0] - 0.02 * 8.0 / TAU).abs() < 1e-6, "{across:?}");
    assert!((down[1] - 0.02 * 4.0 / PI).abs() < 1e-6, "{down:?}");
}

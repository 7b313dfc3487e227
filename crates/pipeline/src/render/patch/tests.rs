use super::*;
use crate::render::SceneName;

/// Compares with [`Shape::hit`], the same point in double precision.
#[test]
fn points_of_a_patch_are_those_of_single_rays() {
    let offsets = [[0.5, 0.5], [0.0, 0.0], [1.0, 0.03], [0.97, 0.999], [0.2, 0.7]];
    for (name, distance) in [(SceneName::Sphere, 1.0), (SceneName::Sphere, 40.0), (SceneName::Plane, 4.0)] {
        let scene = name.scene(32, distance).expect("a scene");
        let (shape, camera) = (scene.shape, &scene.camera);
        let (Shape::Plane { repeats } | Shape::Sphere { repeats }) = shape;
        let [mut hits, mut misses, mut far] = [0; 3];
        for (x, y) in (0..32).flat_map(|y| (0..28).map(move |x| (f64::from(x), f64::from(y)))) {
            let ray = |[dx, dy]: [f32; 2]| camera.ray(x + f64::from(dx), y + f64::from(dy));
            let Some(middle) = shape.hit(camera.eye, ray([0.5, 0.5])) else { continue };
            let mut found = [PatchPoint::default(); 5];
            Patch::new(shape, camera, [x, y], &middle).trace(offsets.iter().copied(), &mut found);
            for (found, offset) in found.iter().zip(offsets) {
                let exact = shape.hit(camera.eye, ray(offset));
                match (found.meeting, exact) {
                    (Meeting::Far, _) => far += 1,
                    (Meeting::Miss, None) => misses += 1,
                    (Meeting::Hit, Some(exact)) => {
                        hits += 1;
                        // Distances from the eye are relative to the size of the picture.
                        let away = dot(exact.position, exact.position).sqrt();
                        let pairs = found.position.iter().zip(exact.position);
                        let off = pairs.map(|(a, b)| (f64::from(*a) - b).abs() / away).fold(0.0, f64::max);
                        assert!(off < 3e-6, "{name:?} {x} {y} {offset:?}: {found:?} {exact:?}");
                        for (a, b) in found.uv.iter().zip(exact.uv) {
                            let turns = f64::from(*a) - b;
                            let off = (turns - turns.round()).abs() / (repeats * away);
                            assert!(off < 3e-6, "{name:?} {x} {y} {offset:?}: {found:?} {exact:?}");
                        }
                    }
                    (found, exact) => panic!("{name:?} {x} {y} {offset:?}: {found:?} {exact:?}"),
                }
            }
        }
        assert!(hits > 1000 && far * 2 < hits, "{name:?}: {hits} {misses} {far}");
        assert!(name != SceneName::Sphere || misses > 0);
    }
}

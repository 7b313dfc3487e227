//! Tests of damaged objects: they are dropped, baked again and replaced.

use super::machine::{Machine, without_cache};
use super::moto::{Moto, URL};

#[test]
fn replaces_damaged_objects() {
    let Some(moto) = Moto::start() else { return };
    let options = format!("--cache {URL}");
    let expected = without_cache();
    Machine::new(&moto.endpoint()).statuses(&options);
    for kind in ["blobs", "jobs"] {
        for object in moto.objects(kind) {
            let mut bytes = moto.get(&object);
            *bytes.last_mut().expect("a byte") ^= 1;
            moto.put(&object, &bytes);
        }
        let bake = Machine::new(&moto.endpoint());
        let run = bake.bake(&options);
        assert_eq!(run.statuses, ["baked"; 3], "{kind}");
        let warnings = run.warnings();
        assert!(warnings.len() >= 3, "{warnings:#?}");
        for warning in warnings {
            assert!(
                warning.starts_with("warning: assets/") && warning.contains("replaced if the store allows it"),
                "{warning}"
            );
        }
        assert_eq!(bake.outputs(), expected);
        assert_eq!(Machine::new(&moto.endpoint()).statuses(&options), ["cached"; 3], "{kind}");
    }
}

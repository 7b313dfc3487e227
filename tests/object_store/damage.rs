//! What is damaged in a store is dropped, baked again and put back.

use super::machine::{Machine, alone};
use super::moto::{Moto, URL};

#[test]
fn damaged_objects_are_replaced() {
    let Some(moto) = Moto::start() else { return };
    let options = format!("--cache {URL}");
    let whole = alone();
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
                warning.starts_with("warning: assets/") && warning.contains("drop it if that is allowed"),
                "{warning}"
            );
        }
        assert_eq!(bake.outputs(), whole);
        assert_eq!(Machine::new(&moto.endpoint()).statuses(&options), ["cached"; 3], "{kind}");
    }
}

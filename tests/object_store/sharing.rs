//! Tests that several machines share the results of their bakes.

use super::machine::{Bake, Machine, without_cache};
use super::moto::{Moto, URL};

#[test]
fn a_second_machine_reuses_results_of_the_first() {
    let Some(mut moto) = Moto::start() else { return };
    let both = format!("--cache cache --cache {URL}");
    let (first, second) = (Machine::new(&moto.endpoint()), Machine::new(&moto.endpoint()));
    assert_eq!(first.statuses(&both), ["baked"; 3]);
    let objects = (moto.objects("jobs"), moto.objects("blobs"));
    assert_eq!(objects.0.len(), 3);
    assert_eq!(second.statuses(&both), ["cached"; 3]);
    assert_eq!(second.outputs(), first.outputs());
    assert_eq!(second.outputs(), without_cache());
    assert_eq!(Machine::new(&moto.endpoint()).statuses(&format!("--cache {URL}")), ["cached"; 3], "without a folder");
    assert_eq!((moto.objects("jobs"), moto.objects("blobs")), objects, "a cached run changes the store");
    moto.kill();
    assert_eq!(second.statuses(&both), ["cached"; 3], "results from the store are in the disk cache");
}

#[test]
fn machines_may_bake_the_same_assets_at_the_same_time() {
    let Some(moto) = Moto::start() else { return };
    let options = format!("--cache {URL} --json");
    let machines = [(); 3].map(|()| Machine::new(&moto.endpoint()));
    let bakes = machines.each_ref().map(|machine| machine.command(&options).spawn().expect("the command starts"));
    for bake in bakes {
        assert_eq!(Bake::from_output(bake.wait_with_output().expect("an exit")).err, "");
    }
    let outputs = without_cache();
    assert!(machines.iter().all(|machine| machine.outputs() == outputs));
    let late = Machine::new(&moto.endpoint());
    assert_eq!(late.statuses(&format!("--cache {URL}")), ["cached"; 3]);
    assert_eq!(late.outputs(), outputs);
}

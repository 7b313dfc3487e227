//! What one machine bakes no other bakes again.

use super::machine::{Bake, Machine, alone};
use super::moto::{Moto, URL};

#[test]
fn two_machines_share_what_they_bake() {
    let Some(mut moto) = Moto::start() else { return };
    let both = format!("--cache cache --cache {URL}");
    let (first, second) = (Machine::new(&moto.endpoint()), Machine::new(&moto.endpoint()));
    assert_eq!(first.statuses(&both), ["baked"; 3]);
    let objects = (moto.objects("jobs"), moto.objects("blobs"));
    assert_eq!(objects.0.len(), 3);
    assert_eq!(second.statuses(&both), ["cached"; 3]);
    assert_eq!(second.outputs(), first.outputs());
    assert_eq!(second.outputs(), alone());
    assert_eq!(Machine::new(&moto.endpoint()).statuses(&format!("--cache {URL}")), ["cached"; 3], "without a folder");
    assert_eq!((moto.objects("jobs"), moto.objects("blobs")), objects, "a cached run puts");
    moto.kill();
    assert_eq!(second.statuses(&both), ["cached"; 3], "what came from the store is in the folder");
}

#[test]
fn machines_that_bake_the_same_at_once_do_not_mind() {
    let Some(moto) = Moto::start() else { return };
    let options = format!("--cache {URL} --json");
    let machines = [(); 3].map(|()| Machine::new(&moto.endpoint()));
    let bakes = machines.each_ref().map(|machine| machine.command(&options).spawn().expect("the command starts"));
    for bake in bakes {
        assert_eq!(Bake::of(bake.wait_with_output().expect("an exit")).err, "");
    }
    let outputs = alone();
    assert!(machines.iter().all(|machine| machine.outputs() == outputs));
    let late = Machine::new(&moto.endpoint());
    assert_eq!(late.statuses(&format!("--cache {URL}")), ["cached"; 3]);
    assert_eq!(late.outputs(), outputs);
}

use super::*;
use crate::settings::{MaxModel, Model, Profile};

#[test]
fn auto_keeps_isotropic_lobes_for_every_engine() {
    for engine in Engine::ALL {
        let values = Values { engine: Some(engine), model: Some(Model::Auto), ..Values::default() };
        let origin = "command line".to_owned();
        let settings = resolve(&[ConfigSource { origin, values }]).expect("settings").settings;
        assert_eq!((settings.model, settings.max_model), (Model::Auto, MaxModel::Isotropic), "{engine:?}");
    }
}

#[test]
fn a_later_preset_replaces_the_largest_model_of_an_earlier_one() {
    let source = |engine, profile| ConfigSource {
        origin: format!("{engine:?}"),
        values: Values { engine: Some(engine), profile, ..Values::default() },
    };
    // The plugin of three.js shows anisotropic lobes.
    let sources = [source(Engine::Godot, None), source(Engine::Three, Some(Profile::Pyramid))];
    let resolved = resolve(&sources).expect("settings");
    assert_eq!(resolved.settings.max_model, MaxModel::Anisotropic);
    assert_eq!(resolved.engine, Some(Engine::Three));
}

#[test]
fn a_later_preset_leaves_the_container_of_an_earlier_one_behind() {
    let source = |engine, glb| ConfigSource {
        origin: "a source".to_owned(),
        values: Values { engine: Some(engine), glb, ..Values::default() },
    };
    let glb = |sources: &[ConfigSource]| resolve(sources).expect("settings").settings.glb;
    assert_eq!(glb(&[source(Engine::Godot, None)]), Some(false));
    assert_eq!(glb(&[source(Engine::Godot, None), source(Engine::Three, None)]), None);
    assert_eq!(glb(&[source(Engine::Godot, Some(true)), source(Engine::Three, None)]), Some(true));
    assert_eq!(glb(&[source(Engine::Three, Some(false)), source(Engine::Filament, None)]), Some(false));
}

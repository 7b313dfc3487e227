use super::*;
use crate::project::{ConfigSource, Values, resolve};

#[test]
fn every_engine_has_a_preset_of_its_own_name() {
    for engine in Engine::value_variants() {
        let preset = engine.preset();
        assert_eq!(serde_json::to_value(engine).unwrap(), preset.name);
        assert_eq!(engine.to_possible_value().unwrap().get_name(), preset.name);
    }
}

#[test]
fn presets_bake_isotropic_lobes_into_core_materials() {
    for engine in Engine::value_variants() {
        let preset = engine.preset();
        assert_eq!(preset.model(Profile::Both), Some(Model::Isotropic), "{engine:?}");
        assert_eq!((preset.model(Profile::Pyramid), preset.max_model(Profile::Pyramid)), (None, None), "{engine:?}");
    }
}

#[test]
fn auto_keeps_isotropic_lobes_for_engines_that_read_no_anisotropy() {
    for engine in Engine::value_variants() {
        let values = Values { engine: Some(*engine), model: Some(Model::Auto), ..Values::default() };
        let origin = "command line".to_owned();
        let settings = resolve(&[ConfigSource { origin, values }]).expect("settings").settings;
        let expected = match engine {
            Engine::Filament | Engine::Godot => MaxModel::Isotropic,
            _ => MaxModel::Anisotropic,
        };
        assert_eq!((settings.model, settings.max_model), (Model::Auto, expected), "{engine:?}");
    }
}

#[test]
fn a_later_preset_replaces_the_largest_model_of_an_earlier_one() {
    let source = |engine| ConfigSource {
        origin: format!("{engine:?}"),
        values: Values { engine: Some(engine), ..Values::default() },
    };
    let resolved = resolve(&[source(Engine::Godot), source(Engine::Three)]).expect("settings");
    assert_eq!(resolved.settings.max_model, MaxModel::Anisotropic);
    assert_eq!(resolved.engine, Some(Engine::Three));
}

#[test]
fn notes_name_the_switches_of_limiters_that_are_on_by_default() {
    let with_notes: Vec<&str> =
        Engine::value_variants().iter().filter(|e| e.limiter_note().is_some()).map(|e| e.preset().name).collect();
    assert_eq!(with_notes, ["babylon", "godot"]);
    let note = Engine::Godot.limiter_note().expect("a note");
    assert!(note.asks_for_action);
    assert!(note.text.contains("screen_space_roughness_limiter/enabled"), "{note}");
}

#[test]
fn presets_write_a_gltf_where_an_engine_cannot_use_what_is_inside_a_glb() {
    for engine in Engine::value_variants() {
        let preset = engine.preset();
        let (glb, form) = match engine {
            Engine::Bevy => (Some(false), Form::Dual),
            Engine::Godot => (Some(false), Form::Auto),
            // These load KTX2, and need no PNG copies.
            _ => (None, Form::Strict),
        };
        assert_eq!((preset.glb, preset.form), (glb, form), "{engine:?}");
    }
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

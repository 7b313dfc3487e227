use super::*;
use crate::settings::OwnAnisotropy;

#[test]
fn every_engine_has_a_preset_of_its_own_name() {
    for engine in Engine::ALL {
        let preset = engine.preset();
        assert_eq!(serde_json::to_value(engine).unwrap(), preset.name);
        #[cfg(feature = "cli")]
        assert_eq!(clap::ValueEnum::to_possible_value(&engine).unwrap().get_name(), preset.name);
    }
}

#[test]
fn presets_bake_isotropic_lobes_into_core_materials() {
    for engine in Engine::ALL {
        let preset = engine.preset();
        assert_eq!(preset.model(Profile::Both), Model::Isotropic, "{engine:?}");
        assert_eq!(preset.model(Profile::Pyramid), Model::Anisotropic, "{engine:?}");
        assert_eq!(preset.max_model(Profile::Pyramid), None, "{engine:?}");
        assert_eq!(preset.max_model(Profile::Portable), Some(MaxModel::Isotropic), "{engine:?}");
        let is_unread = matches!(engine, Engine::Filament | Engine::Godot);
        let own = if is_unread { OwnAnisotropy::Ignore } else { OwnAnisotropy::Keep };
        assert_eq!(preset.own_anisotropy(Profile::Both), Some(own), "{engine:?}");
        assert_eq!(preset.own_anisotropy(Profile::Pyramid), None, "{engine:?}");
    }
}

#[test]
fn notes_name_the_switches_of_limiters_that_are_on_by_default() {
    let settings = Settings::default();
    let with_notes = Engine::ALL.into_iter().filter(|engine| !engine.notes(&settings).is_empty());
    assert_eq!(with_notes.collect::<Vec<_>>(), [Engine::Babylon, Engine::Godot]);
    let notes = Engine::Godot.notes(&settings);
    assert!(notes[0].asks_for_action);
    assert!(notes[0].text.contains("screen_space_roughness_limiter/enabled"), "{notes:?}");
    assert_eq!(Engine::Godot.notes(&settings.with_profile(Profile::Pyramid)), []);
}

#[test]
fn presets_write_a_gltf_where_an_engine_cannot_use_what_is_inside_a_glb() {
    for engine in Engine::ALL {
        let preset = engine.preset();
        let (glb, form) = match engine {
            Engine::Bevy => (Some(false), Form::Dual),
            Engine::Godot => (Some(false), Form::Fallback),
            // These load KTX2, and need no PNG copies.
            _ => (None, Form::Strict),
        };
        assert_eq!((preset.glb, preset.form), (glb, form), "{engine:?}");
    }
}

use super::*;

#[test]
fn every_engine_has_a_preset_of_its_own_name() {
    for engine in Engine::value_variants() {
        let preset = engine.preset();
        assert_eq!(serde_json::to_value(engine).unwrap(), preset.name);
        assert_eq!(engine.to_possible_value().unwrap().get_name(), preset.name);
    }
}

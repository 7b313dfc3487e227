use super::*;

fn text(settings: &Settings, model: Model) -> String {
    serde_json::to_string(&RecordedSettings::new(settings, model)).expect("JSON")
}

#[test]
fn writes_defaults_in_a_fixed_order_with_the_digits_of_double_precision() {
    let expected = concat!(
        r#"{"profile":"portable","model":"auto","maxError":0.10000000149011612,"distribution":"auto","lobe":"ggx","#,
        r#""target":"basis","quality":"fast","gltf":"strict","frame":"unit","heightScale":null,"#,
        r#""scaleNormals":true}"#
    );
    assert_eq!(text(&Settings::default(), Model::Auto), expected);
}

#[test]
fn appends_settings_that_have_no_default() {
    let settings = Settings {
        frame: Frame::MainDirection([0.6, 0.8, 0.0]),
        height_scale: Some(0.2),
        max_model: MaxModel::Isotropic,
        own_anisotropy: OwnAnisotropy::Keep,
        rdo: Some(0.5),
        scale_normals: Some(true),
        textures: Textures::All,
        diffuse_light: DiffuseLight::Suns,
        view: Some(View::new(2.0, 1080)),
        quality: Effort::Best,
        ..Settings::default()
    };
    let expected = concat!(
        r#"{"profile":"portable","model":"none","maxError":0.10000000149011612,"distribution":"auto","lobe":"ggx","#,
        r#""target":"basis","quality":"best","gltf":"strict","#,
        r#""frame":{"mainDirection":[0.6000000238418579,0.800000011920929,0.0]},"heightScale":0.20000000298023224,"#,
        r#""asked":"auto","maxModel":"isotropic","ownAnisotropy":"keep","rdo":0.5,"scaleNormals":true,"textures":"all","#,
        r#""diffuseLight":"suns","#,
        r#""view":{"nearest":2.0,"screenHeight":1080,"fov":45.0,"aspect":1.778,"trim":false}}"#
    );
    assert_eq!(text(&settings, Model::None), expected);
}

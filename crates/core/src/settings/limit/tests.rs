use super::*;
use crate::bump::Frame;
use crate::settings::{Form, Settings, View};

#[test]
fn default_settings_are_valid() {
    assert_eq!(Settings::default().validate(), Ok(()));
}

#[test]
fn rejects_values_out_of_range() {
    let settings = Settings::default();
    let view = View::new(1.0, 1080);
    for (result, expected) in [
        (settings.with_max_error(1.5), "max-error: expected a number from 0 to 1, found 1.5"),
        (settings.with_max_error(f32::NAN), "max-error: expected a number from 0 to 1, found NaN"),
        (settings.with_rdo(0.0), "rdo: expected a number above 0, up to 6, found 0"),
        (
            settings.with_height_scale(f32::INFINITY),
            "height-scale: expected a number from -1000000 to 1000000, found inf",
        ),
        (
            settings.with_frame(Frame::MainDirection([0.0, 2.0, 0.0])),
            "main-direction: expected a direction of length 1, found [0.0, 2.0, 0.0]",
        ),
        (settings.with_view(View { nearest: 0.0, ..view }), "nearest: expected a number above 0, found 0"),
        (settings.with_view(View { screen_height: 0, ..view }), "screen-height: expected a number above 0, found 0"),
        (settings.with_view(View { fov: 180.0, ..view }), "fov: expected degrees between 0 and 180, found 180"),
        (settings.with_view(View { aspect: -1.0, ..view }), "aspect: expected a number above 0, found -1"),
    ] {
        assert_eq!(result.unwrap_err().to_string(), format!("{expected}; give a value in the range"));
    }
    assert_eq!(settings.with_glb(true).with_gltf(Form::Dual).validate(), Err(SettingsError::DualInGlb));
}

#[test]
fn validates_values_that_were_assigned_to_fields() {
    let (settings, view) = (Settings::default(), View::new(1.0, 1080));
    for wrong in [
        Settings { max_error: 1.5, ..settings },
        Settings { rdo: Some(0.0), ..settings },
        Settings { height_scale: Some(f32::INFINITY), ..settings },
        Settings { frame: Frame::MainDirection([f32::NAN; 3]), ..settings },
        Settings { view: Some(View { nearest: 0.0, ..view }), ..settings },
    ] {
        assert!(matches!(wrong.validate(), Err(SettingsError::Range { .. })), "{wrong:?}");
    }
}

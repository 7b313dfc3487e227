use std::fmt::Debug;

use clap::ValueEnum;
use proptest::option;
use proptest::prelude::*;
use proptest::sample::select;

use super::*;
use crate::bump::FrameKind;
use crate::codec::Target;
use crate::codec::uastc::Effort;
use crate::lobe::{Distribution, Family};
use crate::project::Engine;
use crate::run::plan_file::Plan;
use crate::settings::{Form, Model, Profile};

/// A small asset. Tests run in the folder of their crate.
const SOURCE: &str = "../../fixtures/tiny/tiny.gltf";

fn job(settings: &Values) -> Job {
    Job::new(Path::new(SOURCE), Path::new("out"), None, settings).expect("a job")
}

fn variants<T: ValueEnum + Debug + 'static>() -> impl Strategy<Value = Option<T>> {
    option::of(select(T::value_variants()))
}

prop_compose! {
    fn texture_values()(
        profile in variants::<Profile>(),
        model in variants::<Model>(),
        max_error in option::of(0.0..=1.0),
        quality in option::of(select(vec![Effort::Fast, Effort::Best])),
        rdo in option::of(0.1..6.0),
        distribution in variants::<Distribution>(),
        lobe in variants::<Family>(),
        target in variants::<Target>(),
        max_texels in any::<Option<u64>>(),
        provenance in any::<Option<bool>>(),
    ) -> Values {
        let values = Values::default();
        Values { profile, model, max_error, quality, rdo, distribution, lobe, target, max_texels, provenance, ..values }
    }
}

prop_compose! {
    /// Generates settings that a bake accepts.
    fn values()(
        texture in texture_values(),
        engine in variants::<Engine>(),
        gltf in variants::<Form>(),
        is_glb in any::<Option<bool>>(),
        frame in variants::<FrameKind>(),
        main_direction in option::of([0.1..1.0, -1.0..1.0, -9.0..9.0]),
        height_scale in option::of(-10.0..10.0),
        view in option::of((0.1..1000.0, 1..5000_u32)),
        fov in option::of(1.0..179.0),
        aspect in option::of(0.1..4.0),
        trim in any::<Option<bool>>(),
    ) -> Values {
        let (nearest, screen_height) = view.unzip();
        // The dual form needs external textures, and `trim` needs a view.
        let glb = is_glb.filter(|_| gltf != Some(Form::Dual));
        let trim = trim.filter(|_| nearest.is_some());
        Values {
            engine, gltf, glb, frame, main_direction, height_scale, nearest, screen_height, fov, aspect, trim, ..texture
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn a_job_of_a_plan_that_is_read_again_keeps_its_settings_and_its_id(settings in values()) {
        let job = job(&settings);
        let json = serde_json::to_string(&Plan::new(vec![job.clone()])).expect("JSON");
        let read: Plan = serde_json::from_str(&json).expect("a plan");
        prop_assert_eq!(&read.jobs[0], &job);
        prop_assert_eq!(&read.jobs[0].settings, &settings);
        prop_assert!(read.jobs[0].check().is_ok());
    }
}

fn settings_of_every_kind() -> Values {
    let (nearest, screen_height) = (Some(30.0), Some(720));
    let defaults = Values::defaults();
    Values { provenance: Some(false), rdo: Some(1.0), height_scale: Some(-0.5), nearest, screen_height, ..defaults }
}

#[test]
fn the_id_covers_version_settings_and_files_as_json_in_a_fixed_order() {
    let job = job(&settings_of_every_kind());
    let settings = concat!(
        r#"{"profile":"portable","model":"auto","max-model":"anisotropic","own-anisotropy":"bake","max-error":0.1,"quality":"fast","#,
        r#""distribution":"auto","lobe":"ggx","target":"basis","max-texels":268435456,"provenance":false,"textures":"bumps","diffuse-light":"environment","gltf":"strict","frame":"unit","#,
        r#""main-direction":[0.0,1.0,0.0],"fov":45.0,"aspect":1.778,"trim":false,"#,
        r#""rdo":1.0,"height-scale":-0.5,"nearest":30.0,"screen-height":720}"#,
    );
    assert_eq!(serde_json::to_string(&job.settings).expect("JSON"), settings);
    let files = job.inputs.iter().enumerate().map(|(index, input)| {
        // The document counts by its stem.
        let name = if index == 0 { input.path.file_stem() } else { input.path.file_name() };
        format!("[{:?},\"{}\"]", name.expect("a name"), input.blake3.expect("a digest"))
    });
    let (version, files) = (env!("CARGO_PKG_VERSION"), files.collect::<Vec<_>>().join(","));
    let identity = format!(r#"{{"version":"{version}","settings":{settings},"files":[{files}]}}"#);
    assert_eq!(job.id, digest(identity.as_bytes()));
}

#[test]
fn the_command_line_has_the_settings_as_flags() {
    let words = [
        "roughcast",
        "bake",
        SOURCE,
        "-o",
        "out",
        "--no-config",
        "--profile=portable",
        "--model=auto",
        "--max-model=anisotropic",
        "--own-anisotropy=bake",
        "--max-error=0.1",
        "--quality=fast",
        "--distribution=auto",
        "--lobe=ggx",
        "--target=basis",
        "--max-texels=268435456",
        "--no-provenance",
        "--textures=bumps",
        "--diffuse-light=environment",
        "--gltf=strict",
        "--frame=unit",
        "--main-direction=0.0,1.0,0.0",
        "--fov=45.0",
        "--aspect=1.778",
        "--rdo=1.0",
        "--height-scale=-0.5",
        "--nearest=30.0",
        "--screen-height=720",
    ];
    assert_eq!(job(&settings_of_every_kind()).command, words);
    let without_camera = job(&Values { trim: Some(false), glb: Some(true), ..Values::default() }).command;
    assert_eq!(without_camera[5..], ["--no-config", "--glb=true"]);
    let command =
        job(&Values { fov: Some(30.0), aspect: Some(1.0), provenance: Some(true), ..Values::default() }).command;
    assert_eq!(command[5..], ["--no-config"]);
}

#[test]
fn a_named_output_is_part_of_the_id_and_of_the_command_line() {
    let settings = Values { glb: Some(true), ..Values::default() };
    let of_name = |name| Job::new(Path::new(SOURCE), Path::new("out"), name, &settings).expect("a job");
    let (plain, named) = (of_name(None), of_name(Some("packed")));
    assert_ne!(plain.id, named.id);
    assert_eq!(named.command[3..5], ["-o", "out/packed.glb"]);
    assert_eq!(
        named.outputs.iter().map(|output| output.path.as_path()).collect::<Vec<_>>(),
        [Path::new("out/packed.glb")]
    );
    assert_eq!(named.output_stem(), "packed");
    assert_eq!(named.source_stem(), "tiny");
    // The name of the source needs no name of its own.
    assert_eq!(of_name(Some("tiny")), plain);
}

#[test]
fn a_plan_names_no_output_in_another_folder() {
    let job = job(&Values::default());
    for name in ["../x", "a/b", "/x", "..", ".", "", "a\\b", "a\0"] {
        let mut json = serde_json::to_value(&job).expect("JSON");
        json["name"] = json!(name);
        assert!(serde_json::from_value::<Job>(json).is_err(), "{name:?}");
    }
    let mut json = serde_json::to_value(&job).expect("JSON");
    json["name"] = json!("a b.c");
    assert_eq!(serde_json::from_value::<Job>(json).expect("a job").name.as_deref(), Some("a b.c"));
}

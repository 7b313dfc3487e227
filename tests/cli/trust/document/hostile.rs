//! Numbers that overflow, and documents that are unreasonably large.

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use super::*;

#[test]
fn scales_without_finite_slopes_are_refused() {
    for (member, part) in [("normalTexture", "normalTexture"), ("heightTexture", "heightTexture")] {
        for scale in [1e30, -1e9] {
            let sphere = Sphere::new();
            sphere.edit(|root| {
                let material = &mut root["materials"][0];
                if member == "heightTexture" {
                    material.as_object_mut().expect("a material").remove("normalTexture");
                    material["extras"] = json!({ "roughcast": { "heightTexture": { "index": 1, "scale": scale } } });
                } else {
                    material[member]["scale"] = json!(scale);
                }
            });
            let line = sphere.error_line(&["--target", "float"]);
            assert!(line.contains(part) && line.contains("and the most that is read is"), "{line}");
        }
    }
}

/// Reads every half float of the baked textures of `sphere`, by `check --deep`.
fn assert_sound(sphere: &Sphere, options: &[&str]) {
    let root = sphere.baked(options);
    for material in root["materials"].as_array().expect("materials") {
        assert!(!material["extensions"].to_string().contains("null"), "{options:?}: {material}");
    }
    let run = roughcast(["check".as_ref(), sphere.output().as_os_str(), "--deep".as_ref()]);
    for code in ["RC1301", "RC1403"] {
        assert!(!run.out.contains(code), "{options:?}: {}", run.out);
    }
}

/// Normals of the largest scales are so steep that x rounds to 1. Normals of the smallest scales are flat.
#[test]
fn scales_of_any_size_give_finite_values() {
    for scale in [1e4, -1e4, 3e3, 1e-7, -1e-30, 1e-44] {
        let sphere = Sphere::new();
        sphere.edit(|root| root["materials"][0]["normalTexture"]["scale"] = json!(scale));
        assert_sound(&sphere, &["--target", "float", "--profile", "both"]);
    }
}

/// One texel of a normal map may have any length, and does not damage its level.
#[test]
fn normals_of_any_length_give_finite_values() {
    for (x, z) in [(f32::MAX, f32::MAX), (f32::MAX, 1.0), (f32::MAX, 2e19), (-f32::MAX, 0.5), (1e-30, 1e-38)] {
        let sphere = Sphere::new();
        fs::write(sphere.file("normal.exr"), exr([x, -0.25, z])).expect("a file");
        sphere.edit(|root| root["images"][1] = json!({ "uri": "normal.exr" }));
        assert_sound(&sphere, &["--target", "float", "--profile", "both"]);
    }
}

#[test]
fn huge_colours_give_finite_values() {
    let sphere = Sphere::new();
    fs::write(sphere.file("surface.exr"), exr([f32::MAX, 0.5, f32::MAX])).expect("a file");
    fs::write(sphere.file("axis.exr"), exr([-f32::MAX, f32::MAX, 1.0])).expect("a file");
    sphere.edit(|root| {
        root["images"][2] = json!({ "uri": "surface.exr" });
        let axis = root["textures"].as_array().expect("textures").len();
        push(root, "images", json!({ "uri": "axis.exr" }));
        push(root, "textures", json!({ "source": 3 }));
        let anisotropy = json!({ "anisotropyStrength": 0.5, "anisotropyTexture": { "index": axis } });
        root["materials"][0]["extensions"] = json!({ "KHR_materials_anisotropy": anisotropy });
    });
    assert_sound(&sphere, &["--target", "float"]);
}

fn push(root: &mut Value, array: &str, value: Value) {
    root[array].as_array_mut().expect("an array").push(value);
}

/// Returns 16 x 16 texels of (-0.1, 0.2, 0.9), one of them `texel`.
fn exr(texel: [f32; 3]) -> Vec<u8> {
    use ::exr::prelude::{Encoding, Image, SpecificChannels, WritableImage};
    let pixel = |at: ::exr::math::Vec2<usize>| {
        let [x, y, z] = if (at.x(), at.y()) == (5, 3) { texel } else { [-0.1, 0.2, 0.9] };
        (x, y, z)
    };
    let channels = SpecificChannels::build().with_channel("R").with_channel("G").with_channel("B").with_pixel_fn(pixel);
    let image = Image::from_encoded_channels((16, 16), Encoding::UNCOMPRESSED, channels);
    let mut file = std::io::Cursor::new(Vec::new());
    image.write().to_buffered(&mut file).expect("an EXR");
    file.into_inner()
}

/// Overlapping vectors cannot be read, so that the mesh is unknown.
#[test]
fn unreadable_meshes_give_finite_values() {
    for stride in [1, 2, 3, 4, 252] {
        let sphere = Sphere::new();
        sphere.edit(|root| root["bufferViews"][0]["byteStride"] = json!(stride));
        assert_sound(&sphere, &["--frame", "natural", "--profile", "both"]);
    }
    for value in [f32::MAX, f32::NAN, f32::INFINITY, 1e-40] {
        let sphere = Sphere::new();
        let mut bytes = fs::read(sphere.file("brushed.bin")).expect("a buffer");
        bytes[..5220].copy_from_slice(&value.to_le_bytes().repeat(1305));
        bytes[..4].copy_from_slice(&1f32.to_le_bytes());
        fs::write(sphere.file("brushed.bin"), bytes).expect("a file");
        assert_sound(&sphere, &["--frame", "natural", "--profile", "both"]);
    }
}

/// Time after which a bake counts as hanging. Each of these bakes takes seconds.
const HANG: Duration = Duration::from_secs(240);

/// Bakes the sphere and kills the bake if it hangs.
fn assert_ends(sphere: &Sphere, options: &[&str]) {
    let (input, output) = (sphere.file("brushed.gltf"), sphere.output());
    let mut command = Command::new(env!("CARGO_BIN_EXE_roughcast"));
    command.arg("bake").arg(input).arg("-o").arg(output).arg("-q").args(options).stdout(Stdio::null());
    let mut child = command.spawn().expect("the command starts");
    let start = Instant::now();
    while start.elapsed() < HANG && child.try_wait().expect("a process").is_none() {
        std::thread::sleep(Duration::from_millis(50));
    }
    let is_hanging = child.try_wait().expect("a process").is_none();
    if is_hanging {
        child.kill().expect("a process");
    }
    let status = child.wait().expect("a process");
    assert!(!is_hanging, "{options:?}: still baking after {HANG:?}");
    assert!(status.success(), "{options:?}: {status}");
}

#[test]
fn many_buffers_are_read_once() {
    let sphere = Sphere::new();
    sphere.edit(|root| {
        let buffer = root["buffers"][0].clone();
        root["buffers"] = json!(vec![buffer; 50_000]);
    });
    assert_ends(&sphere, &[]);
}

#[test]
fn many_primitives_with_materials_of_their_own_are_looked_up_once() {
    let sphere = Sphere::new();
    sphere.edit(|root| {
        let (primitive, material) = (&root["meshes"][0]["primitives"][0], &root["materials"][0]);
        let numbered = |i: usize| {
            let mut primitive = primitive.clone();
            // One triangle, because the work is in finding it.
            primitive["indices"] = json!(root["accessors"].as_array().expect("accessors").len());
            primitive["material"] = json!(i);
            primitive
        };
        let primitives: Vec<Value> = (0..20_000).map(numbered).collect();
        let materials = vec![material.clone(); 20_000];
        let mut triangle = root["accessors"][4].clone();
        triangle["count"] = json!(3);
        push(root, "accessors", triangle);
        root["meshes"][0]["primitives"] = json!(primitives);
        root["materials"] = json!(materials);
    });
    assert_ends(&sphere, &["--frame", "natural", "--profile", "both"]);
}

#[test]
fn a_bake_of_many_primitives_of_one_material_ends() {
    let sphere = Sphere::new();
    sphere.edit(|root| {
        let primitive = root["meshes"][0]["primitives"][0].clone();
        root["meshes"][0]["primitives"] = json!(vec![primitive; 50_000]);
    });
    assert_ends(&sphere, &[]);
}

/// Textures that share an image do not copy it. It may be a data URI of megabytes.
#[test]
fn textures_of_one_image_share_its_data() {
    let sphere = Sphere::new();
    let png = fs::read(sphere.file("brushed_normal.png")).expect("an image");
    let encode = |byte: &u8| format!("%{byte:02X}");
    let uri = format!("data:image/png,{}", png.iter().map(encode).collect::<String>());
    sphere.edit(|root| {
        root["images"][1] = json!({ "uri": uri });
        let (texture, mut material) = (root["textures"][1].clone(), root["materials"][0].clone());
        let first = root["textures"].as_array().expect("textures").len();
        for i in 0..10_000 {
            push(root, "textures", texture.clone());
            material["normalTexture"]["index"] = json!(first + i);
            push(root, "materials", material.clone());
        }
    });
    assert_ends(&sphere, &["--gltf", "strict"]);
}

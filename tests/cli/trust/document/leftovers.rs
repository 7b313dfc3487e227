//! Data that only replaced images needed is removed, and images keep distinct names.

use super::*;

/// Returns the number of bytes of `bin`, which is buffer 0, that no buffer view of `root` covers.
fn unseen(root: &Value, bin: &[u8]) -> usize {
    let mut is_seen = vec![false; bin.len()];
    for view in root["bufferViews"].as_array().expect("views").iter().filter(|view| view["buffer"] == 0) {
        let number = |key: &str| view[key].as_u64().unwrap_or(0) as usize;
        is_seen[number("byteOffset")..number("byteOffset") + number("byteLength")].fill(true);
    }
    is_seen.iter().filter(|is_seen| !**is_seen).count()
}

/// Returns the bytes of image `index`.
fn image<'b>(root: &Value, bin: &'b [u8], index: usize) -> &'b [u8] {
    let view = &root["bufferViews"][root["images"][index]["bufferView"].as_u64().expect("a view") as usize];
    let number = |key: &str| view[key].as_u64().unwrap_or(0) as usize;
    &bin[number("byteOffset")..number("byteOffset") + number("byteLength")]
}

#[test]
fn a_glb_keeps_no_byte_of_replaced_images() {
    let lake = fixtures().join("waves/waves.glb");
    let (before, old) = glb(&lake);
    let normal = image(&before, &old, 0);
    let colour = image(&before, &old, 1);
    for options in [&[][..], &["--gltf", "fallback", "--profile", "both"], &["--glb=false", "--gltf", "fallback"]] {
        let folder = tempdir().expect("a folder");
        bake(&lake, folder.path(), options);
        let (root, bin) = if options.contains(&"--glb=false") {
            let bin = fs::read(folder.path().join("waves.roughcast/waves.bin")).expect("a buffer");
            (document(&folder.path().join("waves.gltf")), bin)
        } else {
            glb(&folder.path().join("waves.glb"))
        };
        let middle = &normal[normal.len() / 2..][..64];
        assert!(!bin.windows(64).any(|part| part == middle), "{options:?}: the replaced image is still there");
        let views = root["bufferViews"].as_array().expect("views").len();
        assert!(unseen(&root, &bin) < 8 * views, "{options:?}: {} bytes of nobody", unseen(&root, &bin));
        let images = root["images"].as_array().expect("images");
        let at = images.iter().position(|image| image["name"] == "waves_colour").expect("the colour");
        assert_eq!(image(&root, &bin, at), colour, "{options:?}");
        assert_eq!(root["accessors"], before["accessors"]);
        for view in 0..5 {
            let range =
                |root: &Value| (root["bufferViews"][view].clone(), root["bufferViews"][view]["byteLength"].clone());
            assert_eq!(range(&root), range(&before), "{options:?}");
        }
        let check = roughcast(["check".as_ref(), folder.path().as_os_str(), "--deep".as_ref()]);
        assert_eq!(check.code, 0, "{options:?}: {}{}", check.out, check.err);
    }
}

#[test]
fn baked_images_and_files_have_the_names_of_images() {
    let folder = tempdir().expect("a folder");
    bake(
        &fixtures().join("waves/waves.glb"),
        folder.path(),
        &["--profile", "both", "--glb=false", "--gltf", "fallback"],
    );
    let names: Vec<String> = files(&folder.path().join("waves.roughcast")).into_iter().map(|(name, _)| name).collect();
    for name in
        ["waves_normal.normal.ktx2", "waves_normal.normal.png", "waves_normal.offset.ktx2", "Lake.roughness.ktx2"]
    {
        assert!(names.iter().any(|other| other == name), "{name} is not among {names:?}");
    }
    let root = document(&folder.path().join("waves.gltf"));
    for image in root["images"].as_array().expect("images") {
        let name = image["name"].as_str().expect("every image has a name");
        let uri = image["uri"].as_str().unwrap_or("waves_colour");
        // The new normal map has replaced the old one and keeps its name. Other new images have the names of their
        // files.
        let expected = uri.trim_start_matches("waves.roughcast/").trim_end_matches(".ktx2").trim_end_matches(".png");
        assert!(name == expected || (name == "waves_normal" && expected == "waves_normal.normal"), "{name}: {uri}");
    }
    for texture in root["textures"].as_array().expect("textures").iter().skip(2) {
        assert!(texture["name"].as_str().is_some_and(|name| name.contains('.')), "{texture}");
    }
}

/// In a GLB whose first buffer is a file, no buffer uses the BIN chunk, and the URI of the file stays.
#[test]
fn a_first_buffer_that_is_a_file_stays_a_file() {
    let sphere = Sphere::new();
    let root = document(&sphere.file("brushed.gltf"));
    let path = sphere.file("brushed.glb");
    fs::remove_file(sphere.file("brushed.gltf")).expect("a file");
    fs::write(&path, to_glb(&root, &[7; 64])).expect("a file");
    bake(&path, &sphere.output(), &["--glb=false"]);
    let baked = document(&sphere.output().join("brushed.gltf"));
    assert_eq!(baked["buffers"], root["buffers"]);
    let read = |path: PathBuf| fs::read(path).expect("a buffer");
    assert_eq!(read(sphere.output().join("brushed.bin")), read(sphere.file("brushed.bin")));
    assert!(!sphere.output().join("brushed.roughcast/brushed.bin").exists());
}

#[test]
fn a_bin_chunk_without_a_buffer_adds_no_buffer() {
    let sphere = Sphere::new();
    let mut root = document(&sphere.file("brushed.gltf"));
    for member in ["buffers", "bufferViews", "accessors", "meshes"] {
        root.as_object_mut().expect("an object").remove(member);
    }
    root["nodes"] = json!([{}]);
    let path = sphere.file("brushed.glb");
    fs::remove_file(sphere.file("brushed.gltf")).expect("a file");
    fs::write(&path, to_glb(&root, &[7; 64])).expect("a file");
    bake(&path, &sphere.output(), &["--glb=false"]);
    assert_eq!(document(&sphere.output().join("brushed.gltf")).get("buffers"), None);
    bake(&path, &sphere.output(), &[]);
    let (root, bin) = glb(&sphere.output().join("brushed.glb"));
    assert!(root["buffers"].is_array() && !bin.starts_with(&[7; 64]));
}

//! Files that are not what they claim to be, or do not fit into memory. Their asset fails, and every other one is
//! baked.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use exr::prelude::{WritableImage, f16};
use tempfile::{TempDir, tempdir};

use crate::process::{Run, bad_and_good_asset};

/// A bad asset (`in/bad`, the brushed sphere, for tests to damage) and a good one (`in/good`, the lake). Both are baked
/// to `out`.
struct Scene {
    folder: TempDir,
}

impl Scene {
    fn new() -> Self {
        Self { folder: bad_and_good_asset() }
    }

    /// Returns a scene in which `bytes`, in a file with this extension, replace the normal map of the bad asset.
    fn with_normal_map(extension: &str, bytes: &[u8]) -> Self {
        let scene = Self::new();
        let (document, name) = (scene.bad("brushed.gltf"), format!("brushed_normal.{extension}"));
        let text = fs::read_to_string(&document).expect("a document");
        fs::write(document, text.replace("brushed_normal.png", &name)).expect("a writable file");
        fs::write(scene.bad(&name), bytes).expect("a file");
        scene
    }

    fn bad(&self, name: &str) -> PathBuf {
        self.folder.path().join("in/bad").join(name)
    }

    /// Bakes both assets, with `limit` KiB of address space if one is given.
    fn bake(&self, limit: Option<u64>) -> Run {
        let limit = limit.map_or_else(String::new, |limit| format!("ulimit -v {limit}; "));
        let mut command = Command::new("sh");
        command.args(["-c", &format!("{limit}exec \"$0\" \"$@\""), env!("CARGO_BIN_EXE_roughcast")]);
        command.args(["bake", "in", "-o", "out", "--quiet", "--threads", "2"]).current_dir(self.folder.path());
        finished(command)
    }

    /// Bakes both assets, expects outputs of the good one only, and returns the error about the bad one.
    fn error_line(&self, limit: Option<u64>, codes: &[i32]) -> String {
        let run = self.bake(limit);
        assert!(codes.contains(&run.code), "exit {}, {}", run.code, run.err);
        assert!(self.is_baked("good/waves.glb"), "the good asset is not baked: {}", run.err);
        assert!(!self.is_baked("bad/brushed.gltf"), "the bad asset is baked: {}", run.err);
        assert_eq!(run.err.lines().count(), 1, "expected one line, found:\n{}", run.err);
        run.err
    }

    fn is_baked(&self, name: &str) -> bool {
        self.folder.path().join("out").join(name).is_file()
    }
}

/// Longest time for a run that may hang.
const PATIENCE: Duration = Duration::from_secs(120);

/// Waits for `command`. Its standard input stays open, so that a program that reads it would wait for ever.
fn finished(mut command: Command) -> Run {
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the command starts");
    let input = child.stdin.take();
    let start = Instant::now();
    while child.try_wait().expect("a child").is_none() {
        if start.elapsed() > PATIENCE {
            child.kill().expect("a child");
            panic!("the run hangs");
        }
        thread::sleep(Duration::from_millis(20));
    }
    drop(input);
    child.wait_with_output().expect("a child").into()
}

fn mkfifo(path: &Path) {
    let made = Command::new("mkfifo").arg(path).status().expect("mkfifo starts");
    assert!(made.success(), "a pipe can be made");
}

#[test]
#[cfg(unix)]
fn a_pipe_instead_of_any_file_is_refused() {
    for name in ["brushed_colour.png", "brushed_normal.png", "brushed_surface.png", "brushed.bin"] {
        let scene = Scene::new();
        fs::remove_file(scene.bad(name)).expect("a file");
        mkfifo(&scene.bad(name));
        let line = scene.error_line(None, &[1]);
        assert!(line.contains(name) && line.contains("not an ordinary file"), "{line}");
    }
}

#[test]
#[cfg(unix)]
fn links_to_a_pipe_a_device_and_a_socket_are_refused() {
    use std::os::unix::fs::symlink;
    use std::os::unix::net::UnixListener;
    let sockets = tempdir().expect("a folder");
    let socket = sockets.path().join("socket");
    let _listening = UnixListener::bind(&socket).expect("a socket");
    let pipe = sockets.path().join("pipe");
    mkfifo(&pipe);
    for target in [Path::new("/dev/stdin"), Path::new("/dev/zero"), &socket, &pipe] {
        let scene = Scene::new();
        let image = scene.bad("brushed_colour.png");
        fs::remove_file(&image).expect("a file");
        symlink(target, image).expect("a link");
        let line = scene.error_line(None, &[1]);
        assert!(line.contains("brushed_colour.png"), "{}: {line}", target.display());
    }
}

#[test]
#[cfg(unix)]
fn a_pipe_in_the_cache_is_not_an_entry() {
    let scene = Scene::new();
    let bake = || {
        let mut command = Command::new(env!("CARGO_BIN_EXE_roughcast"));
        command.args(["bake", "in/good", "-o", "out", "--quiet", "--cache", "cache"]).current_dir(scene.folder.path());
        finished(command)
    };
    assert_eq!(bake().code, 0);
    let entries = walkdir::WalkDir::new(scene.folder.path().join("cache")).into_iter().flatten();
    for entry in entries.filter(|entry| entry.file_type().is_file()) {
        fs::remove_file(entry.path()).expect("a file");
        mkfifo(entry.path());
    }
    fs::remove_dir_all(scene.folder.path().join("out")).expect("a folder");
    let again = bake();
    assert_eq!(again.code, 0, "{}", again.err);
    assert!(scene.is_baked("waves.glb"));
}

/// Returns a JPEG of noise with 128 x 128 texels.
fn jpeg(progressive: bool) -> Vec<u8> {
    let mut file = Vec::new();
    let texels: Vec<u8> = (0..128 * 128 * 3usize).map(|i| (i * i * 7919 % 251) as u8).collect();
    let mut encoder = jpeg_encoder::Encoder::new(&mut file, 80);
    encoder.set_progressive(progressive);
    encoder.encode(&texels, 128, 128, jpeg_encoder::ColorType::Rgb).expect("a JPEG");
    file
}

#[test]
fn a_jpeg_with_a_missing_part_is_refused_even_with_its_end_marker() {
    for whole in [jpeg(false), jpeg(true)] {
        let (fifth, third) = (whole.len() / 5, whole.len() / 3);
        let cut = [&whole[..fifth], b"\xff\xd9"].concat();
        let line = Scene::with_normal_map("jpg", &cut).error_line(None, &[1]);
        assert!(line.contains("JPEG file is cut off"), "{line}");
        let holed = [&whole[..third], &whole[2 * third..]].concat();
        let line = Scene::with_normal_map("jpg", &holed).error_line(None, &[1]);
        assert!(line.contains("JPEG file is"), "{line}");
    }
}

/// Address space of the following runs, in KiB.
const LIMIT: u64 = 2 << 20;

/// Returns a PNG of `side` x `side` texels of 64 bits without data, in less than 100 bytes.
fn empty_png(side: u32) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, side, side);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Sixteen);
    drop(encoder.write_header().expect("a header"));
    file
}

/// Returns an EXR of 4 kB that claims 16384 x 16384 texels.
fn small_exr() -> Vec<u8> {
    let mut file = std::io::Cursor::new(Vec::new());
    let texel = |x: exr::math::Vec2<usize>| (f16::from_f32(x.0 as f32), f16::ZERO, f16::ONE);
    let channels = exr::image::SpecificChannels::rgb(texel);
    exr::image::Image::from_channels((40, 40), channels).write().to_buffered(&mut file).expect("an EXR");
    let mut file = file.into_inner();
    for name in ["dataWindow\0box2i\0", "displayWindow\0box2i\0"] {
        let at = file.windows(name.len()).position(|w| w == name.as_bytes()).expect("an attribute") + name.len() + 4;
        for (corner, value) in [0, 0, 16383, 16383i32].into_iter().enumerate() {
            file[at + 4 * corner..][..4].copy_from_slice(&value.to_le_bytes());
        }
    }
    file.resize(4096, 0);
    file
}

#[test]
#[cfg(target_os = "linux")]
fn an_image_that_claims_more_than_memory_fails_its_asset() {
    for (extension, bytes) in [("png", empty_png(16384)), ("exr", small_exr())] {
        let line = Scene::with_normal_map(extension, &bytes).error_line(Some(LIMIT), &[1, 4]);
        assert!(line.contains("Brushed steel") && line.contains(&format!("brushed_normal.{extension}")), "{line}");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn an_image_that_is_larger_than_memory_fails_its_asset() {
    // The data is as dense as deflate allows, so that only memory limits the image.
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, 16384, 16384);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header().expect("a header");
    let mut stream = writer.stream_writer().expect("a stream");
    for _ in 0..16384 {
        std::io::Write::write_all(&mut stream, &[128; 4 * 16384]).expect("a row");
    }
    stream.finish().expect("a file");
    drop(writer);
    let line = Scene::with_normal_map("png", &png).error_line(Some(LIMIT / 2), &[4]);
    assert!(line.contains("brushed_normal.png") && line.contains("MiB of free memory"), "{line}");
}

#[test]
#[cfg(target_os = "linux")]
fn a_buffer_larger_than_memory_is_copied() {
    let scene = Scene::new();
    File::options()
        .write(true)
        .open(scene.bad("brushed.bin"))
        .expect("a file")
        .set_len(3 << 30)
        .expect("a sparse file");
    let run = scene.bake(Some(LIMIT));
    assert_eq!((run.code, run.err.as_str()), (0, ""));
    let copy = fs::metadata(scene.folder.path().join("out/bad/brushed.bin")).expect("a copy");
    assert_eq!(copy.len(), 3 << 30);
}

/// Tests that a run ends with an error rather than a crash for any limit on memory.
#[test]
#[cfg(target_os = "linux")]
fn a_run_ends_cleanly_for_any_limit_on_memory() {
    let side = 2048;
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, side, side);
    encoder.set_color(png::ColorType::Rgb);
    let noise: Vec<u8> = (0..side * side * 3).map(|i| 100 + (i.wrapping_mul(2_654_435_761) >> 27) as u8).collect();
    encoder.write_header().and_then(|mut writer| writer.write_image_data(&noise)).expect("a PNG");
    for mebibytes in (250..=1000).step_by(75) {
        let scene = Scene::with_normal_map("png", &png);
        let run = scene.bake(Some(mebibytes << 10));
        let is_recorded = run.code == 0 || (run.code == 4 && run.err.contains("memory"));
        assert!(is_recorded, "{mebibytes} MiB: exit {}, {}", run.code, run.err);
    }
}

/// An image of 60,000 channels gets a short message.
#[test]
fn an_exr_of_many_channels_gets_a_short_message() {
    let names: Vec<String> = (0..60_000).map(|i| format!("c{i}")).collect();
    let channel =
        |name: &String| exr::prelude::AnyChannel::new(name.as_str(), exr::prelude::FlatSamples::F32(vec![0.5]));
    let channels = exr::prelude::AnyChannels::sort(names.iter().map(channel).collect());
    let mut file = std::io::Cursor::new(Vec::new());
    exr::image::Image::from_channels((1, 1), channels).write().to_buffered(&mut file).expect("an EXR");
    let line = Scene::with_normal_map("exr", &file.into_inner()).error_line(None, &[1]);
    assert!(line.len() < 1000 && line.contains("more: name one"), "{} bytes: {line:.300}", line.len());
}

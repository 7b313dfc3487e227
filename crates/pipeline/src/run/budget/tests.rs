use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;

use super::*;
use crate::run::job::JobInput;

#[test]
fn permits_stay_within_the_budget() {
    let budget = MemoryBudget { total: 100, free: Mutex::new(100), left: Condvar::new() };
    let (taken, most) = (AtomicU64::new(0), AtomicU64::new(0));
    thread::scope(|scope| {
        for job in 0..40 {
            let (budget, taken, most) = (&budget, &taken, &most);
            scope.spawn(move || {
                let bytes = [10, 40, 60, 1000][job % 4];
                let _permit = budget.take(bytes);
                let now = taken.fetch_add(bytes.min(100), Ordering::SeqCst) + bytes.min(100);
                most.fetch_max(now, Ordering::SeqCst);
                thread::yield_now();
                taken.fetch_sub(bytes.min(100), Ordering::SeqCst);
            });
        }
    });
    assert!(most.into_inner() <= 100);
    assert_eq!(*budget.free(), 100);
}

#[test]
fn the_largest_image_decides_on_the_memory_of_a_job() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    image::RgbImage::new(30, 20).save(path("small.png")).expect("a file");
    image::RgbImage::new(300, 200).save(path("large.png")).expect("a file");
    std::fs::write(path("mesh.bin"), vec![0; 1 << 20]).expect("a file");
    let input = |name: &str, bytes| JobInput { path: path(name), blake3: None, bytes };
    let inputs = |names: &[&str]| names.iter().map(|name| input(name, 1000)).collect();
    let job = |inputs| Job {
        id: crate::digest::digest(b""),
        source: path("a.gltf"),
        output: PathBuf::new(),
        name: None,
        settings: crate::project::Values::default(),
        inputs,
        outputs: Vec::new(),
        cost: 0,
        command: Vec::new(),
    };
    assert_eq!(memory(&job(inputs(&["a.gltf"]))), 32 * 500);
    assert_eq!(memory(&job(inputs(&["a.gltf", "mesh.bin", "absent.png"]))), 32 * 500);
    assert_eq!(memory(&job(inputs(&["a.gltf", "small.png", "large.png"]))), 25 * 60_000);
    // One of three images may be a base colour.
    assert_eq!(memory(&job(inputs(&["a.gltf", "small.png", "large.png", "small.png"]))), 32 * 60_000);
}

/// Reads sizes from headers that are wrong or end early.
#[test]
fn damaged_headers_cause_no_panic() {
    let mut png = std::io::Cursor::new(Vec::new());
    image::RgbImage::new(5, 7).write_to(&mut png, image::ImageFormat::Png).expect("a file");
    let starts: [&[u8]; 8] = [
        png.get_ref(),
        b"\xff\xd8\xff\xe0\0\x10JFIF\0\x01\xff\xc0\0\x11\x08\xff\xff\xff\xff",
        b"II*\0\xff\xff\xff\xff",
        b"RIFF\xff\xff\xff\xffWEBPVP8L\xff\xff\xff\xff",
        b"\x76\x2f\x31\x01\x02\0\0\0channels\0chlist\0\xff\xff\xff\xff",
        b"#?RADIANCE\n\n-Y 99999999999999999999 +X 1\n",
        b"\xabKTX 20\xbb\r\n\x1a\n\0\0\0\0\xff\xff\xff\xff\xff\xff\xff\xff",
        b"\0\0\x02\0\0\0\0\0\0\0\0\0\xff\xff\xff\xff\x18\0",
    ];
    for start in starts {
        for length in 0..start.len() {
            let mut bytes = start[..length].to_vec();
            let _ = imagesize::blob_size(&bytes);
            bytes.resize(4 * length, 0xff);
            let _ = imagesize::blob_size(&bytes);
        }
    }
}

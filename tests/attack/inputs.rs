//! Valid files, which the attacks damage.

use std::fs;
use std::io::Cursor;
use std::path::Path;

use ::image::{ImageFormat, Rgb, RgbImage};
use jpeg_encoder::{ColorType, Encoder};

/// Settings with every kind of value.
pub const CONFIGURATION: &str = "output = \"../baked\"\ntarget = \"bc\"\nmax-error = 0.2\n\n[remote]\nurl = \
    \"grpc://farm:8980\"\njobs = 4\n\n[[override]]\nfiles = [\"props/**\", \"*_{a,b}.gltf\"]\nquality = \"best\"\n";

fn fixture(name: &str) -> Vec<u8> {
    fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name)).expect("a fixture")
}

/// Returns documents with materials of every kind.
pub fn documents() -> Vec<Vec<u8>> {
    ["brushed/brushed.gltf", "heights/heights.gltf", "knobs/knobs.gltf", "waves/waves.glb"].map(fixture).into()
}

/// Returns a picture of 16 x 16 texels in each format. The first byte of each case selects the format, as the entry
/// expects.
pub fn images() -> Vec<Vec<u8>> {
    let picture = RgbImage::from_fn(16, 16, |x, y| Rgb([100 + 3 * x as u8, 90 + 4 * y as u8, 240]));
    let encoded = |format| {
        let mut file = Cursor::new(Vec::new());
        picture.write_to(&mut file, format).expect("a picture");
        file.into_inner()
    };
    let jpeg = |is_progressive| {
        let mut file = Vec::new();
        let mut encoder = Encoder::new(&mut file, 90);
        encoder.set_progressive(is_progressive);
        encoder.encode(picture.as_raw(), 16, 16, ColorType::Rgb).expect("a JPEG");
        file
    };
    let named = |name: u8, file: Vec<u8>| [vec![name], file].concat();
    let textures = textures().into_iter().map(|file| named(7, file));
    let pictures = [
        named(0, encoded(ImageFormat::Png)),
        named(0, fixture("maps/line_normal.png")),
        named(1, jpeg(false)),
        named(1, jpeg(true)),
        named(2, tiff(&picture)),
        named(3, encoded(ImageFormat::Tga)),
        named(4, encoded(ImageFormat::WebP)),
        named(6, fixture("maps/dunes_height.exr")),
        named(8, encoded(ImageFormat::Png)),
    ];
    pictures.into_iter().chain(textures).collect()
}

fn tiff(picture: &RgbImage) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let mut encoder = ::tiff::encoder::TiffEncoder::new(&mut file).expect("a TIFF");
    encoder.write_image::<::tiff::encoder::colortype::RGB8>(16, 16, picture.as_raw()).expect("a TIFF");
    file.into_inner()
}

/// Returns textures that the tool itself bakes, of several targets and with every content.
pub fn textures() -> Vec<Vec<u8>> {
    let folder = tempfile::tempdir().expect("a folder");
    let map = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/maps/line_normal.png");
    for target in ["basis", "float"] {
        let output = folder.path().join(format!("{target}.ktx2"));
        let run = std::process::Command::new(env!("CARGO_BIN_EXE_roughcast"))
            .args(["map".as_ref(), map.as_os_str(), "-o".as_ref(), output.as_os_str()])
            .args(["--target", target, "--profile", "both", "--roughness-factor", "0.3", "--quiet"])
            .output()
            .expect("the command starts");
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    }
    let mut files: Vec<_> = fs::read_dir(folder.path()).expect("a folder").map(|f| f.expect("a file").path()).collect();
    files.sort();
    files.iter().map(|path| fs::read(path).expect("a texture")).collect()
}

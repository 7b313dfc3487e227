//! Each fault of a bump map has a note, and maps without faults have none.

use crate::bake::{BaseRoughness, bake_map};
use crate::bump::{HeightMap, NormalLayout, NormalMap};
use crate::codec::Target;
use crate::image::{Image, Samples};
use crate::material::bump_map::BumpMap;
use crate::mip::Wrap;
use crate::note::{Note, NoteKind};
use crate::settings::{Model, Profile, Settings};

const N: u32 = 64;

/// Returns the notes of a bake on a surface of roughness `roughness`.
fn notes(bump_map: &BumpMap, roughness: f32, settings: Settings) -> Vec<Note> {
    let base = BaseRoughness { image: None, factor: roughness };
    bake_map(bump_map, Some(&base), &settings).unwrap().notes
}

/// Returns settings whose error bound cannot be missed.
fn anisotropic() -> Settings {
    Settings { model: Model::Anisotropic, target: Target::Float, max_error: 1.0, ..Settings::default() }
}

fn normals(width: u32, height: u32, samples: Samples) -> BumpMap {
    BumpMap::Normals(NormalMap::new(Image { width, height, channels: 3, samples }, NormalLayout::Xyz, false).unwrap())
}

/// Returns a map of float normals with these slopes.
fn of_slopes(width: u32, height: u32, slope: impl Fn(u32, u32) -> [f32; 2]) -> BumpMap {
    let texel = |i: u32| {
        let [u, v] = slope(i % width, i / width);
        // Negative somewhere, so that floats are components.
        [-u - 1e-6, -v, 1.0]
    };
    normals(width, height, Samples::F32((0..width * height).flat_map(texel).collect()))
}

/// Checks that exactly one note has the kind `kind` and that its sentence has `part`.
fn assert_one(notes: &[Note], kind: NoteKind, part: &str) {
    let texts: Vec<&str> = notes.iter().filter(|note| note.kind == kind).map(|note| note.text.as_str()).collect();
    assert!(matches!(texts[..], [text] if text.contains(part)), "{kind:?}: {part}: {notes:?}");
}

/// Returns the slopes of ridges along v, +-0.3.
fn ridges(x: u32, _: u32) -> [f32; 2] {
    [if x.is_multiple_of(2) { 0.3 } else { -0.3 }, 0.0]
}

#[test]
fn a_map_without_faults_has_no_notes() {
    assert_eq!(notes(&of_slopes(N, N, ridges), 0.4, anisotropic()), []);
}

#[test]
fn slopes_beyond_the_clamp_are_counted() {
    let bump_map = of_slopes(N, N, |x, y| if (x, y) == (3, 5) { [40.0, 0.0] } else { ridges(x, y) });
    assert_one(&notes(&bump_map, 0.4, anisotropic()), NoteKind::SteepSlopes, "1 of 4096 texels are steeper than 16");
}

#[test]
fn normals_below_the_surface_are_counted() {
    let mut samples = [0.01, -0.01, 1.0].repeat(16);
    samples[3..6].copy_from_slice(&[0.6, 0.0, -0.8]);
    samples[9..12].copy_from_slice(&[1.0, 0.0, 0.0]);
    assert_one(
        &notes(&normals(4, 4, Samples::F32(samples)), 0.4, anisotropic()),
        NoteKind::NormalsBelowSurface,
        "2 of 16 normals point along",
    );
}

/// The black half of an atlas adds no roughness, at its edge either.
#[test]
fn black_texels_are_counted_and_roughen_nothing() {
    let row = [[128, 128, 255].repeat(3), [0, 0, 0].repeat(5)].concat();
    let bump_map = normals(8, 8, Samples::U8(row.repeat(8)));
    assert_one(&notes(&bump_map, 0.4, anisotropic()), NoteKind::UnusedTexels, "40 of 64 texels are black");
    let mut offsets = vec![[1.0; 2]; 8];
    bump_map.offsets(3, &mut offsets);
    assert!(offsets.iter().flatten().all(|slope| slope.abs() < 0.01), "{offsets:?}");
}

#[test]
fn alphas_above_one_are_counted() {
    let bump_map = of_slopes(N, N, |x, _| [if x.is_multiple_of(2) { 3.0 } else { -3.0 }, 0.0]);
    // Fitted lobes, those of the coarsest levels, stay within the limit.
    let texels = 1360;
    assert_one(
        &notes(&bump_map, 0.4, anisotropic()),
        NoteKind::AlphaAboveOne,
        &format!("{texels} texels over all levels are rougher"),
    );
}

#[test]
fn reports_resampling_to_sizes_of_whole_blocks() {
    for (size, grid) in [((7, 5), "8 x 8"), ((1, 9), "4 x 12"), ((1, 1), "4 x 4")] {
        let bump_map = of_slopes(size.0, size.1, ridges);
        let blocks = Settings { target: Target::Basis, ..anisotropic() };
        assert_one(
            &notes(&bump_map, 0.4, blocks),
            NoteKind::Resampled,
            &format!("the map of {} x {} texels was resampled to {grid}", size.0, size.1),
        );
        assert_eq!(notes(&bump_map, 0.4, anisotropic()), []);
    }
}

/// Rounding a gentle dome to 8 bits roughens a mirror, and no rougher surface.
#[test]
fn reports_depths_too_small_for_a_smooth_surface() {
    let dome = |one: f32| {
        move |i: u32| {
            let [x, y] = [i % N, i / N].map(|c| 0.2 * (c as f32 / N as f32 - 0.5));
            let z = (1.0 - x * x - y * y).sqrt();
            [x, y, z].map(|c| ((0.5 * c + 0.5) * one).round())
        }
    };
    let bytes = Samples::U8((0..N * N).flat_map(dome(255.0)).map(|c| c as u8).collect());
    let words = Samples::U16((0..N * N).flat_map(dome(65535.0)).map(|c| c as u16).collect());
    let (bytes, words) = (normals(N, N, bytes), normals(N, N, words));
    assert_one(&notes(&bytes, 0.05, anisotropic()), NoteKind::SmallDepth, "the depth of the bump map is too small");
    assert_eq!(notes(&bytes, 0.3, anisotropic()), []);
    assert_eq!(notes(&words, 0.05, anisotropic()), []);
}

/// Rounding heights to 8 bits roughens even paint.
#[test]
fn reports_heights_of_eight_bits() {
    let bump_map = |samples| {
        let image = Image { width: N, height: N, channels: 1, samples };
        let (slope_per_step, wrap) = ([0.05 * 1024.0; 2], [Wrap::Clamp; 2]);
        BumpMap::Heights { map: HeightMap::new(image).unwrap(), slope_per_step, wrap }
    };
    let ramp = |one: f32| (0..N * N).map(move |i| (i % N) as f32 / 1000.0 * one);
    let bytes = bump_map(Samples::U8(ramp(255.0).map(|h| h.round() as u8).collect()));
    let words = bump_map(Samples::U16(ramp(65535.0).map(|h| h.round() as u16).collect()));
    let floats = bump_map(Samples::F32(ramp(1.0).collect()));
    assert_one(&notes(&bytes, 0.3, anisotropic()), NoteKind::SmallDepth, "the depth of the bump map is too small");
    for deep in [words, floats] {
        assert_eq!(notes(&deep, 0.3, anisotropic()), []);
    }
}

/// Grooves around the centre, as a lathe leaves them: along one radius the signs cannot agree.
#[test]
fn reports_axes_that_rotate_around_a_point() {
    let lathe = |x: u32, y: u32| {
        let [x, y] = [x, y].map(|c| c as f32 - 0.5 * (N as f32 - 1.0));
        let radius = (x * x + y * y).sqrt();
        let slope = if (radius as u32).is_multiple_of(2) { 0.3 } else { -0.3 };
        [slope * x / radius, slope * y / radius]
    };
    let bump_map = of_slopes(N, N, lathe);
    assert_one(
        &notes(&bump_map, 0.3, anisotropic()),
        NoteKind::OpposedDirections,
        "directions of anisotropy point away",
    );
    let pyramid = Settings { profile: Profile::Pyramid, ..anisotropic() };
    assert_one(&notes(&bump_map, 0.3, pyramid), NoteKind::FilterLoss, "filtering D loses");
    assert_eq!(notes(&of_slopes(N, N, ridges), 0.3, pyramid), []);
}

//! A preparation from the cache is the one that is made: every hit, the light and every pixel, bit for bit; and no file of a
//! cache, whatever is in it, stops a run.

use crate::support::program::moving;
use crate::support::run::{Case, case};
use crate::support::scene::{self, Scene, Shape};
use crate::support::specular::hall;
use glam::{Quat, Vec3, Vec3A};
use serde_json::json;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use sweeplight::sequence::prepared::Prepared;
use sweeplight::sequence::{Event, Renderer, prepare, verify};
use sweeplight::settings::{HemisphereSampling, Meshing, Pairs, Settings, SkyChoice, Solver};
use sweeplight::visibility::Visibility;

/// What a run heard.
#[derive(Debug, Default)]
struct Heard {
    stages: Vec<String>,
    warnings: Vec<String>,
}

impl Heard {
    fn kept(&self) -> bool {
        let has = |name: &str| self.stages.iter().any(|stage| stage == name);
        assert!(has("read the cache") || has("cut patches"), "{self:?}");
        !has("cut patches")
    }
}

fn prepared(settings: &Settings) -> (Prepared, Heard) {
    let heard = Mutex::new(Heard::default());
    let watch = |event: Event| match event {
        Event::Stage { name, .. } => heard.lock().expect("no panic").stages.push(name.into()),
        Event::Warning(text) => heard.lock().expect("no panic").warnings.push(text.into()),
        _ => {}
    };
    let prepared = prepare::prepare(settings, &watch).expect("a scene");
    (prepared, heard.into_inner().expect("no panic"))
}

/// What a frame ended with.
#[derive(PartialEq)]
struct FrameBits {
    view: Visibility,
    reflected: Vec<Vec3A>,
    pixels: Vec<[f32; 3]>,
}

fn frames(prepared: &Prepared) -> Vec<FrameBits> {
    let mut renderer = Renderer::new(prepared);
    let frame = |index| {
        let pixels = renderer.step(index).expect("a camera").image.radiance;
        FrameBits {
            view: renderer.state().view.clone(),
            reflected: renderer.state().light.reflected.clone(),
            pixels,
        }
    };
    (0..prepared.frames.len()).map(frame).collect()
}

/// The files of a cache.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("a folder").flatten();
    entries.map(|entry| entry.path()).collect()
}

/// Renders some frames without a cache, into one, and from it, and insists that all are the same.
fn same(mut case: Case) {
    case.settings.image.size = (16, 9);
    case.settings.scene.frames = Some(vec![3, 1]);
    let (plain, heard) = prepared(&case.settings);
    let expected = frames(&plain);
    let folder = case.folder.path().join("cache");
    case.settings.output.cache = Some(folder.clone());
    for kept in [false, true] {
        let (cached, again) = prepared(&case.settings);
        assert_eq!(again.kept(), kept);
        assert_eq!(again.warnings, heard.warnings);
        assert_eq!(cached.counts.elements, plain.counts.elements);
        assert_eq!(cached.counts.sides, plain.counts.sides);
        assert!(frames(&cached) == expected, "frames differ, kept {kept}");
    }
    assert_eq!(files(&folder).len(), 1);
}

/// A hall with mirrors, panes, a curtain, a sheet and glass, of which some move.
fn mirrors() -> Scene {
    let at = |x: f32, turn: f32| (Vec3::new(x, -0.3, 0.1), Quat::from_rotation_y(turn));
    hall([at(-0.4, 0.0), at(0.2, 0.4), at(0.5, 0.9)])
}

/// A room lit by a lamp that moves, a spot at rest and the sun through nothing, with a round thing in it.
fn lamps() -> Scene {
    let mut scene = moving();
    let spot = json!({"type": "spot", "intensity": 40.0, "spot": {"outerConeAngle": 0.9}});
    scene.light(spot, Vec3::new(1.5, 1.4, 0.0), Vec3::new(-1.0, -1.0, 0.2));
    let point = json!({"type": "point", "intensity": 20.0});
    let lamp = scene.light(point, Vec3::ZERO, Vec3::X);
    let places = [Vec3::new(1.0, 0.9, 0.0), Vec3::new(0.0, 1.0, 1.0)];
    scene.slide(lamp, "LINEAR", &[(0.0, places[0]), (1.0, places[1])]);
    scene
}

#[test]
fn a_cached_preparation_is_the_one_that_is_made() {
    same(case(&moving()));
    same(case(&mirrors()));
    same(case(&lamps()));
}

#[test]
fn so_it_is_by_every_solver_and_with_every_mesh() {
    let with = |scene: &Scene, change: fn(&mut Settings)| {
        let mut case = case(scene);
        change(&mut case.settings);
        same(case);
    };
    with(&moving(), |s| s.solve.solver = Solver::Progressive);
    with(&moving(), |s| s.solve.pairs = Pairs::Near);
    with(&moving(), |s| {
        (s.solve.element_size, s.solve.form_factors) = (Some(1.5), HemisphereSampling::Disks);
    });
    with(&moving(), |s| s.solve.patch_elements = 4);
    with(&moving(), |s| s.solve.from_scratch = true);
    with(&moving(), |s| s.film.shutter = 0.5);
    for mesh in [Meshing::Adaptive, Meshing::Shadows] {
        let mut case = case(&moving());
        case.settings.solve.mesh = mesh;
        (
            case.settings.solve.element_size,
            case.settings.solve.elements,
        ) = (None, Some(300));
        same(case);
    }
    // The sky does not get into a closed room, which is warned of each time.
    with(&moving(), |s| s.light.sky = Some(SkyChoice::Even([1.0; 3])));
    // A ball of many small triangles is cut into clusters.
    let mut round = moving();
    let grey = round.material(Vec3::splat(0.5), Vec3::ZERO);
    let mut ball = Shape::ball(40);
    ball.positions.iter_mut().for_each(|p| *p *= 0.4);
    round.object("ball", &ball, grey);
    with(&round, |s| {
        (s.solve.element_size, s.solve.elements) = (None, Some(800));
    });
}

#[test]
fn verify_finds_no_difference() {
    let mut case = case(&moving());
    case.settings.output.cache = Some(case.folder.path().join("cache"));
    for _ in 0..2 {
        let verified = verify(&case.settings, &sweeplight::sequence::silence, &|_| {});
        let verified = verified.expect("a scene");
        assert_eq!((verified.differ, verified.pixels_differ), (0, 0));
        assert_eq!(verified.frames, 9);
    }
}

/// A small room for files that are damaged many times.
fn small() -> Case {
    let mut case = case(&scene::corner(true));
    (
        case.settings.solve.element_size,
        case.settings.solve.samples,
    ) = (Some(0.5), Some(16));
    case.settings.image.size = (8, 5);
    case.settings.scene.frames = Some(vec![2]);
    case.settings.output.cache = Some(case.folder.path().join("cache"));
    case
}

#[test]
fn a_file_that_is_foreign_cut_or_damaged_is_told_once_and_made_anew() {
    let case = small();
    let expected = frames(&prepared(&case.settings).0);
    let folder = case.folder.path().join("cache");
    let [file] = &files(&folder)[..] else {
        panic!("one file");
    };
    let whole = fs::read(file).expect("a file");
    let damaged = |at: usize| {
        let mut bytes = whole.clone();
        bytes[at] ^= 0x10;
        bytes
    };
    let wrong = [
        Vec::new(),
        b"a letter".to_vec(),
        whole[..whole.len() / 2].to_vec(),
        whole[..whole.len() - 1].to_vec(),
        [&whole[..], b"more"].concat(),
        damaged(0),
        damaged(9),
        damaged(20),
        damaged(whole.len() / 3),
        damaged(whole.len() - 1),
    ];
    for bytes in wrong {
        fs::write(file, &bytes).expect("a file");
        let (made, heard) = prepared(&case.settings);
        let of_file = |text: &&String| text.starts_with(&*file.to_string_lossy());
        assert_eq!(
            heard.warnings.iter().filter(of_file).count(),
            1,
            "{heard:?}"
        );
        assert!(!heard.kept() && frames(&made) == expected);
        let (read, heard) = prepared(&case.settings);
        assert!(heard.kept() && frames(&read) == expected);
    }
    // What is there may be a folder too; then nothing is kept.
    fs::remove_file(file).expect("a file");
    fs::create_dir(file).expect("a folder");
    let (made, heard) = prepared(&case.settings);
    assert!(!heard.kept() && frames(&made) == expected);
}

/// Lengths and numbers out of all bounds, with a checksum that is right: whoever writes it must not stop the program.
#[test]
fn wild_content_with_the_right_checksum_stops_nothing() {
    let case = small();
    prepared(&case.settings);
    let folder = case.folder.path().join("cache");
    let [file] = &files(&folder)[..] else {
        panic!("one file");
    };
    let whole = fs::read(file).expect("a file");
    let (label, end) = (44, whole.len() - 32);
    let mut state = 9u64;
    let mut random = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1);
        (state >> 33) as usize
    };
    let mut read = 0;
    for k in 0..150 {
        let mut bytes = whole[..end].to_vec();
        // Whole words, most of them lengths and numbers, at the start more than later.
        let reach = if k % 2 == 0 { 4096 } else { end - label - 8 };
        let at = label + random() % reach.min(end - label - 8) / 4 * 4;
        let value = [0u32, 1, 1 << 16, 1 << 24, u32::MAX, random() as u32][k % 6];
        bytes[at..at + 4].copy_from_slice(&value.to_ne_bytes());
        let checksum = blake3::hash(&bytes);
        bytes.extend(checksum.as_bytes());
        fs::write(file, bytes).expect("a file");
        let (made, heard) = prepared(&case.settings);
        assert!(!made.patches.sides.is_empty());
        read += usize::from(heard.kept());
    }
    assert!(
        read > 0,
        "every file was refused, so that none tells of what is read"
    );
}

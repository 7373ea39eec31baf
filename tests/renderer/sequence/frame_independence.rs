//! A frame is what its time says, however it was reached: back and forth, alone, or after all the others.

use crate::support::run::{Case, case};
use crate::support::scene::{self, Scene};
use glam::{Quat, Vec3, Vec3A};
use std::fs;
use sweeplight::image::film::Image;
use sweeplight::sequence::{render, silence};
use sweeplight::settings::{Solver, TOLERANCE};
use sweeplight::solver::{self, Radiosity};
use sweeplight::visibility::{MissIds, Visibility};

/// A block that goes 1.6 m to the side, turning, and comes back: `seconds` in all.
fn out_and_back(seconds: f32) -> Scene {
    let mut scene = scene::room();
    let block = scene::block(&mut scene, "block", Vec3::new(0.4, 0.6, 0.3));
    let home = Vec3::new(-0.8, -0.6, 0.3);
    let away = home + Vec3::new(1.6, 0.0, -0.4);
    let half = seconds / 2.0;
    scene.slide(
        block,
        "LINEAR",
        &[(0.0, home), (half, away), (seconds, home)],
    );
    let (from, to) = (scene::about_y(10.0), scene::about_y(77.0));
    scene.turn(block, "LINEAR", &[(0.0, from), (half, to), (seconds, from)]);
    scene
}

/// What a frame ended with.
struct Frame {
    frame: u32,
    view: Visibility,
    reflected: Vec<Vec3A>,
    image: Image,
}

/// All frames of the settings.
fn frames(case: &Case) -> Vec<Frame> {
    let mut frames = Vec::new();
    case.walk(&case.prepare(), |state, report, image| {
        frames.push(Frame {
            frame: report.frame,
            view: state.view.clone(),
            reflected: state.light.reflected.clone(),
            image: image.clone(),
        });
    });
    frames
}

/// Insists that two renders of one frame have the same bits: hits, light and picture.
fn same(a: &Frame, b: &Frame) {
    assert_eq!(a.frame, b.frame);
    assert!(a.view == b.view, "frame {}: samples differ", a.frame);
    assert!(
        a.reflected == b.reflected,
        "frame {}: light differs",
        a.frame
    );
    assert!(
        a.image.radiance == b.image.radiance,
        "frame {}: pixels differ",
        a.frame
    );
}

/// The same place asks the same questions of the same things, and every solve starts from the same light: the last frame is
/// the first one, bit for bit.
#[test]
fn what_comes_back_finds_the_same_answers() {
    let mut frames = frames(&case(&out_and_back(1.0)));
    assert_eq!(frames.len(), 9);
    assert!(frames[0].view != frames[4].view, "nothing moved");
    frames[8].frame = 0;
    same(&frames[8], &frames[0]);
}

/// A frame depends on nothing but its time: alone, in any order and twice over it is the frame of the whole run, bit for
/// bit. Frame 1 comes after itself, so that nothing changed; from 17 to 4 and 20 to 0 everything did.
#[test]
fn any_order_and_any_part_of_the_frames_gives_the_same_bits() {
    let mut case = case(&out_and_back(2.5));
    let whole = frames(&case);
    assert_eq!(whole.len(), 21);
    for part in [&[17][..], &[4], &[5, 3, 9], &[6, 1, 1, 20, 0]] {
        case.settings.scene.frames = Some(part.to_vec());
        for frame in frames(&case) {
            same(&frame, &whole[frame.frame as usize]);
        }
    }
}

/// The same where light, colours and camera change too, the shutter is open and light is shot: the pixels of another frame
/// never show.
#[test]
fn pixels_of_another_frame_do_not_show() {
    let mut scene = out_and_back(1.0);
    let lamp = "/materials/1/extensions/KHR_materials_emissive_strength/emissiveStrength";
    scene.point(lamp, "LINEAR", &[(0.0, &[9.0]), (1.0, &[2.0])]);
    let camera = "/nodes/2/translation";
    scene.point(
        camera,
        "STEP",
        &[(0.0, &[1.7, 0.9, 1.7]), (0.6, &[1.6, 0.9, 1.7])],
    );
    let mut case = case(&scene);
    case.settings.film.shutter = 0.5;
    case.settings.film.sub_frames = 2;
    case.settings.scene.fps = 4.0;
    for solver in [Solver::Gather, Solver::Progressive] {
        case.settings.solve.solver = solver;
        case.settings.scene.frames = None;
        let whole = frames(&case);
        case.settings.scene.frames = Some(vec![3, 1]);
        for frame in frames(&case) {
            same(&frame, &whole[frame.frame as usize]);
        }
    }
}

/// The same in the files, byte for byte: `--frames 17` against frame 17 of all, as EXR in floats and as PNG; and the file
/// holds the image's own bits.
#[test]
fn a_frame_alone_is_the_same_file() {
    let mut case = case(&out_and_back(2.5));
    let save = |case: &mut Case, name: &str| {
        let at = |extension: &str| case.folder.path().join(format!("{name}_####.{extension}"));
        let patterns = ["exr", "png"].map(|extension| at(extension).display().to_string());
        case.settings.output.images = patterns.to_vec();
        case.settings.output.exr_float = true;
        render(&case.settings, &silence).expect("a sequence");
        let file = |extension: &str| case.folder.path().join(format!("{name}_0017.{extension}"));
        ["exr", "png"].map(file)
    };
    let whole = save(&mut case, "whole");
    case.settings.scene.frames = Some(vec![17]);
    let alone = save(&mut case, "alone");
    for (whole, alone) in whole.iter().zip(&alone) {
        let [whole, alone] = [whole, alone].map(|path| fs::read(path).expect("a file"));
        assert!(whole == alone, "the files differ");
    }
    let frame = frames(&case).remove(0);
    let saved = radiance(&alone[0]);
    assert!(saved == frame.image.radiance, "the file is not the image");
}

/// The pixels of an EXR file.
fn radiance(path: &std::path::Path) -> Vec<[f32; 3]> {
    let image = exr::prelude::read_first_rgba_layer_from_file(
        path,
        |size, _| (size.width(), vec![[0.0; 3]; size.area()]),
        |(width, pixels): &mut (usize, Vec<[f32; 3]>), at, (r, g, b, _): (f32, f32, f32, f32)| {
            pixels[at.y() * *width + at.x()] = [r, g, b];
        },
    );
    image.expect("an EXR").layer_data.channel_data.pixels.1
}

/// A turn by a quaternion and by its negative is the same turn: q and −q are one rotation.
#[test]
fn a_quaternions_sign_means_nothing() {
    let views = [1.0, -1.0].map(|sign| {
        let mut scene = scene::room();
        let block = scene::block(&mut scene, "block", Vec3::new(0.4, 0.6, 0.3));
        let turned = Quat::from_xyzw(0.0, 0.6, 0.0, 0.8) * sign;
        scene.turn(block, "LINEAR", &[(0.0, Quat::IDENTITY), (0.25, turned)]);
        frames(&case(&scene))
    });
    for (a, b) in views[0].iter().zip(&views[1]) {
        assert!(a.view == b.view, "frame {} differs", a.frame);
    }
}

/// Whatever light a solve starts from, it ends with every channel of every R within the tolerance × rms R of the
/// solution, as `gather` promises: here from darkness and from the light of every other frame, against a solve to 1e-6.
#[test]
fn a_solve_ends_within_its_tolerance_from_any_start() {
    let mut case = case(&out_and_back(1.0));
    case.settings.solve.samples = Some(32);
    let prepared = case.prepare();
    let mut lights = vec![Radiosity::default()];
    case.walk_light(&prepared, |state, _| lights.push(state.light.clone()));
    case.walk_light(&prepared, |state, report| {
        let shares = prepared.back.shares(&state.view);
        let rows = prepared.rows(&state.view, &shares);
        let solve = |start: Radiosity, tolerance: f32| {
            let direct = state.view.direct();
            let kinds = MissIds::KINDS;
            solver::gather(
                &rows,
                &direct,
                &prepared.patches.reflectances(&prepared.rest),
                kinds,
                start,
                tolerance,
            )
            .reflected
        };
        let exact = solve(Radiosity::default(), 1e-6);
        let squares: f32 = exact.iter().map(|r| r.length_squared()).sum();
        let rms = (squares / (3 * prepared.patches.sides.len()) as f32).sqrt();
        for start in &lights {
            let light = solve(start.clone(), TOLERANCE);
            let pairs = light.iter().zip(&exact);
            let off = pairs
                .map(|(a, b)| (*a - *b).abs().max_element())
                .fold(0.0, f32::max)
                / rms;
            assert!(off <= TOLERANCE, "frame {}: off by {off}", report.frame);
        }
    });
}

//! A frame is what its time says, however it was reached: back and forth, alone, or after all the others.

use crate::support::run::{Case, case};
use crate::support::scene::{self, Scene};
use glam::{Quat, Vec3, Vec3A};
use std::f32::consts::PI;
use sweeplight::image::film::Image;
use sweeplight::sequence::{render, silence};
use sweeplight::settings::TOLERANCE;
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

/// Root mean square of the reflected radiosity, over all channels.
fn rms(frame: &Frame) -> f32 {
    let squares: f32 = frame.reflected.iter().map(|r| r.length_squared()).sum();
    (squares / (3 * frame.reflected.len()) as f32).sqrt()
}

/// Largest difference of any channel of the radiosity.
fn light_between(a: &Frame, b: &Frame) -> f32 {
    let pairs = a.reflected.iter().zip(&b.reflected);
    pairs
        .map(|(a, b)| (*a - *b).abs().max_element())
        .fold(0.0, f32::max)
}

fn between(a: &[[f32; 3]], b: &[[f32; 3]]) -> f32 {
    assert_eq!(a.len(), b.len());
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

/// The same place asks the same questions of the same things: the last view is the first one, bit for bit, and the light
/// is the same to the tolerance of two solves.
#[test]
fn what_comes_back_finds_the_same_answers() {
    let frames = frames(&case(&out_and_back(1.0)));
    let (first, last) = (&frames[0], &frames[8]);
    assert_eq!(frames.len(), 9);
    assert!(first.view == last.view, "the last view is not the first");
    assert!(first.view != frames[4].view, "nothing moved");
    let allowed = 2.0 * TOLERANCE * rms(first);
    let off = light_between(first, last);
    assert!(
        off <= allowed,
        "light is off by {off}, allowed is {allowed}"
    );
}

/// A frame's answers do not depend on other frames at all; its light does, by what two solves may leave: each is within
/// the tolerance × rms R of the solution. A pixel shows ρ/π × the mean of such R, and ρ ≤ 0.7 here.
#[test]
fn a_frame_alone_is_the_frame_of_the_whole_run() {
    let mut case = case(&out_and_back(2.5));
    let whole = frames(&case);
    assert_eq!(whole.len(), 21);
    for frame in [17, 4] {
        case.settings.scene.frames = Some(vec![frame]);
        let alone = frames(&case).remove(0);
        let among = &whole[frame as usize];
        assert_eq!((alone.frame, among.frame), (frame, frame));
        assert!(alone.view == among.view, "frame {frame}: samples differ");
        let allowed = 2.0 * TOLERANCE * rms(&alone);
        let off = light_between(&alone, among);
        assert!(
            off <= allowed,
            "frame {frame}: light is off by {off} of {allowed}"
        );
        let off = between(&alone.image.radiance, &among.image.radiance);
        let allowed = allowed * 0.7 / PI + 1e-6;
        assert!(
            off <= allowed,
            "frame {frame}: a pixel is off by {off} of {allowed}"
        );
    }
}

/// The same in the files: `--frames 17` against frame 17 of all, in EXR floats; and the file holds the image's own bits.
#[test]
fn a_frame_alone_is_the_same_file() {
    let mut case = case(&out_and_back(2.5));
    let save = |case: &mut Case, name: &str| {
        let pattern = case.folder.path().join(format!("{name}_####.exr"));
        case.settings.output.images = vec![pattern.to_string_lossy().into_owned()];
        case.settings.output.exr_float = true;
        render(&case.settings, &silence).expect("a sequence");
        radiance(&case.folder.path().join(format!("{name}_0017.exr")))
    };
    let whole = save(&mut case, "whole");
    case.settings.scene.frames = Some(vec![17]);
    let alone = save(&mut case, "alone");
    let frame = frames(&case).remove(0);
    assert!(alone == frame.image.radiance, "the file is not the image");
    let (off, allowed) = (
        between(&whole, &alone),
        2.0 * TOLERANCE * rms(&frame) * 0.7 / PI + 1e-6,
    );
    assert!(
        off <= allowed,
        "a pixel is off by {off}, allowed is {allowed}"
    );
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

/// Whatever order frames are rendered in, each is the same: its own time says all.
#[test]
fn the_order_of_frames_changes_no_answer() {
    let mut case = case(&out_and_back(1.0));
    let forth = frames(&case);
    case.settings.scene.frames = Some(vec![6, 1, 1, 8, 0]);
    for frame in frames(&case) {
        assert!(
            frame.view == forth[frame.frame as usize].view,
            "frame {} differs",
            frame.frame
        );
    }
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
    case.walk(&prepared, |state, _, _| lights.push(state.light.clone()));
    case.walk(&prepared, |state, report, _| {
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

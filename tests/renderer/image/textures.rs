//! Surfaces point by point: pictures, vertex colours, holes, and what is unlit, each against a formula or a twin.

use crate::support::run::{self, case};
use crate::support::scene::{self, Scene, Shape};
use glam::{Vec2, Vec3, Vec4};
use serde_json::json;
use std::f32::consts::PI;
use sweeplight::formfactor::hemisphere::ORIGINS;
use sweeplight::ids::SideId;
use sweeplight::image::film::Image;
use sweeplight::sequence::prepared::Prepared;

/// glTF's numbers for what lies beyond a picture's edge.
const REPEAT: u32 = 10497;
const CLAMP: u32 = 33071;

const WHITE: [u8; 4] = [255; 4];
const BLACK: [u8; 4] = [0, 0, 0, 255];

/// Half the height of the plane z = 0 that the camera sees.
const SEEN: f32 = 0.9;

/// A black room that shines with radiance 1 from all sides, 4 m wide, and a camera that looks at the plane z = 0.
///
/// A surface in it that nothing shades receives π, hence shows radiance ρ π / π = ρ.
fn bright() -> Scene {
    let mut scene = Scene::default();
    let sky = scene.material(Vec3::ZERO, Vec3::ONE);
    scene.object("sky", &Shape::solid(Vec3::splat(2.0)).inside_out(), sky);
    let height = 1.5;
    let degrees = 2.0 * (SEEN / height).atan().to_degrees();
    scene.camera(Vec3::Z * height, Vec3::ZERO, degrees);
    scene
}

/// A square from −1 to 1 in the plane z = 0 that faces the camera, its picture upright.
fn board() -> Shape {
    let at = |x: f32, y: f32| Vec3::new(x, y, 0.0);
    Shape {
        texcoords: vec![Vec2::Y, Vec2::ONE, Vec2::X, Vec2::ZERO],
        ..Shape::quad([at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)])
    }
}

/// The pixels whose middle lies on the board, with its place there; and half a pixel's width.
fn on_board(image: &Image) -> (Vec<(Vec2, Vec3)>, f32) {
    let half = SEEN / image.height as f32;
    let (width, height) = (image.width as f32, image.height as f32);
    let place = |i: usize| {
        let (x, y) = (i % image.width as usize, i / image.width as usize);
        Vec2::new(2.0 * x as f32 + 1.0 - width, height - 2.0 * y as f32 - 1.0) * half
    };
    let pixels = image.radiance.iter().enumerate();
    let pixels = pixels.map(|(i, pixel)| (place(i), Vec3::from(*pixel)));
    let inside = pixels.filter(|(at, _)| at.abs().max_element() < 1.0 - half);
    (inside.collect(), half)
}

fn near(got: Vec3, expected: Vec3, allowed: f32) -> bool {
    (got - expected).abs().max_element() <= allowed
}

/// Four colours in the quarters of a picture, 16 × 16 pixels: upper left, upper right, lower left, lower right.
fn quarters(colours: [[u8; 4]; 4]) -> Vec<Vec<[u8; 4]>> {
    let pixel = |x: usize, y: usize| colours[x / 8 + 2 * (y / 8)];
    (0..16)
        .map(|y| (0..16).map(|x| pixel(x, y)).collect())
        .collect()
}

/// Each pixel shows the colour of its quarter, although the board is but two elements. sRGB 188 is light 0.50289.
/// A picture turned by a quarter counter-clockwise in texture coordinates turns clockwise on the board.
#[test]
fn each_pixel_looks_into_the_picture() {
    let grey = 0.502_886;
    let colours = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::splat(grey)];
    for turned in [false, true] {
        let mut scene = bright();
        let paper = scene.material(Vec3::splat(0.8), Vec3::ZERO);
        let bytes = [
            [255, 0, 0, 255],
            [0, 255, 0, 255],
            [0, 0, 255, 255],
            [188, 188, 188, 255],
        ];
        let picture = scene.texture(&quarters(bytes), REPEAT);
        let mut info = json!({"index": picture});
        if turned {
            info["extensions"] = json!({"KHR_texture_transform": {"rotation": PI / 2.0}});
        }
        scene.edit(paper)["pbrMetallicRoughness"]["baseColorTexture"] = info;
        scene.object("board", &board(), paper);
        let mut case = case(&scene);
        case.settings.solve.element_size = Some(3.0);
        let (pixels, half) = on_board(&case.first_image());
        let mut seen = [0; 4];
        for (at, got) in pixels {
            // Leave out what lies within a pixel of the picture (1/8 m) of a border.
            if at.abs().min_element() > 0.125 + half && at.abs().max_element() < 0.875 - half {
                let quarter = (at.x > 0.0) as usize + 2 * (at.y < 0.0) as usize;
                // (u, v) → (v, −u): the upper left of the board, u and v below ½, looks at the lower left, and so on.
                let quarter = if turned {
                    [2, 0, 3, 1][quarter]
                } else {
                    quarter
                };
                assert!(near(got, 0.8 * colours[quarter], 0.002), "{got} at {at}");
                seen[quarter] += 1;
            }
        }
        assert!(seen.iter().all(|count| *count > 40), "{seen:?}");
    }
}

/// A board that is mirrored in the second frame shows its mirror image from the same side, though it faces the camera
/// on one side alone: a mirrored node keeps its front, and each point of the surface its colour and its light. One half of
/// it glows, and the other does not.
#[test]
fn what_is_mirrored_on_the_way_shows_its_mirror_image() {
    let mut scene = bright();
    let paper = scene.material(Vec3::splat(0.8), Vec3::ONE);
    let bytes = [
        [255, 0, 0, 255],
        [0, 255, 0, 255],
        [0, 0, 255, 255],
        [188, 188, 188, 255],
    ];
    let picture = json!({"index": scene.texture(&quarters(bytes), REPEAT)});
    scene.edit(paper)["pbrMetallicRoughness"]["baseColorTexture"] = picture;
    let halves = json!({"index": scene.texture(&quarters([WHITE, BLACK, WHITE, BLACK]), REPEAT)});
    scene.edit(paper)["emissiveTexture"] = halves;
    let board = scene.object("board", &board(), paper);
    let mirror = Vec3::new(-1.0, 1.0, 1.0);
    scene.scale(board, "STEP", &[(0.0, Vec3::ONE), (0.125, mirror)]);
    let case = case(&scene);
    let mut images = Vec::new();
    case.walk(&case.prepare(), |_, _, image| images.push(image.clone()));
    let (width, mut seen) = (images[0].width as usize, 0);
    let inside = on_board(&images[0]).0;
    for (at, _) in inside {
        // Leave out what lies within a pixel of the picture of a border.
        if at.abs().min_element() < 0.2 || at.abs().max_element() > 0.8 {
            continue;
        }
        let half = SEEN / images[0].height as f32;
        let column = ((at.x / half + width as f32 - 1.0) / 2.0).round() as usize;
        let row = ((images[0].height as f32 - 1.0 - at.y / half) / 2.0).round() as usize;
        let [before, after] = [column, width - 1 - column].map(|x| row * width + x);
        let (before, after) = (images[0].radiance[before], images[1].radiance[after]);
        assert!(
            near(before.into(), after.into(), 0.01),
            "{before:?} {after:?}"
        );
        seen += 1;
    }
    assert!(seen > 100, "{seen}");
    case.exact();
}

/// A checker of 2 × 2 pixels whose sampler asks for the nearest: no pixel of the image lies between its two colours but
/// where it sees both.
#[test]
fn the_nearest_pixel_makes_squares() {
    let shows = |filter: u32| {
        let mut scene = bright();
        let paper = scene.material(Vec3::ONE, Vec3::ZERO);
        let rows = [vec![WHITE, BLACK], vec![BLACK, WHITE]];
        let picture = scene.texture(&rows, CLAMP);
        scene.sampler(picture)["magFilter"] = filter.into();
        scene.edit(paper)["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": picture});
        scene.object("board", &board(), paper);
        let (pixels, half) = on_board(&case(&scene).first_image());
        let apart = |at: &Vec2| at.abs().min_element() > half;
        let mixed = |got: &Vec3| got.x > 0.02 && got.x < 0.98;
        let pixels = pixels.into_iter().filter(|(at, _)| apart(at));
        pixels.filter(|(_, got)| mixed(got)).count()
    };
    const NEAREST: u32 = 9728;
    const LINEAR: u32 = 9729;
    assert_eq!(shows(NEAREST), 0);
    assert!(shows(LINEAR) > 100);
}

/// The picture's coordinates go ten times around: checkers far smaller than an element, and than a pixel. Elements
/// reflect the mean, and so do pixels, without a pattern.
#[test]
fn what_is_finer_than_an_element_or_a_pixel_is_its_mean() {
    let mut scene = bright();
    let paper = scene.material(Vec3::ONE, Vec3::ZERO);
    let row = |y: usize| (0..16).map(move |x| [WHITE, BLACK][(x + y) % 2]);
    let rows: Vec<Vec<[u8; 4]>> = (0..16).map(|y| row(y).collect()).collect();
    let picture = scene.texture(&rows, REPEAT);
    scene.edit(paper)["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": picture,
        "extensions": {"KHR_texture_transform": {"scale": [10.0, 10.0]}}});
    scene.object("board", &board(), paper);
    let case = case(&scene);
    let prepared = case.prepare();
    let tints =
        of(&prepared, "board").map(|side| prepared.patches.reflectance(SideId::from_index(side)));
    for tint in tints {
        assert!(near(tint, Vec3::splat(0.5), 0.005), "{tint}");
    }
    let (pixels, _) = on_board(&case.first_image());
    for (at, got) in pixels {
        assert!(near(got, Vec3::splat(0.5), 0.02), "{got} at {at}");
    }
}

/// The sides of a node.
fn of<'a>(prepared: &'a Prepared, node: &'a str) -> impl Iterator<Item = usize> + 'a {
    (0..prepared.patches.sides.len()).filter(move |side| run::name(prepared, *side) == node)
}

/// Black on the left and red on the right: at x the board reflects (x + 1)/2 of red, and its elements the mean of that.
#[test]
fn vertex_colours_run_evenly() {
    let mut scene = bright();
    let paper = scene.material(Vec3::ONE, Vec3::ZERO);
    let [black, red] = [Vec4::W, Vec4::new(1.0, 0.0, 0.0, 1.0)];
    let shape = Shape {
        colors: vec![black, red, red, black],
        texcoords: Vec::new(),
        ..board()
    };
    scene.object("board", &shape, paper);
    let case = case(&scene);
    let prepared = case.prepare();
    let placed = &prepared.rest;
    for side in of(&prepared, "board") {
        let element = &prepared.patches.elements[prepared.patches.sides[side].element];
        let middle = placed.element_corners(element).iter().sum::<Vec3>() / 3.0;
        let got = prepared.patches.reflectance(SideId::from_index(side));
        assert!(near(got, Vec3::X * (middle.x + 1.0) / 2.0, 1e-5), "{got}");
    }
    let (pixels, half) = on_board(&case.first_image());
    assert!(pixels.len() > 500);
    for (at, got) in pixels {
        assert!(
            near(got, Vec3::X * (at.x + 1.0) / 2.0, half),
            "{got} at {at}"
        );
    }
}

/// A picture of eight columns, of which `hole` are not there: alpha ½ lies exactly on their borders.
fn strip(hole: std::ops::Range<usize>) -> Vec<Vec<[u8; 4]>> {
    let alpha = |x: usize| if hole.contains(&x) { 0 } else { 255 };
    vec![(0..8).map(|x| [200, 100, 50, alpha(x)]).collect()]
}

/// A lit room with a screen under its lamp: with a strip cut out of its picture, or the two pieces left of it.
fn screened(cut: bool) -> Scene {
    let mut scene = scene::room();
    let paper = scene.material(Vec3::splat(0.5), Vec3::ZERO);
    scene.double_sided(paper);
    let piece = |from: f32, to: f32| {
        let at = |u: f32, z: f32| Vec3::new(2.0 * u - 1.0, 0.3, z);
        Shape {
            texcoords: [from, from, to, to].map(|u| Vec2::new(u, 0.5)).to_vec(),
            ..Shape::quad([at(from, -1.0), at(from, 1.0), at(to, 1.0), at(to, -1.0)])
        }
    };
    let picture = scene.texture(&strip(3..5), CLAMP);
    scene.edit(paper)["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": picture});
    if cut {
        scene.edit(paper)["alphaMode"] = "MASK".into();
        scene.object("screen", &piece(0.0, 1.0), paper);
    } else {
        scene.object("left", &piece(0.0, 3.0 / 8.0), paper);
        scene.object("right", &piece(5.0 / 8.0, 1.0), paper);
    }
    scene
}

/// Light falls through a hole as it falls past the edges of what is left: the room's own samples find the same.
#[test]
fn a_hole_is_as_good_as_nothing() {
    let light = |cut: bool| {
        let case = case(&screened(cut));
        let prepared = case.prepare();
        let mut light = Vec::new();
        case.walk_light(&prepared, |state, _| {
            let half = &state.view.resting;
            let sides = of(&prepared, "room");
            light = sides
                .map(|side| half.emitters.resting.direct[side])
                .collect();
        });
        light
    };
    let (cut, pieces, whole) = (light(true), light(false), {
        let mut scene = screened(true);
        let paper = 2;
        scene.edit(paper)["alphaMode"] = "OPAQUE".into();
        let case = case(&scene);
        let mut light = Vec::new();
        let prepared = case.prepare();
        case.walk_light(&prepared, |state, _| {
            let sides = of(&prepared, "room");
            light = sides
                .map(|s| state.view.resting.emitters.resting.direct[s])
                .collect();
        });
        light
    });
    assert_eq!(cut, pieces);
    assert!(cut != whole, "the hole matters");
}

/// What is left of a strip 3 of 8 wide on either side: the share of elements adds up to 6/8 of the screen, sides that
/// are wholly gone receive nothing, and origins in holes do not count.
#[test]
fn elements_are_there_as_far_as_their_picture() {
    let case = case(&screened(true));
    let prepared = case.prepare();
    let patches = &prepared.patches;
    let (mut there, mut all) = (0.0, 0.0);
    for (number, element) in patches.elements.iter().enumerate() {
        let surface = &patches.surfaces[patches.surface_of[element.triangle]];
        let node = prepared.animation.instances[surface.instance].node;
        if prepared.animation.nodes[node].name == "screen" {
            let [a, b, c] = prepared.rest.element_corners(element);
            let area = 0.5 * (b - a).cross(c - a).length();
            (there, all) = (there + area * element.share, all + area);
            let sides = patches.side_of[number];
            assert_eq!(element.share == 0.0, sides == [None; 2]);
        }
    }
    assert!(
        (all - 4.0f32).abs() < 1e-4 && (there - 3.0).abs() < 0.02,
        "{there} of {all}"
    );
    case.walk_light(&prepared, |state, _| {
        let sides: Vec<usize> = of(&prepared, "screen").collect();
        let open = |side: &usize| {
            ORIGINS as u32 - state.view.resting.hemisphere.invalid_origins[*side].count_ones()
        };
        let share: u32 = sides.iter().map(open).sum();
        // Origins are even over an element, so as many are open as of it is there: within a tenth for 16 of each.
        let expected = sides.iter().map(|side| {
            let element = &patches.elements[patches.sides[*side].element];
            ORIGINS as f32 * element.share
        });
        let expected: f32 = expected.sum();
        assert!(
            (share as f32 / expected - 1.0).abs() < 0.1,
            "{share}, expected {expected}"
        );
    });
}

/// Through the hole the camera sees what is behind, and nothing of the board's own colour.
#[test]
fn a_hole_is_seen_through() {
    let mut scene = bright();
    let paper = scene.material(Vec3::splat(0.5), Vec3::ZERO);
    let picture = scene.texture(&strip(3..5), CLAMP);
    scene.edit(paper)["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": picture});
    scene.edit(paper)["alphaMode"] = "MASK".into();
    scene.object("board", &board(), paper);
    let (pixels, half) = on_board(&case(&scene).first_image());
    for (at, got) in pixels {
        // Behind is the black wall that shines with radiance 1; sRGB 200, 100, 50 is light 0.578, 0.127, 0.0319.
        let paper = 0.5 * Vec3::new(0.577_580, 0.127_438, 0.031_896);
        let expected = if at.x.abs() < 0.25 { Vec3::ONE } else { paper };
        if (at.x.abs() - 0.25).abs() > half {
            assert!(near(got, expected, 0.002), "{got} at {at}");
        }
    }
}

/// A leaf with random holes that flies through the room, before a curtain with holes: nothing may differ from a trace
/// from nothing.
#[test]
fn movers_with_holes_are_exact() {
    let mut scene = scene::room();
    let hash = |x: usize, y: usize| (x * 2_654_435_761 + y * 40_503) >> 7;
    let row = |y: usize| {
        (0..12).map(move |x| [180, (hash(y, x) % 256) as u8, 60, (hash(x, y) % 256) as u8])
    };
    let rows: Vec<Vec<[u8; 4]>> = (0..12).map(|y| row(y).collect()).collect();
    let picture = scene.texture(&rows, REPEAT);
    let leaf = scene.material(Vec3::splat(0.9), Vec3::ZERO);
    scene.double_sided(leaf);
    scene.edit(leaf)["alphaMode"] = "BLEND".into();
    scene.edit(leaf)["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": picture});
    let curtain = Shape {
        colors: [1.0, 0.6, 0.9, 0.7]
            .map(|a| Vec4::new(0.9, a, 0.5, a))
            .to_vec(),
        ..board()
    };
    scene.object(
        "curtain",
        &curtain.clone().at(Vec3::new(-0.5, 0.2, -1.2)),
        leaf,
    );
    let flying = scene.object("leaf", &curtain, leaf);
    let at = |x: f32| Vec3::new(x, 0.1, 0.3 * x);
    scene.slide(flying, "LINEAR", &[(0.0, at(-1.5)), (1.0, at(1.5))]);
    let turned = scene::about_y(120.0);
    scene.turn(
        flying,
        "LINEAR",
        &[(0.0, glam::Quat::IDENTITY), (1.0, turned)],
    );
    let verified = case(&scene).exact();
    assert!(verified.changed > 0);
}

/// What is unlit shows its own colours, has no side in the solve, and still blocks light; alone it lights nothing.
#[test]
fn the_unlit_are_seen_as_they_are() {
    let mut scene = bright();
    let sign = scene.material(Vec3::new(0.8, 0.4, 0.2), Vec3::splat(7.0));
    scene.edit(sign)["extensions"] = json!({"KHR_materials_unlit": {}});
    let picture = scene.texture(&[vec![[188, 255, 255, 255]]], REPEAT);
    scene.edit(sign)["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": picture});
    scene.object("board", &board(), sign);
    let lit = case(&scene);
    let prepared = lit.prepare();
    assert_eq!(of(&prepared, "board").count(), 0);
    let (pixels, _) = on_board(&lit.first_image());
    for (at, got) in pixels {
        let expected = Vec3::new(0.8 * 0.502_886, 0.4, 0.2);
        assert!(near(got, expected, 2e-5), "{got} at {at}");
    }
    // With the room's light put out the board is as bright as before, and the room is black.
    let sky = 0;
    scene.edit(sky)["emissiveFactor"] = json!([0, 0, 0]);
    let (pixels, _) = on_board(&case(&scene).first_image());
    assert!(
        pixels
            .iter()
            .all(|(_, got)| near(*got, Vec3::new(0.402_309, 0.4, 0.2), 2e-5))
    );
    let all = case(&scene).first_image().radiance;
    assert_eq!(all[0], [0.0; 3], "the room's wall");
}

/// A lit room whose lamp shines on one half: by a picture, by alpha, or since it is but half as wide.
fn half_lamp(how: &str) -> Scene {
    let mut scene = Scene::default();
    let walls = scene.material(Vec3::new(0.7, 0.6, 0.5), Vec3::ZERO);
    let shell = Shape::solid(Vec3::new(2.0, 1.5, 2.0)).inside_out();
    scene.object("room", &shell, walls);
    let lamp = scene.material(Vec3::ZERO, Vec3::new(9.0, 8.0, 6.0));
    let most = if how == "narrow" { 0.5 } else { 1.0 };
    let at = |u: f32, z: f32| Vec3::new(2.0 * u - 1.0, 1.2, z);
    let texcoords = [0.0, most, most, 0.0].map(|u| Vec2::new(u, 0.5)).to_vec();
    let panel = Shape {
        texcoords,
        ..Shape::quad([at(0.0, -0.5), at(most, -0.5), at(most, 0.5), at(0.0, 0.5)])
    };
    let pixel = |x: usize| match (how, x < 32) {
        (_, true) => WHITE,
        ("picture", false) => BLACK,
        _ => [255, 255, 255, 0],
    };
    let picture = scene.texture(&[(0..64).map(pixel).collect()], CLAMP);
    if how == "picture" {
        scene.edit(lamp)["emissiveTexture"] = json!({"index": picture});
    } else {
        scene.edit(lamp)["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": picture});
        scene.edit(lamp)["alphaMode"] = "MASK".into();
    }
    scene.object("lamp", &panel, lamp);
    scene.camera(Vec3::new(0.0, -1.4, 1.9), Vec3::new(0.0, 1.2, 0.0), 70.0);
    scene
}

/// A lamp of which a picture lights one half, or leaves one half, lights a room as one of half the size does.
#[test]
fn a_lamp_lit_by_half_is_half_a_lamp() {
    let direct = |how: &str| {
        let mut case = case(&half_lamp(how));
        case.settings.solve.element_size = Some(0.3);
        (case.settings.solve.samples, case.settings.image.size) = (Some(16), (8, 5));
        let prepared = case.prepare();
        let emission: Vec3 = prepared
            .patches
            .side_ids()
            .map(|side| {
                let element = prepared.patches.sides[side].element;
                let area = prepared.rest.area(&prepared.patches.elements[element]);
                prepared.patches.emission(side) * area
            })
            .sum();
        let mut light = Vec::new();
        case.walk_light(&prepared, |state, _| {
            let sides = of(&prepared, "room");
            light = sides
                .map(|s| state.view.resting.emitters.resting.direct[s])
                .collect();
        });
        (emission, light)
    };
    let (expected, narrow) = direct("narrow");
    // π L × 1 m × 1 m.
    assert!(
        near(expected / PI, Vec3::new(9.0, 8.0, 6.0), 1e-4),
        "{expected}"
    );
    for how in ["picture", "alpha"] {
        let (emission, light) = direct(how);
        assert!(near(emission / expected, Vec3::ONE, 0.005), "{emission}");
        assert!(light.len() == narrow.len() && light.len() > 500);
        for (got, expected) in light.iter().zip(&narrow) {
            assert!(
                near(*got, *expected, 0.02 * expected.max_element() + 1e-3),
                "{got} {expected}"
            );
        }
    }
}

/// Seen directly, a lamp shows its picture: L on the bright half, nothing on the dark one, with a border of a pixel.
#[test]
fn a_lamp_shows_its_picture() {
    let mut scene = Scene::default();
    let lamp = scene.material(Vec3::ZERO, Vec3::new(9.0, 8.0, 6.0));
    let picture = scene.texture(&[(0..64).map(|x| [BLACK, WHITE][x / 32]).collect()], CLAMP);
    scene.edit(lamp)["emissiveTexture"] = json!({"index": picture});
    scene.object("board", &board(), lamp);
    scene.camera(
        Vec3::Z * 1.5,
        Vec3::ZERO,
        2.0 * (SEEN / 1.5).atan().to_degrees(),
    );
    let (pixels, half) = on_board(&case(&scene).first_image());
    assert!(pixels.len() > 500);
    for (at, got) in pixels
        .into_iter()
        .filter(|(at, _)| at.x.abs() > 2.0 / 64.0 + half)
    {
        let expected = if at.x > 0.0 {
            Vec3::new(9.0, 8.0, 6.0)
        } else {
            Vec3::ZERO
        };
        assert!(near(got, expected, 1e-4), "{got} at {at}");
    }
}

/// A lamp with a picture and with holes that flies: nothing may differ from a trace from nothing.
#[test]
fn a_flying_picture_lamp_is_exact() {
    let mut scene = half_lamp("picture");
    let lamp = 1;
    scene.double_sided(lamp);
    let picture = scene.texture(&strip(2..5), REPEAT);
    scene.edit(lamp)["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": picture});
    scene.edit(lamp)["alphaMode"] = "MASK".into();
    let flying = 1;
    let at = |x: f32| Vec3::new(x, -0.6, 0.2);
    scene.slide(flying, "LINEAR", &[(0.0, at(-0.7)), (1.0, at(0.7))]);
    let resting = scene.material(Vec3::splat(0.4), Vec3::splat(3.0));
    scene.edit(resting)["emissiveTexture"] = json!({"index": picture});
    scene.object("board", &board().at(Vec3::Z * -1.5), resting);
    let verified = case(&scene).exact();
    assert!(verified.changed > 0);
}

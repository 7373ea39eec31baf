//! Solved light to take along, through the binary: what is written is read back, and agrees with the session's own light.

use crate::support::program::{done, moving, refused, stdout, sweeplight};
use crate::support::run::{Case, case};
use glam::{Affine3A, Quat, Vec3};
use serde_json::Value;
use std::fs;
use sweeplight::scene::Animation;
use sweeplight::sequence::{edit, silence};

fn export(case: &Case, args: &[&str]) -> std::process::Output {
    let mut all = vec![
        "export",
        "scene.gltf",
        "--samples",
        "64",
        "--element-size",
        "0.5",
    ];
    all.extend(["--fps", "8"]);
    all.extend(args);
    sweeplight(case.folder.path(), &all)
}

#[test]
fn a_lit_scene_is_read_as_unlit_with_colours() {
    let case = case(&moving());
    let output = export(
        &case,
        &["-o", "solved.glb", "--frames", "4", "--exposure", "-1"],
    );
    done(&output);
    assert!(stdout(&output).contains("frame 4"), "{}", stdout(&output));
    let path = case.folder.path().join("solved.glb");
    let bytes = fs::read(&path).expect("a file");
    let text = String::from_utf8_lossy(&bytes);
    for word in [
        "KHR_materials_unlit",
        "\"exposure_stops\":-1",
        "\"radiance_of_white\":2.0",
        "\"frame\":4",
    ] {
        assert!(text.contains(word), "{word}");
    }
    let solved = Animation::open(&path).expect("a scene");
    assert!(
        solved
            .materials
            .iter()
            .take(3)
            .all(|material| material.unlit)
    );
    assert!(
        solved
            .meshes
            .iter()
            .all(|mesh| mesh.colors.len() == mesh.positions.len())
    );
    assert!(
        solved
            .meshes
            .iter()
            .flat_map(|mesh| &mesh.colors)
            .any(|c| c.x > 0.05 && c.x < 0.95)
    );
    assert_eq!(solved.cameras.len(), 1);
}

#[test]
fn a_table_has_the_light_of_the_session_with_units() {
    let case = case(&moving());
    done(&export(
        &case,
        &["--radiosity", "light.csv", "--frames", "0,3"],
    ));
    let text = fs::read_to_string(case.folder.path().join("light.csv")).expect("text");
    let head = text.lines().next().expect("a line of names");
    assert!(
        head.contains("area[m^2]") && head.contains("irradiance_b[W/m^2]"),
        "{head}"
    );
    let (session, _) = edit::open(&case.settings, true, &silence).expect("a session");
    let light = session.irradiance_of_sides();
    assert_eq!(text.lines().count(), 1 + 2 * light.len());
    for (row, light) in text.lines().skip(1).zip(&light) {
        let fields: Vec<&str> = row.split(',').collect();
        let number = |at: usize| fields[at].parse::<f32>().expect("a number");
        // The last nine: emission, radiosity, irradiance; before them area and reflectance.
        let first = fields.len() - 9;
        assert!(
            (number(first + 6) - light.x).abs() <= 0.02 * light.x + 1e-3,
            "{row}: {light}"
        );
        let expected = number(first) + number(first - 3) * number(first + 6);
        assert!(
            (number(first + 3) - expected).abs() <= 0.01 * expected + 1e-3,
            "{row}"
        );
    }
}

#[test]
fn an_archive_is_one_and_no_input_is_written_over() {
    let case = case(&moving());
    done(&export(
        &case,
        &["--radiosity", "light.npz", "--frames", "0"],
    ));
    let bytes = fs::read(case.folder.path().join("light.npz")).expect("a file");
    assert!(bytes.starts_with(b"PK\x03\x04") && bytes.windows(14).any(|w| w == b"irradiance.npy"));
    fs::copy(
        case.folder.path().join("scene.gltf"),
        case.folder.path().join("scene.glb"),
    )
    .expect("a copy");
    for (args, words) in [
        (&["-o", "x.gltf"][..], &["-o", ".glb"][..]),
        (&["--radiosity", "x.txt"], &["--radiosity", ".npz"]),
        (&[], &["export", "-o"]),
    ] {
        refused(&export(&case, args), 2, words);
    }
    let over = [
        "export",
        "scene.glb",
        "-o",
        "scene.glb",
        "--samples",
        "64",
        "--element-size",
        "1",
    ];
    refused(
        &sweeplight(case.folder.path(), &over),
        2,
        &["-o", "scene.glb"],
    );
}

/// A .glb file taken apart.
struct Parts {
    json: Value,
    binary: Vec<u8>,
}

impl Parts {
    fn of(case: &Case, name: &str) -> Parts {
        let bytes = fs::read(case.folder.path().join(name)).expect("a file");
        let length = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("4 bytes"));
        let json = length(12) as usize;
        Parts {
            json: serde_json::from_slice(&bytes[20..20 + json]).expect("JSON"),
            binary: bytes[28 + json..].to_vec(),
        }
    }

    /// The numbers of an accessor, normalized where they are.
    fn numbers(&self, accessor: &Value) -> Vec<f32> {
        let accessor = &self.json["accessors"][accessor.as_u64().expect("a number") as usize];
        let view =
            &self.json["bufferViews"][accessor["bufferView"].as_u64().expect("a view") as usize];
        let at = |name: &str| view[name].as_u64().expect("a number") as usize;
        let bytes = &self.binary[at("byteOffset")..at("byteOffset") + at("byteLength")];
        let pairs = || bytes.chunks_exact(2).map(|pair| [pair[0], pair[1]]);
        match accessor["componentType"].as_u64() {
            Some(5122) => pairs()
                .map(|p| f32::from(i16::from_le_bytes(p)) / 32_767.0)
                .collect(),
            Some(5123) => pairs()
                .map(|p| f32::from(u16::from_le_bytes(p)) / 65_535.0)
                .collect(),
            _ => {
                let fours = bytes
                    .chunks_exact(4)
                    .map(|c| c.try_into().expect("4 bytes"));
                fours.map(f32::from_le_bytes).collect()
            }
        }
    }

    /// The node and the mesh of a name.
    fn object(&self, name: &str) -> (usize, &Value) {
        let nodes = self.json["nodes"].as_array().expect("nodes");
        let node = nodes
            .iter()
            .position(|node| node["name"] == name)
            .expect("a node");
        let mesh = nodes[node]["mesh"].as_u64().expect("a mesh") as usize;
        (node, &self.json["meshes"][mesh]["primitives"][0])
    }

    /// Values of a channel at a time between its keys.
    fn at(&self, node: usize, path: &str, seconds: f32) -> Option<Vec<f32>> {
        let animation = &self.json["animations"][0];
        let mut channels = animation["channels"].as_array().expect("channels").iter();
        let channel =
            channels.find(|c| c["target"]["node"] == node && c["target"]["path"] == path)?;
        let sampler = &animation["samplers"][channel["sampler"].as_u64()? as usize];
        let [times, values] = ["input", "output"].map(|end| self.numbers(&sampler[end]));
        let width = values.len() / times.len();
        let next = times
            .iter()
            .position(|time| *time >= seconds)
            .unwrap_or(times.len() - 1);
        let last = next.saturating_sub(1);
        let step = times[next] - times[last];
        let part = if step > 0.0 {
            (seconds - times[last]) / step
        } else {
            1.0
        };
        let at = |key: usize, k: usize| values[key * width + k];
        Some(
            (0..width)
                .map(|k| at(last, k) + (at(next, k) - at(last, k)) * part)
                .collect(),
        )
    }
}

/// As a screen shows linear light.
fn shown(light: f32) -> f32 {
    match light.max(0.0) {
        light if light <= 0.003_130_8 => 12.92 * light,
        light => 1.055 * light.powf(1.0 / 2.4) - 0.055,
    }
}

/// Between its key frames an animated file has the colours of a file of that frame alone, and its objects stand as there.
#[test]
fn an_animated_scene_shows_the_light_of_each_frame() {
    let case = case(&moving());
    let frames = "0-8";
    let args = [
        "-o",
        "all.glb",
        "--animated",
        "--tolerance",
        "0.004",
        "--frames",
        frames,
        "--exposure",
        "-2",
    ];
    let output = export(&case, &args);
    done(&output);
    assert!(
        stdout(&output).contains("key frames"),
        "{}",
        stdout(&output)
    );
    let all = Parts::of(&case, "all.glb");
    let mut targets = 0;
    for frame in [0u8, 3, 5, 8] {
        let name = format!("{frame}.glb");
        let number = frame.to_string();
        done(&export(
            &case,
            &["-o", &name, "--frames", &number, "--exposure", "-2"],
        ));
        let one = Parts::of(&case, &name);
        let seconds = f32::from(frame) / 8.0;
        for node in all.json["nodes"].as_array().expect("nodes") {
            let Some(name) = node["name"].as_str().filter(|_| node["mesh"].is_u64()) else {
                continue;
            };
            let (number, primitive) = all.object(name);
            let mut colors = all.numbers(&primitive["attributes"]["COLOR_0"]);
            let mut places = all.numbers(&primitive["attributes"]["POSITION"]);
            let weights = all.at(number, "weights", seconds).unwrap_or_default();
            for (weight, target) in weights
                .iter()
                .zip(primitive["targets"].as_array().into_iter().flatten())
            {
                targets += 1;
                let more = all.numbers(&target["COLOR_0"]);
                colors
                    .iter_mut()
                    .zip(more)
                    .for_each(|(color, more)| *color += weight * more);
                let changes = &all.json["accessors"]
                    [target["POSITION"].as_u64().expect("a target of positions") as usize];
                if changes["bufferView"].is_u64() {
                    let more = all.numbers(&target["POSITION"]);
                    places
                        .iter_mut()
                        .zip(more)
                        .for_each(|(place, more)| *place += weight * more);
                }
            }
            let rest = |path: &str| {
                node[path].as_array().map(|all| {
                    all.iter()
                        .map(|v| v.as_f64().expect("a number") as f32)
                        .collect::<Vec<f32>>()
                })
            };
            let part = |path: &str| {
                all.at(number, path, seconds)
                    .or_else(|| rest(path))
                    .expect("a transform")
            };
            let carrier = Affine3A::from_scale_rotation_translation(
                Vec3::from_slice(&part("scale")),
                Quat::from_slice(&part("rotation")).normalize(),
                Vec3::from_slice(&part("translation")),
            );
            let (_, still) = one.object(name);
            let (of, at) = (
                one.numbers(&still["attributes"]["COLOR_0"]),
                one.numbers(&still["attributes"]["POSITION"]),
            );
            for (color, place) in colors.chunks(4).zip(places.chunks(3)) {
                let place = carrier.transform_point3(Vec3::from_slice(place));
                let near = at
                    .chunks(3)
                    .zip(of.chunks(4))
                    .filter(|(p, _)| Vec3::from_slice(p).distance(place) < 2e-3);
                let off = near.map(|(_, other)| {
                    let channels = (0..3).map(|k| (shown(color[k]) - shown(other[k])).abs());
                    channels.fold(0.0, f32::max)
                });
                let off = off.fold(f32::INFINITY, f32::min);
                assert!(off < 0.006, "{name}, frame {frame}: {off} at {place}");
            }
        }
    }
    assert!(targets > 0);
    for (args, words) in [
        (
            &["-o", "all.glb", "--animated", "--frames", "3,1"][..],
            ["--frames", "order of time"],
        ),
        (
            &["--radiosity", "light.csv", "--animated"],
            ["--animated", "-o solved.glb"],
        ),
        (
            &["-o", "all.glb", "--animated", "--tolerance", "2"],
            ["--tolerance", "from 0.0001 to 1"],
        ),
    ] {
        refused(&export(&case, args), 2, &words);
    }
}

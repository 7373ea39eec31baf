//! A lit scene that moves: objects are carried as in their file, and their light by morph targets of colours.
//!
//! glTF 2.0 specification, Khronos Group 2021, sections 3.7.2.2 "Morph Targets" and 3.11 "Animations". Each object has a target
//! for every key frame but its first; the weight of one rises from 0 at the key before to 1 at its own and falls to 0 at the
//! next, so that colours between keys are interpolated. Key frames are an object's own (`key_frames.rs`): what light hardly
//! changes on has one. What deforms has its positions in the same targets.

use super::key_frames::{self, chosen};
use super::recording::{Recorded, Recording};
use super::{Document, LitFile, Told};
use crate::error::Result;
use crate::image::srgb;
use crate::session::Session;
use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::path::Path;

/// Positions of what deforms may be off by this share of the colours' tolerance, of the object's size.
const SHAPE: f32 = 0.1;

/// Errors of colours are those of the screen: 16 bits of linear light as an sRGB display shows them.
struct Screen(Vec<f32>);

impl Screen {
    fn new() -> Screen {
        let shown = |light: u16| srgb::signal(f32::from(light) / 65_535.0);
        Screen((0..=u16::MAX).map(shown).collect())
    }

    fn of(&self, light: f32) -> f32 {
        self.0[(light.clamp(0.0, 65_535.0)) as usize]
    }
}

/// What an object's animation came to.
#[derive(Default)]
struct Size {
    vertices: usize,
    clipped: usize,
    keys: usize,
    error: f32,
}

/// All of a recording as a file; `tolerance` is how far colours may be off, as a share of white on the screen.
pub(in crate::export) fn animated(
    session: &Session,
    recording: &Recording,
    (told, tolerance): (Told, f32),
    path: &Path,
) -> Result<LitFile> {
    let (mut document, screen) = (Document::default(), Screen::new());
    let times = document.binary.times(&recording.times);
    let mut moving = Moving {
        times,
        samplers: Vec::new(),
        channels: Vec::new(),
    };
    let mut size = Size::default();
    for recorded in &recording.objects {
        if recorded.corners.is_empty() {
            continue;
        }
        let (keys, error) = keys_of(recorded, &screen, tolerance);
        let node = document.nodes.len();
        let (vertices, clipped) = document.recorded(session, recorded, &keys, path)?;
        size.vertices += vertices;
        size.clipped += clipped;
        size.keys = size.keys.max(keys.len());
        size.error = size.error.max(error);
        if keys.len() > 1 {
            let input: Vec<f32> = keys.iter().map(|key| recording.times[*key]).collect();
            let weights = hats(keys.len());
            let (input, output) = (
                document.binary.times(&input),
                document.binary.scalars(&weights),
            );
            moving.channel((node, "weights"), (input, output), "LINEAR");
        }
        moving.carry(&mut document, node, &recorded.places);
    }
    let camera = document.camera(session, told)?;
    let node = document.nodes.len() - 1;
    let views = recording.views.iter().map(|view| {
        let axes = DMat3::from_cols(
            view.right.as_dvec3(),
            view.up.as_dvec3(),
            -view.forward.as_dvec3(),
        );
        Some(DAffine3::from_mat3_translation(axes, view.eye.as_dvec3()))
    });
    let views: Vec<Option<DAffine3>> = views.collect();
    if let Some(Value::Object(node)) = document.nodes.last_mut() {
        node.remove("matrix");
    }
    moving.carry(&mut document, node, &views);
    let extras = json!({ "sweeplight": {
        "exposure_stops": told.stops, "radiance_of_white": (-told.stops).exp2(), "frame": told.frame,
        "time_s": session.seconds(), "vertices": size.vertices, "clipped_vertices": size.clipped,
        "frames": recording.times.len(), "key_frames": size.keys, "error": size.error,
    }});
    if !moving.channels.is_empty() {
        document.animations = vec![json!({
            "name": "light", "samplers": moving.samplers, "channels": moving.channels,
        })];
    }
    Ok(LitFile {
        bytes: document.finish(camera, extras, session.scene.animation.origin),
        vertices: size.vertices,
        clipped: size.clipped,
        keys: Some((size.keys, size.error)),
    })
}

/// The key frames of an object, and the largest error between them.
fn keys_of(recorded: &Recorded, screen: &Screen, tolerance: f32) -> (Vec<usize>, f32) {
    let extent = recorded.corners.iter().fold(0.0f32, |extent, p| {
        extent.max(p.distance(recorded.corners[0]))
    });
    let shape = tolerance / (SHAPE * tolerance * extent).max(f32::MIN_POSITIVE);
    let error = |frame: usize, keys: [usize; 2]| {
        // What is hidden may have any colour.
        if recorded.places[frame].is_none() {
            return 0.0;
        }
        let part = key_frames::share(frame, keys);
        let [from, to] = keys.map(|key| recorded.colors_at(key));
        let mut most = 0.0f32;
        for ((now, from), to) in recorded.colors[frame].iter().zip(from).zip(to) {
            for channel in 0..3 {
                let [from, to] = [from, to].map(|color| f32::from(color[channel]));
                let between = from + (to - from) * part;
                most = most.max((screen.of(between) - screen.of(f32::from(now[channel]))).abs());
            }
        }
        if let Some(deformed) = &recorded.deformed {
            let [from, to] = keys.map(|key| recorded.deformed_at(deformed, key));
            for ((now, from), to) in deformed[frame].iter().zip(from).zip(to) {
                most = most.max(now.distance(from.lerp(*to, part)) * shape);
            }
        }
        most
    };
    chosen(recorded.places.len(), tolerance, error)
}

/// The weights of the targets at each of so many keys, key by key.
fn hats(keys: usize) -> Vec<f32> {
    let at = |key: usize| (1..keys).map(move |target| if target == key { 1.0 } else { 0.0 });
    (0..keys).flat_map(at).collect()
}

impl Recorded {
    /// The frame nearest to a key in which the object is seen.
    fn seen_near(&self, key: usize) -> usize {
        let seen = (0..self.places.len()).filter(|frame| self.places[*frame].is_some());
        seen.min_by_key(|frame| frame.abs_diff(key)).unwrap_or(key)
    }

    fn colors_at(&self, key: usize) -> &[[u16; 3]] {
        &self.colors[self.seen_near(key)]
    }

    fn deformed_at<'a>(&self, deformed: &'a [Vec<Vec3>], key: usize) -> &'a [Vec3] {
        &deformed[self.seen_near(key)]
    }

    /// Positions at each key, if it deforms.
    fn shapes_at(&self, keys: &[usize]) -> Vec<&[Vec3]> {
        let Some(deformed) = &self.deformed else {
            return Vec::new();
        };
        keys.iter()
            .map(|key| self.deformed_at(deformed, *key))
            .collect()
    }
}

impl Document {
    /// Adds an object with its targets, and gives the number of its vertices, and of those that were clipped.
    fn recorded(
        &mut self,
        session: &Session,
        recorded: &Recorded,
        keys: &[usize],
        path: &Path,
    ) -> Result<(usize, usize)> {
        let colors: Vec<&[[u16; 3]]> = keys.iter().map(|key| recorded.colors_at(*key)).collect();
        let shapes = recorded.shapes_at(keys);
        let vertices = Vertices::of(recorded, &colors, &shapes);
        let material = self.material(session, (recorded.object.material, recorded.glows), path)?;
        let base = vertices.pick(colors[0]);
        let rest = vertices.pick(shapes.first().copied().unwrap_or(&recorded.corners));
        let mut attributes = json!({
            "POSITION": self.binary.positions(&rest),
            "COLOR_0": self.binary.colors(&base),
        });
        if recorded.has_texture(session) {
            let texcoords = vertices.pick(&recorded.texcoords);
            attributes["TEXCOORD_0"] = self.binary.texcoords(&texcoords).into();
        }
        // Viewers look for targets of colours only where there are such of positions.
        let still = keys.len() > 1 && shapes.is_empty();
        let still = still.then(|| self.binary.no_changes(rest.len()));
        let mut targets = Vec::new();
        for key in 1..keys.len() {
            let moved = shapes.get(key).map(|shape| {
                let moved = vertices.pick(shape).into_iter().zip(&rest);
                let moved: Vec<Vec3> = moved.map(|(to, from)| to - from).collect();
                self.binary.positions(&moved)
            });
            let colors = vertices.pick(colors[key]);
            targets.push(json!({
                "POSITION": moved.or(still),
                "COLOR_0": self.binary.color_changes(&base, &colors),
            }));
        }
        let indices = self.binary.indices(&vertices.indices);
        let mut primitive =
            json!({ "attributes": attributes, "indices": indices, "material": material });
        let name = &session.scene.animation.nodes[recorded.object.node].name;
        let mut mesh = json!({ "name": name });
        if !targets.is_empty() {
            mesh["weights"] = vec![0.0; targets.len()].into();
            primitive["targets"] = targets.into();
        }
        mesh["primitives"] = json!([primitive]);
        self.nodes
            .push(json!({ "name": name, "mesh": self.meshes.len() }));
        self.meshes.push(mesh);
        let clipped = vertices.pick(&recorded.clipped);
        Ok((
            rest.len(),
            clipped.iter().filter(|clipped| **clipped).count(),
        ))
    }
}

/// Corners that stand, look and change alike are one vertex.
struct Vertices {
    /// A corner of each vertex.
    corner: Vec<usize>,
    /// The vertex of each corner.
    indices: Vec<u32>,
}

impl Vertices {
    fn of(recorded: &Recorded, colors: &[&[[u16; 3]]], shapes: &[&[Vec3]]) -> Vertices {
        let mut known: HashMap<Vec<u32>, u32> = HashMap::new();
        let (mut first, mut indices) = (Vec::new(), Vec::new());
        for corner in 0..recorded.corners.len() {
            let mut bits: Vec<u32> = recorded.corners[corner].to_array().map(f32::to_bits).into();
            bits.extend(recorded.texcoords[corner].to_array().map(f32::to_bits));
            bits.extend(
                colors
                    .iter()
                    .flat_map(|colors| colors[corner].map(u32::from)),
            );
            let places = shapes.iter().map(|shape| shape[corner].to_array());
            bits.extend(places.flat_map(|place| place.map(f32::to_bits)));
            let index = *known.entry(bits).or_insert_with(|| {
                first.push(corner);
                first.len() as u32 - 1
            });
            indices.push(index);
        }
        Vertices {
            corner: first,
            indices,
        }
    }

    /// What vertices have of something that corners have.
    fn pick<T: Copy>(&self, of_corners: &[T]) -> Vec<T> {
        self.corner
            .iter()
            .map(|corner| of_corners[*corner])
            .collect()
    }
}

impl Recorded {
    /// Whether a texture multiplies its colours.
    fn has_texture(&self, session: &Session) -> bool {
        let material = &session.scene.animation.materials[self.object.material];
        material.base_map.is_some() && !self.glows
    }
}

/// The animation as it grows.
struct Moving {
    /// The accessor of the times of all frames.
    times: usize,
    samplers: Vec<Value>,
    channels: Vec<Value>,
}

impl Moving {
    fn channel(&mut self, (node, path): (usize, &str), ends: (usize, usize), interpolation: &str) {
        let sampler = self.samplers.len();
        self.samplers.push(json!({
            "input": ends.0, "output": ends.1, "interpolation": interpolation,
        }));
        self.channels
            .push(json!({ "sampler": sampler, "target": { "node": node, "path": path } }));
    }

    /// Puts a node where it is in the first frame, and moves it on; where it is hidden it has no size.
    fn carry(&mut self, document: &mut Document, node: usize, places: &[Option<DAffine3>]) {
        let parts = parts(places);
        let translations = parts.iter().map(|part| part.2.as_vec3().to_array());
        let rotations = parts.iter().map(|part| part.1.as_quat().to_array());
        let scales = parts.iter().map(|part| part.0.as_vec3().to_array());
        // What comes and goes does so at once.
        let comes = if places.contains(&None) {
            "STEP"
        } else {
            "LINEAR"
        };
        self.track(document, (node, "translation"), translations, "LINEAR");
        self.track(document, (node, "rotation"), rotations, "LINEAR");
        self.track(document, (node, "scale"), scales, comes);
    }

    /// Sets a node's value in the first frame, and adds a channel where it changes.
    fn track<const N: usize>(
        &mut self,
        document: &mut Document,
        (node, path): (usize, &str),
        values: impl Iterator<Item = [f32; N]>,
        interpolation: &str,
    ) {
        let values: Vec<[f32; N]> = values.collect();
        let Some(first) = values.first() else {
            return;
        };
        document.nodes[node][path] = first.to_vec().into();
        if values.iter().any(|value| value != first) {
            let output = document.binary.vectors(values.as_flattened(), N);
            self.channel((node, path), (self.times, output), interpolation);
        }
    }
}

/// Scale, rotation and translation in each frame; rotations go the shorter way round, and what is hidden stays where it was,
/// without a size.
fn parts(places: &[Option<DAffine3>]) -> Vec<(DVec3, DQuat, DVec3)> {
    let Some(known) = places.iter().flatten().next() else {
        return Vec::new();
    };
    let mut last = known.to_scale_rotation_translation();
    let parts = places.iter().map(|place| {
        let Some(place) = place else {
            return (DVec3::ZERO, last.1, last.2);
        };
        let (scale, rotation, translation) = place.to_scale_rotation_translation();
        let turned = rotation.dot(last.1) < 0.0;
        last = (
            scale,
            if turned { -rotation } else { rotation },
            translation,
        );
        last
    });
    parts.collect()
}

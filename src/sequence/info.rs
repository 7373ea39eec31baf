//! What is in a scene, what is made of it and how it would be cut, without rendering anything.

use super::effort::Effort;
use super::observer;
use super::opening::{self, Opened};
use crate::error::Result;
use crate::ids::NodeId;
use crate::mesh::RadiosityMesh;
use crate::report::table::grouped;
use crate::scene::light::Lamp;
use crate::scene::pose::Presence;
use crate::scene::{Animation, Lens};
use crate::settings::Settings;
use glam::Vec3;
use serde::Serialize;
use std::fmt::Write;

/// A scene in names and numbers.
#[derive(Clone, Debug, Serialize)]
pub struct Info {
    /// The file.
    pub file: String,
    /// The file's scenes by name.
    pub scenes: Vec<String>,
    /// The one that is looked into: a position in `scenes`.
    pub scene: usize,
    /// Nodes in the scene.
    pub nodes: usize,
    /// Triangles in the scene that are ever seen.
    pub triangles: usize,
    /// Materials of the file.
    pub materials: usize,
    /// Width, height and depth in metres at time 0.
    pub size: [f32; 3],
    /// Cameras on nodes, in the order of `--camera`.
    pub cameras: Vec<CameraInfo>,
    /// Animations, in the order of `--animation`.
    pub animations: Vec<ClipInfo>,
    /// Nodes with triangles that the playing animation moves, or shows and hides.
    pub movers: Vec<String>,
    /// Materials that emit, with their radiance at rest.
    pub emitters: Vec<(String, [f32; 3])>,
    /// Lights on nodes of the scene.
    pub lights: Vec<LightInfo>,
    /// Frames that would be rendered.
    pub frames: usize,
    /// Longest edge of an element in metres.
    pub element_size: f32,
    /// Elements the scene would be cut into.
    pub elements: usize,
    /// Samples of the light of a frame.
    pub samples: u64,
    /// Bytes that rendering takes at most, about, with the settings of `info` and all others as they are by default.
    pub memory_bytes: u64,
    /// Seconds of the preparation and of the first picture, about, on this machine.
    pub seconds: [f64; 2],
    /// Extensions that the file uses.
    pub extensions: Vec<ExtensionInfo>,
    /// What will be rendered in a simpler way than the file asks.
    pub warnings: Vec<String>,
}

/// A camera.
#[derive(Clone, Debug, Serialize)]
pub struct CameraInfo {
    /// Its name.
    pub name: String,
    /// `perspective` or `orthographic`.
    pub kind: &'static str,
    /// Whether the playing animation moves it or changes its lens.
    pub animated: bool,
}

/// An animation of the file.
#[derive(Clone, Debug, Serialize)]
pub struct ClipInfo {
    /// Its name.
    pub name: String,
    /// Time of its last key.
    pub seconds: f64,
    /// Properties of the scene that it changes.
    pub channels: usize,
    /// Whether it plays.
    pub plays: bool,
}

/// An extension.
#[derive(Clone, Debug, Serialize)]
pub struct ExtensionInfo {
    /// Its name.
    pub name: String,
    /// What is made of it: `read`, `read as …` or `left out: …`.
    pub handled: String,
}

/// A light on a node, as the file gives it.
#[derive(Clone, Debug, Serialize)]
pub struct LightInfo {
    /// The light's name.
    pub name: String,
    /// The node that carries it.
    pub node: String,
    /// point, spot or directional.
    pub kind: String,
    /// Linear RGB.
    pub color: [f32; 3],
    /// Candela, or lux of a direction, at rest.
    pub intensity: f64,
    /// Whether the playing animation moves its node.
    pub moves: bool,
    /// Whether the playing animation changes what it sends out.
    pub changes: bool,
}

impl LightInfo {
    /// Every light that a node of the scene carries.
    fn of(animation: &Animation) -> Vec<LightInfo> {
        let moves = animation.nodes_move();
        let info = |lamp: &Lamp| {
            let light = &animation.lights[lamp.light];
            LightInfo {
                name: light.name.clone(),
                node: animation.nodes[lamp.node].name.clone(),
                kind: light.kind.to_string(),
                color: light.beam.color.to_array(),
                intensity: light.beam.intensity,
                moves: moves[lamp.node],
                changes: animation.beam_changes(lamp.light),
            }
        };
        animation.lamps.iter().map(info).collect()
    }
}

impl std::fmt::Display for LightInfo {
    fn fmt(&self, to: &mut std::fmt::Formatter) -> std::fmt::Result {
        let unit = if self.kind == "directional" {
            "lx"
        } else {
            "cd"
        };
        write!(to, "{} ({} {} {unit}", self.name, self.kind, self.intensity)?;
        for (is, word) in [(self.moves, "moves"), (self.changes, "changes")] {
            if is {
                write!(to, ", {word}")?;
            }
        }
        to.write_str(")")
    }
}

/// Looks into a scene.
pub fn info(settings: &Settings) -> Result<Info> {
    let Opened {
        animation, frames, ..
    } = Opened::of(settings, &observer::silence)?;
    let sizes = opening::uniform(settings, &animation);
    let element_size = sizes.even();
    let effort = Effort::of(settings, &animation, &sizes);
    effort.judge(settings, &observer::silence)?;
    let patches = RadiosityMesh::cut_by(&animation, &sizes)?;
    let bounds = patches.at(&animation, &animation.pose(0.0)).bounds();
    let emits = animation
        .materials
        .iter()
        .filter(|m| m.emission() != Vec3::ZERO);
    Ok(Info {
        file: settings.scene.file.display().to_string(),
        scenes: animation.scenes.clone(),
        scene: animation.scene,
        nodes: animation.nodes.len(),
        triangles: patches.surface_of.len(),
        // The last one is the specification's, not the file's.
        materials: animation.materials.len() - 1,
        size: bounds.extent().to_array(),
        cameras: cameras(&animation),
        animations: clips(&animation),
        movers: movers(&animation, &patches),
        emitters: emits
            .map(|m| (m.name.clone(), m.emission().to_array()))
            .collect(),
        lights: LightInfo::of(&animation),
        frames: frames.len(),
        element_size,
        elements: patches.count(),
        samples: effort.samples(),
        memory_bytes: effort.bytes(),
        seconds: effort.seconds(settings, rayon::current_num_threads()),
        extensions: extensions(&animation),
        warnings: animation.warnings.clone(),
    })
}

fn cameras(animation: &Animation) -> Vec<CameraInfo> {
    let moves = animation.cameras_move();
    let info = |(index, camera): (usize, &crate::scene::SceneCamera)| CameraInfo {
        name: camera.name.clone(),
        kind: match camera.lens {
            Lens::Perspective { .. } => "perspective",
            Lens::Orthographic { .. } => "orthographic",
        },
        animated: moves[index],
    };
    animation.cameras.iter().enumerate().map(info).collect()
}

fn clips(animation: &Animation) -> Vec<ClipInfo> {
    let info = |(index, clip): (usize, &crate::scene::Clip)| ClipInfo {
        name: clip.name.clone(),
        seconds: clip.seconds,
        channels: clip.channels.len(),
        plays: animation.playing.contains(&index),
    };
    animation.clips.iter().enumerate().map(info).collect()
}

/// The names of the nodes whose surfaces move, each once; those that come and go are marked.
fn movers(animation: &Animation, patches: &RadiosityMesh) -> Vec<String> {
    let presence = animation.presence();
    let mut nodes: Vec<NodeId> = patches
        .surfaces
        .iter()
        .filter(|surface| surface.moves)
        .map(|surface| animation.instances[surface.instance].node)
        .collect();
    nodes.sort_unstable();
    nodes.dedup();
    let named = |node: NodeId| {
        let name = &animation.nodes[node].name;
        match presence[node] {
            Presence::AtTimes => format!("{name} (comes and goes)"),
            _ => name.clone(),
        }
    };
    nodes.into_iter().map(named).collect()
}

fn extensions(animation: &Animation) -> Vec<ExtensionInfo> {
    let info = |extension: &crate::scene::Extension| ExtensionInfo {
        name: extension.name.clone(),
        handled: extension.handled.to_string(),
    };
    animation.extensions.iter().map(info).collect()
}

impl Info {
    /// The same for reading.
    pub fn text(&self) -> String {
        let mut text = format!(
            "{}: {} nodes, {} triangles, {} materials, {:.2} x {:.2} x {:.2} m\n",
            self.file,
            self.nodes,
            self.triangles,
            self.materials,
            self.size[0],
            self.size[1],
            self.size[2]
        );
        for (name, items, between) in self.rows() {
            let items = match &items[..] {
                [] => "none".to_string(),
                items => items.join(between),
            };
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{name:12} {items}");
        }
        text
    }

    /// The rows of the text: their names, their items, and the text between two items.
    fn rows(&self) -> [(&'static str, Vec<String>, &'static str); 12] {
        let (row, line) = (", ", "\n             ");
        let mark = |here: bool, told: &'static str| if here { told } else { "" };
        let scene = |(i, name): (usize, &String)| {
            format!("{i} '{name}'{}", mark(i == self.scene, ", shown"))
        };
        let camera = |(i, c): (usize, &CameraInfo)| {
            format!(
                "{i} '{}' {}{}",
                c.name,
                c.kind,
                mark(c.animated, ", animated")
            )
        };
        let clip = |(i, c): (usize, &ClipInfo)| {
            let plays = mark(c.plays, ", plays");
            let (name, seconds, channels) = (&c.name, c.seconds, c.channels);
            format!("{i} '{name}' {seconds:.3} s, {channels} channels{plays}")
        };
        let emitters = self.emitters.iter().map(|(m, l)| format!("{m} {l:?}"));
        let (elements, size) = (self.elements, self.element_size);
        let elements = format!("{elements} with edges up to {size:.3} m");
        let memory = format!("about {:.2} GB", self.memory_bytes as f64 / 1e9);
        let [preparation, picture] = self.seconds;
        let time = format!(
            "about {preparation:.1} s for {} samples once, {picture:.1} s for the first picture; later frames take less",
            grouped(self.samples)
        );
        let extensions = self.extensions.iter();
        let extensions = extensions.map(|e| format!("{} {}", e.name, e.handled));
        let scenes = self.scenes.iter().enumerate().map(scene).collect();
        let cameras = self.cameras.iter().enumerate().map(camera).collect();
        let clips = self.animations.iter().enumerate().map(clip).collect();
        let lights = self.lights.iter().map(LightInfo::to_string).collect();
        [
            ("scenes", scenes, line),
            ("cameras", cameras, line),
            ("animations", clips, line),
            ("movers", self.movers.clone(), row),
            ("emitters", emitters.collect(), row),
            ("frames", vec![self.frames.to_string()], row),
            ("lights", lights, row),
            ("elements", vec![elements], row),
            ("memory", vec![memory], row),
            ("time", vec![time], row),
            ("extensions", extensions.collect(), line),
            ("warnings", self.warnings.clone(), line),
        ]
    }
}

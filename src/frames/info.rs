//! What is in a scene and how it would be cut, without rendering anything.

use super::prepare;
use crate::error::Result;
use crate::patch::{self, Patches};
use crate::settings::Settings;
use glam::Vec3;
use serde::Serialize;
use std::fmt::Write;

/// A scene in names and numbers.
#[derive(Clone, Debug, Serialize)]
pub struct Info {
    /// The file.
    pub file: String,
    /// Nodes in the scene.
    pub nodes: usize,
    /// Triangles in the scene.
    pub triangles: usize,
    /// Width, height and depth in metres at time 0.
    pub size: [f32; 3],
    /// Cameras by name.
    pub cameras: Vec<String>,
    /// Animations with their length in seconds.
    pub animations: Vec<(String, f64)>,
    /// Nodes with triangles that the playing animation moves.
    pub movers: Vec<String>,
    /// Materials that emit, with their radiance.
    pub emitters: Vec<(String, [f32; 3])>,
    /// Frames that would be rendered.
    pub frames: usize,
    /// Longest edge of an element in metres.
    pub element_size: f32,
    /// Elements the scene would be cut into.
    pub elements: usize,
    /// Extensions that the file uses.
    pub extensions: Vec<String>,
    /// What will be rendered in a simpler way than the file asks.
    pub warnings: Vec<String>,
}

/// Looks into a scene.
pub fn info(settings: &Settings) -> Result<Info> {
    let animation = prepare::open(settings)?;
    animation.choose_camera(&settings.camera)?;
    let element_size = prepare::element_size(settings, &animation);
    let patches = Patches::cut(&animation, element_size)?;
    let bounds = patches.at(&animation, &animation.pose(0.0)).bounds();
    let moves = animation.moves();
    let mut movers: Vec<usize> = animation
        .instances
        .iter()
        .map(|i| i.node as usize)
        .filter(|n| moves[*n])
        .collect();
    movers.dedup();
    let emits = animation
        .materials
        .iter()
        .filter(|m| m.emission() != Vec3::ZERO);
    Ok(Info {
        file: settings.scene.display().to_string(),
        nodes: animation.nodes.len(),
        triangles: patches.surface_of.len(),
        size: bounds.extent().to_array(),
        cameras: animation.cameras.iter().map(|c| c.name.clone()).collect(),
        animations: animation
            .clips
            .iter()
            .map(|c| (c.name.clone(), c.seconds))
            .collect(),
        movers: movers
            .into_iter()
            .map(|n| animation.nodes[n].name.clone())
            .collect(),
        emitters: emits
            .map(|m| (m.name.clone(), m.emission().to_array()))
            .collect(),
        frames: prepare::frames(settings, &animation).len(),
        element_size,
        elements: patch::count(&animation, element_size, usize::MAX),
        extensions: animation
            .extensions
            .iter()
            .map(|e| e.name.clone())
            .collect(),
        warnings: animation.warnings.clone(),
    })
}

impl Info {
    /// The same for reading.
    pub fn text(&self) -> String {
        let mut text = format!(
            "{}: {} nodes, {} triangles, {:.2} x {:.2} x {:.2} m\n",
            self.file, self.nodes, self.triangles, self.size[0], self.size[1], self.size[2]
        );
        let mut list = |name: &str, items: Vec<String>| {
            let items = if items.is_empty() {
                "none".to_string()
            } else {
                items.join(", ")
            };
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{name:12} {items}");
        };
        list(
            "cameras",
            self.cameras
                .iter()
                .enumerate()
                .map(|(i, c)| format!("{i} '{c}'"))
                .collect(),
        );
        list(
            "animations",
            self.animations
                .iter()
                .enumerate()
                .map(|(i, (c, s))| format!("{i} '{c}' {s:.3} s"))
                .collect(),
        );
        list("movers", self.movers.clone());
        list(
            "emitters",
            self.emitters
                .iter()
                .map(|(m, l)| format!("{m} {l:?}"))
                .collect(),
        );
        list("frames", vec![self.frames.to_string()]);
        list(
            "elements",
            vec![format!(
                "{} with edges up to {:.3} m",
                self.elements, self.element_size
            )],
        );
        list("extensions", self.extensions.clone());
        list("warnings", self.warnings.clone());
        text
    }
}

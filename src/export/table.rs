//! The radiosity of every side in every frame, as rows with units: CSV for spreadsheets, NPZ for NumPy.
//!
//! A side is the front or the back of an element. Lengths are metres, areas m²; emission, radiosity and irradiance are
//! W/m² in red, green and blue, with B = E + R and R = reflectance × irradiance. Sides keep their numbers in all frames.

use super::npz;
use crate::ids::{SideId, SurfaceId};
use crate::session::Session;
use glam::{DVec3, Vec2, Vec3};
use std::fmt::Write;
use zip::result::ZipResult;

/// The columns: the name, the unit, and how many numbers each row has of it.
pub const COLUMNS: [(&str, &str, usize); 7] = [
    ("position", "m", 3),
    ("normal", "1", 3),
    ("area", "m^2", 1),
    ("reflectance", "1", 3),
    ("emission", "W/m^2", 3),
    ("radiosity", "W/m^2", 3),
    ("irradiance", "W/m^2", 3),
];

/// Rows of all frames.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// Frames and their times in seconds.
    pub frames: Vec<(u32, f64)>,
    /// For each side the node and the material, the element, and whether it is the back.
    pub sides: Vec<(String, String, u32, bool)>,
    /// For each column its numbers: frame by frame, side by side.
    pub columns: [Vec<f32>; 7],
}

impl Table {
    /// Adds the present state of a session as a frame.
    pub fn add(&mut self, frame: u32, session: &Session) {
        let (scene, placed) = (&session.scene, session.placed());
        let patches = &scene.patches;
        if self.frames.is_empty() {
            self.sides = patches
                .side_ids()
                .map(|side| named(session, side))
                .collect();
        }
        self.frames.push((frame, session.seconds()));
        let (irradiance, emitted) = (session.irradiance_of_sides(), session.emitted_by_sides());
        let reflected = session.reflected();
        for side in patches.side_ids() {
            let stand = patches.stand(placed, side, Vec2::X);
            let [a, b, c] = stand.corners;
            let middle = ((a + b + c) / 3.0).as_dvec3();
            let middle = scene.animation.to_file(middle);
            let emission = if session.is_there(patches.surface_at(side)) {
                emitted[side.index()]
            } else {
                Vec3::ZERO
            };
            let radiosity = reflected[side.index()] + DVec3::from(emission);
            let rows = [
                middle.as_vec3(),
                stand.normal,
                Vec3::splat(patches.area(placed, &patches.sides[side])),
                patches.sent_on(placed, side),
                emission,
                radiosity.as_vec3(),
                irradiance[side.index()],
            ];
            for ((column, (.., width)), row) in self.columns.iter_mut().zip(COLUMNS).zip(rows) {
                // Adding zero makes −0 read as 0.
                column.extend(&(row + Vec3::ZERO).to_array()[..width]);
            }
        }
    }

    /// As comma-separated values, with a line of names and units.
    pub fn csv(&self) -> String {
        let mut text = String::from("frame,time_s,side,node,material,element,facing");
        for (name, unit, width) in COLUMNS {
            let axes = match (width, name) {
                (1, _) => &[""][..],
                (_, "position" | "normal") => &["_x", "_y", "_z"],
                _ => &["_r", "_g", "_b"],
            };
            for axis in axes {
                let _ = write!(text, ",{name}{axis}[{unit}]");
            }
        }
        text.push('\n');
        for (at, (frame, seconds)) in self.frames.iter().enumerate() {
            for (side, (node, material, element, back)) in self.sides.iter().enumerate() {
                let facing = if *back { "back" } else { "front" };
                let (node, material) = (quoted(node), quoted(material));
                let _ = write!(
                    text,
                    "{frame},{seconds},{side},{node},{material},{element},{facing}"
                );
                let row = at * self.sides.len() + side;
                for (column, (.., width)) in self.columns.iter().zip(COLUMNS) {
                    for number in &column[row * width..(row + 1) * width] {
                        let _ = write!(text, ",{number}");
                    }
                }
                text.push('\n');
            }
        }
        text
    }

    /// As an archive of NumPy arrays: each column is an array of frames × sides × numbers.
    ///
    /// # Errors
    /// Where it does not fit the format.
    pub fn npz(&self) -> ZipResult<Vec<u8>> {
        let (frames, sides) = (self.frames.len(), self.sides.len());
        let mut archive = npz::Archive::default();
        for (column, (name, _, width)) in self.columns.iter().zip(COLUMNS) {
            archive.floats(name, &[frames, sides, width], column);
        }
        let numbers: Vec<u32> = self.frames.iter().map(|(frame, _)| *frame).collect();
        archive.numbers("frame", &numbers);
        let times: Vec<f32> = self.frames.iter().map(|(_, time)| *time as f32).collect();
        archive.floats("time", &[frames], &times);
        let elements: Vec<u32> = self
            .sides
            .iter()
            .map(|(_, _, element, _)| *element)
            .collect();
        archive.numbers("element", &elements);
        let backs: Vec<u32> = self
            .sides
            .iter()
            .map(|(.., back)| u32::from(*back))
            .collect();
        archive.numbers("back", &backs);
        let of = |name: fn(&(String, String, u32, bool)) -> &String| -> Vec<String> {
            self.sides.iter().map(|side| name(side).clone()).collect()
        };
        archive.texts("node", &of(|(node, ..)| node));
        archive.texts("material", &of(|(_, material, ..)| material));
        let units = COLUMNS
            .iter()
            .map(|(name, unit, _)| format!("{name}: {unit}"));
        archive.texts(
            "units",
            &units.chain(["time: s".into()]).collect::<Vec<_>>(),
        );
        archive.finish()
    }
}

/// Where a side belongs.
fn named(session: &Session, side: SideId) -> (String, String, u32, bool) {
    let (scene, patches) = (&session.scene, &session.scene.patches);
    let surface: SurfaceId = patches.surface_at(side);
    let of = patches.sides[side];
    (
        scene.animation.nodes[scene.node_of(surface)].name.clone(),
        scene.animation.materials[scene.material_of(surface)]
            .name
            .clone(),
        of.element.number(),
        of.back,
    )
}

/// A name as a field: in quotes where it has commas, quotes or line ends.
fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) {
        return format!("\"{}\"", name.replace('"', "\"\""));
    }
    name.into()
}

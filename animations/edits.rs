//! Measures unscripted edits: `cargo run --release --example edits [ELEMENTS…]`.
//!
//! Builds furnished rooms of about so many elements (5,000, 20,000 and 50,000 if none are given), opens a session on each
//! with 512 samples, and moves a chair of 504 triangles, switches the lamp, repaints a wall and opens a door, each several
//! times. Prints medians in milliseconds beside the same state asked and solved from nothing, in the same run.

use base64::Engine;
use glam::{DVec3, Vec3};
use serde_json::{Value, json};
use std::error::Error;
use std::time::Instant;
use sweeplight::mesh;
use sweeplight::report::FrameReport;
use sweeplight::scene::Animation;
use sweeplight::sequence::{edit, silence};
use sweeplight::session::{Session, Step};
use sweeplight::settings::Settings;

/// Hemisphere samples of a side.
const SAMPLES: u32 = 512;

/// Times that each edit is made; each time it is another state.
const TIMES: usize = 9;

/// A room in the making: materials and nodes of one glTF file.
#[derive(Default)]
struct Room {
    materials: Vec<Value>,
    meshes: Vec<Value>,
    accessors: Vec<Value>,
    nodes: Vec<Value>,
    bytes: Vec<u8>,
}

/// Quadrangles, counter-clockwise seen from the front.
type Quads = Vec<[Vec3; 4]>;

/// A box with its front outside.
fn cuboid(lo: [f32; 3], hi: [f32; 3]) -> Quads {
    let corner = |i: usize| {
        Vec3::from(std::array::from_fn(|axis| {
            if i >> axis & 1 == 1 {
                hi[axis]
            } else {
                lo[axis]
            }
        }))
    };
    let faces = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    faces.iter().map(|face| face.map(corner)).collect()
}

/// The same with its front inside.
fn inside(quads: Quads) -> Quads {
    quads.into_iter().map(|[a, b, c, d]| [a, d, c, b]).collect()
}

/// A chair of 42 boxes: seat, legs, back posts, and slats for the rest.
fn chair() -> Quads {
    let mut parts = cuboid([-0.21, 0.43, -0.17], [0.21, 0.465, 0.23]);
    for x in [-0.205, 0.169] {
        parts.extend(cuboid([x, 0.0, 0.18], [x + 0.036, 0.429, 0.216]));
        parts.extend(cuboid([x, 0.0, -0.207], [x + 0.036, 0.95, -0.171]));
    }
    for slat in 0..37 {
        let x = -0.162 + 0.0088 * slat as f32;
        parts.extend(cuboid([x, 0.5, -0.195], [x + 0.004, 0.9, -0.185]));
    }
    parts
}

impl Room {
    fn material(&mut self, name: &str, color: [f32; 3], radiance: f32) -> usize {
        self.materials.push(json!({
            "name": name, "pbrMetallicRoughness": {"baseColorFactor": [color[0], color[1], color[2], 1], "metallicFactor": 0},
            "emissiveFactor": if radiance > 0.0 { [1, 1, 1] } else { [0; 3] },
            "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": radiance.max(1.0)}},
        }));
        self.materials.len() - 1
    }

    fn node(&mut self, name: &str, quads: &Quads, material: usize, at: [f32; 3]) {
        let offset = self.bytes.len();
        for corner in quads.iter().flat_map(|[a, b, c, d]| [a, b, c, a, c, d]) {
            self.bytes
                .extend(corner.to_array().iter().flat_map(|x| x.to_le_bytes()));
        }
        let all = || quads.iter().flatten().copied();
        let lo = all().reduce(Vec3::min).unwrap_or_default().to_array();
        let hi = all().reduce(Vec3::max).unwrap_or_default().to_array();
        self.accessors.push(
            json!({"bufferView": 0, "byteOffset": offset, "componentType": 5126,
            "count": 6 * quads.len(), "type": "VEC3", "min": lo, "max": hi}),
        );
        let position = self.accessors.len() - 1;
        self.meshes.push(
            json!({"primitives": [{"attributes": {"POSITION": position}, "material": material}]}),
        );
        self.nodes
            .push(json!({"name": name, "mesh": self.meshes.len() - 1, "translation": at}));
    }

    /// A room with a door to a corridor, a table, four chairs, shelves and two lamps.
    fn furnished() -> Value {
        let mut room = Room::default();
        let white = room.material("white", [0.75, 0.74, 0.7], 0.0);
        let wall = room.material("wall", [0.7, 0.7, 0.72], 0.0);
        let oak = room.material("oak", [0.5, 0.35, 0.2], 0.0);
        let seat = room.material("seat", [0.2, 0.35, 0.4], 0.0);
        let lamp = room.material("lamp", [0.5; 3], 12.0);
        let corridor = room.material("corridor lamp", [0.5; 3], 20.0);
        let mut shell = inside(cuboid([0.0; 3], [6.0, 2.7, 5.0]));
        // The first face is at z = 0, where the door is; the fifth, at x = 0, is the wall to be painted.
        shell.remove(0);
        let painted = shell.remove(3);
        let front = |x: [f32; 2], y: [f32; 2]| {
            [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]]
                .map(|[x, y]| Vec3::new(x, y, 0.0))
        };
        shell.extend([
            front([0.0, 2.0], [0.0, 2.7]),
            front([2.9, 6.0], [0.0, 2.7]),
            front([2.0, 2.9], [2.05, 2.7]),
        ]);
        room.node("shell", &shell, white, [0.0; 3]);
        room.node("wall", &vec![painted], wall, [0.0; 3]);
        let mut passage = inside(cuboid([1.0, 0.0, -1.6], [4.0, 2.4, -0.1]));
        passage.remove(1);
        room.node("passage", &passage, white, [0.0; 3]);
        room.node(
            "jambs",
            &[
                cuboid([1.9, 0.0, -0.12], [1.999, 2.2, -0.001]),
                cuboid([2.901, 0.0, -0.12], [3.0, 2.2, -0.001]),
            ]
            .concat(),
            oak,
            [0.0; 3],
        );
        room.node(
            "door",
            &cuboid([0.002, 0.002, 0.0], [0.896, 2.046, 0.04]),
            oak,
            [2.001, 0.0, 0.003],
        );
        room.node(
            "lamp",
            &cuboid([-0.4, 0.0, -0.4], [0.4, 0.03, 0.4]),
            lamp,
            [3.0, 2.6, 2.5],
        );
        room.node(
            "corridor lamp",
            &cuboid([-0.2, 0.0, -0.2], [0.2, 0.03, 0.2]),
            corridor,
            [2.5, 2.3, -0.9],
        );
        let mut table = cuboid([-0.8, 0.715, -0.45], [0.8, 0.75, 0.45]);
        for (x, z) in [(-0.75, -0.4), (0.7, -0.4), (-0.75, 0.35), (0.7, 0.35)] {
            table.extend(cuboid([x, 0.001, z], [x + 0.05, 0.714, z + 0.05]));
        }
        room.node("table", &table, oak, [3.4, 0.0, 2.6]);
        for (name, at) in [
            ("chair", [3.0, 0.001, 3.6]),
            ("chair 2", [3.9, 0.001, 3.6]),
            ("chair 3", [3.0, 0.001, 1.7]),
            ("chair 4", [4.9, 0.001, 2.4]),
        ] {
            room.node(name, &chair(), seat, at);
        }
        for shelf in 0..5 {
            let y = 0.3 + 0.4 * shelf as f32;
            room.node(
                &format!("shelf {shelf}"),
                &cuboid([5.65, y, 0.6], [5.99, y + 0.03, 2.4]),
                oak,
                [0.0; 3],
            );
        }
        room.nodes.push(json!({"name": "camera", "camera": 0, "translation": [0.7, 1.6, 4.6], "rotation": [-0.07, -0.31, -0.023, 0.948]}));
        room.json()
    }

    fn json(self) -> Value {
        let nodes: Vec<usize> = (0..self.nodes.len()).collect();
        let bytes = base64::engine::general_purpose::STANDARD.encode(&self.bytes);
        json!({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": nodes}], "nodes": self.nodes,
            "extensionsUsed": ["KHR_materials_emissive_strength"],
            "materials": self.materials, "meshes": self.meshes, "accessors": self.accessors,
            "cameras": [{"type": "perspective", "perspective": {"yfov": 0.95, "znear": 0.01}}],
            "bufferViews": [{"buffer": 0, "byteLength": self.bytes.len()}],
            "buffers": [{"byteLength": self.bytes.len(), "uri": format!("data:application/octet-stream;base64,{bytes}")}],
        })
    }
}

/// Makes one edit.
fn apply(session: &mut Session, edit: Value) -> Result<FrameReport, Box<dyn Error>> {
    let step = Step::parse(&json!({"edits": [edit]}).to_string())?;
    Ok(session.apply(&step.edits)?)
}

/// Medians over the times that an edit was made; `before` is made before each, and is not measured.
fn measure(
    session: &mut Session,
    name: &str,
    before: Option<&dyn Fn(usize) -> Value>,
    line: impl Fn(usize) -> Value,
) -> Result<(), Box<dyn Error>> {
    let mut rows: Vec<[f64; 5]> = Vec::new();
    let (mut last, mut residual, mut first, mut after) = (Default::default(), 0.0f64, 0.0, 0.0);
    for time in 0..TIMES {
        if let Some(before) = before {
            apply(session, before(time))?;
            while session.precompute() {}
        }
        let report = apply(session, line(time))?;
        let camera = session.camera((640, 360))?;
        let clock = Instant::now();
        session.image(&camera);
        let image = clock.elapsed().as_secs_f64();
        // As `sweeplight edit` does while nobody waits.
        let clock = Instant::now();
        while session.precompute() {}
        after = f64::max(after, 1e3 * clock.elapsed().as_secs_f64());
        let s = report.seconds;
        // The first time is told apart: what leaves its place changes its number of samples.
        let row = [s.place, s.trace, s.solve, s.light(), image].map(|s| 1e3 * s);
        if time == 0 {
            first = row[3];
        } else {
            rows.push(row);
        }
        residual = residual.max(report.residual);
        last = report;
    }
    let verified = session.verify();
    let median = |column: usize| {
        let mut values: Vec<f64> = rows.iter().map(|row| row[column]).collect();
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let [place, trace, solve, light, image] = [0, 1, 2, 3, 4].map(median);
    // With kept form factors another program would solve alone; without, trace everything first.
    let [resolve, scratch] = [verified.solve_seconds, verified.seconds].map(|s| 1e3 * s);
    // Whoever keeps them still traces the samples that an edit changes.
    let again = place + trace + resolve;
    println!(
        "| {name} | {} | {} | {place:.2} | {trace:.2} | {solve:.2} | {light:.2} | {first:.2} | {again:.0}, {:.1}x | {scratch:.0}, {:.0}x | {}, {} | {residual:.1e} | {image:.0} | {after:.1} | {} |",
        last.traced,
        last.changed,
        again / light,
        scratch / light,
        last.shots,
        last.sweeps,
        verified.differ + verified.pixels_differ,
    );
    Ok(())
}

fn main() -> Result<(), String> {
    // As `sweeplight edit` does, work among the threads that help, not beside them.
    rayon::scope(|_| rooms().map_err(|error| error.to_string()))
}

/// Measures every edit in rooms of the sizes that were asked for.
fn rooms() -> Result<(), Box<dyn Error>> {
    let sizes: Vec<usize> = std::env::args()
        .skip(1)
        .map(|text| text.parse())
        .collect::<Result<_, _>>()?;
    let sizes = if sizes.is_empty() {
        vec![5_000, 20_000, 50_000]
    } else {
        sizes
    };
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("room.gltf");
    std::fs::write(&path, Room::furnished().to_string())?;
    for elements in sizes {
        let mut settings = Settings::new(&path);
        settings.solve.samples = Some(SAMPLES);
        settings.solve.element_size = Some(mesh::size_for(&Animation::open(&path)?, elements));
        let clock = Instant::now();
        let (mut session, report) = edit::open(&settings, false, &silence)?;
        let opened = clock.elapsed().as_secs_f64();
        let (bytes, samples) = session.memory();
        println!(
            "\n{} elements, {} samples; opened in {opened:.2} s ({:.2} s tracing, {:.2} s solving); {:.1} bytes a sample\n",
            session.scene.patches.elements.len(),
            report.samples,
            report.seconds.trace,
            report.seconds.solve,
            bytes as f64 / samples as f64
        );
        println!(
            "| edit | traced | changed | place ms | trace ms | solve ms | light ms | the first time | plain re-solve ms, ratio | from scratch ms, ratio | shots, sweeps | residual | image ms | precompute ms, at most | differ |"
        );
        println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
        let way =
            |time: usize| DVec3::new(1.2, 0.001, 3.4) + DVec3::new(0.05, 0.0, -0.08) * time as f64;
        // Each time another light than before, and at last the first one.
        let strengths = [0, 12, 0, 12, 0, 12, 0, 6, 12];
        let lamp = |time: usize| json!({"emission": {"material": "lamp", "strength": strengths[time % TIMES]}});
        let chair = |time: usize| json!({"move": {"node": "chair", "to": way(time).to_array()}});
        // Each time another colour than any before.
        let green = |time: usize| 0.1 + 0.07 * (time * 4 % TIMES) as f64;
        let blue = |time: usize| 0.8 - 0.06 * (time * 2 % TIMES) as f64;
        let paint = |time: usize| json!({"color": {"material": "wall", "to": [0.7, green(time), blue(time)]}});
        measure(&mut session, "switch the lamp", None, lamp)?;
        measure(&mut session, "move a chair", None, chair)?;
        let moved = "switch the lamp, each time after a chair moved";
        measure(&mut session, moved, Some(&chair), lamp)?;
        measure(&mut session, "repaint a wall", None, paint)?;
        let moved = "repaint a wall, each time after a chair moved";
        measure(&mut session, moved, Some(&chair), paint)?;
        measure(
            &mut session,
            "open the door",
            None,
            |time| json!({"rotate": {"node": "door", "to": {"axis": [0, 1, 0], "degrees": -10.0 * (time + 1) as f64}}}),
        )?;
    }
    Ok(())
}

//! Every way to form factors in a solve of one scene: time, memory, and the error of radiosity against the finest.
//!
//! The mesh and everything else are the same; the first frame is prepared and solved by each method from nothing. The finest are
//! cosine samples, as many as a receiver may have. A radiosity's error is the root mean square over all areas of the difference
//! of reflected radiosities, relative to these.

use crate::error::{Error, Result};
use crate::options::name_of;
use crate::report::table::grouped;
use crate::sequence::prepare::prepare;
use crate::sequence::threads::in_threads;
use crate::sequence::{Event, Renderer, opening, silence};
use crate::settings::{HemisphereSampling, Pairs, Settings, Solver};
use clap::ValueEnum;
use glam::DVec3;
use serde::Serialize;
use std::fmt::Write;

/// Elements of the mesh, few enough for formulas between all pairs.
const ELEMENTS: u32 = 600;

/// Samples of each receiver, and of the finest.
const SAMPLES: u32 = 256;
const FINEST: u32 = 4096;

/// What a method took, and how far off it is.
#[derive(Clone, Debug, Serialize)]
pub struct MethodRow {
    /// The form factors, as `--form-factors` names them; `near pairs` are those of `--pairs near`.
    pub form_factors: String,
    /// Hemisphere samples of a receiver at rest.
    pub samples: u32,
    /// Pairs whose factor is a formula.
    pub pairs: u64,
    /// Seconds of the preparation without its key frame, and of trace and solve of the first frame.
    pub seconds: [f64; 2],
    /// Bytes that are kept: hits, pairs, light; the rows of pairs take 32 more for each while a frame is solved.
    pub bytes: u64,
    /// Relative error of reflected radiosity; 0 of the finest.
    pub error: f64,
}

/// All methods in one scene.
#[derive(Clone, Debug, Serialize)]
pub struct MethodTable {
    /// The scene's file.
    pub scene: String,
    /// Sides of its mesh.
    pub sides: usize,
    /// The methods, the finest first.
    pub rows: Vec<MethodRow>,
    /// Methods that were left out, and why.
    pub left_out: Vec<(String, String)>,
}

/// A solved frame: area and reflected radiosity of each side.
struct SolvedSides(Vec<(f64, DVec3)>);

/// Solves the first frame of a scene by each method.
///
/// # Errors
/// As [`prepare`].
pub fn methods(settings: &Settings, watch: &(dyn Fn(Event) + Sync)) -> Result<MethodTable> {
    in_threads(settings.solve.threads, || table(settings, watch))?
}

fn table(settings: &Settings, watch: &(dyn Fn(Event) + Sync)) -> Result<MethodTable> {
    let mut settings = settings.clone();
    settings.scene.frames.get_or_insert_with(|| vec![0]);
    settings.solve.solver = Solver::Gather;
    if settings.solve.element_size.is_none() {
        settings.solve.elements.get_or_insert(ELEMENTS);
        // One length for all: under a budget some methods would cluster small triangles, and others not.
        let size = opening::element_size(&settings, &opening::open(&settings)?);
        (settings.solve.element_size, settings.solve.elements) = (Some(size), None);
    }
    let all = HemisphereSampling::value_variants();
    watch(Event::Stage {
        name: "compare form factors",
        total: all.len() as u64 + 2,
    });
    let run = |name: &str, set: HemisphereSampling, samples: u32, pairs: Pairs| {
        let mut settings = settings.clone();
        (settings.solve.form_factors, settings.solve.pairs) = (set, pairs);
        settings.solve.samples = Some(samples);
        let solved = solve(&settings, name);
        watch(Event::Advance(1));
        solved
    };
    let (finest, goal) = run("cosine", HemisphereSampling::Cosine, FINEST, Pairs::None)?;
    let (mut rows, mut left_out) = (vec![finest], Vec::new());
    for set in all {
        let name = name_of(set);
        match run(&name, *set, SAMPLES, Pairs::None) {
            Ok(solved) => rows.push(compared(solved, &goal)),
            // Formulas between all pairs are for small scenes.
            Err(Error::Usage { flag, got, .. }) if flag == "--form-factors" => {
                left_out.push((name, format!("too large for all pairs, {got}")));
            }
            Err(error) => return Err(error),
        }
    }
    let near = run(
        "near pairs",
        HemisphereSampling::Cosine,
        SAMPLES,
        Pairs::Near,
    )?;
    rows.push(compared(near, &goal));
    Ok(MethodTable {
        scene: settings.scene.file.display().to_string(),
        sides: goal.0.len(),
        rows,
        left_out,
    })
}

/// Prepares and solves the first frame.
fn solve(settings: &Settings, name: &str) -> Result<(MethodRow, SolvedSides)> {
    let prepared = prepare(settings, &silence)?;
    let mut renderer = Renderer::new(&prepared);
    let report = renderer.solve(0);
    let patches = &prepared.patches;
    let light = &renderer.state().light;
    let sides = patches.sides.iter().zip(&light.reflected);
    let sides = sides.map(|(side, reflected)| {
        let area = f64::from(patches.area(renderer.placed(), side));
        (area, glam::Vec3::from(*reflected).as_dvec3())
    });
    let key = prepared.key.seconds.map_or(0.0, |seconds| seconds.light());
    let row = MethodRow {
        form_factors: name.into(),
        samples: prepared.back.hemisphere.samples as u32,
        pairs: report.pairs_near,
        seconds: [prepared.seconds - key, report.seconds.light()],
        bytes: (prepared.back.memory() + renderer.memory()) as u64,
        error: 0.0,
    };
    let sides = SolvedSides(sides.collect());
    Ok((row, sides))
}

/// A row with its error against the finest.
fn compared((row, solved): (MethodRow, SolvedSides), goal: &SolvedSides) -> MethodRow {
    let (mut off, mut all) = (0.0, 0.0);
    for ((area, light), (_, goal)) in solved.0.iter().zip(&goal.0) {
        off += area * (*light - *goal).length_squared();
        all += area * goal.length_squared();
    }
    let error = if all > 0.0 { (off / all).sqrt() } else { 0.0 };
    MethodRow { error, ..row }
}

impl MethodTable {
    /// The table, a row a method.
    pub fn text(&self) -> String {
        let mut text = format!("{}: {} sides\n", self.scene, grouped(self.sides as u64));
        text += &format!(
            "{:12} {:>8} {:>10} {:>10} {:>10} {:>10} {:>9}\n",
            "form factors", "samples", "pairs", "prepare s", "frame s", "MB", "error"
        );
        for row in &self.rows {
            let [prepare, frame] = row.seconds;
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "{:12} {:8} {:>10} {prepare:10.3} {frame:10.3} {:10.2} {:9.5}",
                row.form_factors,
                row.samples,
                grouped(row.pairs),
                row.bytes as f64 / 1e6,
                row.error
            );
        }
        for (name, reason) in &self.left_out {
            let _ = writeln!(text, "{name:12} left out: {reason}");
        }
        text + "The first row is the finest, against which the others are held. Seconds depend on what else the machine does.\n"
    }
}

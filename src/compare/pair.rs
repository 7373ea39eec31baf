//! The form factor between two things of a scene, frame by frame, by every estimator of the program.
//!
//! Of each estimator it tells the factor, its expected error, the factor back, and whether the two are reciprocal:
//! A F = A′ F′. An error is one standard error of [`REPEATS`](super::repeated::REPEATS) independent results, or for the solve's own row, which is drawn
//! once, their standard deviation; a bias is what all of them may be off alike. The solve takes the open part of a receiver
//! for all of it, every other estimator lets covered parts receive nothing: there the two differ.

use super::ends::{self, FactorEnd};
use super::facets::Facets;
use super::repeated::{STUDENT, deviation, mean};
use super::sampled::{FoundFactors, RowScene};
use super::straight::{FacingEnds, MOST_PAIRS};
use crate::error::{Error, Result};
use crate::formfactor::{Set, hemicube};
use crate::ids::SideId;
use crate::sequence::prepare::prepare;
use crate::sequence::prepared::Prepared;
use crate::sequence::threads::in_threads;
use crate::sequence::{Event, Renderer, sets};
use crate::settings::{Memory, Settings};
use crate::visibility::Accel;
use clap::ValueEnum;
use serde::Serialize;

/// Rounding of sampled rows, which are added up in 32 bits, relative to the factor.
const ROUNDING: f64 = 1e-5;

/// An estimator of form factors in a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum FactorMethod {
    /// The rows of the solve itself, as its settings sample them
    Solve,
    /// Cosine-distributed directions (Malley 1988)
    Cosine,
    /// A hemicube (Cohen, Greenberg 1985)
    Hemicube,
    /// A single plane (Sillion, Puech 1989)
    Plane,
    /// The contour integral times the visible share (Goral and others 1984)
    Contour,
    /// Exact factors from points to polygons times the visible share (Baum, Rushmeier, Winget 1989)
    Points,
    /// Disks, each with one ray (Wallace, Elmquist, Haines 1989)
    Disks,
}

/// What is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct PairQuery {
    /// The end that receives, as [`ends::find`] reads it.
    pub from: String,
    /// The end that sends.
    pub to: String,
    /// One estimator; `None` asks all.
    pub by: Option<FactorMethod>,
}

/// Form factors between two ends.
#[derive(Clone, Debug, Serialize)]
pub struct PairFactors {
    /// The scene's file.
    pub scene: String,
    /// The end that receives.
    pub from: FactorEnd,
    /// The end that sends.
    pub to: FactorEnd,
    /// Frame by frame.
    pub frames: Vec<PairFrame>,
}

/// Form factors in one frame.
#[derive(Clone, Debug, Serialize)]
pub struct PairFrame {
    /// The frame.
    pub frame: u32,
    /// Its time in seconds.
    pub time: f64,
    /// Areas of both ends in m².
    pub areas: [f64; 2],
    /// The share that movers stop of what passes everything at rest; `None` where nothing does.
    pub blocked_by_movers: Option<f64>,
    /// What each estimator found.
    pub estimates: Vec<FactorEstimate>,
    /// Estimators that were left out, and why.
    pub left_out: Vec<(FactorMethod, String)>,
}

/// What an estimator found.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct FactorEstimate {
    /// The estimator.
    pub by: FactorMethod,
    /// The factor: the part of what leaves `from` evenly that arrives at `to`.
    pub factor: f64,
    /// Its expected error.
    pub error: f64,
    /// What it may be off beside that, as coarser steps of the same tell.
    pub bias: f64,
    /// The factor from `to` to `from`.
    pub back: f64,
    /// Its expected error.
    pub back_error: f64,
    /// What it may be off beside that.
    pub back_bias: f64,
    /// Area × factor in m².
    pub exchange: f64,
    /// The same of the factor back.
    pub back_exchange: f64,
    /// Whether both agree within their errors.
    pub reciprocal: bool,
    /// Rays of both, all repetitions together.
    pub rays: u64,
}

/// Finds the form factors between two ends in every frame of the settings.
///
/// # Errors
/// As [`prepare`] and [`ends::find`]; and [`Error::Usage`] where no rows are kept, or the one estimator cannot take the ends.
pub fn factors(
    settings: &Settings,
    query: &PairQuery,
    watch: &(dyn Fn(Event) + Sync),
) -> Result<PairFactors> {
    in_threads(settings.solve.threads, || found(settings, query, watch))?
}

fn found(
    settings: &Settings,
    query: &PairQuery,
    watch: &(dyn Fn(Event) + Sync),
) -> Result<PairFactors> {
    if settings.solve.memory == Memory::Low {
        return Err(Error::Usage {
            flag: "--memory low".into(),
            expected: "rows that are kept, of which a factor is read".into(),
            got: "none".into(),
            way_out: "leave the flag out".into(),
        });
    }
    let prepared = prepare(settings, watch)?;
    let end =
        |flag: &str, text: &str| ends::find(flag, text, &prepared.animation, &prepared.patches);
    let (from, to) = (end("--from", &query.from)?, end("--to", &query.to)?);
    let methods = match query.by {
        Some(method) => vec![method],
        None => FactorMethod::value_variants().to_vec(),
    };
    watch(Event::Stage {
        name: "form factors",
        total: (prepared.frames.len() * methods.len()) as u64,
    });
    let mut renderer = Renderer::new(&prepared);
    let frames = (0..prepared.frames.len()).map(|index| {
        renderer.solve(index);
        let ends = [&from.sides[..], &to.sides[..]];
        let frame = frame(&renderer, &prepared, index, ends, &methods, watch)?;
        match &frame.left_out[..] {
            // What was asked for alone is not left out without a word.
            [(FactorMethod::Contour, reason)] if query.by.is_some() && !frame.is_hidden() => {
                Err(too_many(reason))
            }
            _ => Ok(frame),
        }
    });
    let frames = frames.collect::<Result<Vec<PairFrame>>>()?;
    Ok(PairFactors {
        scene: settings.scene.file.display().to_string(),
        from,
        to,
        frames,
    })
}

impl PairFrame {
    /// Whether an end is hidden, or has no area.
    fn is_hidden(&self) -> bool {
        self.areas.contains(&0.0)
    }
}

fn too_many(reason: &str) -> Error {
    Error::Usage {
        flag: "--by contour".into(),
        expected: format!("at most {MOST_PAIRS} pairs of triangles"),
        got: reason.into(),
        way_out: "name elements instead of nodes, or another estimator".into(),
    }
}

/// The factors in the frame that a renderer has come to.
fn frame(
    renderer: &Renderer,
    prepared: &Prepared,
    index: usize,
    ends: [&[SideId]; 2],
    methods: &[FactorMethod],
    watch: &(dyn Fn(Event) + Sync),
) -> Result<PairFrame> {
    let (patches, placed) = (&prepared.patches, renderer.placed());
    let moment = prepared.moments[index];
    let accel = Accel::with_movers(patches, prepared.back.always(), placed);
    let pose = prepared.animation.pose(moment.time);
    let scales = prepared.light.scales;
    let lights = (prepared.light).at(patches, &prepared.animation, (&pose, placed), scales);
    let facets = ends.map(|sides| Facets::of(patches, placed, sides));
    let scene = RowScene {
        prepared,
        accel: &accel,
        lights: &lights,
    };
    let sight = FacingEnds {
        from: &facets[0],
        to: &facets[1],
        accel: &accel,
        ray_offset: patches.ray_offset,
        seed: 0,
    };
    let mut frame = PairFrame {
        frame: moment.frame,
        time: moment.time,
        areas: facets.each_ref().map(|facets| facets.area),
        blocked_by_movers: None,
        estimates: Vec::new(),
        left_out: Vec::new(),
    };
    if sight.is_empty() {
        let hidden = "an end is hidden, or has no area".to_string();
        frame.left_out = methods
            .iter()
            .map(|method| (*method, hidden.clone()))
            .collect();
        watch(Event::Advance(methods.len() as u64));
        return Ok(frame);
    }
    frame.blocked_by_movers = sight.blocked_by_movers();
    for method in methods {
        match *method == FactorMethod::Contour && sight.pairs() > MOST_PAIRS {
            true => frame
                .left_out
                .push((*method, format!("{} pairs of triangles", sight.pairs()))),
            false => {
                let both = both_ways(*method, renderer, &scene, sight, ends)?;
                frame.estimates.push(estimate(*method, both, frame.areas));
            }
        }
        watch(Event::Advance(1));
    }
    Ok(frame)
}

/// What an estimator finds of the factor and of the factor back.
fn both_ways(
    method: FactorMethod,
    renderer: &Renderer,
    scene: &RowScene,
    sight: FacingEnds,
    [from, to]: [&[SideId]; 2],
) -> Result<[FoundFactors; 2]> {
    let settings = &scene.prepared.settings;
    let samples = settings.solve.hemisphere_samples() as usize;
    let rows =
        |sets: [Set; 2]| [(from, to), (to, from)].map(|(from, to)| scene.factors(sets, from, to));
    let both = [sight, sight.turned()];
    Ok(match method {
        FactorMethod::Solve => {
            let mut spread = rows(sets::chosen(settings)?);
            for (spread, (from, to)) in spread.iter_mut().zip([(from, to), (to, from)]) {
                // What is drawn once lies in the middle of results that differ as these do.
                let own = of_solve(renderer, scene.prepared, from, to);
                let (middle, _) = mean(&spread.values);
                spread
                    .values
                    .iter_mut()
                    .for_each(|value| *value += own - middle);
            }
            spread
        }
        FactorMethod::Cosine => rows([Set::Cosine(samples); 2]),
        FactorMethod::Hemicube => rows([Set::Hemicube(hemicube::nearest(samples)); 2]),
        FactorMethod::Plane => rows([Set::Plane(samples); 2]),
        FactorMethod::Contour => both.map(|sight| sight.contour()),
        FactorMethod::Points => both.map(|sight| sight.points()),
        FactorMethod::Disks => both.map(|sight| sight.disks()),
    })
}

/// The factor by the rows that the solve has read.
fn of_solve(renderer: &Renderer, prepared: &Prepared, from: &[SideId], to: &[SideId]) -> f64 {
    let (patches, placed, factors) = (
        &prepared.patches,
        renderer.placed(),
        renderer.form_factors(),
    );
    let (mut area, mut exchange) = (0.0, 0.0);
    for side in from {
        let own = f64::from(patches.area(placed, &patches.sides[*side]));
        let row = factors.row(*side);
        let seen = row
            .iter()
            .filter(|(other, _)| to.binary_search(other).is_ok());
        area += own;
        exchange += own * seen.fold(0.0, |sum, (_, factor)| sum + f64::from(*factor));
    }
    if area > 0.0 { exchange / area } else { 0.0 }
}

/// Judges what an estimator found.
fn estimate(by: FactorMethod, both: [FoundFactors; 2], areas: [f64; 2]) -> FactorEstimate {
    let error = |found: &FoundFactors| match by {
        FactorMethod::Solve => deviation(&found.values),
        // Where no sample meets the other end, one might have.
        FactorMethod::Cosine | FactorMethod::Hemicube | FactorMethod::Plane => {
            mean(&found.values).1.max(1.0 / found.rays.max(1) as f64)
        }
        FactorMethod::Contour | FactorMethod::Points | FactorMethod::Disks => mean(&found.values).1,
    };
    let errors = both.each_ref().map(error);
    let factors = both.each_ref().map(|found| mean(&found.values).0);
    let exchange = [0, 1].map(|end| areas[end] * factors[end]);
    let spread = [0, 1].map(|end| areas[end] * errors[end]);
    let bias: f64 = [0, 1].map(|end| areas[end] * both[end].bias).iter().sum();
    let allowed = STUDENT * spread[0].hypot(spread[1]) + bias + ROUNDING * exchange[0].abs();
    FactorEstimate {
        by,
        factor: factors[0],
        error: errors[0],
        bias: both[0].bias,
        back: factors[1],
        back_error: errors[1],
        back_bias: both[1].bias,
        exchange: exchange[0],
        back_exchange: exchange[1],
        reciprocal: (exchange[0] - exchange[1]).abs() <= allowed,
        rays: both.iter().map(|found| found.rays).sum(),
    }
}

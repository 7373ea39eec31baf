//! Direct light past occluders, against closed forms: behind an edge, through a slit and a hole, and in the umbra.
//!
//! The receiver is a point below a parallel square emitter, and the edges of the occluders are parallel to the emitter's: they
//! leave a rectangle of it in sight, whose factor is that of Howell's catalogue ([`known::point_to_rectangle`]). So a penumbra
//! has a formula. Every estimator of direct light is held to it: the visible fragments of
//! [`formfactor::visible`](crate::formfactor::visible), to rounding; light samples; and the three sets of hemisphere samples.
//! In the umbra none may find any light at all. Past a thicket of triangles, which has no formula, the fragments are the oracle
//! of the samples.

use super::estimator::{EXACT, Estimator, Found};
use super::known;
use super::shapes::{ROUGH, speck};
use super::table::TableLine;
use super::traced;
use crate::compare::repeated;
use crate::error::Result;
use crate::formfactor::Set;
use crate::formfactor::bsp::BspTree;
use crate::formfactor::visible::visible_factor;
use glam::{DVec3, Vec3};

/// Half the emitter's edge, and its height above the receiver.
const HALF: f64 = 1.0;
const HEIGHT: f64 = 2.0;

/// The height of the occluders: half way, so that a penumbra is as wide as the emitter.
const BETWEEN: f64 = 1.0;

/// How far a half plane goes on.
const FAR: f64 = 16.0;

/// Light samples of the receiver: many, so that a wrong share stands out from their error.
const LIGHT_SAMPLES: usize = 1024;

/// Cosine samples are one in so many of what unoccluded factors take: tables of more take longer to make than to trace.
const THIN: usize = 4;

/// Light samples are computed in 32 bits.
const SINGLE: f64 = 1e-5;

/// Triangles of the thicket.
const THICKET: u32 = 24;

/// A receiver at the origin, which looks up at the emitter past some occluders.
struct Shadow {
    name: String,
    /// Flat convex occluders.
    occluders: Vec<Vec<DVec3>>,
    /// The factor to what is seen; `None` where only the fragments tell.
    expected: Option<f64>,
}

/// A rectangle in a plane of constant height, its corners counter-clockwise seen from below.
fn rectangle(x: [f64; 2], y: [f64; 2], z: f64) -> Vec<DVec3> {
    let corners = [(x[0], y[0]), (x[0], y[1]), (x[1], y[1]), (x[1], y[0])];
    corners.map(|(x, y)| DVec3::new(x, y, z)).to_vec()
}

/// The factor from the origin, looking up, to the part of the emitter within these bounds.
fn seen(x: [f64; 2], y: [f64; 2]) -> f64 {
    let corner = |x: f64, y: f64| {
        let factor = known::point_to_rectangle(x.abs(), y.abs(), HEIGHT);
        factor * x.signum() * y.signum()
    };
    let within = |b: [f64; 2]| b.map(|at| at.clamp(-HALF, HALF));
    let ([a, b], [c, d]) = (within(x), within(y));
    corner(b, d) - corner(a, d) - corner(b, c) + corner(a, c)
}

/// Where an occluder's edge appears on the emitter.
fn appears(at: f64) -> f64 {
    at * HEIGHT / BETWEEN
}

/// The emitter.
fn lamp() -> Vec<DVec3> {
    rectangle([-HALF, HALF], [-HALF, HALF], HEIGHT)
}

/// A plate at the occluders' height.
fn plate(x: [f64; 2], y: [f64; 2]) -> Vec<DVec3> {
    rectangle(x, y, BETWEEN)
}

/// All cases. No number is one of another's halves, so that nothing is right by symmetry.
fn shadows() -> Vec<Shadow> {
    let (all, far) = ([-FAR, FAR], FAR);
    let mut shadows = Vec::new();
    // From full light to the umbra, the edge hides more and more.
    for edge in [0.7, 0.31, 0.13, -0.08, -0.29] {
        shadows.push(Shadow {
            name: format!("behind an edge at {edge}"),
            occluders: vec![plate([edge, far], all)],
            expected: Some(seen([-far, appears(edge)], all)),
        });
    }
    for [from, to] in [[-0.17, 0.11], [0.23, 0.29], [-0.9, -0.41]] {
        shadows.push(Shadow {
            name: format!("through a slit, {from} to {to}"),
            occluders: vec![plate([-far, from], all), plate([to, far], all)],
            expected: Some(seen([from, to].map(appears), all)),
        });
    }
    let (x, y) = ([-0.3, 0.12], [0.07, 0.44]);
    shadows.push(Shadow {
        name: "through a hole".into(),
        occluders: vec![
            plate([-far, x[0]], all),
            plate([x[1], far], all),
            plate(x, [-far, y[0]]),
            plate(x, [y[1], far]),
        ],
        expected: Some(seen(x.map(appears), y.map(appears))),
    });
    shadows.push(Shadow {
        name: "umbra behind a plate".into(),
        occluders: vec![plate([-0.61, 0.57], [-0.55, 0.63])],
        expected: Some(0.0),
    });
    // Each hides a part, and both the whole.
    shadows.push(Shadow {
        name: "umbra of two plates".into(),
        occluders: vec![
            plate([-far, -0.04], all),
            rectangle([-0.03, far], all, 0.5 * BETWEEN),
        ],
        expected: Some(0.0),
    });
    shadows.push(Shadow {
        name: "past a thicket of triangles".into(),
        occluders: thicket(),
        expected: None,
    });
    shadows
}

/// Triangles that cross one another between the receiver and the emitter, always the same.
fn thicket() -> Vec<Vec<DVec3>> {
    let number = |k: u32| f64::from(crate::formfactor::sobol::scatter(k)) / f64::from(u32::MAX);
    let corner = |k: u32| {
        let [x, y, z] = [0, 1, 2].map(|axis| number(3 * k + axis));
        DVec3::new(1.2 * x - 0.6, 1.2 * y - 0.6, 0.5 + 0.9 * z)
    };
    let small = |k: u32| {
        let middle = corner(4 * k);
        let beside = |j| middle + (corner(4 * k + j) - DVec3::Z) * 0.4;
        vec![beside(1), beside(2), beside(3)]
    };
    (0..THICKET).map(small).collect()
}

impl Shadow {
    /// What the fragments of the emitter come to.
    fn by_fragments(&self) -> f64 {
        let polygons = [&[lamp()], &self.occluders[..]].concat();
        let tree = BspTree::build(&polygons);
        visible_factor(&tree, DVec3::ZERO, DVec3::Z, 0, &polygons[0])
    }

    /// What is expected of samples.
    fn expected(&self) -> f64 {
        self.expected.unwrap_or_else(|| self.by_fragments())
    }

    /// The receiver, the emitter and all occluders as meshes.
    fn meshes(&self) -> Vec<Vec<[Vec3; 3]>> {
        let fan = |polygon: &Vec<DVec3>| -> Vec<[Vec3; 3]> {
            let corner = |k: usize| polygon[k].as_vec3();
            let all = 1..polygon.len() - 1;
            all.map(|k| [corner(0), corner(k), corner(k + 1)]).collect()
        };
        let occluders: Vec<[Vec3; 3]> = self.occluders.iter().flat_map(fan).collect();
        vec![speck(), fan(&lamp()), occluders]
    }

    /// Judges what samples found. In the umbra not one may see the emitter.
    fn judged(&self, found: &Found<Vec<f64>>, rounding: f64) -> TableLine {
        let expected = self.expected();
        let line = found.line(&self.name, expected, rounding, 1.0, |f| f[1]);
        match expected > 0.0 {
            true => line,
            false => TableLine::new(&self.name, &line.estimator, 0.0, line.got, 0.0, 0.0),
        }
    }
}

/// What the fragments make of every case with a formula.
pub fn of_fragments() -> Vec<TableLine> {
    let known = shadows();
    let known = known.iter().filter_map(|s| Some((s, s.expected?)));
    let line = |(shadow, expected): (&Shadow, f64)| {
        let allowed = if expected > 0.0 { EXACT } else { 0.0 };
        let got = shadow.by_fragments();
        TableLine::new(&shadow.name, "fragments", expected, got, 0.0, allowed)
    };
    known.map(line).collect()
}

/// What light samples make of every case.
pub fn of_light_samples() -> Result<Vec<TableLine>> {
    let line = |shadow: &Shadow| {
        let values = traced::light(&shadow.meshes(), LIGHT_SAMPLES)?;
        let expected = shadow.expected();
        let (got, error) = repeated::mean(&values);
        let allowed = match expected > 0.0 {
            true => repeated::STUDENT * error + SINGLE + ROUGH * expected,
            false => 0.0,
        };
        let by = format!("light {LIGHT_SAMPLES}");
        Ok(TableLine::new(
            &shadow.name,
            &by,
            expected,
            got,
            error,
            allowed,
        ))
    };
    shadows().iter().map(line).collect()
}

/// What an estimator that draws hemisphere samples makes of every case; others see no occluders.
pub fn lines(estimator: Estimator) -> Result<Vec<TableLine>> {
    lines_of(estimator, &shadows())
}

/// What it makes of some cases.
fn lines_of(estimator: Estimator, shadows: &[Shadow]) -> Result<Vec<TableLine>> {
    let Some(set) = estimator.set() else {
        return Ok(Vec::new());
    };
    // A grid's bias is bounded for convex shapes alone: past a thicket only scrambled samples are judged.
    let scrambled = matches!(set, Set::Cosine(_));
    let set = if scrambled { set.thinned(THIN) } else { set };
    let estimator = Estimator::Sampled(set);
    let judged = shadows.iter().filter(|s| scrambled || s.expected.is_some());
    let line = |shadow: &Shadow| {
        let found = estimator.find_of_meshes(set, &shadow.meshes())?;
        Ok(shadow.judged(&found, ROUGH * shadow.expected()))
    };
    judged.map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half the emitter has half its factor, and the cases run from light to darkness.
    #[test]
    fn expected_values_are_shares_of_the_whole() {
        let whole = seen([-1.0, 1.0], [-1.0, 1.0]);
        assert!((whole - 4.0 * known::point_to_rectangle(1.0, 1.0, 2.0)).abs() < 1e-15);
        assert!((seen([-1.0, 0.0], [-9.0, 9.0]) - whole / 2.0).abs() < 1e-15);
        let edges: Vec<f64> = shadows()[..5].iter().filter_map(|s| s.expected).collect();
        assert!(edges[0] == whole && edges.is_sorted_by(|a, b| a > b) && edges[4] > 0.0);
        // Neither open nor closed.
        let thicket = shadows().pop().expect("a thicket").by_fragments();
        assert!(
            0.2 * whole < thicket && thicket < 0.8 * whole,
            "{thicket} of {whole}"
        );
    }

    #[test]
    fn fragments_are_exact() {
        let lines = of_fragments();
        assert_eq!(lines.len(), 11);
        for line in lines {
            assert!(line.pass, "{line:?}");
        }
    }

    #[test]
    fn samples_find_penumbrae_and_no_light_in_the_umbra() {
        let mut lines = of_light_samples().expect("light samples");
        // An edge, a slit and an umbra for each set; `validate` has them all.
        let all = shadows();
        let few: Vec<Shadow> = all.into_iter().skip(3).step_by(3).collect();
        for estimator in Estimator::all() {
            lines.extend(lines_of(estimator, &few).expect("hemisphere samples"));
        }
        assert_eq!(lines.len(), 12 + 3 * few.len());
        for line in &lines {
            assert!(line.pass, "{line:?}");
            // A wrong share would be noticed: of scrambled samples one that is 3 % off, or 1 % of the whole emitter.
            let exact = line.estimator.starts_with("light") || line.estimator.starts_with("cosine");
            let notices = (0.03 * line.expected).max(0.01 * seen([-1.0, 1.0], [-1.0, 1.0]));
            assert!(!exact || line.allowed < notices, "{line:?}");
        }
    }
}

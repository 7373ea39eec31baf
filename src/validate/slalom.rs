//! SLALOM: an empty box with six different walls, whose radiosities two independent programs agree on.
//!
//! Gustafson, Rover, Elbert, Carter 1990, "The design of a scalable, fixed-time computer benchmark", Journal of Parallel
//! and Distributed Computing 12(4):388–401. n patches are dealt out to the faces by area, the largest remainders rounded
//! up; a face is cut into about square patches: into round(√(patches · width/height)) strips of equal width, each of
//! them into patches of equal height, their numbers growing as evenly as whole numbers can. So a strip may hold one
//! patch fewer than the next, which is how any n has a tiling: at n = 54 face 1 has strips of 3, 3, 3 and 2.

use super::estimator::{Estimator, Found};
use super::shapes::Patch;
use super::table::TableLine;
use crate::error::Result;
use crate::formfactor::rectangles::Rectangle;
use crate::solver::dense;
use glam::DVec3;

/// Edges of the box in metres.
pub const BOX: [f64; 3] = [13.5, 9.0, 8.0];

/// Reflectance of faces 1 to 6.
pub const REFLECTANCE: [DVec3; 6] = [
    DVec3::new(0.80, 0.80, 0.80),
    DVec3::new(0.99, 0.01, 0.01),
    DVec3::new(0.54, 0.54, 0.54),
    DVec3::new(0.84, 0.84, 0.84),
    DVec3::new(0.01, 0.01, 0.99),
    DVec3::new(0.84, 0.84, 0.84),
];

/// Emitted radiosity of face 1.
pub const EMISSION: DVec3 = DVec3::splat(1.27);

/// Published area means of the faces.
struct SlalomSolution {
    patches: usize,
    red: [f64; 6],
    green: Option<[f64; 6]>,
    /// Half a unit of the last digit.
    rounding: f64,
}

/// The solutions.
const SOLUTIONS: [SlalomSolution; 3] = [
    SlalomSolution {
        patches: 6,
        red: [
            1.73185667, 0.82378659, 0.47228717, 0.72765026, 0.00914078, 0.69179332,
        ],
        green: Some([
            1.53095004, 0.00660003, 0.32985032, 0.51865355, 0.00660003, 0.48315572,
        ]),
        rounding: 5e-9,
    },
    SlalomSolution {
        patches: 54,
        red: [1.767212, 0.901626, 0.485246, 0.741003, 0.008687, 0.721236],
        green: None,
        rounding: 5e-7,
    },
    SlalomSolution {
        patches: 180,
        red: [1.774627, 0.905806, 0.485792, 0.740395, 0.008642, 0.723909],
        green: None,
        rounding: 5e-7,
    },
];

/// Published factors between whole faces: from, to, factor.
const FACTORS: [(usize, usize, f64); 11] = [
    (1, 2, 0.1407632936),
    (1, 3, 0.2153771039),
    (1, 4, 0.2877192049),
    (2, 1, 0.2375380580),
    (2, 3, 0.2121514948),
    (2, 4, 0.2375380580),
    (2, 5, 0.1006208944),
    (3, 1, 0.2422992419),
    (3, 2, 0.1414343299),
    (3, 5, 0.1414343299),
    (3, 6, 0.2325328564),
];

/// Solved until no radiosity changes by more than this in a sweep: a hundredth of the last published digit.
const TOLERANCE: f64 = 1e-11;

/// Beyond so many patches estimators by quadrature take a quarter of the points in each direction: patches are smaller.
const MANY: usize = 20;

/// A strip of a face: patches of equal size, one above the other.
#[derive(Clone, Copy, Debug)]
pub struct Strip {
    /// The face, from 0.
    pub face: usize,
    /// From where to where it reaches along the face's first axis, in metres.
    pub span: [f64; 2],
    /// How many patches it holds, over the whole of the face's second axis.
    pub patches: usize,
}

/// The axis that a face stands across, and the two that it spans; faces 1 to 3 stand at 0, 4 to 6 at the far end.
pub fn axes(face: usize) -> [usize; 3] {
    [(face + 2) % 3, face % 3, (face + 1) % 3]
}

/// How many of n patches each face gets.
pub fn deal(n: usize) -> [usize; 6] {
    let area = |face: usize| BOX[axes(face)[1]] * BOX[axes(face)[2]];
    let all: f64 = (0..6).map(area).sum();
    let fair: [f64; 6] = std::array::from_fn(|face| n as f64 * area(face) / all);
    let mut dealt = fair.map(|share| share.floor() as usize);
    let mut order = [0, 1, 2, 3, 4, 5];
    order.sort_by(|a, b| (fair[*b] % 1.0).total_cmp(&(fair[*a] % 1.0)));
    let left = n - dealt.iter().sum::<usize>();
    order[..left].iter().for_each(|face| dealt[*face] += 1);
    dealt
}

/// The strips of all faces for n patches.
pub fn strips(n: usize) -> Vec<Strip> {
    let mut strips = Vec::new();
    for (face, patches) in deal(n).into_iter().enumerate() {
        let [_, u, v] = axes(face);
        let count = (patches as f64 * BOX[u] / BOX[v]).sqrt().round() as usize;
        let count = count.clamp(1, patches.max(1));
        let until = |strip: usize| (strip * patches).div_ceil(count);
        for strip in 0..count {
            strips.push(Strip {
                face,
                span: [strip, strip + 1].map(|s| BOX[u] * s as f64 / count as f64),
                patches: until(strip + 1) - until(strip),
            });
        }
    }
    strips
}

/// The patches of a strip, with their fronts inside the box.
pub fn tiles(strip: &Strip) -> Vec<Rectangle> {
    let [axis, u, v] = axes(strip.face);
    let far = strip.face >= 3;
    let height = |k: usize| BOX[v] * k as f64 / strip.patches as f64;
    debug_assert!(u == (axis + 1) % 3 && v == (axis + 2) % 3);
    (0..strip.patches)
        .map(|k| Rectangle {
            axis,
            at: if far { BOX[axis] } else { 0.0 },
            down: far,
            spans: [strip.span, [height(k), height(k + 1)]],
        })
        .collect()
}

/// The box with n patches, and the face of each.
pub fn patches(n: usize) -> (Vec<Patch>, Vec<usize>) {
    let of = |strip: &Strip| {
        let face = strip.face;
        let tiles = tiles(strip).into_iter();
        tiles
            .map(move |tile| (Patch::rectangle(tile), face))
            .collect::<Vec<_>>()
    };
    strips(n).iter().flat_map(of).unzip()
}

/// The radiosity of each patch.
pub fn solve(factors: &[f64], faces: &[usize]) -> Vec<DVec3> {
    let emitted = |face: &usize| if *face == 0 { EMISSION } else { DVec3::ZERO };
    let emission: Vec<DVec3> = faces.iter().map(emitted).collect();
    let reflectance: Vec<DVec3> = faces.iter().map(|face| REFLECTANCE[*face]).collect();
    dense::gauss_seidel(factors, &emission, &reflectance, TOLERANCE)
}

/// Area means over the faces.
pub fn means(patches: &[Patch], faces: &[usize], radiosity: &[DVec3]) -> [DVec3; 6] {
    let mut sums = [(DVec3::ZERO, 0.0); 6];
    for ((patch, face), b) in patches.iter().zip(faces).zip(radiosity) {
        sums[*face].0 += *b * patch.area;
        sums[*face].1 += patch.area;
    }
    sums.map(|(sum, area)| sum / area)
}

/// By how much the mean radiosity of a face may change, in each channel, for light that is off by one part of its range in
/// every row: B′ − B = (1 − ρF′)⁻¹ ρ (H′ − H), and H is taken to change in one direction from the normal to the horizon.
pub fn gains(patches: &[Patch], faces: &[usize], factors: &[f64]) -> [DVec3; 6] {
    let radiosity = solve(factors, faces);
    let most = radiosity.iter().copied().fold(DVec3::ZERO, DVec3::max);
    let least = radiosity.iter().copied().fold(DVec3::MAX, DVec3::min);
    let reflectance: Vec<DVec3> = faces.iter().map(|face| REFLECTANCE[*face]).collect();
    let kept = dense::gauss_seidel(factors, &reflectance, &reflectance, TOLERANCE);
    means(patches, faces, &kept).map(|kept| kept * (most - least))
}

/// An estimator with the effort that so many patches need.
pub fn thrifty(estimator: Estimator, patches: usize) -> Estimator {
    match estimator {
        Estimator::Points(n) if patches > MANY => Estimator::Points(n / 4),
        Estimator::Disks(n) if patches > MANY => Estimator::Disks(n / 4),
        Estimator::Sampled(set) if patches > MANY => Estimator::Sampled(set.thinned(16)),
        other => other,
    }
}

/// Factors between whole faces, and the solutions for n = 6, 54 and 180.
pub fn lines(estimator: Estimator) -> Result<Vec<TableLine>> {
    let mut lines = Vec::new();
    for solution in &SOLUTIONS {
        lines.extend(solution_lines(estimator, solution)?);
    }
    Ok(lines)
}

/// The published factors at n = 6.
fn factor_lines(found: &Found<Vec<f64>>) -> Vec<TableLine> {
    let line = |(from, to, expected): (usize, usize, f64)| {
        let at = 6 * (from - 1) + to - 1;
        let name = format!("SLALOM 6: factor {from} → {to}");
        found.line(&name, expected, 0.0, 1.0, |f| f[at])
    };
    FACTORS.map(line).to_vec()
}

/// A published solution, face by face.
fn solution_lines(estimator: Estimator, solution: &SlalomSolution) -> Result<Vec<TableLine>> {
    // Solve with what the estimator finds.
    let n = solution.patches;
    let estimator = thrifty(estimator, n);
    let (patches, faces) = patches(n);
    let found = estimator.find(&patches)?;
    let solved = found.map(|factors| means(&patches, &faces, &solve(factors, &faces)));
    let gains = gains(&patches, &faces, &found.all[0]);
    // Compare; the box is its own mirror image, so blue is red with faces 2 and 5 exchanged where a face is one patch.
    let mut blue = solution.red;
    blue.swap(1, 4);
    let channels = [
        ("red", Some(solution.red)),
        ("green", solution.green),
        ("blue", solution.green.map(|_| blue)),
    ];
    let mut lines = if n == 6 {
        factor_lines(&found)
    } else {
        Vec::new()
    };
    for (channel, (color, expected)) in channels.into_iter().enumerate() {
        for (face, expected) in expected.into_iter().flatten().enumerate() {
            let name = format!("SLALOM {n}: {color} of face {}", face + 1);
            let gain = gains[face][channel];
            lines.push(solved.line(&name, expected, solution.rounding, gain, |b| {
                b[face][channel]
            }));
        }
    }
    Ok(lines)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formfactor::Set;

    /// Every n has its patches, and they fill the box.
    #[test]
    fn tilings_are_whole() {
        let area = 2.0 * (13.5 * 9.0 + 9.0 * 8.0 + 8.0 * 13.5);
        for n in [6, 7, 11, 54, 179, 180, 720] {
            let (patches, faces) = patches(n);
            assert_eq!((patches.len(), faces.len()), (n, n));
            let sum: f64 = patches.iter().map(|p| p.area).sum();
            assert!((sum - area).abs() < 1e-9, "{n}: {sum}");
        }
        assert_eq!(deal(54), [11, 6, 10, 11, 6, 10]);
        assert_eq!(deal(180), [36, 22, 32, 36, 22, 32]);
        let of_first: Vec<usize> = strips(54)
            .iter()
            .filter(|s| s.face == 0)
            .map(|s| s.patches)
            .collect();
        assert_eq!(of_first, [3, 3, 3, 2]);
    }

    /// n = 6 to 5e-9, n = 54 and 180 to all published digits, by the contour integral and by the closed form.
    #[test]
    fn exact_factors_have_the_published_radiosities() {
        for estimator in [Estimator::Contour, Estimator::Rectangles] {
            for line in lines(estimator).expect("lines") {
                assert!(line.pass && line.allowed < 1e-6, "{line:?}");
            }
        }
    }

    #[test]
    fn samples_have_them_within_their_error() {
        for set in [Set::Cosine(1024), Set::Hemicube(16), Set::Plane(256)] {
            for line in lines(Estimator::Sampled(set)).expect("lines") {
                assert!(line.pass, "{line:?}");
            }
        }
    }
}

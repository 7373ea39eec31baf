//! SLALOM's race: the largest n whose box is solved within a time, from nothing to the radiosities, on all cores.
//!
//! Gustafson, Rover, Elbert, Carter 1990 (see [`slalom`]). The rows are analytic. A strip against a
//! strip needs G of [`rectangles`] only where two patches' ends meet: four values a pair of patches instead of sixteen. By
//! reciprocity each pair of faces is stored once, in 64 bits. The rules ask for every patch's radiosity in three channels.

use super::slalom::{self, Strip, axes};
use crate::error::{Error, Result};
use crate::formfactor::rectangles;
use crate::sequence::observer::Event;
use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;
use std::f64::consts::TAU;
use std::time::Instant;

/// The first n: large enough to be timed, small against a second.
const FIRST: usize = 2_000;

/// The factors may fill so many bytes: 6 GiB, which is n = 43,000 about.
const MOST_BYTES: f64 = 6.0 * 1024.0 * 1024.0 * 1024.0;

/// Five pairs of faces out of twelve hold n² factors: no face sees itself, and each pair is stored once.
const BYTES_A_PAIR: f64 = 8.0 * 5.0 / 12.0;

/// The share of the time to aim at: times vary by some percent.
const AIM: f64 = 0.95;

/// How many times to aim again.
const ATTEMPTS: usize = 4;

/// Solved until no radiosity changes by more than this in a sweep; the rules ask for less.
const TOLERANCE: f64 = 1e-9;

/// What may be missing of the light that is emitted: the tolerance in every patch.
const BALANCED: f64 = 1e-7;

/// Sweeps beyond which nothing is gained: the brightest face reflects 0.99, but no light stays with it.
const MOST_SWEEPS: usize = 1_000;

/// What came of it.
#[derive(Clone, Debug, Serialize)]
pub struct Race {
    /// Patches.
    pub n: usize,
    /// Seconds that were given.
    pub limit: f64,
    /// Seconds that setting up the factors took.
    pub setup: f64,
    /// Seconds of the solve.
    pub solve: f64,
    /// Sweeps of the solve.
    pub sweeps: usize,
    /// Area means of the radiosity on faces 1 to 6, RGB.
    pub means: [[f64; 3]; 6],
    /// What is absorbed over what is emitted, less 1: the worst channel.
    pub imbalance: f64,
    /// Whether memory, not time, was the limit.
    pub memory_bound: bool,
    /// Threads that worked.
    pub threads: usize,
}

/// The exchange between two faces: patches of the first × patches of the second, in m².
struct Block {
    faces: [usize; 2],
    exchange: Vec<f64>,
}

/// One side of the box: its strips, where each one's patches begin, and their areas.
struct Face {
    strips: Vec<Strip>,
    start: Vec<usize>,
    area: Vec<f64>,
}

/// The largest n found within `seconds`.
pub fn race(seconds: f64, watch: &(dyn Fn(Event) + Sync)) -> Race {
    let most = (MOST_BYTES / BYTES_A_PAIR).sqrt() as usize;
    let told = |n: usize| {
        watch(Event::Stage {
            name: &format!("SLALOM n = {n}"),
            total: 15,
        });
        run(n, seconds, watch)
    };
    let mut best: Option<Race> = None;
    let mut n = FIRST;
    for _ in 0..ATTEMPTS {
        let now = told(n);
        let took = now.setup + now.solve;
        let better = best.as_ref().is_none_or(|best| now.n > best.n);
        // The first run counts even when the time was too short for it, or there would be no answer.
        if best.is_none() || took <= seconds && better {
            best = Some(now);
        }
        // Time grows as n². Do not extrapolate beyond eight times the run at once.
        let next = (n as f64 * (AIM * seconds / took).sqrt().min(8.0)) as usize;
        let next = next.clamp(6, most);
        let won = best.as_ref().map_or(0, |best| best.n);
        let close = next.abs_diff(won) * 50 < won && took <= seconds;
        if close {
            break;
        }
        n = next;
    }
    let mut best = best.unwrap_or_else(|| told(6));
    best.memory_bound = best.n == most;
    best
}

/// Solves the box with n patches.
pub fn run(n: usize, limit: f64, watch: &(dyn Fn(Event) + Sync)) -> Race {
    let start = Instant::now();
    let faces = faces(n);
    let blocks: Vec<Block> = (0..6)
        .flat_map(|p| (p + 1..6).map(move |q| [p, q]))
        .map(|pair| {
            let block = block(&faces, pair);
            watch(Event::Advance(1));
            block
        })
        .collect();
    let setup = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let (radiosity, incident, sweeps) = solve(&faces, &blocks);
    let solve = start.elapsed().as_secs_f64();

    // Sum up the faces, and what they absorb.
    let mut absorbed = DVec3::ZERO;
    let means = std::array::from_fn(|f| {
        let area = &faces[f].area;
        let total: f64 = area.iter().sum();
        let mean = |light: &[DVec3]| -> DVec3 {
            light.iter().zip(area).map(|(b, a)| *b * *a).sum::<DVec3>() / total
        };
        absorbed += (DVec3::ONE - slalom::REFLECTANCE[f]) * mean(&incident[f]) * total;
        mean(&radiosity[f]).to_array()
    });
    let emitted = slalom::EMISSION * faces[0].area.iter().sum::<f64>();
    Race {
        n,
        limit,
        setup,
        solve,
        sweeps,
        means,
        imbalance: (absorbed / emitted - DVec3::ONE).abs().max_element(),
        memory_bound: false,
        threads: rayon::current_num_threads(),
    }
}

fn faces(n: usize) -> [Face; 6] {
    let strips = slalom::strips(n);
    std::array::from_fn(|face| {
        let mine: Vec<Strip> = strips.iter().copied().filter(|s| s.face == face).collect();
        let height = slalom::BOX[axes(face)[2]];
        let mut start = vec![0];
        let mut area = Vec::new();
        for strip in &mine {
            let each = (strip.span[1] - strip.span[0]) * height / strip.patches as f64;
            area.extend(std::iter::repeat_n(each, strip.patches));
            start.push(area.len());
        }
        Face {
            strips: mine,
            start,
            area,
        }
    })
}

/// The exchange between all patches of two faces, a strip of the first at a time, in parallel.
fn block(faces: &[Face; 6], pair: [usize; 2]) -> Block {
    let [p, q] = pair.map(|face| &faces[face]);
    let columns = q.area.len();
    let mut exchange = vec![0.0; p.area.len() * columns];
    let mut rest = &mut exchange[..];
    let mut work = Vec::new();
    for strip in &p.strips {
        let (mine, others) = rest.split_at_mut(strip.patches * columns);
        work.push((strip, mine));
        rest = others;
    }
    work.into_par_iter().for_each(|(strip, into)| {
        for (other, first) in q.strips.iter().zip(&q.start) {
            strips(strip, other, into, columns, *first);
        }
    });
    Block {
        faces: pair,
        exchange,
    }
}

/// The exchange between the patches of two strips.
fn strips(p: &Strip, q: &Strip, into: &mut [f64], columns: usize, first: usize) {
    let corner = corners(p, q);
    let line = |j: usize| (0..=q.patches).map(move |l| (j, l));
    let mut last: Vec<f64> = line(0).map(|(j, l)| corner(j, l)).collect();
    for j in 0..p.patches {
        let next: Vec<f64> = line(j + 1).map(|(j, l)| corner(j, l)).collect();
        let row = &mut into[j * columns + first..j * columns + first + q.patches];
        for (l, exchange) in row.iter_mut().enumerate() {
            let sum = (last[l] + next[l + 1]) - (last[l + 1] + next[l]);
            *exchange = sum.abs() / TAU;
        }
        last = next;
    }
}

/// G summed over the four ends of the two strips' widths, as a function of the j-th end of a patch of `p` and the l-th
/// of `q`: the second difference over both is the exchange, but for its sign.
fn corners<'a>(p: &'a Strip, q: &'a Strip) -> Box<dyn Fn(usize, usize) -> f64 + 'a> {
    let ([across_p, u_p, v_p], [across_q, u_q, v_q]) = (axes(p.face), axes(q.face));
    let end_p = move |j: usize| slalom::BOX[v_p] * j as f64 / p.patches as f64;
    let end_q = move |l: usize| slalom::BOX[v_q] * l as f64 / q.patches as f64;
    let [a, b] = p.span;
    let [c, d] = q.span;
    if across_p == across_q {
        let apart = slalom::BOX[across_p];
        return Box::new(move |j, l| {
            let y = end_p(j) - end_q(l);
            let g = |x: f64| rectangles::parallel(x, y, apart);
            (g(a - c) + g(b - d)) - (g(a - d) + g(b - c))
        });
    }
    // Distances from the line in which the planes meet, or along it.
    let at = |face: usize| {
        if face >= 3 {
            slalom::BOX[axes(face)[0]]
        } else {
            0.0
        }
    };
    let (plane_p, plane_q) = (at(p.face), at(q.face));
    let g = rectangles::perpendicular;
    let from_p = move |y: f64| (y - plane_q).abs();
    let from_q = move |y: f64| (y - plane_p).abs();
    // Which of the two axes of each face runs along that line?
    if v_p == across_q && u_q == across_p {
        // The first one of p and the second one of q.
        debug_assert_eq!(u_p, v_q);
        Box::new(move |j, l| {
            let (x, y) = (from_p(end_p(j)), end_q(l));
            let (near, far) = (from_q(c), from_q(d));
            (g(a - y, x, near) + g(b - y, x, far)) - (g(a - y, x, far) + g(b - y, x, near))
        })
    } else {
        // The second one of p and the first one of q.
        debug_assert!(u_p == across_q && v_q == across_p && v_p == u_q);
        Box::new(move |j, l| {
            let (y, z) = (end_p(j), from_q(end_q(l)));
            let (near, far) = (from_p(a), from_p(b));
            (g(y - c, near, z) + g(y - d, far, z)) - (g(y - c, far, z) + g(y - d, near, z))
        })
    }
}

/// Radiosity and incident light of every patch, face after face, and the sweeps it took: Gauss and Seidel's iteration
/// over whole faces, none of which sees itself.
fn solve(faces: &[Face; 6], blocks: &[Block]) -> ([Vec<DVec3>; 6], [Vec<DVec3>; 6], usize) {
    let emission = |f: usize| {
        if f == 0 {
            slalom::EMISSION
        } else {
            DVec3::ZERO
        }
    };
    let mut radiosity: [Vec<DVec3>; 6] =
        std::array::from_fn(|f| vec![emission(f); faces[f].area.len()]);
    let mut incident = radiosity.clone();
    for sweep in 1..=MOST_SWEEPS {
        let mut step = 0.0f64;
        for f in 0..6 {
            let mut sums = vec![DVec3::ZERO; faces[f].area.len()];
            for block in blocks {
                let [p, q] = block.faces;
                if p == f {
                    gather(block, &radiosity[q], &mut sums);
                } else if q == f {
                    scatter(block, &radiosity[p], &mut sums);
                }
            }
            for (i, (sum, area)) in sums.into_iter().zip(&faces[f].area).enumerate() {
                incident[f][i] = sum / *area;
                let new = emission(f) + slalom::REFLECTANCE[f] * incident[f][i];
                step = step.max((new - radiosity[f][i]).abs().max_element());
                radiosity[f][i] = new;
            }
        }
        if step <= TOLERANCE {
            return (radiosity, incident, sweep);
        }
    }
    (radiosity, incident, MOST_SWEEPS)
}

/// Adds what each patch of the first face receives from the second.
fn gather(block: &Block, light: &[DVec3], sums: &mut [DVec3]) {
    let rows = block.exchange.par_chunks(light.len());
    sums.par_iter_mut().zip(rows).for_each(|(sum, row)| {
        *sum += row.iter().zip(light).map(|(k, b)| *b * *k).sum::<DVec3>();
    });
}

/// Adds what each patch of the second face receives from the first: columns in ranges, each walked row by row.
fn scatter(block: &Block, light: &[DVec3], sums: &mut [DVec3]) {
    const RANGE: usize = 256;
    let columns = sums.len();
    let ranges = sums.par_chunks_mut(RANGE).enumerate();
    ranges.for_each(|(range, sums)| {
        for (row, b) in block.exchange.chunks(columns).zip(light) {
            let row = &row[range * RANGE..];
            for (sum, k) in sums.iter_mut().zip(row) {
                *sum += *b * *k;
            }
        }
    });
}

impl Race {
    /// An error where the time was too short for the smallest box, or the light is not in balance.
    pub fn check(&self) -> Result<()> {
        let took = self.setup + self.solve;
        let (expected, got) = if took > self.limit {
            (
                format!("{} patches within {} s", self.n, self.limit),
                format!("{took:.2} s"),
            )
        } else if self.imbalance.is_nan() || self.imbalance > BALANCED {
            (
                format!("as much absorbed as emitted, within {BALANCED:e}"),
                format!("{:e} more or less", self.imbalance),
            )
        } else {
            return Ok(());
        };
        Err(Error::Unproven {
            case: "SLALOM".into(),
            expected,
            got,
            way_out: "give more time with --slalom SECONDS".into(),
        })
    }

    /// The result in words.
    pub fn text(&self) -> String {
        let mut text = format!(
            "SLALOM: {} patches in {:.1} s of {} s on {} threads ({:.1} s for the factors, {:.1} s for {} sweeps)\n",
            self.n,
            self.setup + self.solve,
            self.limit,
            self.threads,
            self.setup,
            self.solve,
            self.sweeps
        );
        if self.memory_bound {
            text += "More would not fit into the memory that is allowed.\n";
        }
        for (face, [red, green, blue]) in self.means.iter().enumerate() {
            text += &format!("face {}  {red:.6} {green:.6} {blue:.6}\n", face + 1);
        }
        text + &format!("absorbed over emitted, less 1: {:.1e}\n", self.imbalance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::silence;
    use crate::validate::Estimator;

    /// The strips' shared corners give the same radiosities as pairwise closed forms, and those published for n = 720
    /// and 2000.
    #[test]
    fn fast_rows_are_the_same_rows() {
        let (patches, faces) = slalom::patches(97);
        let factors = Estimator::Rectangles.factors(&patches).expect("factors");
        let expected = slalom::means(&patches, &faces, &slalom::solve(&factors, &faces));
        let got = run(97, 1.0, &silence);
        for (got, expected) in got.means.iter().zip(expected) {
            let off = (DVec3::from_array(*got) - expected).abs().max_element();
            assert!(off < 1e-8, "{got:?} {expected}");
        }
        for (n, red) in [
            (
                720,
                [1.777436, 0.907495, 0.486087, 0.740553, 0.008622, 0.725101],
            ),
            (
                2000,
                [1.778113, 0.907890, 0.486144, 0.740624, 0.008617, 0.725381],
            ),
        ] {
            let got = run(n, 1.0, &silence);
            for (got, expected) in got.means.iter().zip(red) {
                assert!((got[0] - expected).abs() < 6e-7, "{n}: {got:?} {expected}");
            }
            assert!(got.imbalance < 1e-8, "{}", got.imbalance);
        }
    }
}

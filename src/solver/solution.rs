//! The solution of R = ρ(D + F R), in 64 bits, its residual, and the bound on its error.
//!
//! R = B − E is reflected radiosity, D irradiance straight from emitters, F the form factors. Two vectors are kept: R as far
//! as it has been shot, and H = F R, what each row has received of it. The residual r = ρ(D + H) − R is Cohen's unshot
//! radiosity (1988); it may be negative. It follows from both whenever it is asked for, so that no rounding gathers in it;
//! that needs 64 bits, since r is the small difference of large numbers.
//!
//! The bound: rows of F sum to at most 1, so with q for the largest reflectance R is off by at most max|r| / (1 − q), and
//! ρ(D + F R) by q times as much. A sweep's largest step is such a residual, so gathering has the same bound. Where q is
//! nearly 1 the rows themselves tell a smaller factor (`monotone.rs`).

use super::gather_table::GatherTable;
use super::rows::Rows;
use glam::{DVec3, Vec3, Vec3A};
use rayon::prelude::*;

/// The ambient term takes no mean reflectance for more than this, or it would outshine everything in a white scene.
const MAX_REFLECTANCE: f32 = 0.95;

/// More sweeps than this mean that reflectances of 1 keep all light in the scene; the result is the best so far. Rooms whose
/// only absorber is a lamp take about 20.
pub(super) const MAX_SWEEPS: u32 = 500;

/// Rows whose sums one task adds up; fixed, so that nothing depends on threads.
const CHUNK: usize = 512;

/// The right side of the equation, and each row's weight.
#[derive(Clone, Copy, Debug)]
pub struct System<'a> {
    /// Area; only ratios matter.
    pub area: &'a [f32],
    /// Irradiance D straight from the emitters.
    pub direct: &'a [Vec3],
    /// Reflectance ρ.
    pub reflectance: &'a [Vec3],
}

/// When to stop, whichever comes first.
#[derive(Clone, Copy)]
pub struct StopRule<'a> {
    /// No channel of any row is off by more than this × the rms of R. The error falls geometrically: each halving costs one
    /// or two sweeps more, or about as many shots more.
    pub tolerance: f32,
    /// Shots that are fired at most.
    pub shots: u64,
    /// Whether the time is over.
    pub expired: &'a dyn Fn() -> bool,
}

impl StopRule<'static> {
    /// Stops at the tolerance alone.
    pub fn at(tolerance: f32) -> StopRule<'static> {
        StopRule {
            tolerance,
            shots: u64::MAX,
            expired: &|| false,
        }
    }
}

impl StopRule<'_> {
    /// Whether the tolerance is met or the time is over.
    pub(super) fn reached(&self, residual: &Residual) -> bool {
        residual.bound <= self.tolerance.into() || (self.expired)()
    }
}

/// Course of a solve.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Convergence {
    /// Shots fired.
    pub shots: u64,
    /// Times that all rows were gathered.
    pub sweeps: u32,
    /// Bound on the largest error of any channel of any ρ(D + F R), relative to the rms of R.
    pub residual: f64,
}

impl std::ops::AddAssign for Convergence {
    /// Counts another solve in; the residual is its.
    fn add_assign(&mut self, other: Convergence) {
        self.shots += other.shots;
        self.sweeps += other.sweeps;
        self.residual = other.residual;
    }
}

/// Radiosity that images and the next frame read, in 32 bits.
#[derive(Clone, Debug, Default)]
pub struct Radiosity {
    /// Reflected radiosity R = B − E of each row, followed by zeros for ids of misses.
    pub reflected: Vec<Vec3A>,
    /// Indirect irradiance F R of each row.
    pub indirect: Vec<Vec3>,
    /// Sweeps taken; 0 where light was shot.
    pub sweeps: u32,
    /// Shots fired; 0 where light was gathered.
    pub shots: u64,
    /// Bound on the largest error of any channel of any R, relative to the root mean square of R.
    pub residual: f32,
    /// Irradiance of the ambient term for what was not shot; 0 where light was gathered.
    pub ambient: Vec3,
    /// What uniform irradiance would bring, if it was needed for the bound: where the next search for it starts.
    pub uniform: Solution,
}

/// The solution as far as it is known; also a change of it, or the response to a unit of emission.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Solution {
    /// R of each row as far as it has been shot; never clamped, for negative light is still to be taken back.
    pub shot: Vec<DVec3>,
    /// H = F R of each row.
    pub received: Vec<DVec3>,
}

/// Residual of a solution.
#[derive(Clone, Debug)]
pub struct Residual {
    /// Unshot radiosity r = ρ(D + H) − R of each row.
    pub unshot: Vec<DVec3>,
    /// Root mean square of R, the unshot included.
    pub rms: f64,
    /// Bound on the largest error of any channel of any ρ(D + F R), relative to `rms`.
    pub bound: f64,
    /// Factor by which the largest |r| bounds an error.
    pub(super) scale: f64,
}

impl Solution {
    /// Darkness.
    pub fn dark(rows: usize) -> Solution {
        Solution {
            shot: vec![DVec3::ZERO; rows],
            received: vec![DVec3::ZERO; rows],
        }
    }

    /// The radiosity of an earlier solve, taken for shot, with nothing received yet. Darkness where it has another length,
    /// or where no row reflects direct light: no tolerance relative to the solution would be met on the way down to nothing.
    pub(super) fn after(start: &Radiosity, system: System, misses: usize) -> Solution {
        let rows = system.direct.len();
        let mut solution = Solution::dark(rows);
        if start.reflected.len() == rows + misses && !system.is_dark() {
            let known = solution.shot.iter_mut().zip(&start.reflected);
            known.for_each(|(to, r)| *to = r.as_dvec3());
        }
        solution
    }

    /// Changes the number of rows; new ones are dark.
    pub(super) fn resize(&mut self, rows: usize) {
        self.shot.resize(rows, DVec3::ZERO);
        self.received.resize(rows, DVec3::ZERO);
    }

    /// Adds another solution times a weight for each channel.
    pub(super) fn add(&mut self, other: &Solution, weight: DVec3) {
        let add = |to: &mut [DVec3], of: &[DVec3]| {
            to.iter_mut()
                .zip(of)
                .for_each(|(to, of)| *to += *of * weight);
        };
        add(&mut self.shot, &other.shot);
        add(&mut self.received, &other.received);
    }

    /// Lets rows receive by new hit ids instead of old ones, sample by sample (its number, the old id and the new one), and
    /// rows in `whole` by all of their samples again.
    pub(super) fn follow(
        &mut self,
        rows: &Rows,
        changed: impl Iterator<Item = [u32; 3]>,
        whole: &[u32],
    ) {
        let light = |id: u32| self.shot.get(id as usize).copied().unwrap_or_default();
        for [sample, old, new] in changed {
            let row = sample as usize / rows.stride();
            let more = light(new) - light(old);
            self.received[row] += more * f64::from(rows.share[row]);
        }
        if whole.is_empty() {
            return;
        }
        let table = GatherTable::short(&self.shot);
        let gather = |row: &u32| table.gather(rows, *row as usize);
        let new: Vec<DVec3> = whole.par_iter().with_min_len(64).map(gather).collect();
        for (row, new) in whole.iter().zip(new) {
            self.received[*row as usize] = new;
        }
    }

    /// r = ρ(D + H) − R of a row.
    #[inline]
    pub fn unshot(&self, system: System, row: usize) -> DVec3 {
        let arrives = system.direct[row].as_dvec3() + self.received[row];
        system.reflectance[row].as_dvec3() * arrives - self.shot[row]
    }

    /// Takes a row's unshot radiosity for shot, and returns it.
    #[inline]
    pub(super) fn shoot(&mut self, system: System, row: usize) -> DVec3 {
        let light = self.unshot(system, row);
        self.shot[row] += light;
        light
    }

    /// Residual, with the bound that it puts on the error by the largest reflectance alone.
    pub fn residual(&self, system: System) -> Residual {
        self.residual_by(system, error_scale(system.reflectance))
    }

    /// Residual, with the bound that it puts on the error where no error exceeds the largest |r| times `scale`.
    pub(super) fn residual_by(&self, system: System, scale: f64) -> Residual {
        let mut unshot = vec![DVec3::ZERO; self.shot.len()];
        let look = |(chunk, rows): (usize, &mut [DVec3])| {
            let (mut squares, mut most) = (0.0, 0.0f64);
            for (row, rest) in (chunk * CHUNK..).zip(rows) {
                *rest = self.unshot(system, row);
                squares += (self.shot[row] + *rest).length_squared();
                most = most.max(rest.abs().max_element());
            }
            (squares, most)
        };
        let chunks = unshot.par_chunks_mut(CHUNK).enumerate();
        let chunks: Vec<(f64, f64)> = chunks.map(look).collect();
        let squares: f64 = chunks.iter().map(|(squares, _)| *squares).sum();
        let most = chunks.iter().map(|(_, most)| *most).fold(0.0, f64::max);
        let rms = root_mean_square(squares, unshot.len());
        Residual {
            unshot,
            rms,
            bound: error_bound(most, scale, rms),
            scale,
        }
    }

    /// Irradiance of Cohen's ambient term, which stands in for unshot radiosity until it has been shot.
    ///
    /// Unshot radiosity is taken to spread evenly over all areas and to be reflected for ever by their mean reflectance:
    /// Σ A r / Σ A × (1 + ρ̄ + ρ̄² + …), with ρ̄ = Σ A ρ / Σ A. A dark room beside a bright one glows until that has shot.
    pub fn ambient(&self, system: System) -> Vec3 {
        let (mut area, mut unshot, mut reflectance) = (0.0, DVec3::ZERO, DVec3::ZERO);
        for (row, a) in system.area.iter().enumerate() {
            let a = f64::from(*a);
            area += a;
            unshot += self.unshot(system, row) * a;
            reflectance += system.reflectance[row].as_dvec3() * a;
        }
        ambient(area, unshot, reflectance)
    }

    /// Radiosity ρ(D + H) of each row, the shot and the unshot together.
    pub(super) fn radiosity(
        &self,
        system: System,
        residual: &Residual,
        misses: usize,
        shots: u64,
    ) -> Radiosity {
        let all = self.shot.iter().zip(&residual.unshot);
        let all = all.map(|(shot, rest)| (*shot + *rest).as_vec3a());
        Radiosity {
            reflected: all.chain(vec![Vec3A::ZERO; misses]).collect(),
            indirect: self.received.iter().map(|h| h.as_vec3()).collect(),
            sweeps: 0,
            shots,
            residual: residual.bound as f32,
            ambient: self.ambient(system),
            uniform: Solution::default(),
        }
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        size_of_val(&self.shot[..]) + size_of_val(&self.received[..])
    }
}

impl Residual {
    /// The rows whose error may exceed the tolerance: those that have to shoot.
    pub(super) fn heavy(&self, tolerance: f32) -> impl Iterator<Item = (usize, &DVec3)> {
        let allowed = f64::from(tolerance) * self.rms;
        let rows = self.unshot.iter().enumerate();
        rows.filter(move |(_, r)| r.abs().max_element() * self.scale > allowed)
    }
}

impl System<'_> {
    /// Whether the solution is darkness, since no row reflects direct light.
    pub(super) fn is_dark(&self) -> bool {
        let mut rows = self.direct.iter().zip(self.reflectance);
        rows.all(|(direct, reflectance)| *direct * *reflectance == Vec3::ZERO)
    }
}

/// Irradiance of the ambient term, of Σ A, Σ A r and Σ A ρ over all surfaces.
pub fn ambient(area: f64, unshot: DVec3, reflectance: DVec3) -> Vec3 {
    if area == 0.0 {
        return Vec3::ZERO;
    }
    let mean = (reflectance / area).min(DVec3::splat(MAX_REFLECTANCE.into()));
    (unshot / area / (DVec3::ONE - mean)).as_vec3()
}

/// With q for the largest reflectance q / (1 − q): what max|r| is multiplied by to bound the error.
pub(super) fn error_scale(reflectance: &[Vec3]) -> f64 {
    let q = f64::from(largest(reflectance));
    if q < 1.0 {
        q / (1.0 - q)
    } else {
        f64::INFINITY
    }
}

/// The largest reflectance of any channel.
pub(super) fn largest(reflectance: &[Vec3]) -> f32 {
    let channels = reflectance.iter().map(|r| r.max_element());
    channels.fold(0.0, f32::max)
}

/// The bound on the error, relative to the root mean square, where no channel of any residual exceeds `most`.
pub(super) fn error_bound(most: f64, scale: f64, rms: f64) -> f64 {
    if most > 0.0 && rms > 0.0 {
        most * scale / rms
    } else {
        0.0
    }
}

/// Root mean square of the channels of n rows.
pub(super) fn root_mean_square(squares: f64, rows: usize) -> f64 {
    (squares / (3 * rows.max(1)) as f64).sqrt()
}

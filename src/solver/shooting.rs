//! The shooting solve: the patch with most light still to give gives it to all who see it, over and over.
//!
//! Cohen, Chen, Wallace, Greenberg 1988, "A progressive refinement approach to fast radiosity image generation", Computer
//! Graphics 22(4):75–84. What is unshot, r = ρ(D + F R) − R, may also be negative, and then takes light away: with the
//! last frame's light for a start this is Chen 1990, "Incremental radiosity", Computer Graphics 24(4):135–144, and from
//! darkness, where r = ρD, it is Cohen's.
//!
//! We depart from both in that light is shot through the transpose of the sampled rows. They turn the shooter's own row
//! around by reciprocity, A_i F_ij = A_j F_ji, which samples keep only in the mean: that would solve another matrix than
//! gathering does. And not r is kept but H = F R, what each row has received: r follows from it whenever it is asked
//! for, so that no rounding gathers in r. That needs 64 bits, since r is the small difference of large numbers.

use super::gauss_seidel::{MOST_SHRINK, Radiosity, is_dark, shrink};
use super::rows::{Rows, Transpose};
use glam::{DVec3, Vec3, Vec3A};
use rayon::prelude::*;

/// More shots than this for each row mean that reflectances of 1 keep all light in the scene; as many as a row has sweeps
/// in gathering.
const MOST_SHOTS_EACH: u64 = 2_000;

/// A batch takes whoever has at least this share of the most unshot light, the most first. Each batch looks at every row:
/// in the default scene a half made 243 batches of 66,564 shots, a quarter 93 of 64,934, an eighth 56 of 64,526.
const BATCH: f64 = 0.25;

/// What is known of each row's patch.
#[derive(Clone, Copy, Debug)]
pub struct System<'a> {
    /// Area; only ratios matter.
    pub area: &'a [f32],
    /// Irradiance D straight from the emitters.
    pub direct: &'a [Vec3],
    /// Reflectance ρ.
    pub reflectance: &'a [Vec3],
}

/// When to stop.
#[derive(Clone, Copy, Debug)]
pub struct StopRule {
    /// No channel of any row is off by more than this × the rms of R. Each halving costs about as many shots more, since the
    /// error falls geometrically.
    pub tolerance: f32,
    /// Or so many shots were fired.
    pub shots: u64,
}

impl StopRule {
    /// Shots that are fired at most for so many rows.
    pub(super) fn most(self, rows: usize) -> u64 {
        self.shots.min(MOST_SHOTS_EACH * rows as u64)
    }
}

/// The light between two shots.
#[derive(Clone, Debug)]
pub struct Shooting<'a> {
    /// The patches.
    pub given: System<'a>,
    /// R of each row as far as it has been shot, followed by zeros for answers that are nothing.
    pub shot: Vec<DVec3>,
    /// H = F R, what each row has received of it.
    pub received: Vec<DVec3>,
    /// Shots so far.
    pub shots: u64,
}

/// Solves R = ρ(D + F R) from `start` until the residual or the number of shots is reached.
///
/// The tolerance is that of [`gather`](super::gather()), and so is its bound: rows sum to at most 1, so with q for the
/// largest reflectance R is off by at most max|r| / (1 − q), and ρ(D + F R), which is returned, by q times as much. The
/// residual is that of an evaluation of the rows themselves, after the last shot. `nothing` is how many answers beyond the
/// rows may occur; a start of another length counts as darkness, and so does any where no row reflects direct light.
/// `watch` is shown the light after 1, 2, 4, 8 … shots.
///
/// Shots are fired one after another, so that nothing depends on threads.
pub fn shoot(
    rows: &Rows,
    given: System,
    nothing: usize,
    start: &Radiosity,
    until: StopRule,
    watch: &mut dyn FnMut(&Shooting),
) -> Radiosity {
    debug_assert!(rows.validate());
    let n = rows.len();
    let most = until.most(n);
    let mut light = Shooting::from(given, start, n + nothing);
    let shrink = f64::from(shrink(given.reflectance));
    let mut columns = None;
    loop {
        // Take what has been received from the rows themselves: at the start, and at the end to be sure of it.
        light.received = received(rows, &light.shot);
        let before = light.shots;
        // Shoot batch after batch, those with most light to give first.
        while light.shots < most {
            let batch = light.batch(until.tolerance.into(), shrink);
            if batch.is_empty() {
                break;
            }
            let columns = columns.get_or_insert_with(|| Transpose::of(rows));
            for shooter in batch.into_iter().take((most - light.shots) as usize) {
                light.fire(shooter, columns.column(shooter as usize));
                if light.shots.is_power_of_two() {
                    watch(&light);
                }
            }
        }
        if light.shots == before {
            return light.solved(shrink);
        }
    }
}

impl<'a> Shooting<'a> {
    /// The start: all of its light has been shot, and what that brought is not known yet.
    fn from(given: System<'a>, start: &Radiosity, answers: usize) -> Shooting<'a> {
        let known = start.reflected.len() == answers;
        let shot = if known && !is_dark(given.direct, given.reflectance) {
            start.reflected.iter().map(|r| r.as_dvec3()).collect()
        } else {
            vec![DVec3::ZERO; answers]
        };
        Shooting {
            shot,
            received: vec![DVec3::ZERO; given.direct.len()],
            given,
            shots: 0,
        }
    }

    /// r = ρ(D + H) − R of a row.
    #[inline]
    pub fn unshot(&self, row: usize) -> DVec3 {
        let arrives = self.given.direct[row].as_dvec3() + self.received[row];
        self.given.reflectance[row].as_dvec3() * arrives - self.shot[row]
    }

    /// The irradiance by which Cohen's ambient term stands in for light that is still to be shot, until it has been.
    ///
    /// Unshot light is taken to spread evenly over all areas and to be reflected for ever by their mean reflectance:
    /// Σ A r / Σ A × (1 + ρ̄ + ρ̄² + …), with ρ̄ = Σ A ρ / Σ A. A dark room beside a bright one glows until that has shot.
    pub fn ambient(&self) -> Vec3 {
        let (mut area, mut unshot, mut reflectance) = (0.0, DVec3::ZERO, DVec3::ZERO);
        for (row, a) in self.given.area.iter().enumerate() {
            let a = f64::from(*a);
            area += a;
            unshot += self.unshot(row) * a;
            reflectance += self.given.reflectance[row].as_dvec3() * a;
        }
        if area == 0.0 {
            return Vec3::ZERO;
        }
        let mean = (reflectance / area).min(DVec3::splat(MOST_SHRINK.into()));
        (unshot / area / (DVec3::ONE - mean)).as_vec3()
    }

    fn all_unshot(&self) -> Vec<DVec3> {
        let rows = 0..self.received.len();
        rows.map(|row| self.unshot(row)).collect()
    }

    /// Root mean square of R, with what is to be shot next.
    fn rms(&self, unshot: &[DVec3]) -> f64 {
        let all = self.shot.iter().zip(unshot);
        let squares: f64 = all
            .map(|(shot, rest)| (*shot + *rest).length_squared())
            .sum();
        (squares / (3 * unshot.len().max(1)) as f64).sqrt()
    }

    /// Bound on the largest error of ρ(D + F R) in any channel, relative to the rms of R.
    fn residual(&self, unshot: &[DVec3], shrink: f64) -> f64 {
        let most = unshot
            .iter()
            .map(|r| r.abs().max_element())
            .fold(0.0, f64::max);
        let rms = self.rms(unshot);
        if rms > 0.0 {
            most * shrink / (1.0 - shrink) / rms
        } else {
            0.0
        }
    }

    /// The next to shoot: of the rows that would break the tolerance those with most unshot light, the most first.
    pub(super) fn batch(&self, tolerance: f64, shrink: f64) -> Vec<u32> {
        // Leave out who may keep what is left: its error is within the tolerance.
        let unshot = self.all_unshot();
        let scale = shrink / (1.0 - shrink);
        let allowed = tolerance * self.rms(&unshot);
        let energy = |(row, r): (usize, &DVec3)| {
            let heavy = r.abs().max_element() * scale > allowed;
            heavy.then(|| {
                (
                    row as u32,
                    r.abs().element_sum() * f64::from(self.given.area[row]),
                )
            })
        };
        let mut batch: Vec<(u32, f64)> = unshot.iter().enumerate().filter_map(energy).collect();
        // Sort the largest by what they have, then by number.
        let most = batch.iter().map(|(_, energy)| *energy).fold(0.0, f64::max);
        batch.retain(|(_, energy)| *energy >= BATCH * most);
        batch.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        batch.into_iter().map(|(row, _)| row).collect()
    }

    /// Shoots all that a row has to give, or takes it back, down its column: receivers and their factors.
    pub(super) fn fire(&mut self, shooter: u32, column: impl Iterator<Item = (u32, f64)>) {
        let given = self.unshot(shooter as usize);
        self.shot[shooter as usize] += given;
        for (receiver, factor) in column {
            self.received[receiver as usize] += given * factor;
        }
        self.shots += 1;
    }

    /// What comes out: each row's ρ(D + H), the shot and the unshot together.
    pub(super) fn solved(&self, shrink: f64) -> Radiosity {
        let unshot = self.all_unshot();
        let n = unshot.len();
        let mut reflected = vec![Vec3A::ZERO; self.shot.len()];
        for ((all, shot), rest) in reflected[..n].iter_mut().zip(&self.shot).zip(&unshot) {
            *all = (*shot + *rest).as_vec3a();
        }
        Radiosity {
            reflected,
            indirect: self.received.iter().map(|h| h.as_vec3()).collect(),
            sweeps: 0,
            shots: self.shots,
            residual: self.residual(&unshot, shrink) as f32,
        }
    }
}

/// H = F R, summed up in 64 bits over each row's answers.
fn received(rows: &Rows, shot: &[DVec3]) -> Vec<DVec3> {
    let row = |i| {
        let answers = rows.row(i).iter().map(|j| shot[j as usize]);
        let all: DVec3 = match rows.weights(i) {
            [] => answers.sum(),
            weights => answers.zip(weights).map(|(r, w)| r * f64::from(*w)).sum(),
        };
        let more = rows.correction.of(i);
        let more = more.map(|(j, factor)| shot[j as usize] * f64::from(factor));
        all * f64::from(rows.share[i]) + more.sum::<DVec3>()
    };
    (0..rows.len()).into_par_iter().map(row).collect()
}

#[cfg(test)]
mod tests;

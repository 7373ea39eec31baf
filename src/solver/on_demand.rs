//! Shooting without stored rows: a shooter's row is asked for when it shoots, turned into its column, and forgotten.
//!
//! Cohen, Chen, Wallace, Greenberg 1988, "A progressive refinement approach to fast radiosity image generation", Computer
//! Graphics 22(4):75–84: A_i F_ij = A_j F_ji makes the column of a shooter out of its own row, so that memory is linear in
//! patches. What is unshot, the batches and the tolerance are those of [`shoot`](super::shoot()).
//!
//! We depart in two things, for reciprocity keeps all energy, but not who gets it: a patch is met by as many samples as
//! happen to meet it, few or none where it is small. First, F_ji is a ratio: c_j a_i F_ij / Σ_k a_k F_kj, with a for the
//! open area and c_j for the share of j's own row that ends on patches. Then rows sum to what they do in the stored matrix,
//! at most 1, which keeps a furnace exact and the tolerance's bound rigorous. Second, when all is shot each patch gathers
//! once over its own row, the very one that would be stored: so a small patch receives as well as a large one, and what
//! differs from stored rows is noise of R that this mean smooths. A patch that no sample meets is lit by that alone.

use super::gauss_seidel::{Radiosity, is_dark, shrink};
use super::shooting::{Shooting, StopRule, System};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Rows asked for together: enough for many cores; at 4,096 samples each they take 32 MiB.
const BLOCK: usize = 2048;

/// An answer, and its share of its row: those of a row sum to 1.
pub type Share = (u32, f32);

/// Where rows come from.
pub struct RowProvider<'a> {
    /// Appends the answers of row i that count. They count from 0 over all rows; larger ones are nothing.
    pub row: &'a (dyn Fn(u32, &mut Vec<Share>) + Sync),
    /// Area of each patch that its row speaks for; only ratios matter.
    pub open: &'a [f32],
}

/// What one look at all rows tells: how often each patch is seen, and what the light of the start brings.
#[derive(Clone, Debug)]
pub struct ColumnSums {
    start: Vec<DVec3>,
    seeing: Vec<f64>,
    seen: Vec<f64>,
    brought: Vec<DVec3>,
}

impl ColumnSums {
    /// Before the first row: `start` is the light that is taken for shot, darkness if it has another length.
    pub fn new(rows: usize, nothing: usize, start: &Radiosity) -> ColumnSums {
        let known = start.reflected.len() == rows + nothing;
        let start = start.reflected.iter().map(|r| r.as_dvec3());
        ColumnSums {
            start: if known {
                start.collect()
            } else {
                vec![DVec3::ZERO; rows + nothing]
            },
            seeing: vec![0.0; rows],
            seen: vec![0.0; rows],
            brought: vec![DVec3::ZERO; rows],
        }
    }

    /// Looks at row i, of a patch with this open area; each row once, in any order that is always the same.
    pub fn add(&mut self, i: usize, open: f32, row: impl Iterator<Item = Share>) {
        let n = self.seen.len();
        for (j, share) in row.filter(|(j, _)| (*j as usize) < n) {
            let (j, share) = (j as usize, f64::from(share));
            let exchanged = f64::from(open) * share;
            self.seeing[i] += share;
            self.seen[j] += exchanged;
            self.brought[j] += self.start[i] * exchanged;
        }
    }

    /// c_j / Σ_k a_k F_kj of each patch, or 0 for one that no sample meets.
    fn scales(&self) -> Vec<f64> {
        let scale = |(seeing, seen): (&f64, &f64)| if *seen > 0.0 { seeing / seen } else { 0.0 };
        self.seeing.iter().zip(&self.seen).map(scale).collect()
    }
}

/// Solves R = ρ(D + F R) from the start of the survey until the residual or the number of shots is reached.
///
/// The light's `reflected` is what was shot and is still to be, the start of the next solve; `indirect` is what each
/// patch gathers of it over its own row. `watch` is shown the light after 1, 2, 4, 8 … shots. Shots are fired one after
/// another, so that nothing depends on threads.
pub fn shoot_on_demand(
    demand: &RowProvider,
    survey: ColumnSums,
    given: System,
    until: StopRule,
    watch: &mut dyn FnMut(&Shooting),
) -> Radiosity {
    let n = given.direct.len();
    let (scales, shrink) = (survey.scales(), f64::from(shrink(given.reflectance)));
    let received = survey.brought.iter().zip(&scales).map(|(h, s)| *h * *s);
    let mut light = Shooting {
        given,
        received: received.collect(),
        shot: survey.start,
        shots: 0,
    };
    if is_dark(given.direct, given.reflectance) {
        light.shot.fill(DVec3::ZERO);
        light.received.fill(DVec3::ZERO);
    }
    // Shoot batch after batch, those with most light to give first.
    let most = until.most(n);
    while light.shots < most {
        let mut batch = light.batch(until.tolerance.into(), shrink);
        batch.truncate((most - light.shots).min(usize::MAX as u64) as usize);
        if batch.is_empty() {
            break;
        }
        for block in batch.chunks(BLOCK) {
            for (shooter, row) in block.iter().zip(ask(demand, block)) {
                let open = f64::from(demand.open[*shooter as usize]);
                let sides = row.iter().filter(|(j, _)| (*j as usize) < n);
                let column =
                    sides.map(|(j, share)| (*j, f64::from(*share) * open * scales[*j as usize]));
                light.fire(*shooter, column);
                if light.shots.is_power_of_two() {
                    watch(&light);
                }
            }
        }
    }
    // Let each patch gather once over its own row.
    let mut solved = light.solved(shrink);
    let numbers: Vec<u32> = (0..n as u32).collect();
    solved.indirect.clear();
    for block in numbers.chunks(BLOCK) {
        let seen = ask(demand, block).into_iter().map(|row| {
            let light = row
                .iter()
                .map(|(j, share)| solved.reflected[*j as usize] * *share);
            Vec3::from(light.sum::<glam::Vec3A>())
        });
        solved.indirect.extend(seen);
    }
    solved
}

/// The rows of these patches.
fn ask(demand: &RowProvider, block: &[u32]) -> Vec<Vec<Share>> {
    let row = |i: &u32| {
        let mut row = Vec::new();
        (demand.row)(*i, &mut row);
        row
    };
    block.par_iter().map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::{RowCorrection, Rows, gather};
    use crate::visibility::packed_ids::Answers;

    const NOTHING: usize = 2;

    /// Rows, their open areas, and what is given of their patches.
    struct Room {
        rows: Vec<Vec<u32>>,
        area: Vec<f32>,
        direct: Vec<Vec3>,
        reflectance: Vec<Vec3>,
    }

    impl Room {
        /// What shooting on demand makes of it.
        fn solve(&self, start: &Radiosity, shots: u64) -> (Radiosity, Vec<u64>) {
            let n = self.rows.len();
            let row = |i: u32, into: &mut Vec<Share>| {
                let row = &self.rows[i as usize];
                into.extend(row.iter().map(|j| (*j, 1.0 / row.len() as f32)));
            };
            let mut survey = ColumnSums::new(n, NOTHING, start);
            for (i, area) in self.area.iter().enumerate() {
                let mut shares = Vec::new();
                row(i as u32, &mut shares);
                survey.add(i, *area, shares.into_iter());
            }
            let demand = RowProvider {
                row: &row,
                open: &self.area,
            };
            let given = System {
                area: &self.area,
                direct: &self.direct,
                reflectance: &self.reflectance,
            };
            let until = StopRule {
                tolerance: 1e-6,
                shots,
            };
            let mut watched = Vec::new();
            let light = shoot_on_demand(&demand, survey, given, until, &mut |light| {
                watched.push(light.shots);
            });
            (light, watched)
        }
    }

    /// Where samples keep reciprocity themselves the matrix is the stored one: areas 2, 1, 1, and F_01 = F_02 = ½,
    /// F_10 = F_20 = 1. With D = 1 on the first and ρ = ½: R_0 = ½(1 + R_1), R_1 = R_2 = ½ R_0, so R_0 = ⅔.
    #[test]
    fn reciprocal_rows_are_solved_as_by_hand() {
        let room = Room {
            rows: vec![vec![1, 2], vec![0, 0], vec![0, 0]],
            area: vec![2.0, 1.0, 1.0],
            direct: vec![Vec3::ONE, Vec3::ZERO, Vec3::ZERO],
            reflectance: vec![Vec3::splat(0.5); 3],
        };
        let (light, watched) = room.solve(&Radiosity::default(), u64::MAX);
        for (got, expected) in light
            .reflected
            .iter()
            .zip([2.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0])
        {
            assert!((got.x - expected).abs() < 3e-6, "{got}");
        }
        assert!((light.indirect[0].y - 1.0 / 3.0).abs() < 3e-6);
        assert!((light.indirect[1].y - 2.0 / 3.0).abs() < 3e-6);
        assert!(light.residual <= 1e-6 && light.shots > 10);
        assert_eq!(watched[..4], [1, 2, 4, 8]);
        // From the solution there is next to nothing left to shoot.
        let (again, _) = room.solve(&light, u64::MAX);
        assert!(again.shots < 4, "{}", again.shots);
    }

    /// Whole numbers below another, from a fixed generator.
    fn noise() -> impl FnMut(u32) -> u32 {
        let mut state = 7u64;
        move |below| {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (state >> 40) as u32 % below
        }
    }

    /// Patches that see one another at random, in a room of which one row in five leaves.
    fn random(count: u32, samples: u32) -> Room {
        let mut random = noise();
        let row = |i: u32, random: &mut dyn FnMut(u32) -> u32| -> Vec<u32> {
            let leaves = i.is_multiple_of(5);
            let other = |random: &mut dyn FnMut(u32) -> u32| (i + 1 + random(count - 1)) % count;
            (0..samples)
                .map(|k| {
                    if leaves && k % 2 == 0 {
                        count + 1
                    } else {
                        other(random)
                    }
                })
                .collect()
        };
        Room {
            rows: (0..count).map(|i| row(i, &mut random)).collect(),
            area: (0..count).map(|i| 0.25 + (i % 7) as f32).collect(),
            direct: vec![Vec3::ONE; count as usize],
            reflectance: vec![Vec3::new(0.5, 0.9, 0.0); count as usize],
        }
    }

    /// Closed, with D = 1 and one ρ, R = ρ/(1 − ρ) whatever the samples meet: rows are scaled to sum to 1.
    #[test]
    fn a_furnace_is_exact_whatever_samples_meet() {
        let mut room = random(60, 8);
        let closed = |j: &u32| if *j < 60 { *j } else { 3 };
        for row in &mut room.rows {
            *row = row.iter().map(closed).collect();
        }
        let (light, _) = room.solve(&Radiosity::default(), u64::MAX);
        // The bound is relative to the root mean square, which here is that of (1, 9, 0).
        let allowed = 1e-6 * (82.0f32 / 3.0).sqrt();
        let met = |i: u32| room.rows.iter().flatten().any(|j| *j == i);
        assert!(
            (0..60).all(met),
            "a patch that no sample meets proves nothing"
        );
        for r in &light.reflected[..60] {
            assert!((r.x - 1.0).abs() < allowed, "{r}");
            assert!((r.y - 9.0).abs() < 9e-6 + allowed, "{r}");
            assert_eq!(r.z, 0.0);
        }
    }

    /// With many samples of what everybody sees alike, ratios, shots and gathering agree within sampling error: F_ij is
    /// A_j over the whole area. A row of 4,096 samples errs by 1/64 of the deviation of R over what is seen, which is below
    /// a half of the largest R; that of two matrices and their echoes, 1/(1 − ρ), is below six times that for ρ = ¾.
    #[test]
    fn stored_rows_have_the_same_light() {
        let area: Vec<f32> = (0..24).map(|i| 1.0 + (i % 4) as f32).collect();
        let by_area: Vec<u32> = (0..24u32)
            .flat_map(|i| vec![i; 1 + i as usize % 4])
            .collect();
        let mut room = random(24, 4096);
        let mut dealt = noise();
        let mut other = |_: &u32| by_area[dealt(by_area.len() as u32) as usize];
        let rows = room.rows.iter();
        room.rows = rows
            .map(|row| row.iter().map(&mut other).collect())
            .collect();
        room.area = area;
        let grey = |i: usize| Vec3::splat(0.25 + 0.5 * (i % 2) as f32);
        room.reflectance = (0..24).map(grey).collect();
        room.direct = (0..24).map(|i| Vec3::splat((i % 3) as f32)).collect();
        let (light, _) = room.solve(&Radiosity::default(), u64::MAX);
        let answers = Answers::of(4096, &room.rows.concat());
        let rows = Rows {
            blocks: [&answers, &Answers::default()],
            weights: [&[]; 2],
            share: &[1.0 / 4096.0; 24],
            correction: RowCorrection::default(),
        };
        let dark = Radiosity::default();
        let stored = gather(&rows, &room.direct, &room.reflectance, NOTHING, dark, 1e-6);
        let most = stored
            .reflected
            .iter()
            .fold(0.0f32, |most, r| most.max(r.x));
        for (a, b) in light.reflected.iter().zip(&stored.reflected) {
            assert!((a.x - b.x).abs() < 6.0 / 64.0 * 0.5 * most, "{a} {b}");
        }
    }

    #[test]
    fn darkness_and_a_number_of_shots() {
        let mut room = random(60, 8);
        let (light, watched) = room.solve(&Radiosity::default(), 5);
        assert_eq!((light.shots, watched), (5, vec![1, 2, 4]));
        assert!(light.residual > 0.0);
        room.direct.fill(Vec3::ZERO);
        let (dark, _) = room.solve(&light, u64::MAX);
        assert_eq!((dark.shots, dark.residual), (0, 0.0));
        assert!(dark.reflected.iter().all(|r| r.max_element() == 0.0));
        assert!(dark.indirect.iter().all(|h| *h == Vec3::ZERO));
    }
}

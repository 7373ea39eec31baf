//! Shooting without stored rows: a shooter's row is traced when it shoots, turned into its column, and forgotten.
//!
//! Cohen, Chen, Wallace, Greenberg 1988, "A progressive refinement approach to fast radiosity image generation", Computer
//! Graphics 22(4):75–84: A_i F_ij = A_j F_ji makes the column of a shooter out of its own row, so that memory is linear in
//! patches. Batches and tolerance are those of [`shoot`](super::shoot()).
//!
//! We depart in two things, for reciprocity keeps all energy, but not who gets it: a patch is met by as many samples as
//! happen to meet it, few or none where it is small. First, F_ji is a ratio: c_j a_i F_ij / Σ_k a_k F_kj, with a for the
//! open area and c_j for the share of j's own row that ends on patches. Then rows sum to what they do in the stored matrix,
//! at most 1, which keeps a furnace exact and the tolerance's bound rigorous. Second, when all is shot each patch gathers
//! once over its own row, the very one that would be stored: so a small patch receives as well as a large one, and noise
//! of R is all that differs from stored rows; this mean smooths it. A patch that no sample meets is lit by that alone.

use super::shooting::{BatchRule, COHEN, Run};
use super::solution::{Radiosity, Solution, StopRule, System, error_scale};
use super::transpose::Columns;
use glam::{DVec3, Vec3, Vec3A};
use rayon::prelude::*;

/// Rows traced together: enough for many cores; at 4,096 samples each they take 32 MiB.
const BLOCK: usize = 2048;

/// A hit id, and its share of its row: those of a row sum to 1.
pub type Share = (u32, f32);

/// Source of rows that are not stored.
pub struct RowProvider<'a> {
    /// Appends the samples of row i that count. Ids count from 0 over all rows; larger ones are misses.
    pub row: &'a (dyn Fn(u32, &mut Vec<Share>) + Sync),
    /// Open area of each patch, of which its row speaks; only ratios matter.
    pub open: &'a [f32],
}

/// Column sums of all rows, and what the solution at the start brings.
#[derive(Clone, Debug)]
pub struct ColumnSums {
    /// The solution taken for shot; what it brings is not scaled yet.
    start: Solution,
    /// Share of each row that ends on patches: c.
    seeing: Vec<f64>,
    /// Σ_k a_k F_kj of each column.
    seen: Vec<f64>,
}

impl ColumnSums {
    /// Before the first row: `start` is taken for shot, darkness if it has another length than `rows` and `misses`.
    pub fn new(rows: usize, misses: usize, start: &Radiosity) -> ColumnSums {
        let mut solution = Solution::dark(rows);
        if start.reflected.len() == rows + misses {
            let known = solution.shot.iter_mut().zip(&start.reflected);
            known.for_each(|(to, r)| *to = r.as_dvec3());
        }
        ColumnSums {
            start: solution,
            seeing: vec![0.0; rows],
            seen: vec![0.0; rows],
        }
    }

    /// Adds row i, of a patch with this open area; each row once, in any order that is always the same.
    pub fn add(&mut self, i: usize, open: f32, row: impl Iterator<Item = Share>) {
        let n = self.seen.len();
        for (j, share) in row.filter(|(j, _)| (*j as usize) < n) {
            let (j, share) = (j as usize, f64::from(share));
            let exchanged = f64::from(open) * share;
            self.seeing[i] += share;
            self.seen[j] += exchanged;
            self.start.received[j] += self.start.shot[i] * exchanged;
        }
    }

    /// c_j / Σ_k a_k F_kj of each patch, or 0 for one that no sample meets.
    fn scales(&self) -> Vec<f64> {
        let scale = |(seeing, seen): (&f64, &f64)| if *seen > 0.0 { seeing / seen } else { 0.0 };
        self.seeing.iter().zip(&self.seen).map(scale).collect()
    }
}

/// Columns made of rows by reciprocity.
struct Reciprocal<'a> {
    provider: &'a RowProvider<'a>,
    scales: Vec<f64>,
    /// Rows of the shooters that come next.
    rows: std::vec::IntoIter<Vec<Share>>,
}

impl Columns for Reciprocal<'_> {
    fn prepare(&mut self, shooters: &[u32]) {
        self.rows = trace(self.provider, shooters).into_iter();
    }

    fn scatter(&mut self, j: u32, light: DVec3, received: &mut [DVec3]) {
        let open = f64::from(self.provider.open[j as usize]);
        for (i, share) in self.rows.next().into_iter().flatten() {
            let (i, share) = (i as usize, f64::from(share));
            if let (Some(received), Some(scale)) = (received.get_mut(i), self.scales.get(i)) {
                *received += light * (share * open * scale);
            }
        }
    }
}

/// Solves R = ρ(D + F R) from the start of the column sums until the stop rule says so.
///
/// `reflected` is the shot and the unshot together, the start of the next solve; `indirect` is what each patch gathers of it
/// over its own row. `watch` is shown the solution after 1, 2, 4, 8 … shots.
pub fn shoot_on_demand(
    provider: &RowProvider,
    sums: ColumnSums,
    system: System,
    misses: usize,
    stop: StopRule,
    watch: &mut dyn FnMut(&Solution, u64),
) -> Radiosity {
    let n = system.direct.len();
    let scales = sums.scales();
    let mut solution = sums.start;
    if system.is_dark() {
        solution = Solution::dark(n);
    }
    let received = solution.received.iter_mut().zip(&scales);
    received.for_each(|(received, scale)| *received *= *scale);
    let mut columns = Reciprocal {
        provider,
        scales,
        rows: Vec::new().into_iter(),
    };
    let scale = error_scale(system.reflectance);
    let mut run = Run {
        system,
        scale,
        rule: BatchRule {
            block: BLOCK,
            ..COHEN
        },
        stop,
        shots: 0,
    };
    let residual = solution.residual_by(system, scale);
    let residual = run.shoot(&mut solution, &mut columns, residual, |_| false, watch);
    let mut solved = solution.radiosity(system, &residual, misses, run.shots);
    solved.indirect = gathered(provider, &solved.reflected, n);
    solved
}

/// What each patch gathers of the radiosity over its own row.
fn gathered(provider: &RowProvider, radiosity: &[Vec3A], rows: usize) -> Vec<Vec3> {
    let numbers: Vec<u32> = (0..rows as u32).collect();
    let mut all = Vec::with_capacity(rows);
    for block in numbers.chunks(BLOCK) {
        let gathered = trace(provider, block).into_iter().map(|row| {
            let light = row.iter().map(|(j, share)| radiosity[*j as usize] * *share);
            Vec3::from(light.sum::<Vec3A>())
        });
        all.extend(gathered);
    }
    all
}

/// The rows of these patches.
fn trace(provider: &RowProvider, patches: &[u32]) -> Vec<Vec<Share>> {
    let row = |i: &u32| {
        let mut row = Vec::new();
        (provider.row)(*i, &mut row);
        row
    };
    patches.par_iter().map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::{Rows, gather};
    use crate::visibility::packed_ids::PackedIds;

    const NOTHING: usize = 2;

    /// Rows, their open areas, and what is given of their patches.
    struct ListedRoom {
        rows: Vec<Vec<u32>>,
        area: Vec<f32>,
        direct: Vec<Vec3>,
        reflectance: Vec<Vec3>,
    }

    impl ListedRoom {
        /// What shooting on demand makes of it.
        fn solve(&self, start: &Radiosity, shots: u64) -> (Radiosity, Vec<u64>) {
            let n = self.rows.len();
            let row = |i: u32, into: &mut Vec<Share>| {
                let row = &self.rows[i as usize];
                into.extend(row.iter().map(|j| (*j, 1.0 / row.len() as f32)));
            };
            let mut sums = ColumnSums::new(n, NOTHING, start);
            for (i, area) in self.area.iter().enumerate() {
                let mut shares = Vec::new();
                row(i as u32, &mut shares);
                sums.add(i, *area, shares.into_iter());
            }
            let provider = RowProvider {
                row: &row,
                open: &self.area,
            };
            let system = System {
                area: &self.area,
                direct: &self.direct,
                reflectance: &self.reflectance,
            };
            let stop = StopRule {
                shots,
                ..StopRule::at(1e-6)
            };
            let mut watched = Vec::new();
            let light = shoot_on_demand(&provider, sums, system, NOTHING, stop, &mut |_, shots| {
                watched.push(shots);
            });
            (light, watched)
        }
    }

    /// Where samples keep reciprocity themselves the matrix is the stored one: areas 2, 1, 1, and F_01 = F_02 = ½,
    /// F_10 = F_20 = 1. With D = 1 on the first and ρ = ½: R_0 = ½(1 + R_1), R_1 = R_2 = ½ R_0, so R_0 = ⅔.
    #[test]
    fn reciprocal_rows_are_solved_as_by_hand() {
        let room = ListedRoom {
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
    fn random(count: u32, samples: u32) -> ListedRoom {
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
        ListedRoom {
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
        let ids = PackedIds::of(4096, &room.rows.concat());
        let share = [1.0 / 4096.0; 24];
        let rows = Rows::of(&ids, &share);
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

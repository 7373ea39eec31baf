use super::*;
use crate::solver::gather;
use crate::visibility::packed_ids::PackedIds;
use glam::{Vec3, Vec3A};
use proptest::prelude::*;

/// Rows of equally many samples, and what the patches are like.
#[derive(Clone, Debug)]
struct RandomRoom {
    ids: PackedIds,
    weights: Vec<f32>,
    share: Vec<f32>,
    area: Vec<f32>,
    direct: Vec<Vec3>,
    reflectance: Vec<Vec3>,
}

impl RandomRoom {
    fn rows(&self) -> Rows<'_> {
        Rows {
            weights: [&self.weights, &[]],
            ..Rows::of(&self.ids, &self.share)
        }
    }

    fn system(&self) -> System<'_> {
        System {
            area: &self.area,
            direct: &self.direct,
            reflectance: &self.reflectance,
        }
    }

    fn shoot(&self, start: &Radiosity, tolerance: f32, shots: u64) -> Radiosity {
        let stop = StopRule {
            shots,
            ..StopRule::at(tolerance)
        };
        shoot(&self.rows(), self.system(), 1, start, stop, &mut |_, _| ())
    }

    fn gather(&self, start: Radiosity, tolerance: f32) -> Radiosity {
        let (direct, reflectance) = (&self.direct, &self.reflectance);
        gather(&self.rows(), direct, reflectance, 1, start, tolerance)
    }

    /// The solution after each of the first `shots` shots, one to a batch.
    fn each(&self, shots: u64, mut see: impl FnMut(&Solution, u64)) {
        let mut solution = Solution::dark(self.area.len());
        let mut columns = Transpose::of(&self.rows());
        see(&solution, 0);
        for shot in 1..=shots {
            let residual = solution.residual(self.system());
            let batch = batch(&residual, self.system(), COHEN, StopRule::at(0.0));
            let Some(&first) = batch.first() else { return };
            let light = solution.shoot(self.system(), first as usize);
            columns.scatter(first, light, &mut solution.received);
            see(&solution, shot);
        }
    }

    /// (1 − ρF) R = ρD by Gaussian elimination in 64 bits.
    fn direct_solve(&self) -> Vec<DVec3> {
        let [red, green, blue] = [0, 1, 2].map(|channel| self.eliminate(channel));
        let rows = 0..self.area.len();
        rows.map(|i| DVec3::new(red[i], green[i], blue[i]))
            .collect()
    }

    fn eliminate(&self, channel: usize) -> Vec<f64> {
        // Write the system down, its right side as the last column.
        let n = self.area.len();
        let mut matrix = vec![vec![0.0; n + 1]; n];
        for (i, row) in matrix.iter_mut().enumerate() {
            let reflectance = f64::from(self.reflectance[i][channel]);
            row[i] = 1.0;
            row[n] = reflectance * f64::from(self.direct[i][channel]);
            let ids = self.rows().row(i).iter().enumerate();
            for (k, j) in ids.filter(|(_, j)| (*j as usize) < n) {
                let weight = f64::from(*self.weights.get(k).unwrap_or(&1.0));
                row[j as usize] -= reflectance * weight * f64::from(self.share[i]);
            }
        }
        // Eliminate downwards; rows are dominated by their diagonals, so that no pivot is sought.
        for k in 0..n {
            let (above, below) = matrix.split_at_mut(k + 1);
            for row in below {
                let factor = row[k] / above[k][k];
                (k..=n).for_each(|j| row[j] -= factor * above[k][j]);
            }
        }
        // Put in what is known, upwards.
        let mut solved = vec![0.0; n];
        for i in (0..n).rev() {
            let known: f64 = (i + 1..n).map(|j| matrix[i][j] * solved[j]).sum();
            solved[i] = (matrix[i][n] - known) / matrix[i][i];
        }
        solved
    }
}

/// The largest difference of any channel, relative to the root mean square of what is expected.
fn off(got: &[Vec3A], expected: &[DVec3]) -> f64 {
    let squares: f64 = expected.iter().map(|e| e.length_squared()).sum();
    let pairs = got.iter().zip(expected);
    let most = pairs.map(|(g, e)| (g.as_dvec3() - *e).abs().max_element());
    most.fold(0.0, f64::max) / (squares / (3 * expected.len()) as f64).sqrt()
}

/// Two patches of areas 1 and 3: the first sees only the second, the second the first in one sample of three.
fn two() -> RandomRoom {
    RandomRoom {
        ids: PackedIds::of(3, &[1, 1, 1, 0, 2, 2]),
        weights: Vec::new(),
        share: vec![1.0 / 3.0; 2],
        area: vec![1.0, 3.0],
        direct: vec![Vec3::splat(4.0), Vec3::ZERO],
        reflectance: vec![Vec3::splat(0.5), Vec3::splat(0.25)],
    }
}

/// Four patches of one area that see each other a third each, as the faces of a tetrahedron do: closed and reciprocal.
fn tetrahedron() -> RandomRoom {
    RandomRoom {
        ids: PackedIds::of(3, &[1, 2, 3, 0, 2, 3, 0, 1, 3, 0, 1, 2]),
        weights: Vec::new(),
        share: vec![1.0 / 3.0; 4],
        area: vec![2.0; 4],
        direct: vec![Vec3::new(5.0, 1.0, 0.0), Vec3::ZERO, Vec3::ZERO, Vec3::ONE],
        reflectance: vec![
            Vec3::new(0.8, 0.1, 0.9),
            Vec3::splat(0.5),
            Vec3::new(0.9, 0.0, 0.3),
            Vec3::splat(0.7),
        ],
    }
}

/// r0 = ½·4 = 2 is shot, and a third of it arrives: H1 = ⅔, r1 = ¼·⅔ = ⅙. The mean reflectance is (½·1 + ¼·3)/4 = 5/16, so
/// ambient light is (2·1/4) / (11/16) = 8/11 before the shot and (⅙·3/4) / (11/16) = 2/11 after it.
#[test]
fn the_ambient_term_of_two_patches_as_found_by_hand() {
    let mut seen = Vec::new();
    let room = two();
    room.each(1, |light, _| {
        let unshot = |row| light.unshot(room.system(), row).y;
        seen.push((light.ambient(room.system()).y, unshot(0), unshot(1)));
    });
    let expected = [(8.0 / 11.0, 2.0, 0.0), (2.0 / 11.0, 0.0, 1.0 / 6.0)];
    assert_eq!(seen.len(), 2);
    for (got, expected) in seen.iter().zip(expected) {
        assert!((got.0 - expected.0).abs() < 1e-6, "{got:?}");
        assert!((got.1 - expected.1).abs() < 1e-6 && (got.2 - expected.2).abs() < 1e-6);
    }
}

/// R0 = ½(4 + R1), R1 = ¼·⅓ R0  ⇒  R0 = 2 / (1 − 1/24) = 48/23, R1 = 4/23; nothing is left for the ambient term.
#[test]
fn two_patches_as_solved_by_hand() {
    let room = two();
    let light = room.shoot(&Radiosity::default(), 1e-7, u64::MAX);
    assert!((light.reflected[0].x - 48.0 / 23.0).abs() < 1e-6);
    assert!((light.reflected[1].z - 4.0 / 23.0).abs() < 1e-6);
    assert!((light.indirect[0].y - 4.0 / 23.0).abs() < 1e-6);
    assert!(light.residual <= 1e-7 && light.sweeps == 0);
    room.each(light.shots, |solution, shots| {
        assert!(shots < light.shots || solution.ambient(room.system()).x.abs() < 1e-6);
    });
}

/// In a closed, reciprocal scene light is absorbed or still to be shot: ΣA(1−ρ)(D + H) + ΣA r = ΣA D after every shot.
/// (ΣA F_ij R_j = ΣA_j R_j there, so ΣA H = ΣA R; put r = ρ(D + H) − R in.)
#[test]
fn energy_is_absorbed_or_still_to_be_shot() {
    let room = tetrahedron();
    let given: Vec3 = room.direct.iter().map(|d| *d * 2.0).sum();
    let mut shots = 0;
    room.each(60, |light, _| {
        let sum: DVec3 = (0..4)
            .map(|i| {
                let arrives = room.direct[i].as_dvec3() + light.received[i];
                let absorbed = (DVec3::ONE - room.reflectance[i].as_dvec3()) * arrives;
                2.0 * (absorbed + light.unshot(room.system(), i))
            })
            .sum();
        assert!(
            (sum - given.as_dvec3()).abs().max_element() < 1e-5,
            "{sum} of {given}"
        );
        shots += 1;
    });
    assert_eq!(shots, 61);
    // At the end nothing is left to shoot: what is absorbed is all that came in.
    let light = room.shoot(&Radiosity::default(), 1e-7, u64::MAX);
    let absorbed: Vec3 = (0..4)
        .map(|i| 2.0 * (Vec3::ONE - room.reflectance[i]) * (room.direct[i] + light.indirect[i]))
        .sum();
    assert!((absorbed - given).abs().max_element() < 1e-5);
}

/// Of the first two shots of the tetrahedron, by hand: patch 0 has (4, 0.1, 0), patch 3 (0.7, 0.7, 0.7), so 0 begins.
/// It brings a third of (4, 0.1, 0) to all others; patch 2 then has 0.9·4/3 = 1.2 of red, patch 3 0.7·(1 + 4/3) of red and
/// most of the two others, and comes next.
#[test]
fn the_most_unshot_light_goes_first() {
    let mut order = Vec::new();
    let mut last: Option<Vec<DVec3>> = None;
    tetrahedron().each(2, |light, _| {
        if let Some(last) = last.replace(light.shot.clone()) {
            order.push((0..4).position(|i| light.shot[i] != last[i]));
        }
    });
    assert_eq!(order, [Some(0), Some(3)]);
    // A dim patch goes before a bright one if it is large enough.
    let mut wide = tetrahedron();
    wide.area[3] = 5.0;
    let residual = Solution::dark(4).residual(wide.system());
    let batch = batch(&residual, wide.system(), COHEN, StopRule::at(0.0));
    assert_eq!(batch, [3, 0]);
}

#[test]
fn it_stops_after_as_many_shots_as_allowed_and_shows_powers_of_two() {
    let room = tetrahedron();
    let mut shown = Vec::new();
    let stop = StopRule {
        shots: 11,
        ..StopRule::at(1e-6)
    };
    let mut watch = |_: &Solution, shots| shown.push(shots);
    let dark = Radiosity::default();
    let light = shoot(&room.rows(), room.system(), 1, &dark, stop, &mut watch);
    assert_eq!((light.shots, shown), (11, vec![1, 2, 4, 8]));
    assert!(light.residual > 1e-6);
    // What is left can be shot from where it stopped, with no more shots than were left.
    let all = room.shoot(&dark, 1e-6, u64::MAX);
    let rest = room.shoot(&light, 1e-6, u64::MAX);
    assert!(rest.shots < all.shots, "{} of {}", rest.shots, all.shots);
    assert!(off(&rest.reflected, &room.direct_solve()) < 2e-6);
    // No shot at all: what is lit reflects, once.
    let none = room.shoot(&dark, 1e-6, 0);
    assert_eq!(none.shots, 0);
    assert_eq!(none.reflected[0], Vec3A::new(0.8 * 5.0, 0.1 * 1.0, 0.0));
}

/// A patch that loses all its light shoots what is negative, and darkness follows.
#[test]
fn light_that_goes_out_is_taken_back() {
    let mut room = tetrahedron();
    let lit = room.shoot(&Radiosity::default(), 1e-6, u64::MAX);
    room.direct[0] = Vec3::ZERO;
    let dimmed = room.shoot(&lit, 1e-6, u64::MAX);
    assert!(off(&dimmed.reflected, &room.direct_solve()) < 2e-6);
    room.direct.fill(Vec3::ZERO);
    let dark = room.shoot(&dimmed, 1e-6, u64::MAX);
    assert_eq!((dark.shots, dark.residual), (0, 0.0));
    assert_eq!(dark.reflected, [Vec3A::ZERO; 5]);
}

#[test]
fn nothing_comes_of_nothing() {
    let empty = RandomRoom {
        ids: PackedIds::of(1, &[]),
        weights: Vec::new(),
        share: Vec::new(),
        area: Vec::new(),
        direct: Vec::new(),
        reflectance: Vec::new(),
    };
    assert_eq!(empty.shoot(&Radiosity::default(), 1e-3, u64::MAX).shots, 0);
    let mut black = tetrahedron();
    black.reflectance.fill(Vec3::ZERO);
    let light = black.shoot(&Radiosity::default(), 1e-3, u64::MAX);
    assert_eq!((light.shots, light.residual), (0, 0.0));
    let mut flat = tetrahedron();
    flat.area.fill(0.0);
    let ambient = Solution::dark(4).ambient(flat.system());
    assert_eq!(ambient, Vec3::ZERO);
}

fn vec3(range: std::ops::Range<f32>) -> impl Strategy<Value = Vec3> {
    (range.clone(), range.clone(), range).prop_map(Vec3::from)
}

/// Random rows: up to 24 patches with 4 samples each, of equal weight or not, some of which see nothing, or only covered
/// origins.
fn rooms() -> impl Strategy<Value = RandomRoom> {
    (2usize..24).prop_flat_map(|n| {
        let of = |range| prop::collection::vec(vec3(range), n);
        (
            prop::collection::vec(0..=n as u32, 4 * n),
            prop::collection::vec(prop_oneof![4 => Just(0.25f32), 1 => Just(0.0)], n),
            prop::collection::vec(0.1f32..4.0, n),
            of(0.0..3.0),
            of(0.0..0.9),
            prop_oneof![Just(Vec::new()), prop::collection::vec(0.05f32..1.0, 4)],
        )
            .prop_map(|(ids, mut share, area, direct, reflectance, weights)| {
                if !weights.is_empty() {
                    let all: f32 = weights.iter().sum();
                    share.iter_mut().for_each(|share| *share *= 4.0 / all);
                }
                RandomRoom {
                    ids: PackedIds::of(4, &ids),
                    weights,
                    share,
                    area,
                    direct,
                    reflectance,
                }
            })
    })
}

proptest! {
    #![proptest_config(crate::property::config(200))]

    /// Gathering, shooting from darkness and shooting from other light agree with a direct solve, on any rows.
    #[test]
    fn all_ways_lead_to_one_solution(room in rooms(), before in prop::collection::vec(vec3(0.0..3.0), 24)) {
        let expected = room.direct_solve();
        let dark = room.shoot(&Radiosity::default(), 1e-7, u64::MAX);
        // The light of a frame in which other patches were lit.
        let mut other = room.clone();
        other.direct = before[..other.direct.len()].to_vec();
        let last = other.shoot(&Radiosity::default(), 1e-7, u64::MAX);
        let incremental = room.shoot(&last, 1e-7, u64::MAX);
        let gathered = room.gather(Radiosity::default(), 1e-7);
        for (way, light) in [("darkness", dark), ("last light", incremental), ("gathered", gathered)] {
            let error = off(&light.reflected, &expected);
            prop_assert!(error < 1e-6, "{way}: off by {error:e}, {} shots", light.shots);
        }
    }

    /// The residual is a bound: wherever it stops, no channel is off by more.
    #[test]
    fn the_error_is_within_the_residual(room in rooms(), shots in 0u64..60) {
        let light = room.shoot(&Radiosity::default(), 1e-4, shots);
        // The residual is relative to the light solved for so far.
        let squares: f64 = light.reflected.iter().map(|r| f64::from(r.length_squared())).sum();
        let rms = (squares / (3 * room.area.len()) as f64).sqrt();
        let pairs = light.reflected.iter().zip(room.direct_solve());
        let most = pairs.map(|(g, e)| (g.as_dvec3() - e).abs().max_element()).fold(0.0, f64::max);
        prop_assert!(most <= f64::from(light.residual) * rms + 1e-6 * rms, "{most:e} of {rms:e}, {}", light.residual);
    }

    /// Where half of the rows are white the residual is a bound as well, by either way; none is told where light cannot leave.
    #[test]
    fn the_error_of_white_rooms_is_within_the_residual(room in rooms()) {
        let mut room = room;
        room.reflectance.iter_mut().step_by(2).for_each(|r| *r = Vec3::ONE);
        let ways = [room.shoot(&Radiosity::default(), 1e-2, u64::MAX), room.gather(Radiosity::default(), 1e-2)];
        for light in ways.iter().filter(|light| light.residual.is_finite()) {
            prop_assert!(light.residual <= 1e-2, "{}", light.residual);
            let error = off(&light.reflected, &room.direct_solve());
            prop_assert!(error <= 1.02 * f64::from(light.residual) + 1e-4, "{error:e}, {}", light.residual);
        }
    }
}

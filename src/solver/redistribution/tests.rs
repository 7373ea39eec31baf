use super::*;
use crate::visibility::packed_ids::{PackedIds, Row};

/// Samples of each row.
const EACH: usize = 32;

/// Rows of a room in which every row sees others at random, a few hits being misses.
struct SampledRoom {
    ids: PackedIds,
    count: Vec<u16>,
    share: Vec<f32>,
    area: Vec<f32>,
    direct: Vec<Vec3>,
    reflectance: Vec<Vec3>,
}

impl SampledRoom {
    fn new(n: usize) -> SampledRoom {
        let mut state = 7u64;
        let mut random = move || {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (state >> 33) as u32
        };
        let unit = |x: u32| (x % 1000) as f32 / 1000.0;
        let ids: Vec<u32> = (0..n * EACH)
            .map(|_| random() % (n as u32 + n as u32 / 8))
            .collect();
        SampledRoom {
            ids: PackedIds::of(EACH, &ids),
            count: vec![EACH as u16; n],
            share: vec![1.0 / EACH as f32; n],
            area: (0..n).map(|_| 0.5 + unit(random())).collect(),
            direct: (0..n).map(|_| Vec3::splat(unit(random()))).collect(),
            reflectance: (0..n)
                .map(|_| Vec3::new(0.2, 0.5, 0.8) * unit(random()))
                .collect(),
        }
    }

    fn rows(&self) -> Rows<'_> {
        Rows {
            count: &self.count,
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

    /// R by plain iteration in 64 bits, until nothing changes.
    fn solved(&self) -> Vec<DVec3> {
        let n = self.share.len();
        let mut light = vec![DVec3::ZERO; n];
        for _ in 0..400 {
            light = (0..n)
                .map(|i| {
                    let seen = self
                        .rows()
                        .row(i)
                        .iter()
                        .filter_map(|j| light.get(j as usize));
                    let h = seen.sum::<DVec3>() / EACH as f64;
                    self.reflectance[i].as_dvec3() * (self.direct[i].as_dvec3() + h)
                })
                .collect();
        }
        light
    }

    /// The largest error relative to the rms.
    fn error(&self, light: &Redistribution) -> f64 {
        let exact = self.solved();
        let unshot = light.solution.residual(self.system()).unshot;
        let got = light
            .solution
            .shot
            .iter()
            .zip(&unshot)
            .map(|(a, b)| *a + *b);
        let most = got
            .zip(&exact)
            .map(|(a, b)| (a - *b).abs().max_element())
            .fold(0.0, f64::max);
        let squares: f64 = exact.iter().map(|r| r.length_squared()).sum();
        most / (squares / (3 * exact.len()) as f64).sqrt()
    }
}

fn started(room: &SampledRoom) -> Redistribution {
    let mut light = Redistribution::default();
    light.grow(&vec![0; room.share.len()]);
    light
}

const TOLERANCE: f32 = 2e-3;

/// A tolerance at which hardly anything is left.
const EXACT: f32 = 1e-7;

#[test]
fn from_darkness_gathering_ends_within_its_bound() {
    let room = SampledRoom::new(400);
    let mut light = started(&room);
    let settled = light.settle(&room.rows(), room.system(), StopRule::at(TOLERANCE), &[]);
    assert!(
        settled.sweeps > 0 && settled.residual <= TOLERANCE.into(),
        "{settled:?}"
    );
    assert!(
        room.error(&light) <= TOLERANCE.into(),
        "{}",
        room.error(&light)
    );
    // Sweeps without groups shrink the error by about a half each: 2⁻⁹ needs nine.
    assert!(settled.sweeps <= 4, "{settled:?}");
}

#[test]
fn what_changes_in_one_place_is_shot_and_signed() {
    let mut room = SampledRoom::new(400);
    let mut light = started(&room);
    light.settle(&room.rows(), room.system(), StopRule::at(1e-7), &[]);
    for color in [Vec3::ZERO, Vec3::splat(0.9)] {
        // r of a new colour is Chen's closed form: ρ'(D + H) − ρ(D + H) = (ρ'/ρ − 1) R.
        let (old, before) = (room.reflectance[7], light.solution.shot[7]);
        room.reflectance[7] = color;
        let r = light.solution.residual(room.system()).unshot[7];
        if old.min_element() > 0.0 {
            let closed = (color / old - 1.0).as_dvec3() * before;
            assert!((r - closed).abs().max_element() < 1e-5, "{r} {closed}");
        }
        let settled = light.settle(&room.rows(), room.system(), StopRule::at(TOLERANCE), &[]);
        // One shot; what it reaches is then one row in a dozen of this small room, and may be gathered.
        assert!(settled.shots > 0, "{settled:?}");
        assert!(
            room.error(&light) <= TOLERANCE.into(),
            "{}",
            room.error(&light)
        );
    }
}

#[test]
fn changed_samples_leave_no_hole() {
    let mut room = SampledRoom::new(400);
    let mut light = started(&room);
    light.prepare(&room.rows());
    light.settle(&room.rows(), room.system(), StopRule::at(TOLERANCE), &[]);
    let first = room.ids.clone();
    // Something comes before it all, and goes again before anything has been shot.
    let dark = PackedIds::of(EACH, &vec![u32::MAX; room.ids.len()]);
    let all: Vec<u32> = (0..400).collect();
    // Rows receive all of their samples again, or those that changed alone; half do this, half that.
    for anew in [&all[..], &[], &all[200..]] {
        for new in [dark.clone(), first.clone()] {
            let olds = std::mem::replace(&mut room.ids, new);
            let olds = olds.iter().flat_map(Row::iter);
            let changed: Vec<(u32, u32)> = (0..).zip(olds).collect();
            light.change(&room.rows(), &changed, anew);
        }
    }
    let settled = light.settle(&room.rows(), room.system(), StopRule::at(TOLERANCE), &[]);
    assert_eq!((settled.shots, settled.sweeps), (0, 0), "{settled:?}");
    assert!(
        room.error(&light) <= TOLERANCE.into(),
        "{}",
        room.error(&light)
    );
}

#[test]
fn a_budget_keeps_the_rest_for_later() {
    let room = SampledRoom::new(400);
    let mut light = started(&room);
    let short = light.settle(&room.rows(), room.system(), until(&|| true), &[]);
    assert!(
        short.residual > TOLERANCE.into() && short.sweeps == 0,
        "{short:?}"
    );
    let calls = std::cell::Cell::new(0);
    let one = || calls.replace(calls.get() + 1) > 0;
    let first = light.settle(&room.rows(), room.system(), until(&one), &[]);
    assert!(
        first.residual < short.residual && first.sweeps == 1,
        "{first:?}"
    );
    light.settle(&room.rows(), room.system(), StopRule::at(TOLERANCE), &[]);
    assert!(
        room.error(&light) <= TOLERANCE.into(),
        "{}",
        room.error(&light)
    );
}

#[test]
fn when_all_light_goes_out_nothing_is_left() {
    let mut room = SampledRoom::new(100);
    let mut light = started(&room);
    light.settle(&room.rows(), room.system(), StopRule::at(TOLERANCE), &[]);
    room.direct.fill(Vec3::ZERO);
    let settled = light.settle(&room.rows(), room.system(), StopRule::at(TOLERANCE), &[]);
    assert_eq!(settled, Convergence::default());
    assert!(light.solution.shot.iter().all(|r| *r == DVec3::ZERO));
}

/// Stops at the tolerance, or when the time is over.
fn until(expired: &dyn Fn() -> bool) -> StopRule<'_> {
    StopRule {
        expired,
        ..StopRule::at(TOLERANCE)
    }
}

/// One step along a hint, and nothing else.
fn step(light: &mut Redistribution, room: &SampledRoom, hint: Hint) {
    let stop = StopRule {
        expired: &once(),
        ..StopRule::at(EXACT)
    };
    light.settle(&room.rows(), room.system(), stop, &[hint]);
}

/// Bound on the error relative to the rms.
fn bound(light: &Redistribution, room: &SampledRoom) -> f64 {
    light.solution.residual(room.system()).bound
}

/// Caches the response to an emission.
fn respond(light: &mut Redistribution, room: &SampledRoom, source: u64, unit: &[Vec3]) {
    let cause = (Cause::Emission(source), unit);
    light.respond(&room.rows(), room.system(), cause, StopRule::at(EXACT));
}

/// Time for one thing alone.
fn once() -> impl Fn() -> bool {
    let calls = std::cell::Cell::new(0);
    move || calls.replace(calls.get() + 1) > 0
}

#[test]
fn the_way_back_to_a_colour_is_known() {
    let mut room = SampledRoom::new(400);
    let mut light = started(&room);
    light.settle(&room.rows(), room.system(), StopRule::at(EXACT), &[]);
    let (first, before) = (room.reflectance.clone(), light.solution.clone());
    room.reflectance[..40].fill(Vec3::splat(0.9));
    light.settle(&room.rows(), room.system(), StopRule::at(EXACT), &[]);
    let now = light.solution.clone();
    light.responses.learn_change(7, &before, &now);
    // What led here leads back if it is gone along by −1, in every channel.
    room.reflectance = first;
    assert!(bound(&light, &room) > 0.1);
    step(&mut light, &room, Hint::Repeat(8));
    assert!(bound(&light, &room) > 0.1);
    step(&mut light, &room, Hint::Repeat(7));
    let residual = bound(&light, &room);
    assert!(residual < 10.0 * f64::from(EXACT), "{residual}");
    // Half the way of a green alone is no such way, but nearly.
    room.reflectance[..40]
        .iter_mut()
        .for_each(|c| c.y = 0.5 * (c.y + 0.9));
    let alone = bound(&light, &room);
    step(&mut light, &room, Hint::Repeat(7));
    let residual = bound(&light, &room);
    assert!(residual < 0.5 * alone, "{residual} {alone}");
}

#[test]
fn what_a_switch_is_known_to_miss_is_found() {
    let mut room = SampledRoom::new(400);
    let mut light = started(&room);
    // Two sources: one shines on even rows, one on odd rows; each is known.
    let unit = |odd: usize| -> Vec<Vec3> {
        (0..400)
            .map(|i| Vec3::splat((i % 2 == odd) as u8 as f32))
            .collect()
    };
    let emission = |room: &mut SampledRoom, power: [f32; 2]| {
        room.direct = (0..400).map(|i| Vec3::splat(power[i % 2])).collect();
    };
    let emitted = |power: [f32; 2]| [(0, Vec3::splat(power[0])), (1, Vec3::splat(power[1]))];
    emission(&mut room, [2.0, 3.0]);
    for source in 0..2 {
        respond(&mut light, &room, source, &unit(source as usize));
    }
    light.settle(&room.rows(), room.system(), StopRule::at(EXACT), &[]);
    // Something moves, and the second source is found out again: of the first alone it is not known what it does now.
    room.reflectance[..40].fill(Vec3::splat(0.05));
    light.settle(&room.rows(), room.system(), StopRule::at(EXACT), &[]);
    respond(&mut light, &room, 1, &unit(1));
    emission(&mut room, [0.5, 3.0]);
    light
        .responses
        .warm_start(&mut light.solution, &[(0, Vec3::splat(-1.5))]);
    let stale = bound(&light, &room);
    let emitted = emitted([0.5, 3.0]).to_vec();
    step(&mut light, &room, Hint::Remainder(emitted));
    let residual = bound(&light, &room);
    assert!(
        stale > 0.01 && residual < 10.0 * f64::from(EXACT),
        "{stale} {residual}"
    );
}

#[test]
fn where_a_colour_leads_is_foreseen_to_its_second_bounce() {
    let mut room = SampledRoom::new(400);
    let mut light = started(&room);
    light.settle(&room.rows(), room.system(), StopRule::at(EXACT), &[]);
    let painted: Vec<bool> = (0..400).map(|i| i < 40).collect();
    light.predict(
        &room.rows(),
        room.system(),
        (7, &painted),
        StopRule::at(EXACT),
    );
    let current = |change| light.responses.is_current(Cause::Reflectance(change, 1));
    assert!(current(7) && !current(8));
    // A third less red, half as much green again.
    for color in &mut room.reflectance[..40] {
        *color *= Vec3::new(0.67, 1.5, 1.0);
    }
    let before = bound(&light, &room);
    step(&mut light, &room, Hint::Repeat(7));
    // Rows see a tenth painted ones by chance, so each bounce off them leaves less than half × a tenth: what is missing is the
    // third, and of it what is not alike in all rows.
    let after = bound(&light, &room);
    assert!(before > 0.1 && after < 2.5e-3 * before, "{before} {after}");
}

#[test]
fn what_is_remembered_catches_up_with_what_changed() {
    let mut room = SampledRoom::new(400);
    let mut light = started(&room);
    let unit: Vec<Vec3> = (0..400).map(|i| Vec3::splat((i % 3) as f32)).collect();
    respond(&mut light, &room, 5, &unit);
    // Some samples turn away, rows whole or in part, few enough to be noted or so many that all is gathered again.
    let first: Vec<u32> = room.ids.iter().flat_map(Row::iter).collect();
    let mut change = |room: &mut SampledRoom, new: &[u32], anew: &[u32]| {
        let olds = std::mem::replace(&mut room.ids, PackedIds::of(EACH, new));
        let olds = olds.iter().flat_map(Row::iter).zip(new);
        let pairs = (0..).zip(olds).filter(|(_, (old, new))| old != *new);
        let changed: Vec<(u32, u32)> = pairs.map(|(sample, (old, _))| (sample, old)).collect();
        light.change(&room.rows(), &changed, anew);
        changed.len()
    };
    let mut few = first.clone();
    few[..20 * EACH]
        .iter_mut()
        .step_by(7)
        .for_each(|id| *id = u32::MAX);
    let mut many = few.clone();
    many.iter_mut().step_by(5).for_each(|id| *id = 3);
    let anew: Vec<u32> = (5..10).collect();
    let noted = change(&mut room, &few, &anew) + change(&mut room, &first, &anew);
    assert!(noted > 100 && noted * 16 < first.len(), "{noted}");
    change(&mut room, &few, &[]);
    change(&mut room, &first, &[]);
    light.responses.update(&room.rows());
    room.direct = unit;
    let residual_of = |light: &Redistribution, room: &SampledRoom| {
        let mut light = light.clone();
        light.solution.shot.fill(DVec3::ZERO);
        light.solution.received.fill(DVec3::ZERO);
        light
            .responses
            .warm_start(&mut light.solution, &[(5, Vec3::ONE)]);
        bound(&light, room)
    };
    let there_and_back = residual_of(&light, &room);
    assert!(there_and_back < 10.0 * f64::from(EXACT), "{there_and_back}");
    // So many changed that they are not noted: what rows receive is what they receive of that light, summed up again.
    let olds = std::mem::replace(&mut room.ids, PackedIds::of(EACH, &many));
    let olds: Vec<(u32, u32)> = (0..).zip(olds.iter().flat_map(Row::iter)).collect();
    light.change(&room.rows(), &olds, &[]);
    light.responses.update(&room.rows());
    light.solution.shot.fill(DVec3::ZERO);
    light.solution.received.fill(DVec3::ZERO);
    light
        .responses
        .warm_start(&mut light.solution, &[(5, Vec3::ONE)]);
    for (row, received) in light.solution.received.iter().enumerate() {
        let seen = room.rows().row(row).iter();
        let seen = seen.filter_map(|id| light.solution.shot.get(id as usize));
        let expected = seen.sum::<DVec3>() / EACH as f64;
        assert!((expected - *received).abs().max_element() < 1e-5, "{row}");
    }
}

//! From one frame to the next: ask again only what the movers may really have changed.
//!
//! A resting receiver looks at its contested samples alone, and of those only at the ones that cross a part of a mover
//! which moved, or that a mover answered before. A receiver on a mover that moved asks everything afresh. What is left
//! unasked has the same answer as in the frame before, because nothing that it could meet has moved. Where only light
//! changed nothing is asked: the same answers are weighed anew.

use super::pairs::{NetPairs, units};
use super::trace::Samples;
use super::view::{self, Half, LAMPS, Slots, View};
use super::{BLOCKED, BackBuffer, Stage, UNASKED, ask};
use crate::formfactor::Emitters;
use crate::formfactor::hemisphere::{Asker, ORIGINS};
use crate::formfactor::light::{self, Scratch};
use crate::geometry::oriented::Seen;
use crate::geometry::{BoxTree, Oriented, Ray};
use crate::patch::Patches;
use rayon::prelude::*;
use std::ops::Add;
use std::sync::Mutex;

/// What one update cost and brought, in samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Changes {
    /// Samples tested against the movers or traced again.
    pub candidates: u64,
    /// Samples whose answer differs from the frame before: the oracle.
    pub changed: u64,
    /// Pairs of receiver and patch whose form factor differs from the frame before.
    pub pairs: u64,
}

impl Add for Changes {
    type Output = Changes;
    fn add(self, other: Changes) -> Changes {
        Changes {
            candidates: self.candidates + other.candidates,
            changed: self.changed + other.changed,
            pairs: self.pairs + other.pairs,
        }
    }
}

/// What moved between two frames.
pub struct Moved {
    /// Per surface: whether its place differs from the frame before.
    pub surfaces: Vec<bool>,
    /// Whether all movers did.
    pub all: bool,
    /// Boxes around the parts of the movers that moved, where they are now.
    pub boxes: BoxTree,
    /// The bit of the swept volume's span that this frame belongs to.
    pub span: u32,
    /// The bit of the span that the frame before belonged to; 0 if there was none.
    pub last_span: u32,
    /// A box that turns with it around each moving surface, where it is now.
    pub movers: Vec<(u32, Oriented)>,
    /// Whether a light moved.
    pub lights: bool,
    /// Whether resting and moving emitters emit something else than in the frame before.
    pub shone: [bool; LAMPS],
}

impl Moved {
    /// Whether any answer may differ from the frame before.
    pub fn any(&self) -> bool {
        self.lights || self.surfaces.contains(&true)
    }

    /// The boxes of the moving surfaces that moved, or nothing where these are too many to ask one by one.
    fn oriented(&self) -> impl Iterator<Item = &Oriented> {
        let few = self.movers.len() <= MOST_ORIENTED;
        let moved = move |(surface, _): &&(u32, Oriented)| few && self.surfaces[*surface as usize];
        self.movers.iter().filter(moved).map(|(_, around)| around)
    }

    /// Whether a ray comes near anything that moved.
    pub(super) fn meets(&self, ray: &Ray) -> bool {
        let few = self.movers.len() <= MOST_ORIENTED;
        let passes = few && !self.oriented().any(|around| around.touches(ray));
        !passes && self.boxes.meets(ray)
    }
}

/// Everything an update reads.
struct Now<'a> {
    patches: &'a Patches,
    back: &'a BackBuffer,
    stage: &'a Stage<'a>,
    moved: &'a Moved,
    /// Resting and moving emitters now.
    lamps: [&'a Emitters; LAMPS],
    first_mover: u32,
    /// Whether any surface moved.
    stirred: bool,
}

/// Receivers of one task at least: some cost a thousand times as much as others, so a few must not hold up a frame.
const TASK: usize = 16;

/// Space lent to a task, and given back: a frame fills only as many as there are threads.
struct Lent<'a> {
    space: Space,
    all: &'a Mutex<Vec<Space>>,
}

impl<'a> From<&'a Mutex<Vec<Space>>> for Lent<'a> {
    fn from(all: &'a Mutex<Vec<Space>>) -> Lent<'a> {
        let free = all.lock().ok().and_then(|mut all| all.pop());
        Lent {
            space: free.unwrap_or_default(),
            all,
        }
    }
}

impl Drop for Lent<'_> {
    fn drop(&mut self) {
        if let Ok(mut all) = self.all.lock() {
            all.push(std::mem::take(&mut self.space));
        }
    }
}

/// Space of one task.
#[derive(Default)]
struct Space {
    light: Scratch,
    aim: ask::Aim,
    old_light: Vec<u32>,
    old_points: Vec<u32>,
    pairs: NetPairs,
    movers: Vec<Seen<ORIGINS>>,
}

/// With more moving surfaces than this a tree over the boxes of their parts is asked instead of each one's own box.
const MOST_ORIENTED: usize = 4;

impl BackBuffer {
    /// The answers with all movers gone, and room for those of the receivers on movers; nothing shines yet.
    pub fn static_view(&self, patches: &Patches) -> View {
        let light = self.light_samples;
        let receivers = patches.static_sides as usize;
        let samples = self.hemisphere.samples;
        let mut resting = Half::room(receivers, samples, light, self.lights, false, self.nothing);
        resting.answers.clone_from(&self.answers);
        resting.covered.copy_from_slice(&self.covered);
        resting.sky.copy_from_slice(&self.sky_light);
        if light[0] > 0 {
            let answers = resting.light[0].chunks_mut(light[0]);
            for (side, answers) in answers.enumerate() {
                let aims = self.aims_of(side);
                let (samples, free) = (&self.aims[aims.clone()], &self.light_free[aims]);
                ask::light(samples, self.covered[side], |s| free[s], answers);
            }
        }
        if self.lights[0] > 0 {
            let answers = resting.points[0].chunks_mut(self.lights[0]);
            for (side, answers) in answers.enumerate() {
                for (answer, point) in answers.iter_mut().zip(self.points_at(side)) {
                    let may = point.reach & !self.covered[side];
                    *answer = ask::points(may, |o| point.free >> o & 1 == 1);
                }
            }
        }
        let moving = Half::room(
            patches.sides.len() - receivers,
            self.moving_hemisphere.samples,
            light,
            self.lights,
            true,
            self.nothing,
        );
        let near = self.near_pairs.as_ref().map(|near| near.view());
        View {
            resting,
            moving,
            near: near.unwrap_or_default(),
        }
    }

    /// Brings a view to the stage's time. The view must be [`BackBuffer::static_view`] or of an earlier update; `moved`
    /// must name every mover whose place differs from that update's, and every kind of emitter that emits something
    /// else (all of them after a static view). Each side's own changes are added to `tally`, if one is given.
    pub fn update(
        &self,
        view: &mut View,
        patches: &Patches,
        stage: &Stage,
        lamps: [&Emitters; LAMPS],
        moved: &Moved,
        tally: Option<&mut [Changes]>,
    ) -> Changes {
        if !moved.any() && moved.shone == [false; LAMPS] {
            return Changes::default();
        }
        let now = Now {
            patches,
            back: self,
            stage,
            moved,
            lamps,
            first_mover: patches.static_sides,
            stirred: moved.surfaces.contains(&true),
        };
        let spaces = Mutex::default();
        let lend = || Lent::from(&spaces);
        let resting = view.resting.slots().enumerate().with_min_len(TASK);
        let resting = resting.map_init(lend, |lent, (i, mut slots)| {
            now.resting(i, &mut lent.space, &mut slots)
        });
        let moving = view.moving.slots().enumerate().with_min_len(TASK);
        let moving = moving.map_init(lend, |lent, (i, mut slots)| {
            now.moving(i, &mut lent.space, &mut slots)
        });
        let (resting_tally, moving_tally) = tally
            .map(|tally| tally.split_at_mut(patches.static_sides as usize))
            .unzip();
        let (resting, moving) =
            rayon::join(|| sum(resting, resting_tally), || sum(moving, moving_tally));
        let near = if now.stirred {
            self.update_near(&mut view.near, patches, stage, moved)
        } else {
            Changes::default()
        };
        resting + moving + near
    }
}

/// The sum over the receivers of a half; each one's part is added to its own tally, where one is kept.
fn sum(
    changes: impl IndexedParallelIterator<Item = Changes>,
    tally: Option<&mut [Changes]>,
) -> Changes {
    let Some(tally) = tally else {
        return changes.reduce(Changes::default, Add::add);
    };
    let noted = changes.zip(tally).map(|(changes, tally)| {
        *tally = *tally + changes;
        changes
    });
    noted.reduce(Changes::default, Add::add)
}

impl Now<'_> {
    /// Whether emitters of a kind must be asked afresh by receivers that they, or who asks, move past.
    fn asks_afresh(&self, lamp: usize) -> bool {
        !self.lamps[lamp].is_dark() && (self.stirred || (lamp == 1 && self.moved.lights))
    }

    /// Whether emitters of a kind emit something else now.
    fn shone(&self, lamp: usize) -> bool {
        !self.lamps[lamp].is_dark() && self.moved.shone[lamp]
    }

    /// Updates a receiver that never moves.
    fn resting(&self, i: usize, space: &mut Space, slots: &mut Slots) -> Changes {
        let mut changes = Changes::default();
        let origins = self.back.contested_origins[i];
        let either = self.moved.span | self.moved.last_span;
        let light_contested = self.stirred && self.back.light_spans[i] & either != 0;
        let (samples, spans) = self.back.contested_of(i);
        let contested = self.stirred && !samples.list.is_empty();
        let nothing = !contested && !light_contested && !self.asks_afresh(1);
        if nothing && !self.shone(0) && !self.shone(1) {
            return changes;
        }
        let asker = self
            .back
            .hemisphere
            .asker(self.patches, self.stage.placed, i as u32);
        let covered = *slots.covered;
        if light_contested && origins != 0 {
            *slots.covered = self.covered_at_rest(&asker, i, origins, covered, &mut changes);
        }
        if contested {
            self.contested(&asker, samples, spans, space, slots, &mut changes);
        }
        if light_contested || self.shone(0) {
            self.resting_light(&asker, i, covered, space, slots, &mut changes);
        }
        if self.asks_afresh(1) {
            self.fresh_light(&asker, i as u32, 1, space, slots, &mut changes);
        } else if self.shone(1) {
            self.relight(&asker, i as u32, 1, space, slots);
        }
        changes
    }

    /// Which origins of a resting receiver are covered now: those that resting geometry covers, or a mover.
    fn covered_at_rest(
        &self,
        asker: &Asker,
        i: usize,
        contested: u16,
        old: u16,
        changes: &mut Changes,
    ) -> u16 {
        let mut covered = old;
        for origin in
            (0..ORIGINS).filter(|o| contested >> o & 1 == 1 && self.back.covered[i] >> o & 1 == 0)
        {
            let ray = ask::cover_ray(asker, origin);
            if old >> origin & 1 == 1 || self.moved.meets(&ray) {
                changes.candidates += 1;
                let now = self.stage.mover_covers(self.patches, &ray) as u16;
                covered = covered & !(1 << origin) | now << origin;
            }
        }
        changes.changed += (covered ^ old).count_ones() as u64;
        covered
    }

    /// Asks the contested hemisphere samples of a resting receiver again where a mover may matter.
    fn contested(
        &self,
        asker: &Asker,
        samples: Samples,
        spans: &[u32],
        space: &mut Space,
        slots: &mut Slots,
        changes: &mut Changes,
    ) {
        let nothing = self.back.nothing;
        let mut sky = false;
        space.pairs.start(self.patches.sides.len());
        space.movers.clear();
        if !samples.list.is_empty() {
            let moved = self.moved.oriented();
            space.movers.extend(moved.map(|around| asker.sees(around)));
        }
        let either = self.moved.span | self.moved.last_span;
        for (s, spans) in spans.iter().enumerate() {
            if spans & either == 0 {
                continue;
            }
            let (sample, answer) = (&samples.list[s], samples.answer(s));
            let k = sample.k as usize;
            let old = slots.answers.get(k);
            let by_mover = old != answer;
            if !by_mover && spans & self.moved.span == 0 {
                continue;
            }
            let new = if ask::is_covered(*slots.covered, k) {
                nothing.covered
            } else {
                // Pass by what goes past all that moved; a mover that answered before mostly answers again.
                let touches = |m: &Seen<ORIGINS>| m.touches(k, asker.turned(k), sample.reach);
                let few = !space.movers.is_empty();
                if !by_mover && few && !space.movers.iter().any(touches) {
                    continue;
                }
                let ray = Ray {
                    tmax: sample.reach,
                    ..ask::hemisphere_ray(asker, k)
                };
                if !by_mover && !self.moved.all && !self.moved.boxes.meets(&ray) {
                    continue;
                }
                let (hit, near) = self.stage.closest_mover(&ray);
                changes.candidates += (near || by_mover) as u64;
                match hit {
                    None => answer,
                    hit => ask::answer(
                        self.patches,
                        self.stage.placed,
                        nothing,
                        hit.as_ref(),
                        ray.direction,
                    ),
                }
            };
            if new != old {
                changes.changed += 1;
                let units = units(asker.weights, k);
                space.pairs.change(old, new, units);
                slots.answers.set(k, new);
                sky |= old == nothing.sky || new == nothing.sky;
            }
        }
        changes.pairs += space.pairs.count();
        if let Some([soft, _]) = self.back.sky.as_ref().filter(|_| sky) {
            *slots.sky = ask::sky(soft, nothing, asker, slots.answers.read().iter());
        }
    }

    /// Asks the contested light samples of a resting receiver to resting emitters, and weighs them if any changed or the
    /// light did; `old_covered` are the origins that were covered before.
    fn resting_light(
        &self,
        asker: &Asker,
        i: usize,
        old_covered: u16,
        space: &mut Space,
        slots: &mut Slots,
        changes: &mut Changes,
    ) {
        let (back, aims) = (self.back, self.back.aims_of(i));
        let samples = &back.aims[aims.clone()];
        let before = changes.changed;
        if self.stirred {
            let (free, contested) = (&back.light_free[aims.clone()], &back.light_contested[aims]);
            let free_now = |s: usize, was_free: bool, candidates: &mut u64| {
                if !free[s] || !contested[s] {
                    return free[s];
                }
                let ray = light::ray(asker.point(s), samples[s].target, self.patches.lift);
                self.still_free(&ray, was_free, candidates)
            };
            space.old_light.clear();
            space.old_light.extend_from_slice(slots.light[0]);
            let old = &space.old_light;
            let free_now = |s: usize| {
                let was_free = old[s] != UNASKED && old[s] != BLOCKED;
                free_now(s, was_free, &mut changes.candidates)
            };
            ask::light(samples, *slots.covered, free_now, slots.light[0]);
            let changed = slots.light[0].iter().zip(old).filter(|(a, b)| a != b);
            changes.changed += changed.count() as u64;
            self.resting_points(asker, i, slots, changes);
        }
        // What a light brings is a mean over the origins that count, so it follows these too.
        let covers = old_covered != *slots.covered && back.lights[0] > 0;
        if changes.changed > before || covers || self.shone(0) {
            view::relight(asker, self.lamps[0], 0, back.factors_at(i), samples, slots);
        }
    }

    /// Asks again whether resting lights shine on a resting receiver.
    fn resting_points(&self, asker: &Asker, i: usize, slots: &mut Slots, changes: &mut Changes) {
        let lights = self.lamps[0].lights.iter().zip(self.back.points_at(i));
        for ((light, point), answer) in lights.zip(slots.points[0].iter_mut()) {
            let old = *answer;
            *answer = ask::points(point.reach & !*slots.covered, |o| {
                if point.contested >> o & 1 == 0 {
                    return point.free >> o & 1 == 1;
                }
                let ray = ask::light_ray(light, asker, o, i as u32, self.patches.lift);
                self.still_free(&ray, old >> o & 1 == 1, &mut changes.candidates)
            });
            changes.changed += ask::points_differ(old, *answer) as u64;
        }
    }

    /// Whether a ray that nothing at rest blocks is free now.
    fn still_free(&self, ray: &Ray, was_free: bool, candidates: &mut u64) -> bool {
        if was_free && !self.moved.meets(ray) {
            return true;
        }
        *candidates += 1;
        !self.stage.blocked_by_mover(ray)
    }

    /// Weighs the answers to one kind of emitter anew, without asking: the aim is the same as when they were asked.
    fn relight(&self, asker: &Asker, side: u32, lamp: usize, space: &mut Space, slots: &mut Slots) {
        let Space { light, aim, .. } = space;
        let cells = self.lamps[lamp];
        view::aim(self.patches, asker, side, cells, lamp, light, aim, slots);
        view::relight(asker, cells, lamp, &aim.factors, &aim.samples, slots);
    }

    /// Aims and asks all light samples to one kind of emitter, counting what changed.
    fn fresh_light(
        &self,
        asker: &Asker,
        side: u32,
        lamp: usize,
        space: &mut Space,
        slots: &mut Slots,
        changes: &mut Changes,
    ) {
        let cells = self.lamps[lamp];
        space.old_light.clear();
        space.old_light.extend_from_slice(slots.light[lamp]);
        space.old_points.clear();
        space.old_points.extend_from_slice(slots.points[lamp]);
        let Space { light, aim, .. } = space;
        view::lights(
            self.patches,
            self.stage,
            asker,
            side,
            cells,
            lamp,
            light,
            aim,
            slots,
        );
        changes.candidates += self.back.light_samples[lamp] as u64;
        changes.candidates += (cells.lights.len() * ORIGINS) as u64;
        changes.changed += slots.light[lamp]
            .iter()
            .zip(&space.old_light)
            .filter(|(a, b)| a != b)
            .count() as u64;
        let points = slots.points[lamp].iter().zip(&space.old_points);
        changes.changed += points
            .map(|(a, b)| ask::points_differ(*a, *b) as u64)
            .sum::<u64>();
    }

    /// Updates a receiver on a mover.
    fn moving(&self, i: usize, space: &mut Space, slots: &mut Slots) -> Changes {
        let mut changes = Changes::default();
        let side = self.first_mover + i as u32;
        let element = self.patches.sides[side as usize].element;
        let triangle = self.patches.elements[element as usize].triangle;
        let fresh = self.moved.surfaces[self.patches.surface_of[triangle as usize] as usize];
        let asker = self
            .back
            .moving_hemisphere
            .asker(self.patches, self.stage.placed, side);

        // What is away and was away before has no answer that could change.
        if !fresh && asker.stand.is_flat() {
            return changes;
        }
        if self.stirred {
            self.moving_row(&asker, fresh, space, slots, &mut changes);
        }
        for lamp in 0..LAMPS {
            if self.asks_afresh(lamp) {
                self.fresh_light(&asker, side, lamp, space, slots, &mut changes);
            } else if self.shone(lamp) {
                self.relight(&asker, side, lamp, space, slots);
            }
        }
        changes
    }

    /// Asks a receiver on a mover for its covered origins and hemisphere samples; all of them if it moved itself.
    fn moving_row(
        &self,
        asker: &Asker,
        fresh: bool,
        space: &mut Space,
        slots: &mut Slots,
        changes: &mut Changes,
    ) {
        // A side with all movers below it, as every side of a convex one that moves alone, meets none of them.
        let (point, normal) = (asker.stand.corners[0], asker.stand.normal);
        let below = 0.5 * self.patches.lift;
        let alone = self
            .moved
            .movers
            .iter()
            .all(|(_, around)| around.is_below(point, normal, below));
        let covered = *slots.covered;
        for origin in 0..ORIGINS {
            let ray = ask::cover_ray(asker, origin);
            if fresh || covered >> origin & 1 == 1 || self.moved.meets(&ray) {
                changes.candidates += 1;
                let blocked = |ray: &Ray| {
                    if alone {
                        self.stage.rest_covers(self.patches, ray)
                    } else {
                        self.stage.covers(self.patches, ray)
                    }
                };
                let now = ask::covers(asker, origin, blocked) as u16;
                *slots.covered = *slots.covered & !(1 << origin) | now << origin;
            }
        }
        changes.changed += (*slots.covered ^ covered).count_ones() as u64;

        space.pairs.start(self.patches.sides.len());
        for k in 0..slots.answers.len() {
            let old = slots.answers.get(k);
            if !fresh && !self.may_differ(asker, k, old, slots) {
                continue;
            }
            changes.candidates += 1;
            let closest = |ray: &Ray| {
                if alone {
                    self.stage.closest_at_rest(ray)
                } else {
                    self.stage.closest(ray)
                }
            };
            let nothing = self.back.nothing;
            let placed = self.stage.placed;
            view::hemisphere(self.patches, placed, nothing, asker, k, closest, slots);
            let new = slots.answers.get(k);
            if new != old {
                changes.changed += 1;
                let units = units(asker.weights, k);
                space.pairs.change(old, new, units);
            }
        }
        changes.pairs += space.pairs.count();
        // Its samples turn with it, so that the same answers may come from elsewhere.
        let differ = changes.changed > 0 || fresh;
        if let Some([_, soft]) = self.back.sky.as_ref().filter(|_| differ) {
            *slots.sky = ask::sky(soft, self.back.nothing, asker, slots.answers.read().iter());
        }
    }

    /// Whether a sample of a receiver whose own mover rests may have another answer now.
    fn may_differ(&self, asker: &Asker, k: usize, old: u32, slots: &Slots) -> bool {
        let nothing = self.back.nothing;
        let on_mover =
            (old >= self.first_mover && old < nothing.covered) || old == nothing.black_mover;
        let covered = ask::is_covered(*slots.covered, k);
        // Take the old answer's distance with a hair more, so that a mover that draws level is asked about.
        let tmax = slots.reach[k] * (1.0 + 1e-5);
        on_mover
            || covered != (old == nothing.covered)
            || (!covered
                && self.moved.meets(&Ray {
                    tmax,
                    ..ask::hemisphere_ray(asker, k)
                }))
    }
}

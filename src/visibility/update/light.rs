//! Updating what arrives straight from the emitters: its samples are asked again where a mover may matter, and only
//! weighed anew where nothing but the emission changed.

use super::{Now, Space};
use crate::formfactor::hemisphere::{Asker, ORIGINS};
use crate::geometry::Ray;
use crate::visibility::receiver::{self, Slots};
use crate::visibility::{BLOCKED, Changes, UNASKED, sample};

impl Now<'_> {
    /// Whether emitters of a kind must be asked afresh by receivers that they, or who asks, move past.
    pub(super) fn asks_afresh(&self, lamp: usize) -> bool {
        !self.lamps[lamp].is_dark() && (self.stirred || (lamp == 1 && self.moved.lights))
    }

    /// Whether emitters of a kind emit something else now.
    pub(super) fn shone(&self, lamp: usize) -> bool {
        !self.lamps[lamp].is_dark() && self.moved.shone[lamp]
    }

    /// Asks the contested light samples of a resting receiver to resting emitters, and weighs them if any changed or the
    /// light did; `old_covered` are the origins that were covered before.
    pub(super) fn resting_light(
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
            let free_now = |s: usize, was_free: bool, traced: &mut u64| {
                if !free[s] || !contested[s] {
                    return free[s];
                }
                let ray = Ray::to_point(asker.point(s), samples[s].target, self.patches.lift);
                self.still_free(&ray, was_free, traced)
            };
            space.old_light.clear();
            space.old_light.extend_from_slice(slots.light[0]);
            let old = &space.old_light;
            let free_now = |s: usize| {
                let was_free = old[s] != UNASKED && old[s] != BLOCKED;
                free_now(s, was_free, &mut changes.traced)
            };
            sample::light(samples, *slots.covered, free_now, slots.light[0]);
            let changed = slots.light[0].iter().zip(old).filter(|(a, b)| a != b);
            changes.changed += changed.count() as u64;
            self.resting_points(asker, i, slots, changes);
        }
        // What a light brings is a mean over the origins that count, so it follows these too.
        let covers = old_covered != *slots.covered && back.lights[0] > 0;
        if changes.changed > before || covers || self.shone(0) {
            receiver::relight(asker, self.lamps[0], 0, back.factors_at(i), samples, slots);
        }
    }

    /// Asks again whether resting lights shine on a resting receiver.
    fn resting_points(&self, asker: &Asker, i: usize, slots: &mut Slots, changes: &mut Changes) {
        let lights = self.lamps[0].lights.iter().zip(self.back.points_at(i));
        for ((light, point), answer) in lights.zip(slots.points[0].iter_mut()) {
            let old = *answer;
            *answer = sample::points(point.reach & !*slots.covered, |o| {
                if point.contested >> o & 1 == 0 {
                    return point.free >> o & 1 == 1;
                }
                let ray = sample::light_ray(light, asker, o, i as u32, self.patches.lift);
                self.still_free(&ray, old >> o & 1 == 1, &mut changes.traced)
            });
            changes.changed += sample::points_differ(old, *answer) as u64;
        }
    }

    /// Whether a ray that nothing at rest blocks is free now.
    fn still_free(&self, ray: &Ray, was_free: bool, traced: &mut u64) -> bool {
        if was_free && !self.moved.meets(ray) {
            return true;
        }
        *traced += 1;
        !self.stage.blocked_by_mover(ray)
    }

    /// Weighs the answers to one kind of emitter anew, without asking: the aim is the same as when they were asked.
    pub(super) fn relight(
        &self,
        asker: &Asker,
        side: u32,
        lamp: usize,
        space: &mut Space,
        slots: &mut Slots,
    ) {
        let Space { light, aim, .. } = space;
        let cells = self.lamps[lamp];
        receiver::aim(self.patches, asker, side, cells, lamp, light, aim, slots);
        receiver::relight(asker, cells, lamp, &aim.factors, &aim.samples, slots);
    }

    /// Aims and asks all light samples to one kind of emitter, counting what changed.
    pub(super) fn fresh_light(
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
        receiver::lights(
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
        changes.traced += self.back.light_samples[lamp] as u64;
        changes.traced += (cells.lights.len() * ORIGINS) as u64;
        changes.changed += slots.light[lamp]
            .iter()
            .zip(&space.old_light)
            .filter(|(a, b)| a != b)
            .count() as u64;
        let points = slots.points[lamp].iter().zip(&space.old_points);
        changes.changed += points
            .map(|(a, b)| sample::points_differ(*a, *b) as u64)
            .sum::<u64>();
    }
}

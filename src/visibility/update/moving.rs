//! Updating a receiver on a mover: everything is asked again if the mover moved, else what others that moved may matter to.

use super::{Now, Space};
use crate::formfactor::hemisphere::{Asker, ORIGINS};
use crate::geometry::Ray;
use crate::visibility::changed_pairs::units;
use crate::visibility::receiver::{self, Slots};
use crate::visibility::store::LAMPS;
use crate::visibility::{Changes, sample};

impl Now<'_> {
    /// Updates a receiver on a mover.
    pub(super) fn moving(&self, i: usize, space: &mut Space, slots: &mut Slots) -> Changes {
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
            let ray = sample::cover_ray(asker, origin);
            if fresh || covered >> origin & 1 == 1 || self.moved.meets(&ray) {
                changes.traced += 1;
                let blocked = |ray: &Ray| {
                    if alone {
                        self.stage.rest_covers(self.patches, ray)
                    } else {
                        self.stage.covers(self.patches, ray)
                    }
                };
                let now = sample::covers(asker, origin, blocked) as u16;
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
            changes.traced += 1;
            let closest = |ray: &Ray| {
                if alone {
                    self.stage.closest_at_rest(ray)
                } else {
                    self.stage.closest(ray)
                }
            };
            let nothing = self.back.nothing;
            let placed = self.stage.placed;
            receiver::hemisphere(self.patches, placed, nothing, asker, k, closest, slots);
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
            *slots.sky = sample::sky(soft, self.back.nothing, asker, slots.answers.read().iter());
        }
    }

    /// Whether a sample of a receiver whose own mover rests may have another answer now.
    fn may_differ(&self, asker: &Asker, k: usize, old: u32, slots: &Slots) -> bool {
        let nothing = self.back.nothing;
        let on_mover =
            (old >= self.first_mover && old < nothing.covered) || old == nothing.black_mover;
        let covered = sample::is_covered(*slots.covered, k);
        // Take the old answer's distance with a hair more, so that a mover that draws level is asked about.
        let tmax = slots.reach[k] * (1.0 + 1e-5);
        on_mover
            || covered != (old == nothing.covered)
            || (!covered
                && self.moved.meets(&Ray {
                    tmax,
                    ..sample::hemisphere_ray(asker, k)
                }))
    }
}

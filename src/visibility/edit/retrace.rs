//! Asking the marked samples.
//!
//! A sample whose answer moved sees what moved, if that is still nearer, and else the first thing from its old distance on: whatever
//! else there was lay no nearer. A sample that may cross what moved is tested against that alone; where both draw
//! level, all is asked, since the lower number wins.

use super::cones::Cones;
use super::hits::{Answers, COVERED, SKY, Slots, Tables, answer, black_surface, is_black};
use super::moved_bounds::{COVER, FRESH, Marks, UNCOVERED};
use crate::emission::FilteredSky;
use crate::formfactor::Hemisphere;
use crate::formfactor::hemisphere::{Asker, ORIGINS, turn};
use crate::geometry::obb_packet::keep_touching;
use crate::geometry::{Abreast, Hit, Oriented, Ray, Tree};
use crate::mesh::Patches;
use crate::visibility::{Stage, sample};
use glam::Vec3;
use rayon::prelude::*;

/// What asking found.
#[derive(Default)]
pub(crate) struct Found {
    /// Samples that were asked, covers included.
    pub(crate) asked: u64,
    /// Samples whose answer is another: their position in the list of all, and the old answer.
    pub(crate) changed: Vec<(u32, u32)>,
    /// Sides of which an answer or a cover is another.
    pub(crate) sides: Vec<u32>,
    /// Of those, the ones of which all was asked, or of which a cover is another.
    pub(crate) anew: Vec<u32>,
    /// How many samples more, or fewer, met the black back of a surface; one may occur again and again.
    backs: Vec<(u32, i64)>,
}

impl Found {
    /// Takes note of so many samples more with an answer, if that is a black back.
    fn count(&mut self, id: u32, more: i64) {
        let Some(surface) = black_surface(id) else {
            return;
        };
        match self.backs.last_mut() {
            Some((last, count)) if *last == surface => *count += more,
            _ => self.backs.push((surface, more)),
        }
    }
}

/// Sides that one thread asks in one go, at most: those of what moved follow one another and ask most, so that a
/// quarter of all sides, which is what two threads would share the work in, may hold half of it.
pub(crate) const GO: usize = 128;

/// A bit for the first sample of each sixteen: times a mask of origins it is a mask of samples.
const EACH_ORIGIN: u64 = 0x0001_0001_0001_0001;

/// One side's slots.
struct Row<'a> {
    ids: Slots<'a>,
    reach: &'a mut [f32],
    count: &'a mut u16,
    covered: &'a mut u16,
    sky: &'a mut Vec3,
    black: &'a mut u16,
}

/// What is asked.
pub(crate) struct Asked<'a> {
    pub(crate) patches: &'a Patches,
    pub(crate) tables: &'a Tables,
    /// Everything, where it is now.
    pub(crate) stage: &'a Stage<'a>,
    /// What moved, where it is now.
    pub(crate) movers: &'a Tree,
    /// Whether nothing else stands in the smaller tree.
    pub(crate) alone: bool,
    /// The surface of each side.
    pub(crate) surface_of_side: &'a [u32],
    /// Per surface: whether its sides take fewer samples.
    pub(crate) loose: &'a [bool],
    /// Whether anybody wants to know which samples changed.
    pub(crate) notes: bool,
    /// Boxes around what moved, where it is now.
    pub(crate) shapes: &'a [Oriented],
}

impl Asked<'_> {
    /// Asks what is marked, and marks the sides whose covered origins have changed.
    pub(crate) fn ask(&self, answers: &mut Answers, marks: &mut Marks) -> Found {
        let (stride, words) = (answers.stride(), marks.words);
        let code = answers.code;
        let rows = (
            answers.ids.rows_mut(),
            answers.reach.par_chunks_mut(stride),
            answers.count.par_iter_mut(),
            answers.covered.par_iter_mut(),
            answers.sky.par_iter_mut(),
            answers.black.par_iter_mut(),
        );
        let marks = (
            marks.flags.par_iter_mut(),
            marks.bits.par_chunks_mut(2 * words.max(1)),
        );
        let all = rows.into_par_iter().zip(marks.into_par_iter()).enumerate();
        let found = all.with_min_len(16).with_max_len(GO).fold(
            Default::default,
            |(mut found, mut boxes), (side, (row, (flag, bits)))| {
                if *flag != 0 {
                    let (row, reach, count, covered, sky, black) = row;
                    let ids = Slots { row, code };
                    let row = Row {
                        ids,
                        reach,
                        count,
                        covered,
                        sky,
                        black,
                    };
                    self.side(side as u32, row, flag, bits, &mut found, &mut boxes);
                }
                (found, boxes)
            },
        );
        let found = found
            .map(|(found, _)| found)
            .reduce(Found::default, |mut one, mut other| {
                one.asked += other.asked;
                one.changed.append(&mut other.changed);
                one.sides.append(&mut other.sides);
                one.anew.append(&mut other.anew);
                one.backs.append(&mut other.backs);
                one
            });
        for (surface, more) in &found.backs {
            answers.backs[*surface as usize] += more;
        }
        found
    }

    fn table(&self, side: u32) -> (&Hemisphere, &Cones, Option<&FilteredSky>) {
        let loose = self.loose[self.surface_of_side[side as usize] as usize] as usize;
        let sky = self.tables.sky.as_ref().map(|sky| &sky[loose]);
        (
            &self.tables.directions[loose],
            &self.tables.cones[loose],
            sky,
        )
    }

    /// Asks what is marked of one side.
    fn side(
        &self,
        side: u32,
        mut row: Row,
        flag: &mut u8,
        bits: &mut [u64],
        found: &mut Found,
        boxes: &mut Vec<Abreast>,
    ) {
        let (table, cones, sky) = self.table(side);
        let asker = table.asker(self.patches, self.stage.placed, side);
        let (known, first) = (found.changed.len(), side * row.ids.len() as u32);
        let covered = *row.covered;
        if *flag & (FRESH | COVER) != 0 {
            *row.covered = sample::covered(&asker, |ray| self.stage.covers(self.patches, ray));
            found.asked += ORIGINS as u64;
        }
        if *flag == FRESH {
            *row.count = table.samples as u16;
            for k in 0..row.ids.len() {
                let old = row.ids.get(k);
                if k < table.samples {
                    self.afresh(&asker, k, &mut row, 0.0);
                } else {
                    row.ids.set(k, COVERED);
                    row.reach[k] = f32::INFINITY;
                }
                if row.ids.get(k) != old {
                    self.note(found, [old, row.ids.get(k)], first + k as u32, row.black);
                }
            }
            found.asked += table.samples as u64;
        } else {
            let uncovered = covered ^ *row.covered;
            for k in (0..*row.count as usize).filter(|k| sample::is_covered(uncovered, *k)) {
                let old = row.ids.get(k);
                self.afresh(&asker, k, &mut row, 0.0);
                self.note(found, [old, row.ids.get(k)], first + k as u32, row.black);
                found.asked += 1;
            }
            let (gone, come) = bits.split_at_mut(bits.len() / 2);
            if come.iter().any(|word| *word != 0) {
                let seen = self.shapes.iter().map(|shape| asker.sees(shape));
                boxes.clear();
                boxes.extend(seen.map(|seen| Abreast::of(&seen)));
                let directions = cones.directions(turn(side, 0).0);
                keep_touching(boxes, directions, row.reach, come);
            }
            let open = u64::from(!(uncovered | *row.covered)) * EACH_ORIGIN;
            for word in gone.iter_mut().chain(come.iter_mut()) {
                *word &= open;
                found.asked += u64::from(word.count_ones());
            }
            for k in set(gone) {
                let old = row.ids.get(k);
                self.left(&asker, k, &mut row);
                if row.ids.get(k) != old {
                    self.note(found, [old, row.ids.get(k)], first + k as u32, row.black);
                }
            }
            for k in set(come) {
                let old = row.ids.get(k);
                self.crossed(&asker, k, &mut row);
                if row.ids.get(k) != old {
                    self.note(found, [old, row.ids.get(k)], first + k as u32, row.black);
                }
            }
        }
        if covered != *row.covered {
            *flag |= UNCOVERED;
        }
        // A fresh side may see the same things from elsewhere, or in another order.
        let anew = *flag & (FRESH | UNCOVERED) != 0;
        if anew {
            found.anew.push(side);
        }
        if found.changed.len() > known || anew {
            found.sides.push(side);
            if let Some(sky) = sky {
                *row.sky = sky_of(sky, &asker, &row.ids);
            }
        }
    }

    /// Takes note of an answer that was another.
    fn note(&self, found: &mut Found, [old, new]: [u32; 2], sample: u32, black: &mut u16) {
        *black = *black + u16::from(is_black(new)) - u16::from(is_black(old));
        found.count(new, 1);
        found.count(old, -1);
        if self.notes {
            found.changed.push((sample, old));
        }
    }

    /// Asks sample k through everything, from a distance on before which there is nothing.
    fn afresh(&self, asker: &Asker, k: usize, row: &mut Row, tmin: f32) {
        if sample::is_covered(*row.covered, k) {
            row.ids.set(k, COVERED);
            row.reach[k] = f32::INFINITY;
            return;
        }
        let ray = sample::hemisphere_ray(asker, k);
        let hit = self.stage.closest(&Ray { tmin, ..ray });
        self.answered(k, row, &ray, hit);
    }

    /// Asks a sample whose answer moved.
    fn left(&self, asker: &Asker, k: usize, row: &mut Row) {
        let ray = sample::hemisphere_ray(asker, k);
        let tmax = row.reach[k];
        // Where nothing else is apart, what it meets farther off is of use too.
        let end = if self.alone { ray.tmax } else { tmax };
        let hit = self.movers.closest(&Ray { tmax: end, ..ray });
        // A hit must exceed tmin: one that is as far as the old answer counts.
        let tmin = tmax.next_down().max(0.0);
        match hit {
            Some(hit) if hit.t < tmax => self.answered(k, row, &ray, Some(hit)),
            _ if self.alone && !sample::is_covered(*row.covered, k) => {
                let hit = self.stage.closest_beside(&Ray { tmin, ..ray }, hit);
                self.answered(k, row, &ray, hit);
            }
            _ => self.afresh(asker, k, row, tmin),
        }
    }

    /// Writes down what a sample's ray meets.
    #[inline]
    fn answered(&self, k: usize, row: &mut Row, ray: &Ray, hit: Option<Hit>) {
        let id = answer(self.patches, self.stage.placed, hit.as_ref(), ray.direction);
        row.ids.set(k, id);
        row.reach[k] = hit.map_or(f32::INFINITY, |hit| hit.t);
    }

    /// Asks a sample that may cross what moved.
    fn crossed(&self, asker: &Asker, k: usize, row: &mut Row) {
        let ray = sample::hemisphere_ray(asker, k);
        let reach = row.reach[k];
        let tmax = reach.next_up();
        match self.movers.closest(&Ray { tmax, ..ray }) {
            Some(hit) if hit.t < reach => self.answered(k, row, &ray, Some(hit)),
            Some(hit) => self.afresh(asker, k, row, hit.t.next_down().max(0.0)),
            None => {}
        }
    }
}

/// The positions of the bits that are set.
fn set(words: &[u64]) -> impl Iterator<Item = usize> {
    words.iter().enumerate().flat_map(|(word, bits)| {
        let mut bits = *bits;
        std::iter::from_fn(move || {
            let at = bits.trailing_zeros() as usize;
            (bits != 0).then(|| {
                bits &= bits - 1;
                64 * word + at
            })
        })
    })
}

/// Irradiance from the sky, of one sample's share each.
fn sky_of(sky: &FilteredSky, asker: &Asker, ids: &Slots) -> Vec3 {
    let out = (0..ids.len()).filter(|k| ids.get(*k) == SKY);
    out.map(|k| sky.radiance(asker.direction(k))).sum::<Vec3>() * std::f32::consts::PI
}

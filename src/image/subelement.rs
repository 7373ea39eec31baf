//! Cache of direct light on sixteen cells of an element, for gather rays that hit an element at close range.
//!
//! Lischinski, Tampieri, Greenberg 1993, "Combining hierarchical radiosity and discontinuity meshing", Computer Graphics
//! 27:199–208: their local pass computes direct light near a point from the emitters themselves. From afar a constant
//! radiosity over each element is enough. Near a contact it is not: an element that a shadow's edge crosses looks half lit
//! from the dark corner, which becomes too bright. So a ray that hits an element within two of its longest edges looks up
//! a cell, which is lit directly like a fragment of a pixel; the indirect part stays that of the element. Pixels share the
//! cells. Cells are kept from frame to frame like pixels, and traced again only where a mover may alter their light.

use super::changes::{MovedBoxes, SceneChanges, shaded};
use super::context::ShadingContext;
use super::direct;
use super::fragment::Fragment;
use super::hit_id::{CELLS, GatherHit, HitId};
use super::pixel::Pixel;
use crate::geometry::Hit;
use crate::ids::SideId;
use crate::mesh::{Kind, PosedMesh, RadiosityMesh};
use glam::{Vec3, Vec3A};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU16, Ordering};

/// Elements nearer than so many times their longest edge are looked at in cells: further away, one cell fills little of
/// the hemisphere.
const NEAR: f32 = 2.0;

/// Tasks take so many cells.
const CHUNK: usize = 16;

/// Corners of a cell, as weights of its element's second and third corner.
fn corners(cell: u32) -> [[f32; 2]; 3] {
    let row = (0..CELLS)
        .rev()
        .find(|b| b * (2 * CELLS - b) <= cell)
        .unwrap_or(0);
    let within = cell - row * (2 * CELLS - row);
    let place = within / 2;
    let at = |b: u32, c: u32| [b as f32 / CELLS as f32, c as f32 / CELLS as f32];
    match within % 2 {
        0 => [at(row, place), at(row + 1, place), at(row, place + 1)],
        _ => [
            at(row + 1, place + 1),
            at(row, place + 1),
            at(row + 1, place),
        ],
    }
}

/// The cell of a side that a ray hits, if it is near.
pub fn cell(patches: &RadiosityMesh, placed: &PosedMesh, side: SideId, hit: &Hit) -> Option<HitId> {
    let surface = || &patches.surfaces[patches.surface_of[hit.triangle]];
    if hit.t >= NEAR * patches.element_size || surface().transmission.is_some() {
        return None;
    }
    let (element, weights) = patches.cuts.locate(hit.triangle, hit.u, hit.v);
    if patches.clusters.cluster(element).is_some() {
        // Its triangles are small, and cells are those of one.
        return None;
    }
    let [a, b, c] = placed.element_corners(&patches.elements[element]);
    let edges = [a - b, b - c, c - a].map(Vec3::length_squared);
    let longest = edges.into_iter().fold(0.0, f32::max);
    (hit.t * hit.t < NEAR * NEAR * longest).then(|| HitId::cell(side, weights))
}

/// The cells that gather rays hit, with the direct light on each.
#[derive(Clone, Debug, Default)]
pub struct SubelementCache {
    /// A bit for each cell of each side that is looked at.
    wanted: Vec<u16>,
    /// Where each side's cells start.
    start: Vec<u32>,
    /// Each cell as a pixel that sees one plane, of which all is in it.
    cells: Vec<Pixel>,
}

impl SubelementCache {
    /// Brings the cells that hits name to time t, and all others that are known if `more`; `changes` is `None` when nothing is
    /// known about the last frame.
    pub fn update<'a>(
        &mut self,
        scene: &ShadingContext,
        named: impl ParallelIterator<Item = &'a [GatherHit]>,
        changes: Option<&SceneChanges>,
        more: bool,
    ) {
        let same = changes.is_some_and(SceneChanges::is_none);
        self.want(scene.patches, named, (changes.is_some(), more));
        let boxes = MovedBoxes::of(changes);
        let sides: Vec<(SideId, u32)> = (scene.patches.side_ids())
            .zip(&self.wanted)
            .flat_map(|(side, wanted)| {
                let cells = (0..16).filter(move |cell| wanted >> cell & 1 == 1);
                cells.map(move |cell| (side, cell))
            })
            .collect();
        let cells = self.cells.par_iter_mut().zip(sides).with_min_len(CHUNK);
        cells.for_each_init(
            direct::LightScratch::default,
            |space, (pixel, (side, cell))| {
                if same && !pixel.groups.is_empty() {
                    return;
                }
                // What moved or has another colour, or was not looked at before, is lit again.
                let plane = plane(scene, side, cell);
                let moved = !pixel
                    .groups
                    .first()
                    .is_some_and(|old| old.stands_as(&plane));
                if moved {
                    pixel.groups = [plane].into();
                }
                for kind in Kind::BOTH {
                    let emitters_changed = changes.is_some_and(|changes| changes.emitters[kind]);
                    if moved || emitters_changed || shaded(pixel, scene, kind, &boxes) {
                        let seed = side.number().wrapping_mul(16).wrapping_add(cell);
                        let pass = direct::LightPass::Few;
                        direct::relight(scene, pixel, kind, seed, pass, None, space);
                    }
                }
            },
        );
    }

    /// Takes over which cells are looked at now; those that were before keep their light if `known`, and are looked at on if `all`.
    fn want<'a>(
        &mut self,
        patches: &RadiosityMesh,
        named: impl ParallelIterator<Item = &'a [GatherHit]>,
        (known, all): (bool, bool),
    ) {
        let before = |side| self.wanted.get(side).filter(|_| all).copied();
        let wanted: Vec<AtomicU16> = (0..patches.sides.len())
            .map(|side| AtomicU16::new(before(side).unwrap_or(0)))
            .collect();
        named.for_each(|hits| {
            for (side, cell) in hits.iter().map(|hit| hit.seen.parts()) {
                if let Some(cell) = cell {
                    let bit = 1 << cell;
                    let bits = &wanted[side as usize];
                    // Most were named before: look first, for a store takes the line away from the other threads.
                    if bits.load(Ordering::Relaxed) & bit == 0 {
                        bits.fetch_or(bit, Ordering::Relaxed);
                    }
                }
            }
        });
        let wanted: Vec<u16> = wanted.into_iter().map(AtomicU16::into_inner).collect();
        let mut old = std::mem::take(&mut self.cells).into_iter();
        let before = std::mem::replace(&mut self.wanted, wanted);
        self.start.clear();
        for (side, wanted) in self.wanted.iter().enumerate() {
            self.start.push(self.cells.len() as u32);
            let before = before.get(side).copied().unwrap_or(0);
            for cell in (0..16).filter(|cell| (wanted | before) >> cell & 1 == 1) {
                let kept = (before >> cell & 1 == 1).then(|| old.next()).flatten();
                if wanted >> cell & 1 == 1 {
                    self.cells.push(kept.filter(|_| known).unwrap_or_default());
                }
            }
        }
    }

    /// Reflected radiosity of every cell: its own direct light, and the indirect light of its side.
    pub fn reflected(&self, scene: &ShadingContext, irradiance: &[Vec3]) -> Vec<Vec3A> {
        let patches = scene.patches;
        let side = |(side, wanted): (usize, &u16)| {
            let first = self.start[side] as usize;
            let cells = &self.cells[first..first + wanted.count_ones() as usize];
            let color = match cells {
                [] => Vec3::ZERO,
                _ => scene.accel.placed.colors[patches.surface_at(SideId::from_index(side))],
            };
            let light = |cell: &Pixel| {
                let group = &cell.groups[0];
                let mut light = group.light.resting + group.light.moving + irradiance[side];
                for kind in Kind::BOTH {
                    let cells = &scene.lights.emitters[kind];
                    for c in &cell.changing[kind] {
                        light += cells.now(c.emitter) * c.share;
                    }
                }
                Vec3A::from(light * group.tint * color)
            };
            cells.iter().map(light).collect::<Vec<_>>()
        };
        let sides = self.wanted.par_iter().enumerate().with_min_len(256);
        sides.flat_map_iter(side).collect()
    }

    /// The radiosity at a hit, of the sides' reflected radiosity and the cells'.
    #[inline]
    pub fn look_up(&self, name: HitId, reflected: &[Vec3A], close: &[Vec3A]) -> Vec3A {
        match name.parts() {
            (seen, None) => reflected[seen as usize],
            (side, Some(cell)) => {
                let before = self.wanted[side as usize] & ((1 << cell) - 1);
                close[(self.start[side as usize] + before.count_ones()) as usize]
            }
        }
    }

    /// Cells that differ in any bit from those of an update that knows no fewer, or are missing there.
    pub fn differences(&self, other: &SubelementCache) -> u64 {
        let mut differ = 0;
        for (side, wanted) in self.wanted.iter().enumerate() {
            let there = other.wanted.get(side).copied().unwrap_or(0);
            for cell in (0..16).filter(|cell| wanted >> cell & 1 == 1) {
                let same = || self.at(side, cell) == other.at(side, cell);
                differ += u64::from(there >> cell & 1 == 0 || !same());
            }
        }
        differ
    }

    /// A cell that is looked at.
    fn at(&self, side: usize, cell: u32) -> &Pixel {
        let before = self.wanted[side] & ((1 << cell) - 1);
        &self.cells[(self.start[side] + before.count_ones()) as usize]
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        let cells: usize = self.cells.iter().map(Pixel::memory).sum();
        size_of_val(&self.wanted[..]) + size_of_val(&self.start[..]) + cells
    }
}

/// A cell as a plane that light falls on; irradiance × its tint is radiosity.
fn plane(scene: &ShadingContext, side: SideId, cell: u32) -> Fragment {
    let patches = scene.patches;
    let stand = patches.stand(scene.accel.placed, side, glam::Vec2::X);
    let [a, b, c] = stand.corners;
    let at = |[v, w]: [f32; 2]| a + (b - a) * v + (c - a) * w + stand.normal * patches.ray_offset;
    let corners = corners(cell).map(at);
    let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    let [x, y, z] = corners.map(|corner| (corner + middle) * 0.5);
    let surface = patches.surface_at(side);
    let back = patches.sides[side].back;
    Fragment::cell(
        surface,
        back,
        [middle, x, y, z],
        stand.normal,
        patches.reflectance(side),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_lies_in_the_cell_that_it_names() {
        // Walk over a grid that misses the cells' edges; each point is a mean of its cell's corners with weights above 0.
        let mut seen = 0u32;
        for (i, j) in (0..40).flat_map(|i| (0..40 - i).map(move |j| (i, j))) {
            let (v, w) = ((i as f32 + 0.31) / 41.0, (j as f32 + 0.33) / 41.0);
            let (side, cell) = HitId::cell(SideId::new(7), [1.0 - v - w, v, w]).parts();
            let cell = cell.unwrap();
            assert_eq!(side, 7);
            let [p, q, r] = corners(cell).map(glam::Vec2::from);
            let at = glam::Vec2::new(v, w);
            let area = (q - p).perp_dot(r - p);
            let inside = [(q, r), (r, p), (p, q)].map(|(q, r)| (q - at).perp_dot(r - at) / area);
            assert!(
                inside.iter().all(|share| *share > 0.0),
                "{cell}: {at} {inside:?}"
            );
            seen |= 1 << cell;
        }
        assert_eq!(seen, 0xffff, "all sixteen");
    }

    #[test]
    fn on_edges_a_cell_is_named_all_the_same() {
        for weights in [
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [0.0, 0.5, 0.5],
            [-1e-7, 0.25, 0.75],
        ] {
            let (side, cell) = HitId::cell(SideId::new((1 << 25) + 2), weights).parts();
            assert!(
                side == (1 << 25) + 2 && cell.is_some_and(|cell| cell < 16),
                "{weights:?}"
            );
        }
    }

    #[test]
    fn what_is_whole_is_itself() {
        assert_eq!(HitId::whole(12).parts(), (12, None));
        assert_eq!(HitId::cell(SideId::new(12), [0.2, 0.3, 0.5]).seen(), 12);
    }
}

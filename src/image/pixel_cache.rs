//! The pixels' own back-buffer: while the camera stands still, a pixel is asked again only where a mover may matter.
//!
//! A pixel is traced again when a mover's part, where it was or where it is, may lie before its farthest hit. Its
//! direct light is asked again when such a part may stand in the shaft between its point and an emitter (Haines,
//! Wallace 1991, "Shaft culling for efficient ray-traced radiosity", Eurographics Workshop on Rendering), or when the
//! emitter itself moves. Indirect light is looked up in every frame: it follows the solve. What an emitter that changes
//! its light counts for is kept apart, so that a change of light alone asks nothing.

use super::aov::{self, Arriving, PixelAov};
use super::camera::Camera;
use super::direct::{self, Verdict};
use super::film::Image;
use super::final_gather::{self, SolvedRadiosity};
use super::interpolate::IrradianceField;
use super::pixel::{self, Pixel, Scene, Space};
use super::subelement::Closeups;
use crate::geometry::{Bounds, BoxTree};
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// What was asked of a pixel, beside a bit for each kind of emitter: its primary samples, and what it gathers.
const SEEN: u8 = 4;
const GATHERED: u8 = 8;

/// Pixels that one task shades.
const CHUNK: usize = 64;

/// What every pixel saw in the last frame.
#[derive(Clone, Debug, Default)]
pub struct PixelCache {
    camera: Option<Camera>,
    pixels: Vec<Pixel>,
    pattern: Vec<Vec2>,
    /// The pixels of which the last update asked anything.
    asked: Vec<bool>,
    /// The cells of near sides that they look at.
    closeups: Closeups,
}

/// What moved since the last frame, for pixels.
pub struct SceneChanges<'a> {
    /// Boxes of moved parts, where they were and where they are.
    pub boxes: &'a [Bounds],
    /// Whether resting emitters changed their cones or ranges, and whether moving ones did or moved.
    pub lamps: [bool; 2],
}

impl PixelCache {
    /// Brings all pixels to the scene's time and counts those of which anything was asked again.
    ///
    /// `stir` is `None` when nothing is known about the last frame: everything is then traced.
    pub fn update(&mut self, scene: &Scene, stir: Option<&SceneChanges>) -> u64 {
        let (width, height) = scene.camera.size;
        let all = stir.is_none() || self.camera != Some(scene.camera);
        if self.pattern.is_empty() {
            self.pattern = pixel::pattern(scene.samples, scene.filter);
        }
        self.camera = Some(scene.camera);
        self.pixels
            .resize_with(width as usize * height as usize, Pixel::default);
        if stir.is_some_and(|stir| !all && stir.boxes.is_empty() && stir.lamps == [false; 2]) {
            self.asked.fill(false);
            return 0;
        }
        // Cells do not mind where the camera is.
        let stirred = stir;
        let stir = stir.filter(|_| !all);
        let mut asked = self.see(scene, stir);
        self.edges(scene, &mut asked);
        self.light(scene, stir, &mut asked);
        self.asked = self.penumbrae(scene, &asked);
        if scene.gathering.is_some() {
            let pixels = self.pixels.par_iter().with_min_len(CHUNK);
            let groups = pixels.flat_map_iter(|pixel| &pixel.groups);
            let named = groups.map(|group| &group.gathered[..]);
            self.closeups.update(scene, named, stirred);
        }
        self.asked.iter().filter(|asked| **asked).count() as u64
    }

    /// Traces the primary samples of pixels before which something moved, or of all, and tells which.
    fn see(&mut self, scene: &Scene, stir: Option<&SceneChanges>) -> Vec<u8> {
        let near = stir.map(|stir| nearest_boxes(&scene.camera, stir.boxes));
        let pattern = &self.pattern;
        let update = |space: &mut Space, (i, pixel): (usize, &mut Pixel)| -> u8 {
            if near.as_ref().is_some_and(|near| near[i] > pixel.far) {
                return 0;
            }
            *pixel = pixel::see(scene, pattern, i as u32, false, space);
            SEEN
        };
        let pixels = self.pixels.par_iter_mut().enumerate().with_min_len(CHUNK);
        pixels.map_init(Space::default, update).collect()
    }

    /// Takes all of the pattern where one of a pixel's four neighbours sees something else: an edge that runs along
    /// pixels is missed by the few samples of them all.
    fn edges(&mut self, scene: &Scene, asked: &mut [u8]) {
        let (width, height) = (scene.camera.size.0 as usize, scene.camera.size.1 as usize);
        let edge = |i: usize| {
            let (x, y) = (i % width, i / width);
            let beside = [
                (x > 0).then(|| i - 1),
                (x + 1 < width).then_some(i + 1),
                (y > 0).then(|| i - width),
                (y + 1 < height).then_some(i + width),
            ];
            let mut beside = beside.into_iter().flatten();
            self.pixels[i].several || beside.any(|j| self.pixels[i].differs(&self.pixels[j]))
        };
        let edges: Vec<bool> = (0..self.pixels.len()).into_par_iter().map(edge).collect();
        let pattern = &self.pattern;
        let pixels = self.pixels.par_iter_mut().zip(asked).enumerate();
        let update = |space: &mut Space, (i, (pixel, asked)): (usize, (&mut Pixel, &mut u8))| {
            if pixel.fine != edges[i] {
                *pixel = pixel::see(scene, pattern, i as u32, edges[i], space);
                *asked = SEEN;
            }
        };
        pixels
            .with_min_len(CHUNK)
            .for_each_init(Space::default, update);
    }

    /// Lights the pixels that were seen anew or whose light something moved through; a bit for each kind of emitter says
    /// which, and one whether anything was gathered.
    fn light(&mut self, scene: &Scene, stir: Option<&SceneChanges>, asked: &mut [u8]) {
        let boxes = stir.map_or(&[][..], |stir| stir.boxes);
        let moved = BoxTree::build(boxes);
        let pixels = self.pixels.par_iter_mut().zip(asked).enumerate();
        let update = |space: &mut direct::Space,
                      (i, (pixel, asked)): (usize, (&mut Pixel, &mut u8))| {
            let seen = *asked & SEEN != 0;
            for lamp in 0..2 {
                let stirred = stir.is_some_and(|stir| stir.lamps[lamp]);
                if seen || stirred || shaded(pixel, scene, lamp, boxes) {
                    let sure = Verdict::default();
                    pixel.verdict[lamp] =
                        direct::relight(scene, pixel, lamp, i as u32, sure, space);
                    *asked |= 1 << lamp;
                }
            }
            if let Some(gathering) = &scene.gathering
                && final_gather::ask(scene, gathering, pixel, i as u32, &moved)
            {
                *asked |= GATHERED;
            }
        };
        pixels
            .with_min_len(CHUNK)
            .for_each_init(direct::Space::default, update);
    }

    /// Asks many light samples where a pixel and its eight neighbours disagree about an emitter, and says of which pixels
    /// anything was asked. A few samples alone would leave specks: some pixels of a faint penumbra miss it.
    fn penumbrae(&mut self, scene: &Scene, asked: &[u8]) -> Vec<bool> {
        let (width, height) = (scene.camera.size.0 as usize, scene.camera.size.1 as usize);
        let verdicts: Vec<[Verdict; 2]> = self.pixels.iter().map(|p| p.verdict).collect();
        let around = |i: usize, lamp: usize| {
            let (x, y) = (i % width, i / width);
            let rows = y.saturating_sub(1)..(y + 2).min(height);
            let columns = x.saturating_sub(1)..(x + 2).min(width);
            let all = rows.flat_map(|y| columns.clone().map(move |x| y * width + x));
            all.fold(Verdict::default(), |all, j| all.or(verdicts[j][lamp]))
                .disagreeing()
        };
        let update = |space: &mut direct::Space, (i, pixel): (usize, &mut Pixel)| -> bool {
            let mut any = asked[i] != 0;
            for lamp in 0..2 {
                let penumbrae = around(i, lamp);
                let fresh = asked[i] >> lamp & 1 == 1;
                // What was asked just now already is the answer where nobody disagrees.
                let settled = fresh && penumbrae == Verdict::default();
                if !settled && (fresh || penumbrae != pixel.penumbrae[lamp]) {
                    direct::relight(scene, pixel, lamp, i as u32, penumbrae, space);
                    any = true;
                }
                pixel.penumbrae[lamp] = penumbrae;
            }
            any
        };
        let pixels = self.pixels.par_iter_mut().enumerate().with_min_len(CHUNK);
        pixels.map_init(direct::Space::default, update).collect()
    }

    /// The image: what is emitted, lit directly, and interpolated.
    pub fn image(
        &self,
        scene: &Scene,
        indirect: &IrradianceField,
        solved: &SolvedRadiosity,
    ) -> Image {
        let arriving = Arriving::at(scene, &self.pixels, indirect, solved, &self.closeups);
        let pixels = (0..self.pixels.len()).into_par_iter().with_min_len(CHUNK);
        let parts = |index| aov::parts(scene, &self.pixels, index, &arriving);
        let (width, height) = scene.camera.size;
        Image {
            width,
            height,
            radiance: pixels.map(|i| parts(i).sum().to_array()).collect(),
        }
    }

    /// What each pixel shows, row by row: its radiance in parts, and what lies behind it.
    pub fn aovs(
        &self,
        scene: &Scene,
        indirect: &IrradianceField,
        solved: &SolvedRadiosity,
    ) -> Vec<PixelAov> {
        let arriving = Arriving::at(scene, &self.pixels, indirect, solved, &self.closeups);
        let pixels = (0..self.pixels.len()).into_par_iter().with_min_len(CHUNK);
        let glance = |i| aov::glance(scene, &self.pixels, i, &arriving, self.asked[i]);
        pixels.map(glance).collect()
    }

    /// The side that each pixel sees most of, row by row, or [`NO_SIDE`](crate::mesh::NO_SIDE) where none has a radiosity.
    pub fn sides(&self) -> Vec<u32> {
        self.pixels.par_iter().map(aov::side).collect()
    }

    /// Pixels, and cells of what is near them, that differ in any bit from those of another update.
    pub fn differences(&self, other: &PixelCache) -> u64 {
        let pairs = self.pixels.iter().zip(&other.pixels);
        let differ = pairs.filter(|(a, b)| a != b).count() as u64;
        differ + self.closeups.differences(&other.closeups)
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        let pixels: usize = self.pixels.par_iter().map(Pixel::memory).sum();
        pixels + self.closeups.memory()
    }
}

/// For each pixel the distance of the nearest box that its rays may meet, or infinity.
fn nearest_boxes(camera: &Camera, boxes: &[Bounds]) -> Vec<f32> {
    let (width, height) = camera.size;
    let mut near = vec![f32::INFINITY; width as usize * height as usize];
    for bounds in boxes {
        let distance = camera.nearest(bounds);
        let (columns, rows) = camera.covers(bounds);
        for y in rows {
            let row = (y * width) as usize;
            for n in &mut near[row + columns.start as usize..row + columns.end as usize] {
                *n = n.min(distance);
            }
        }
    }
    near
}

/// Whether a box may stand between a pixel's points and an emitter of one kind.
pub(super) fn shaded(pixel: &Pixel, scene: &Scene, lamp: usize, boxes: &[Bounds]) -> bool {
    pixel.groups.iter().any(|group| {
        // The starts of its light samples spread around the group's point: widen the boxes by as much.
        let spread = group
            .starts
            .iter()
            .fold(0.0f32, |s, p| s.max(p.distance(group.point)));
        let wider = |b: &Bounds| b.padded(spread * 1.001 + 1e-5 * group.point.abs().max_element());
        let cells = scene.lamps[lamp];
        let mut surfaces = cells.boxes.iter();
        let mut lights = cells.lights.iter();
        surfaces.any(|emitter| {
            let mut boxes = boxes.iter();
            boxes.any(|b| in_shaft(group.point, emitter, &wider(b)))
        }) || lights.any(|light| {
            let mut boxes = boxes.iter().map(wider);
            boxes.any(|b| in_shaft(group.point, &light.goal(group.point, &b), &b))
        })
    })
}

/// Whether a box meets the shaft from a point to an emitter's box.
///
/// At parameter s of the way the shaft is the box point + s (emitter − point): on each axis two bounds linear in s, so
/// the parameters at which it overlaps the given box are an interval; the box is in the shaft if the three have a
/// parameter in common.
fn in_shaft(point: Vec3, emitter: &Bounds, bounds: &Bounds) -> bool {
    let (mut first, mut last) = (0.0f32, 1.0f32);
    let mut at_most = |slope: f32, limit: f32| {
        // Keep the parameters with slope · s ≤ limit.
        if slope > 0.0 {
            last = last.min(limit / slope);
        } else if slope < 0.0 {
            first = first.max(limit / slope);
        } else if limit < 0.0 {
            last = -1.0;
        }
    };
    for axis in 0..3 {
        at_most(
            emitter.lo[axis] - point[axis],
            bounds.hi[axis] - point[axis],
        );
        at_most(
            point[axis] - emitter.hi[axis],
            point[axis] - bounds.lo[axis],
        );
    }
    first <= last * (1.0 + 1e-5) + 1e-6
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shaft_holds_what_lies_in_between_and_nothing_beside() {
        let emitter = Bounds {
            lo: Vec3::new(-1.0, 4.0, -1.0),
            hi: Vec3::new(1.0, 4.0, 1.0),
        };
        let cube = |x: f32, y: f32| Bounds {
            lo: Vec3::new(x - 0.1, y - 0.1, -0.1),
            hi: Vec3::new(x + 0.1, y + 0.1, 0.1),
        };
        // At half of the way the shaft is half as wide as the emitter: it reaches from −0.5 to 0.5.
        assert!(in_shaft(Vec3::ZERO, &emitter, &cube(0.0, 2.0)));
        assert!(in_shaft(Vec3::ZERO, &emitter, &cube(0.55, 2.0)));
        assert!(!in_shaft(Vec3::ZERO, &emitter, &cube(0.75, 2.0)));
        assert!(!in_shaft(Vec3::ZERO, &emitter, &cube(0.0, 5.0)));
        assert!(!in_shaft(Vec3::ZERO, &emitter, &cube(0.0, -1.0)));
    }
}

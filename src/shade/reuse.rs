//! The pixels' own back-buffer: while the camera stands still, a pixel is asked again only where a mover may matter.
//!
//! A pixel is traced again when a mover's part, where it was or where it is, may lie before its farthest hit. Its
//! direct light is asked again when such a part may stand in the shaft between its point and an emitter (Haines,
//! Wallace 1991, "Shaft culling for efficient ray-traced radiosity", Eurographics Workshop on Rendering), or when the
//! emitter itself moves. Indirect light is looked up in every frame: it follows the solve. What an emitter that changes
//! its light counts for is kept apart, so that a change of light alone asks nothing.

use super::camera::Camera;
use super::film::Image;
use super::indirect::AtVertices;
use super::pixel::{self, Pixel, Scene, Space, Verdict};
use crate::geometry::Bounds;
use crate::patch::NO_SIDE;
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// Bits of both kinds of emitters, resting and moving.
const BOTH: u8 = 3;

/// Pixels that one task shades.
const CHUNK: usize = 64;

/// What every pixel saw in the last frame.
#[derive(Clone, Debug, Default)]
pub struct Pixels {
    camera: Option<Camera>,
    pixels: Vec<Pixel>,
    pattern: Vec<Vec2>,
}

/// What moved since the last frame, for pixels.
pub struct Stir<'a> {
    /// Boxes of moved parts, where they were and where they are.
    pub boxes: &'a [Bounds],
    /// Whether resting emitters changed their cones or ranges, and whether moving ones did or moved.
    pub lamps: [bool; 2],
}

impl Pixels {
    /// Brings all pixels to the scene's time and counts those of which anything was asked again.
    ///
    /// `stir` is `None` when nothing is known about the last frame: everything is then traced.
    pub fn update(&mut self, scene: &Scene, stir: Option<&Stir>) -> u64 {
        let (width, height) = scene.camera.size;
        let all = stir.is_none() || self.camera != Some(scene.camera);
        if self.pattern.is_empty() {
            self.pattern = pixel::pattern(scene.samples);
        }
        self.camera = Some(scene.camera);
        self.pixels
            .resize_with(width as usize * height as usize, Pixel::default);
        let asked = match stir.filter(|_| !all) {
            Some(stir) if stir.boxes.is_empty() && stir.lamps == [false; 2] => return 0,
            Some(stir) => self.stirred(scene, stir),
            None => self.afresh(scene),
        };
        self.penumbrae(scene, &asked)
    }

    /// Traces every pixel.
    fn afresh(&mut self, scene: &Scene) -> Vec<u8> {
        let width = scene.camera.size.0;
        let pattern = &self.pattern;
        let pixels = self.pixels.par_iter_mut().enumerate().with_min_len(CHUNK);
        pixels.for_each_init(Space::default, |space, (i, pixel)| {
            *pixel = pixel::trace(scene, pattern, i as u32 % width, i as u32 / width, space);
        });
        vec![BOTH; self.pixels.len()]
    }

    /// Traces or lights the pixels again before which something moved; a bit for each kind of emitter says which.
    fn stirred(&mut self, scene: &Scene, stir: &Stir) -> Vec<u8> {
        let width = scene.camera.size.0;
        let near = nearest_boxes(&scene.camera, stir.boxes);
        let pattern = &self.pattern;
        let update = |space: &mut Space, (i, pixel): (usize, &mut Pixel)| -> u8 {
            if near[i] <= pixel.far {
                *pixel = pixel::trace(scene, pattern, i as u32 % width, i as u32 / width, space);
                return BOTH;
            }
            let mut asked = 0;
            for lamp in 0..2 {
                if stir.lamps[lamp] || shaded(pixel, scene, lamp, stir.boxes) {
                    let sure = Verdict::default();
                    pixel.verdict[lamp] = pixel::relight(scene, pixel, lamp, i as u32, sure, space);
                    asked |= 1 << lamp;
                }
            }
            asked
        };
        let pixels = self.pixels.par_iter_mut().enumerate().with_min_len(CHUNK);
        pixels.map_init(Space::default, update).collect()
    }

    /// Asks many light samples where a pixel and its eight neighbours disagree about an emitter, and counts the pixels
    /// of which anything was asked. A few samples alone would leave specks: some pixels of a faint penumbra miss it.
    fn penumbrae(&mut self, scene: &Scene, asked: &[u8]) -> u64 {
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
        let update = |space: &mut Space, (i, pixel): (usize, &mut Pixel)| -> u64 {
            let mut any = asked[i] != 0;
            for lamp in 0..2 {
                let penumbrae = around(i, lamp);
                let fresh = asked[i] >> lamp & 1 == 1;
                // What was asked just now already is the answer where nobody disagrees.
                let settled = fresh && penumbrae == Verdict::default();
                if !settled && (fresh || penumbrae != pixel.penumbrae[lamp]) {
                    pixel::relight(scene, pixel, lamp, i as u32, penumbrae, space);
                    any = true;
                }
                pixel.penumbrae[lamp] = penumbrae;
            }
            any as u64
        };
        let pixels = self.pixels.par_iter_mut().enumerate().with_min_len(CHUNK);
        pixels.map_init(Space::default, update).sum()
    }

    /// The image: what is emitted, lit directly, and interpolated.
    pub fn image(&self, scene: &Scene, indirect: &AtVertices) -> Image {
        let patches = scene.patches;
        let colors = &scene.stage.placed.colors;
        let radiance = self.pixels.par_iter().with_min_len(CHUNK).map(|pixel| {
            let mut radiance = pixel.emitted;
            for (surface, share) in &pixel.glows {
                radiance += scene.shine.surfaces[*surface as usize] * *share;
            }
            for (cells, changing) in scene.lamps.iter().zip(&pixel.changing) {
                for c in changing {
                    let color = colors[pixel.groups[c.group as usize].surface as usize];
                    radiance += cells.now(c.emitter as usize) * c.share * color;
                }
            }
            for group in &pixel.groups {
                radiance += (group.lit[0] + group.lit[1]) * colors[group.surface as usize];
            }
            for hit in &pixel.hits {
                let weights = [1.0 - hit.at[0] - hit.at[1], hit.at[0], hit.at[1]];
                let irradiance =
                    indirect.interpolate(patches.vertex_of[hit.side as usize], weights);
                let color = colors[patches.surface_at(hit.side)];
                radiance += irradiance * hit.tint * color;
            }
            radiance.to_array()
        });
        let (width, height) = scene.camera.size;
        Image {
            width,
            height,
            radiance: radiance.collect(),
        }
    }

    /// The side that each pixel sees most of, row by row, or [`NO_SIDE`] where none has a radiosity.
    pub fn sides(&self) -> Vec<u32> {
        let most = |pixel: &Pixel| {
            let seen = |side: u32| pixel.hits.iter().filter(|hit| hit.side == side).count();
            let best = pixel
                .hits
                .iter()
                .max_by_key(|hit| (seen(hit.side), hit.side));
            best.map_or(NO_SIDE, |hit| hit.side)
        };
        self.pixels.par_iter().map(most).collect()
    }

    /// Pixels that differ in any bit from those of another update.
    pub fn differences(&self, other: &Pixels) -> u64 {
        self.pixels
            .iter()
            .zip(&other.pixels)
            .filter(|(a, b)| a != b)
            .count() as u64
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        let held = |p: &Pixel| {
            let changing: usize = p.changing.iter().map(|c| size_of_val(&c[..])).sum();
            size_of::<Pixel>() + size_of_val(&p.hits[..]) + size_of_val(&p.groups[..]) + changing
        };
        self.pixels.par_iter().map(held).sum()
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
fn shaded(pixel: &Pixel, scene: &Scene, lamp: usize, boxes: &[Bounds]) -> bool {
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

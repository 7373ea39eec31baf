//! Cache of pixels: while the camera stands still, a pixel is traced again only where a mover may alter it.
//!
//! A pixel is traced again when a mover's part, where it was or where it is, may lie before its farthest hit. Its
//! direct light is traced again when such a part may stand in the shaft between its point and an emitter (Haines,
//! Wallace 1991, "Shaft culling for efficient ray-traced radiosity", Eurographics Workshop on Rendering), or when the
//! emitter itself moves. Indirect light is looked up in every frame: it follows the solve. What an emitter that changes
//! its light counts for is kept apart, so that a change of light alone traces nothing.

use super::aov::{self, IncidentLight, PixelAov};
use super::camera::Camera;
use super::changes::{MovedBoxes, SceneChanges, shaded};
use super::context::ShadingContext;
use super::direct::{self, LightPass};
use super::film::Image;
use super::final_gather::{self, SolvedRadiosity};
use super::gather_points::GatherPoints;
use super::hit_id::GatherHit;
use super::indirect_mode::IndirectMode;
use super::interpolate::IrradianceField;
use super::pixel::Pixel;
use super::primary::{self, PrimaryScratch};
use super::shadow_test::ShadowTest;
use super::static_visibility::StaticVisibility;
use super::subelement::SubelementCache;
use crate::emission::Emission;
use crate::geometry::{AabbBvh8, Bounds, Ray};
use crate::ids::SideId;
use crate::mesh::{Kind, PerKind};
use glam::{Vec2, Vec3, Vec3A};
use rayon::prelude::*;

/// What was traced of a pixel, beside a bit for each kind of emitter: its primary samples, what it gathers, and its primary
/// samples where they see the same as before, so that its light stays.
const SEEN: u8 = 4;
const GATHERED: u8 = 8;
const LOOKED: u8 = 16;

/// Neighbours up to so many pixels away along rows and columns tell where penumbrae are.
const AROUND: usize = 3;

/// Pixels that one task shades.
const CHUNK: usize = 64;

/// What is known of a pixel's light samples.
type KeptVisibility = Option<Box<StaticVisibility>>;

/// A pixel with its number, what was traced of it, and what is known of its light samples.
type Asked<'a> = (usize, ((&'a mut Pixel, &'a mut u8), &'a mut KeptVisibility));

/// What every pixel saw in the last frame.
#[derive(Clone, Debug, Default)]
pub struct PixelCache {
    camera: Option<Camera>,
    pixels: Vec<Pixel>,
    /// What is known of each pixel's light samples; nothing before they are asked again.
    at_rest: Vec<KeptVisibility>,
    pattern: Vec<Vec2>,
    /// The pixels of which the last update traced anything.
    traced: Vec<bool>,
    /// The cells of near sides that they look at.
    subelements: SubelementCache,
    /// The points of surfaces that they gather by.
    points: GatherPoints,
    /// The light that these were last looked up in.
    looked_up: Option<LookedUp>,
}

/// Light that points were looked up in: while it is the same, so is what arrives.
#[derive(Clone, Debug, PartialEq)]
struct LookedUp {
    irradiance: Vec<Vec3>,
    reflected: Vec<Vec3A>,
    emission: Emission,
    colors: Vec<Vec3>,
}

impl PixelCache {
    /// Brings all pixels to the scene's time and counts those of which anything was traced again.
    ///
    /// `changes` is `None` when nothing is known about the last frame: everything is then traced.
    pub fn update(&mut self, scene: &ShadingContext, changes: Option<&SceneChanges>) -> u64 {
        let (width, height) = scene.camera.size;
        let all = changes.is_none() || self.camera != Some(scene.camera);
        if self.pattern.is_empty() {
            self.pattern = primary::pattern(scene.params.samples, scene.params.filter);
        }
        self.camera = Some(scene.camera);
        self.pixels
            .resize_with(width as usize * height as usize, Pixel::default);
        self.at_rest.resize_with(self.pixels.len(), Option::default);
        if !all && changes.is_some_and(SceneChanges::is_none) {
            self.traced.fill(false);
            return 0;
        }
        // Cells do not mind where the camera is.
        let known = changes;
        let changes = changes.filter(|_| !all);
        let moved = AabbBvh8::build(changes.map_or(&[], |changes| changes.boxes));
        if scene.params.finish.kind == IndirectMode::Points {
            self.points.open(scene, known.is_some());
        }
        let mut traced = self.see(scene, changes, &moved);
        self.edges(scene, &mut traced);
        self.light(scene, changes, &moved, &mut traced);
        self.traced = self.penumbrae(scene, &traced);
        self.gather(scene, known);
        self.traced.iter().filter(|traced| **traced).count() as u64
    }

    /// Traces the primary samples of pixels before which something moved, or of all, and tells which.
    fn see(
        &mut self,
        scene: &ShadingContext,
        changes: Option<&SceneChanges>,
        moved: &AabbBvh8,
    ) -> Vec<u8> {
        let near = changes.map(|changes| nearest_boxes(&scene.camera, changes.boxes));
        let pattern = &self.pattern;
        let update = |space: &mut PrimaryScratch, (i, pixel): (usize, &mut Pixel)| -> u8 {
            if near.as_ref().is_some_and(|near| near[i] > pixel.far)
                && !pixel.segments.iter().any(|segment| meets(moved, segment))
            {
                return 0;
            }
            let seen = primary::see(scene, pattern, i as u32, pixel.fine, space);
            if near.is_some() && seen.sees_as(pixel) {
                return LOOKED;
            }
            *pixel = seen;
            SEEN
        };
        let pixels = self.pixels.par_iter_mut().enumerate().with_min_len(CHUNK);
        pixels.map_init(PrimaryScratch::default, update).collect()
    }

    /// Takes all of the pattern where one of a pixel's four neighbours sees something else: an edge that runs along
    /// pixels is missed by the few samples of them all.
    fn edges(&mut self, scene: &ShadingContext, traced: &mut [u8]) {
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
        let pixels = self.pixels.par_iter_mut().zip(traced).enumerate();
        let update = |space: &mut PrimaryScratch,
                      (i, (pixel, traced)): (usize, (&mut Pixel, &mut u8))| {
            if pixel.fine != edges[i] {
                *pixel = primary::see(scene, pattern, i as u32, edges[i], space);
                *traced = SEEN;
            }
        };
        pixels
            .with_min_len(CHUNK)
            .for_each_init(PrimaryScratch::default, update);
    }

    /// Lights the pixels that were seen anew or whose light something moved through; a bit for each kind of emitter says
    /// which, and one whether anything was gathered.
    fn light(
        &mut self,
        scene: &ShadingContext,
        changes: Option<&SceneChanges>,
        moved: &AabbBvh8,
        traced: &mut [u8],
    ) {
        let gathering = scene.gathering();
        let boxes = MovedBoxes::of(changes);
        let keeps = scene.accel.has_movers_apart();
        let others = changes.is_some_and(|changes| changes.emitters.resting);
        let points = &self.points;
        let pixels = self.pixels.par_iter_mut().zip(traced);
        let pixels = pixels.zip(&mut self.at_rest).enumerate();
        let update = |space: &mut direct::LightScratch, (i, ((pixel, traced), at_rest)): Asked| {
            let seen = *traced & SEEN != 0;
            if seen || others {
                *at_rest = None;
            }
            for kind in Kind::BOTH {
                let emitters_changed = changes.is_some_and(|changes| changes.emitters[kind]);
                if seen || emitters_changed || shaded(pixel, scene, kind, &boxes) {
                    let kept = (keeps && !seen).then(|| &mut **at_rest.get_or_insert_default());
                    pixel.shadow_tests[kind] =
                        direct::relight(scene, pixel, kind, i as u32, LightPass::Few, kept, space);
                    *traced |= 1 << kind as u8;
                }
            }
            if seen {
                points.claim(pixel);
            }
            if let Some(gathering) = &gathering
                && final_gather::trace(scene, gathering, pixel, i as u32, moved)
            {
                *traced |= GATHERED;
            }
        };
        pixels
            .with_min_len(CHUNK)
            .for_each_init(direct::LightScratch::default, update);
    }

    /// Brings the points that the pixels gather by to the scene's time, and the cells that these and the pixels look at.
    fn gather(&mut self, scene: &ShadingContext, known: Option<&SceneChanges>) {
        let Some(gathering) = scene.gathering() else {
            return;
        };
        let same = known.is_some_and(SceneChanges::is_none);
        if !same {
            self.looked_up = None;
        }
        // While nothing moves, only new points name cells that are not known.
        let more = same && gathering.points.is_some();
        if let Some(set) = gathering.points {
            self.points
                .update(scene, (&gathering, set), &self.pixels, known);
        }
        let pixels = self.pixels.par_iter().with_min_len(CHUNK);
        let groups = pixels.flat_map_iter(|pixel| &pixel.groups);
        let named = groups.map(|group| &group.gathered[..]);
        let named = named.chain(self.points.hits(more));
        self.subelements.update(scene, named, known, more);
    }

    /// Asks many light samples where a pixel's neighbours disagree about an emitter, and says of which pixels anything was
    /// traced. A few samples alone would leave specks: some pixels of a faint penumbra miss it. The pixel's own few are not
    /// read, for where they stay they are the result: chosen by themselves they would be biased.
    fn penumbrae(&mut self, scene: &ShadingContext, traced: &[u8]) -> Vec<bool> {
        let (width, height) = (scene.camera.size.0 as usize, scene.camera.size.1 as usize);
        let shadow_tests: Vec<PerKind<ShadowTest>> =
            self.pixels.iter().map(|p| p.shadow_tests).collect();
        let around = |i: usize, kind: Kind| {
            let (x, y) = (i % width, i / width);
            let rows = y.saturating_sub(AROUND)..(y + AROUND + 1).min(height);
            let columns = x.saturating_sub(AROUND)..(x + AROUND + 1).min(width);
            let all = rows.flat_map(|y| columns.clone().map(move |x| y * width + x));
            let others = all.filter(|j| *j != i);
            let found = others.fold(ShadowTest::default(), |all, j| {
                all.or(shadow_tests[j][kind])
            });
            found.disagreeing()
        };
        let keeps = scene.accel.has_movers_apart();
        let update = |space: &mut direct::LightScratch,
                      (i, (pixel, at_rest)): (usize, (&mut Pixel, &mut KeptVisibility))|
         -> bool {
            let mut any = traced[i] != 0;
            let seen = traced[i] & SEEN != 0;
            for kind in Kind::BOTH {
                let penumbrae = around(i, kind);
                let fresh = traced[i] >> kind as u8 & 1 == 1;
                // Samples traced just now are the result already where no neighbour disagrees.
                let settled = fresh && penumbrae.is_none();
                if !settled && (fresh || penumbrae != pixel.penumbrae[kind]) {
                    let kept = (keeps && !seen).then(|| &mut **at_rest.get_or_insert_default());
                    let pass = LightPass::Penumbrae(penumbrae, pixel.shadow_tests[kind]);
                    direct::relight(scene, pixel, kind, i as u32, pass, kept, space);
                    any = true;
                }
                pixel.penumbrae[kind] = penumbrae;
            }
            any
        };
        let pixels = self.pixels.par_iter_mut().zip(&mut self.at_rest);
        let pixels = pixels.enumerate().with_min_len(CHUNK);
        pixels
            .map_init(direct::LightScratch::default, update)
            .collect()
    }

    /// The image: what is emitted, lit directly, and interpolated.
    pub fn image(
        &mut self,
        scene: &ShadingContext,
        indirect: &IrradianceField,
        solved: &SolvedRadiosity,
    ) -> Image {
        self.look_up(scene, solved);
        let (pixels, points) = (&self.pixels[..], &self.points);
        let arriving =
            IncidentLight::at(scene, pixels, indirect, solved, &self.subelements, points);
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
        &mut self,
        scene: &ShadingContext,
        indirect: &IrradianceField,
        solved: &SolvedRadiosity,
    ) -> Vec<PixelAov> {
        self.look_up(scene, solved);
        let (pixels, points) = (&self.pixels[..], &self.points);
        let arriving =
            IncidentLight::at(scene, pixels, indirect, solved, &self.subelements, points);
        let pixels = (0..self.pixels.len()).into_par_iter().with_min_len(CHUNK);
        let record = |i| aov::pixel_aov(scene, &self.pixels, i, &arriving, self.traced[i]);
        pixels.map(record).collect()
    }

    /// Looks up what arrives at the points, where the light is not the one that they were last looked up in.
    fn look_up(&mut self, scene: &ShadingContext, solved: &SolvedRadiosity) {
        let Some(gathering) = scene.gathering() else {
            return;
        };
        let Some(set) = gathering.points else {
            return;
        };
        let light = LookedUp {
            irradiance: solved.irradiance.to_vec(),
            reflected: solved.reflected.to_vec(),
            emission: scene.lights.emission.clone(),
            colors: scene.accel.placed.colors.clone(),
        };
        let changed = self.looked_up.as_ref() != Some(&light);
        let close = self.subelements.reflected(scene, solved.irradiance);
        let subelements = &self.subelements;
        let of = |hit: &GatherHit| subelements.look_up(hit.seen, solved.reflected, &close);
        self.points.light(scene, (&gathering, set), changed, of);
        self.looked_up = Some(light);
    }

    /// The side that each pixel sees most of, row by row; none where none has a radiosity.
    pub fn sides(&self) -> Vec<Option<SideId>> {
        self.pixels.par_iter().map(aov::side).collect()
    }

    /// Pixels, points that they gather by, and cells of what is near, that differ in any bit from those of another update. That
    /// may know more points and cells.
    pub fn differences(&self, other: &PixelCache) -> u64 {
        let pairs = self.pixels.iter().zip(&other.pixels);
        let differ = pairs.filter(|(a, b)| a != b).count() as u64;
        differ
            + self.subelements.differences(&other.subelements)
            + other.points.differences(&self.points)
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        let pixels: usize = self.pixels.par_iter().map(Pixel::memory).sum();
        let at_rest = self.at_rest.par_iter().flatten();
        let at_rest: usize = at_rest.map(|kept| kept.memory()).sum();
        pixels
            + at_rest
            + size_of_val(&self.at_rest[..])
            + self.subelements.memory()
            + self.points.memory()
    }
}

/// Whether moved geometry may lie on a segment, or draw level with its end.
fn meets(moved: &AabbBvh8, segment: &Ray) -> bool {
    let tmax = segment.tmax * (1.0 + 1e-5);
    !moved.is_empty() && moved.meets(&Ray { tmax, ..*segment })
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

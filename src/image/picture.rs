//! The picture of a scene that changes: its pixels, and the changes that they have not been traced for yet.
//!
//! A clip's frames and the steps of edits share it. Changes add up until the next picture, so none is lost where light is
//! solved several times between two pictures.

use super::aov::PixelAov;
use super::camera::Camera;
use super::context::ShadingContext;
use super::film::Image;
use super::final_gather::SolvedRadiosity;
use super::indirect_mode::{FinalGather, IndirectMode};
use super::interpolate::{IrradianceField, VertexAdjacency};
use super::{changes::SceneChanges, pixel_cache::PixelCache};
use crate::geometry::Bounds;
use crate::ids::SideId;
use crate::mesh::{PerKind, PosedMesh, RadiosityMesh};
use glam::{Vec3, Vec3A};
use std::borrow::Cow;

/// The pixels of the last picture, and the changes since.
#[derive(Clone, Debug, Default)]
pub struct Picture {
    pixels: PixelCache,
    /// The camera of the last picture, until its pixels are forgotten.
    camera: Option<Camera>,
    /// Bounds of moved geometry, before and after each move.
    boxes: Vec<Bounds>,
    /// Whether resting and moving emitters moved, or changed their cones or ranges.
    emitters: PerKind<bool>,
}

/// Indirect light for a picture.
pub struct Lit<'a> {
    /// The sides that meet in each vertex.
    pub vertices: &'a VertexAdjacency,
    /// Invalid origins of each side, a bit each.
    pub invalid_origins: &'a [u16],
    /// Indirect irradiance of each side, the sky's included, in W/m².
    pub irradiance: Cow<'a, [Vec3]>,
    /// Reflected radiosity of each side, then zeros for misses; read only where pixels gather.
    pub reflected: Cow<'a, [Vec3A]>,
    /// How pixels reconstruct indirect light.
    pub finish: IndirectMode,
}

impl Picture {
    /// Adds the bounds of geometry that moved or looks different.
    pub fn disturb(&mut self, boxes: impl IntoIterator<Item = Bounds>) {
        self.boxes.extend(boxes);
    }

    /// Adds whether resting and moving emitters moved, or changed their cones or ranges.
    pub fn relight(&mut self, emitters: PerKind<bool>) {
        self.emitters = self.emitters.zip(emitters).map(|(known, new)| known | new);
    }

    /// Lets the next picture trace all pixels.
    pub fn forget(&mut self) {
        self.camera = None;
    }

    /// Brings the pixels to the scene's time, and counts those that were traced or lit again.
    pub fn update(&mut self, scene: &ShadingContext) -> u64 {
        let changes = SceneChanges {
            boxes: &self.boxes,
            emitters: self.emitters,
        };
        let known = self.camera.is_some().then_some(&changes);
        let traced = self.pixels.update(scene, known);
        self.camera = Some(scene.camera);
        self.boxes.clear();
        self.emitters = PerKind::default();
        traced
    }

    /// The camera of the last picture, if nothing has changed since.
    pub fn current(&self) -> Option<Camera> {
        let unchanged = self.boxes.is_empty() && self.emitters == PerKind::default();
        self.camera.filter(|_| unchanged)
    }

    /// The image in this light. [`Picture::update`] comes first.
    pub fn image(&mut self, scene: &ShadingContext, light: &Lit) -> Image {
        self.pixels
            .image(scene, &light.spread(scene), &light.solved())
    }

    /// Radiance in parts and surface of each pixel, row by row. [`Picture::update`] comes first.
    pub fn aovs(&mut self, scene: &ShadingContext, light: &Lit) -> Vec<PixelAov> {
        self.pixels
            .aovs(scene, &light.spread(scene), &light.solved())
    }

    /// The side that fills most of each pixel, row by row.
    pub fn sides(&self) -> Vec<Option<SideId>> {
        self.pixels.sides()
    }

    /// PixelCache that differ in any bit from those of the same scene traced from scratch.
    pub fn differences_from_scratch(&self, scene: &ShadingContext) -> u64 {
        let mut pixels = PixelCache::default();
        pixels.update(scene, None);
        pixels.differences(&self.pixels)
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        self.pixels.memory()
    }
}

impl Lit<'_> {
    /// Irradiance constant over each side, or interpolated between vertices.
    fn spread(&self, scene: &ShadingContext) -> IrradianceField<'_> {
        let (patches, placed) = (scene.patches, scene.accel.placed);
        match self.finish {
            IndirectMode::Flat => IrradianceField::Flat(&self.irradiance),
            _ => {
                let smooth = (self.vertices).at_vertices(
                    patches,
                    placed,
                    &self.irradiance,
                    self.invalid_origins,
                );
                IrradianceField::Smooth(smooth)
            }
        }
    }

    fn solved(&self) -> SolvedRadiosity<'_> {
        SolvedRadiosity {
            irradiance: &self.irradiance,
            reflected: &self.reflected,
        }
    }
}

/// The share of the indirect light at each vertex that pixels gather, or `None` where none ever do. `near` is the distance
/// of each side to the nearest surface in metres, and `moves` tells which surfaces are gathered for being dynamic.
pub fn gathered_share(
    finishing: &FinalGather,
    vertices: &VertexAdjacency,
    (patches, placed): (&RadiosityMesh, &PosedMesh),
    near: &[f32],
    moves: impl Fn(usize) -> bool,
) -> Option<Vec<f32>> {
    let dynamic = patches.surfaces.iter().enumerate();
    let dynamic = dynamic.filter(|(surface, _)| moves(*surface));
    let around = dynamic.map(|(_, s)| Bounds::of_points(placed.of(s).iter().flatten()));
    let around: Vec<Bounds> = around.filter(|bounds| !bounds.is_empty()).collect();
    finishing.shares(vertices, patches, placed, near, &around)
}

//! The emissive surfaces and the lights at time t: what light samples aim at.
//!
//! A cell is one side of an emissive triangle, or, where a picture makes a surface glow unevenly, of an element with
//! its mean emission; what is dark is no cell. An emitter is a surface, or each of its lamps where they lie apart. Middles and
//! normals lie apart per axis, so that the sweep over all cells that every receiver makes runs in vector lanes. Emitters are
//! numbered: first surfaces, then lights.

use super::current::{Emission, PeakEmission};
use super::punctual::{PeakLight, PunctualLight};
use crate::geometry::Bounds;
use crate::ids::{EmitterId, SurfaceId};
use crate::mesh::{Kind, PerKind, PosedMesh, RadiosityMesh, Surface};
use glam::Vec3;
use std::ops::Range;

/// Emissive sides and lights in one pose: those that rest, or those that move.
#[derive(Clone, Debug, Default)]
pub struct Emitters {
    /// World corners of each cell.
    pub corners: Vec<[Vec3; 3]>,
    /// What multiplies its surface's emission in each cell.
    pub glow: Vec<Vec3>,
    /// Whether any lamp's cells emit differently from one another.
    pub uneven: bool,
    /// Brightness by which cells are ranked: the mean of the channels of the largest E = π·L that the cell ever has.
    pub brightness: Vec<f32>,
    /// Middle of each cell, per axis.
    pub middle: [Vec<f32>; 3],
    /// Unit normal of the emitting side, per axis.
    pub normal: [Vec<f32>; 3],
    /// Area of each cell in m².
    pub area: Vec<f32>,
    /// Square of the distance within which a cell's factor needs the exact contour.
    pub near: Vec<f32>,
    /// The emitter of each cell: a position in the lists that follow.
    pub emitter_of: Vec<EmitterId>,
    /// The cells of each emitter that is a surface, or a lamp of one.
    pub cell_ranges: Vec<Range<usize>>,
    /// The surface of each.
    pub surface: Vec<SurfaceId>,
    /// Emitted radiosity E = π·L of each emitting surface now.
    pub emission: Vec<Vec3>,
    /// Whether it changes.
    pub varies: Vec<bool>,
    /// One box around the cells of each emitting surface, to test whether a mover may shade something.
    pub boxes: Vec<Bounds>,
    /// Lights without a surface that ever emit.
    pub lights: Vec<PunctualLight>,
    /// What holds of each of them for the whole animation.
    pub peak: Vec<PeakLight>,
}

/// Everything that emits at one time.
pub struct Lights {
    /// Emission of each surface and light.
    pub emission: Emission,
    /// The emitters of each kind.
    pub emitters: PerKind<Emitters>,
}

impl Lights {
    /// The emitters of this emission in a pose.
    pub fn at(
        patches: &RadiosityMesh,
        placed: &PosedMesh,
        emission: Emission,
        peak: &PeakEmission,
    ) -> Lights {
        let at = |kind| Emitters::at(patches, placed, &emission, peak, kind);
        Lights {
            emitters: PerKind::from(Kind::BOTH.map(at)),
            emission,
        }
    }
}

/// Pixels tell the shadows of so many emitters apart: surfaces are parted into lamps as long as there are no more, lights
/// among them.
pub const TOLD_APART: usize = 32;

/// A cell is near when closer than this many of its longest edges; beyond, its middle alone errs by about 0.5 %.
const NEAR: f32 = 8.0;

impl Emitters {
    /// The emitting sides of the surfaces that move, or of those that do not, and the lights likewise.
    pub fn at(
        patches: &RadiosityMesh,
        placed: &PosedMesh,
        emission: &Emission,
        peak: &PeakEmission,
        kind: Kind,
    ) -> Emitters {
        let mut cells = Emitters::default();
        let lights = peak
            .lights
            .iter()
            .filter(|peak| peak.emits && Kind::of(peak.moves) == kind);
        let emits = |s: &Surface| {
            Kind::of(s.moves) == kind && s.emission != Vec3::ZERO && s.triangles.0 < s.triangles.1
        };
        let surfaces = patches.surfaces.iter().filter(|s| emits(s));
        let mut left = TOLD_APART.saturating_sub(lights.count() + surfaces.count());
        for (index, surface) in patches
            .surface_ids()
            .zip(&patches.surfaces)
            .filter(|(_, s)| emits(s))
        {
            // Every lamp beside the first is one emitter more.
            let more = surface.lamps.len().saturating_sub(1);
            let part = more > 0 && more <= left;
            left -= if part { more } else { 0 };
            cells.add(patches, placed, index, (peak.surfaces[index].1, part));
        }
        cells.relight(emission, peak, kind);
        cells
    }

    /// The emitting sides of these surfaces alone, as if each emitted 1: what arrives is what a unit of their light brings.
    pub fn unit(patches: &RadiosityMesh, placed: &PosedMesh, surfaces: &[SurfaceId]) -> Emitters {
        let mut cells = Emitters::default();
        for &index in surfaces {
            cells.add(patches, placed, index, (true, false));
            cells.emission.push(Vec3::ONE);
        }
        cells
    }

    /// Adds the cells of a surface, lamp by lamp if these are to `part`.
    fn add(
        &mut self,
        patches: &RadiosityMesh,
        placed: &PosedMesh,
        surface: SurfaceId,
        (varies, part): (bool, bool),
    ) {
        let id = surface;
        let surface = &patches.surfaces[id];
        let (emission, both) = (surface.emission, surface.double_sided);
        let flipped = placed.is_flipped(|| id);
        let fronts = |[a, b, c]: [Vec3; 3]| if flipped { [a, c, b] } else { [a, b, c] };
        let triangles = placed.of(surface);
        if part {
            for lamp in &surface.lamps {
                let (first, lamp) = (self.len(), lamp.iter().map(|t| triangles[*t as usize]));
                for corners in lamp.clone() {
                    self.push_sides(&fronts(corners), emission, Vec3::ONE, both);
                }
                self.close(id, first, Bounds::of_points(lamp.flatten()), varies);
            }
            return;
        }
        let first = self.len();
        if surface.even {
            for corners in triangles {
                self.push_sides(&fronts(*corners), emission, Vec3::ONE, both);
            }
        } else {
            self.uneven = true;
            for element in patches.elements_of(surface) {
                let emission = surface.emission_of(element);
                if emission != Vec3::ZERO {
                    let corners = placed.element_corners(element);
                    self.push_sides(&fronts(corners), emission, element.glow, both);
                }
            }
        }
        let bounds = Bounds::of_points(triangles.iter().flatten().copied());
        self.close(id, first, bounds, varies);
    }

    /// Makes the cells from this one on an emitter, which lies in a box.
    fn close(&mut self, surface: SurfaceId, first: usize, bounds: Bounds, varies: bool) {
        self.boxes.push(bounds);
        self.cell_ranges.push(first..self.len());
        self.surface.push(surface);
        self.varies.push(varies);
    }

    /// Lets the same emitters, where they stand, emit what they do now.
    pub fn relight(&mut self, emission: &Emission, peak: &PeakEmission, kind: Kind) {
        let now = self.surface.iter().map(|s| emission.surfaces[*s]);
        self.emission = now.collect();
        let lights = emission.lights.iter().zip(&peak.lights);
        let mine = lights.filter(|(_, peak)| peak.emits && Kind::of(peak.moves) == kind);
        (self.lights, self.peak) = mine.unzip();
    }

    fn push_sides(&mut self, corners: &[Vec3; 3], emission: Vec3, glow: Vec3, both: bool) {
        self.push(corners, emission, glow);
        if both {
            self.push(&[corners[0], corners[2], corners[1]], emission, glow);
        }
    }

    fn push(&mut self, corners: &[Vec3; 3], emission: Vec3, glow: Vec3) {
        let [a, b, c] = *corners;
        let cross = (b - a).cross(c - a);
        let (middle, normal) = ((a + b + c) / 3.0, cross.normalize_or_zero());
        let longest = a
            .distance_squared(b)
            .max(b.distance_squared(c))
            .max(c.distance_squared(a));
        for axis in 0..3 {
            self.middle[axis].push(middle[axis]);
            self.normal[axis].push(normal[axis]);
        }
        self.corners.push(*corners);
        let emitter = EmitterId::from_index(self.cell_ranges.len());
        self.emitter_of.push(emitter);
        self.glow.push(glow);
        self.brightness.push(emission.element_sum() / 3.0);
        self.area.push(0.5 * cross.length());
        self.near.push(NEAR * NEAR * longest);
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.area.len()
    }

    /// Whether there is no cell; there may be lights.
    pub fn is_empty(&self) -> bool {
        self.area.is_empty()
    }

    /// Whether nothing emits at any time.
    pub fn is_dark(&self) -> bool {
        self.is_empty() && self.lights.is_empty()
    }

    /// The id of a light: lights follow the surfaces.
    pub fn id_of_light(&self, light: usize) -> EmitterId {
        EmitterId::from_index(self.cell_ranges.len() + light)
    }

    /// What an emitter emits now: E of a surface, the power of a light.
    pub fn now(&self, emitter: EmitterId) -> Vec3 {
        match self.emission.get(emitter.index()) {
            Some(emission) => *emission,
            None => self.lights[emitter.index() - self.cell_ranges.len()].power,
        }
    }

    /// Whether what an emitter emits changes.
    pub fn changes(&self, emitter: EmitterId) -> bool {
        match self.varies.get(emitter.index()) {
            Some(varies) => *varies,
            None => self.peak[emitter.index() - self.cell_ranges.len()].varies,
        }
    }

    /// Middle of a cell.
    pub fn middle_of(&self, cell: usize) -> Vec3 {
        Vec3::new(
            self.middle[0][cell],
            self.middle[1][cell],
            self.middle[2][cell],
        )
    }

    /// Unit normal of a cell's emitting side.
    pub fn normal_of(&self, cell: usize) -> Vec3 {
        Vec3::new(
            self.normal[0][cell],
            self.normal[1][cell],
            self.normal[2][cell],
        )
    }
}

//! The swept volume: everywhere a mover goes, as boxes over its parts and over spans of frames.
//!
//! Baum, Wallace, Cohen, Greenberg 1986, "The back-buffer algorithm: an extension of the radiosity method to dynamic
//! environments", The Visual Computer 2(5):298–306. The paper sweeps whole objects; boxes over parts and spans follow
//! a turning door far closer than one box around all of its positions.

use crate::archive::{ArchiveReader, ArchiveWriter};
use crate::geometry::obb::{Axes, Obb};
use crate::geometry::{AabbBvh8, Bounds, Ray};
use crate::ids::SurfaceId;
use crate::mesh::{PosedMesh, RadiosityMesh, placed::is_hidden};
use glam::Vec3;
use std::io;

/// Parts of one mover: 16 boxes follow a diagonal slab within a sixteenth of its length.
const PARTS: usize = 16;

/// Spans of the frame sequence, a bit of a mask each: as many as keep a mover's boxes at 512.
const SPANS: usize = u32::BITS as usize;

/// Padding of each box as a fraction of its distance from the world's origin, so that rounding cannot leave it.
const PAD: f32 = 1e-5;

/// Boxes that together contain every triangle of every mover in every rendered pose.
#[derive(Clone, Debug)]
pub struct SweptVolume {
    /// The boxes: for each span, those of all parts.
    pub boxes: Vec<Bounds>,
    /// The times of the poses, in seconds.
    times: Vec<f64>,
    /// Poses in a span.
    span: usize,
    tree: AabbBvh8,
    spans: Vec<AabbBvh8>,
}

/// The movers' triangles in groups that lie close together: positions in the movers' part of [`PosedMesh::triangles`].
#[derive(Clone, Debug, Default)]
pub struct Parts {
    /// Triangle ids of each part.
    pub triangles: Vec<Vec<u32>>,
    /// The surface each part belongs to.
    pub surface: Vec<SurfaceId>,
    /// The moving surfaces with the axes along which a box fits each best.
    axes: Vec<(SurfaceId, Axes)>,
}

impl Parts {
    /// Groups each mover's triangles by halving them along the longest axis of their middles.
    pub fn of(patches: &RadiosityMesh, placed: &PosedMesh) -> Parts {
        let mut parts = Parts::default();
        let surfaces = patches.surface_ids().zip(&patches.surfaces);
        for (id, surface) in surfaces.filter(|(_, s)| s.moves) {
            let all: Vec<u32> = (surface.triangles.0..surface.triangles.1).collect();
            halve(all, placed, PARTS, &mut parts.triangles);
            parts.surface.resize(parts.triangles.len(), id);
            let axes = Axes::fitting(placed.of(surface));
            parts.axes.push((id, axes));
        }
        parts
    }

    /// One box around each part in a pose; an empty one where all of it is away.
    pub fn boxes(&self, placed: &PosedMesh) -> Vec<Bounds> {
        let around = |part: &Vec<u32>| {
            let triangles = part.iter().map(|t| &placed.triangles[*t as usize]);
            Bounds::of_points(triangles.filter(|t| !is_hidden(t)).flatten())
        };
        self.triangles.iter().map(around).map(pad).collect()
    }

    /// One box that turns with it around each moving surface that is not away in a pose.
    pub fn oriented(&self, patches: &RadiosityMesh, placed: &PosedMesh) -> Vec<(SurfaceId, Obb)> {
        let around = |(surface, axes): &(SurfaceId, Axes)| {
            let triangles = placed.of(&patches.surfaces[*surface]);
            (*surface, Obb::around(triangles, *axes))
        };
        let is_here = |(surface, _): &&(SurfaceId, Axes)| {
            let triangles = placed.of(&patches.surfaces[*surface]);
            !triangles.iter().all(is_hidden)
        };
        self.axes.iter().filter(is_here).map(around).collect()
    }
}

fn halve(mut triangles: Vec<u32>, placed: &PosedMesh, parts: usize, out: &mut Vec<Vec<u32>>) {
    if parts == 1 || triangles.len() <= 1 {
        if !triangles.is_empty() {
            out.push(triangles);
        }
        return;
    }
    let middle = |t: &u32| placed.triangles[*t as usize].iter().copied().sum::<Vec3>() / 3.0;
    let bounds = Bounds::of_points(triangles.iter().map(middle));
    let axis = bounds.extent().max_position();
    triangles.sort_by(|a, b| middle(a)[axis].total_cmp(&middle(b)[axis]).then(a.cmp(b)));
    let upper = triangles.split_off(triangles.len() / 2);
    halve(triangles, placed, parts / 2, out);
    halve(upper, placed, parts / 2, out);
}

fn pad(bounds: Bounds) -> Bounds {
    let reach = bounds.lo.abs().max(bounds.hi.abs()).max_element();
    bounds.padded(PAD * reach)
}

impl SweptVolume {
    /// The boxes over the poses at these times in seconds, which are rendered in about this order.
    pub fn of(parts: &Parts, times: Vec<f64>, pose: impl Fn(f64) -> PosedMesh) -> SweptVolume {
        let span = times.len().div_ceil(SPANS).max(1);
        let mut boxes: Vec<Bounds> = Vec::new();
        for (index, time) in times.iter().enumerate() {
            let here = parts.boxes(&pose(*time));
            if index % span == 0 {
                boxes.extend(here);
            } else {
                let first = boxes.len() - here.len();
                boxes[first..]
                    .iter_mut()
                    .zip(here)
                    .for_each(|(swept, now)| *swept = swept.union(now));
            }
        }
        SweptVolume::with(parts, times, boxes)
    }

    /// The volume of these boxes, span after span.
    fn with(parts: &Parts, times: Vec<f64>, boxes: Vec<Bounds>) -> SweptVolume {
        let tree = AabbBvh8::build(&boxes);
        let each = parts.triangles.len().max(1);
        let spans = boxes.chunks(each).map(AabbBvh8::build).collect();
        SweptVolume {
            span: times.len().div_ceil(SPANS).max(1),
            times,
            boxes,
            tree,
            spans,
        }
    }

    /// Writes what [`SweptVolume::restore`] reads.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn store(&self, to: &mut ArchiveWriter) -> io::Result<()> {
        to.column(&self.boxes, |bounds| [bounds.lo, bounds.hi])
    }

    /// Reads the boxes over the poses at these times.
    ///
    /// # Errors
    /// Words on boxes of other parts or times.
    pub fn restore(
        parts: &Parts,
        times: Vec<f64>,
        from: &mut ArchiveReader,
    ) -> Result<SweptVolume, String> {
        let span = times.len().div_ceil(SPANS).max(1);
        let corners: Vec<[Vec3; 2]> =
            from.list_of(times.len().div_ceil(span) * parts.triangles.len())?;
        let boxes = corners.iter().map(|[lo, hi]| Bounds { lo: *lo, hi: *hi });
        Ok(SweptVolume::with(parts, times, boxes.collect()))
    }

    /// The spans, a bit each, in which a mover may come between a ray's start and its end; 0 for a settled ray.
    pub fn spans(&self, ray: &Ray) -> u32 {
        if self.boxes.is_empty() || !self.tree.meets(ray) {
            return 0;
        }
        (self.spans.iter().enumerate())
            .fold(0, |mask, (s, tree)| mask | (tree.meets(ray) as u32) << s)
    }

    /// The bit of the span that a time belongs to; all bits for a time that no pose has.
    pub fn span_of(&self, time: f64) -> u32 {
        let index = self.times.iter().position(|known| *known == time);
        index.map_or(u32::MAX, |index| 1 << (index / self.span))
    }

    /// Whether a mover may ever come between a ray's start and its end.
    pub fn meets(&self, ray: &Ray) -> bool {
        !self.boxes.is_empty() && self.tree.meets(ray)
    }
}

//! The change from one moment to the next: moved surfaces, and emitters whose light differs.

use crate::emission::Emission;
use crate::emission::Lights;
use crate::geometry::{AabbBvh8, Bounds};
use crate::ids::SurfaceId;
use crate::mesh::{Kind, PerKind, PosedMesh, Surface};
use crate::sequence::prepared::Prepared;
use crate::visibility::Accel;
use crate::visibility::update::Moved;
use glam::Vec3;

/// A moment that the next one is compared with.
pub(crate) struct Last {
    /// The geometry.
    pub(crate) placed: PosedMesh,
    /// The emission.
    pub(crate) emission: Emission,
    /// Bounds of the movers' parts.
    pub(crate) boxes: Vec<Bounds>,
    /// The bit of the swept volume's span that the moment belongs to.
    pub(crate) span: u32,
}

/// The geometry and the lights of a moment, and their differences from the last one.
pub(crate) struct Change<'a> {
    /// The geometry, ready for rays.
    pub(crate) accel: Accel<'a>,
    /// The emitters.
    pub(crate) lights: Lights,
    /// Moved surfaces.
    pub(crate) moved: Moved,
    /// Whether lights of each kind, resting and moving, changed their cones or ranges, or moved.
    beams: PerKind<bool>,
    /// Bounds of the movers' parts.
    boxes: Vec<Bounds>,
    /// Whether there was a last moment.
    pub(crate) known: bool,
    /// Whether a surface has another colour than in the last moment.
    repainted: bool,
}

/// Differences of light between two moments.
#[derive(Default)]
struct LightChanges {
    /// Whether a light moved.
    moved: bool,
    /// Whether emitters of each kind emit something else.
    lit_changed: PerKind<bool>,
    /// Whether lights of each kind changed their cones or ranges, or moved.
    beams: PerKind<bool>,
}

impl<'a> Change<'a> {
    /// Compares a moment with the last one; `time` is its time in seconds.
    pub(crate) fn of(
        prepared: &'a Prepared,
        last: Option<&Last>,
        placed: &'a PosedMesh,
        lights: Lights,
        time: f64,
    ) -> Change<'a> {
        let patches = &prepared.patches;
        let surfaces = moved_surfaces(prepared, last, placed);
        let boxes = prepared.parts.boxes(placed);
        let moved: Vec<Bounds> = boxes
            .iter()
            .zip(&prepared.parts.surface)
            .filter(|(_, surface)| surfaces[**surface])
            .map(|(bounds, _)| *bounds)
            .collect();
        let changed = light_changes(prepared, last, &lights);
        let every_mover = patches.surfaces.iter().zip(&surfaces);
        Change {
            accel: Accel::with_movers(patches, prepared.back.always(), placed),
            lights,
            moved: Moved {
                all: { every_mover }.all(|(surface, moved)| surface.moves == *moved),
                surfaces,
                span: prepared.swept.span_of(time),
                last_span: last.map_or(0, |last| last.span),
                movers: prepared.parts.oriented(patches, placed),
                boxes: AabbBvh8::build(&moved),
                lights: changed.moved,
                lit_changed: changed.lit_changed,
            },
            beams: changed.beams,
            boxes,
            known: last.is_some(),
            repainted: last.is_some_and(|last| last.placed.colors != placed.colors),
        }
    }

    /// Whether neither a hit nor the light can differ from the last moment.
    pub(crate) fn is_none(&self) -> bool {
        let lit = self.moved.lit_changed == PerKind::default() && !self.repainted;
        self.known && lit && !self.moved.any()
    }

    /// Bounds of moved geometry for pixels: in the last moment, and now.
    pub(crate) fn disturbed(&self, prepared: &Prepared, last: Option<&Last>) -> Vec<Bounds> {
        let Some(last) = last else {
            return Vec::new();
        };
        let surface = &prepared.parts.surface;
        let moved = |(bounds, surface): (&Bounds, &SurfaceId)| {
            self.moved.surfaces[*surface].then_some(*bounds)
        };
        let before = last.boxes.iter().zip(surface);
        let both = before.chain(self.boxes.iter().zip(surface));
        let boxes = both.filter_map(moved);
        boxes.filter(|bounds| !bounds.is_empty()).collect()
    }

    /// Whether pixels must trace the shadow rays of resting and moving emitters again: their beams changed, or an emitter moved.
    pub(crate) fn relit(&self, prepared: &Prepared) -> PerKind<bool> {
        let emits = |(surface, moved): (&Surface, &bool)| *moved && surface.emission != Vec3::ZERO;
        let surfaces = prepared.patches.surfaces.iter();
        let moved = surfaces.zip(&self.moved.surfaces).any(emits);
        PerKind {
            moving: self.beams.moving || moved,
            ..self.beams
        }
    }

    /// Gives up the geometry, and keeps the rest for the next comparison, with the geometry's own data.
    pub(crate) fn end(self) -> impl FnOnce(PosedMesh) -> Last + use<> {
        let (emission, boxes, span) = (self.lights.emission, self.boxes, self.moved.span);
        move |placed| Last {
            placed,
            emission,
            boxes,
            span,
        }
    }
}

/// Whether each surface stands elsewhere than in the last moment; before the first one, all movers do.
fn moved_surfaces(prepared: &Prepared, last: Option<&Last>, placed: &PosedMesh) -> Vec<bool> {
    let patches = &prepared.patches;
    let differs = |last: &Last, id: SurfaceId, s: &Surface| {
        last.placed.of(s) != placed.of(s)
            || last.placed.normals.of(id) != placed.normals.of(id)
            || last.placed.is_flipped(|| id) != placed.is_flipped(|| id)
    };
    let moved =
        |(id, s): (SurfaceId, &Surface)| s.moves && last.is_none_or(|last| differs(last, id, s));
    patches
        .surface_ids()
        .zip(&patches.surfaces)
        .map(moved)
        .collect()
}

/// Compares the emitters of a moment with those of the last one; before the first one, all differ.
fn light_changes(prepared: &Prepared, last: Option<&Last>, lights: &Lights) -> LightChanges {
    let mut changes = LightChanges::default();
    let (peak, now) = (&prepared.light.peak, &lights.emission);
    let before = last.map(|last| &last.emission);
    for (index, surface) in prepared.patches.surfaces.iter().enumerate() {
        let same = before.is_some_and(|b| b.surfaces[index] == now.surfaces[index]);
        changes.lit_changed[Kind::of(surface.moves)] |= !same && surface.emission != Vec3::ZERO;
    }
    let peak = peak.lights.iter().enumerate();
    for (index, peak) in peak.filter(|(_, peak)| peak.emits) {
        let light = &now.lights[index];
        let last = before.map(|b| b.lights[index]);
        let moved = last.is_none_or(|last| last.stands() != light.stands());
        let beam =
            last.is_none_or(|last| (last.cone, last.range) != (light.cone, light.range) || moved);
        let kind = Kind::of(peak.moves);
        changes.lit_changed[kind] |= last != Some(*light);
        changes.moved |= moved && peak.moves;
        changes.beams[kind] |= beam;
    }
    changes
}

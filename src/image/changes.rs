//! Changes of the scene since the last frame, and whether they may alter a pixel's direct light.

use super::context::ShadingContext;
use super::pixel::Pixel;
use crate::geometry::Bounds;
use crate::mesh::{Kind, PerKind};
use glam::Vec3;

/// What moved since the last frame, for pixels.
pub struct SceneChanges<'a> {
    /// Boxes of moved parts, where they were and where they are.
    pub boxes: &'a [Bounds],
    /// Whether resting emitters changed their cones or ranges, and whether moving ones did or moved.
    pub emitters: PerKind<bool>,
}

impl SceneChanges<'_> {
    /// Whether nothing moved.
    pub(super) fn is_none(&self) -> bool {
        self.boxes.is_empty() && self.emitters == PerKind::default()
    }
}

/// Boxes, and one around all of them, which mostly tells that none stands anywhere near.
pub(super) struct MovedBoxes<'a> {
    boxes: &'a [Bounds],
    all: Bounds,
}

impl MovedBoxes<'_> {
    /// Those of the changes; none where nothing is known.
    pub(super) fn of<'a>(changes: Option<&SceneChanges<'a>>) -> MovedBoxes<'a> {
        let boxes = changes.map_or(&[][..], |changes| changes.boxes);
        let all = boxes.iter().copied().fold(Bounds::EMPTY, Bounds::union);
        MovedBoxes { boxes, all }
    }
}

/// Whether a box may stand between a pixel's points and an emitter of one kind.
pub(super) fn shaded(
    pixel: &Pixel,
    scene: &ShadingContext,
    kind: Kind,
    moved: &MovedBoxes,
) -> bool {
    let boxes = moved.boxes;
    if boxes.is_empty() {
        return false;
    }
    pixel.groups.iter().any(|group| {
        // The starts of its light samples spread around the group's point, and above it: widen the boxes by as much.
        let spread = group
            .starts
            .iter()
            .fold(0.0f32, |s, p| s.max(p.distance(group.point)));
        let spread = spread + group.smooth.rise;
        let wider = |b: &Bounds| b.padded(spread * 1.001 + 1e-5 * group.point.abs().max_element());
        let cells = &scene.lights.emitters[kind];
        let mut surfaces = cells.boxes.iter();
        let mut lights = cells.lights.iter();
        let all = wider(&moved.all);
        surfaces.any(|emitter| {
            let mut boxes = boxes.iter();
            in_shaft(group.point, emitter, &all)
                && boxes.any(|b| in_shaft(group.point, emitter, &wider(b)))
        }) || lights.any(|light| {
            let meets = |b: &Bounds| in_shaft(group.point, &light.goal(group.point, b), b);
            meets(&all) && boxes.iter().map(wider).any(|b| meets(&b))
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

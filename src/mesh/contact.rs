//! Contacts: elements are cut where a static surface stands on another or crosses it, and light is not interpolated across.
//!
//! An element that reaches to both sides of a wall would have one light for both: a bright room would leak into a dark one
//! (Baum, Mann, Smith, Winget 1991, "Making radiosity usable: automatic preprocessing and meshing techniques for the
//! generation of accurate radiosity solutions", Computer Graphics 25(4):51–60, whose lines of intersection these are). We do
//! not intersect planes but ask what origins of samples would see: an edge, lifted as they are, is split where a ray along it
//! strikes something. So whatever stands closer to a surface than the ray offset stands on it, and holes are holes. The first who
//! asks for an edge decides for all: two triangles that share it are cut alike. A wall that ends inside an element does not
//! cut it, for light comes round its end; and what moves neither cuts nor is cut, for elements are fixed for all time.

use super::near_light::{NearLight, ReachedLight};
use super::shadow_cuts::ShadowCuts;
use super::sizes::Sizes;
use crate::geometry::{Bvh8, Ray};
use crate::ids::TriangleId;
use crate::scene::{Animation, deform::Shown};
use crate::texture::Cutouts;
use glam::Vec3;
use std::collections::HashMap;
use std::sync::Arc;

/// Offset of sample origins from their surface, as a fraction of the scene's size: 0.2 mm in a 10 m room. Half of it
/// would come near the rounding of coordinates; double would step over gaps of half a millimetre.
const LIFT: f32 = 2e-5;

/// Cosine of the least angle between a surface and what cuts it, 3°: what lies on it as a rug does is a cover, not a wall.
const COVER: f32 = 0.9986;

/// What is closer to a surface than this share of an edge, 4 mm of 25 cm, is taken to stand on it: authors leave such gaps.
const GAP: f32 = 1.0 / 64.0;

/// Both ends of an edge must be this far from what cuts it, in lifts: nearer ends lie on it.
const CLEAR: f32 = 0.5;

/// What cuts an edge is as wide as this share of it, to one side at least: a leg of a chair is not, and parts nothing.
const WIDE: f32 = 0.5;

/// And so tall, leaning by no more than 45°: a skirting board parts nothing either.
const TALL: f32 = 0.25;

/// The plane of what goes on passes within this share of the edge's length of where it was crossed.
const SAME: f32 = 1.0 / 32.0;

/// Half the way across a line between elements, in lifts, along which they see each other or not.
const ACROSS: f32 = 2.0;

/// The resting triangles.
pub(super) struct Contacts {
    triangles: Vec<[Vec3; 3]>,
    tree: Bvh8,
    /// Distance of sample origins from their surface, in metres.
    ray_offset: f32,
    /// Of each instance whether it is cut at all, and whether its back receives light too.
    cut: Vec<Option<bool>>,
    light: NearLight,
}

/// The edges of one surface that have been asked for, and where they are cut.
pub(super) struct Crossings<'a> {
    contacts: &'a Contacts,
    /// Whether its back receives light too.
    double_sided: bool,
    known: HashMap<EdgeBits, Option<f32>>,
    /// The emitters that are near enough to count, and the edges that were asked about them.
    light: Option<&'a ReachedLight<'a>>,
    lit: HashMap<EdgeBits, bool>,
    /// The boundaries of shadows, if they cut, and the edges that were asked about them.
    shadows: Option<ShadowCuts<'a>>,
}

/// The cut of an edge.
pub(super) struct EdgeCut {
    /// The weight of its second end.
    pub(super) share: f32,
    /// The point.
    pub(super) point: Vec3,
    /// The boundary of a shadow that crosses it there, if that is why.
    shadow: Option<u32>,
}

/// The ends of an edge, bit by bit, in an order of their own.
type EdgeBits = [[u32; 3]; 2];

/// The plane of a triangle.
struct ContactPlane {
    point: Vec3,
    normal: Vec3,
}

impl ContactPlane {
    /// Signed distance of a point in metres; negative behind the plane.
    fn away(&self, point: Vec3) -> f32 {
        (point - self.point).dot(self.normal)
    }
}

impl Contacts {
    /// The contacts of an animation's resting triangles, numbered in the order of their instances; `cutouts` knows their holes.
    pub(super) fn of(animation: &Animation, shown: &[Shown], cutouts: &Arc<Cutouts>) -> Contacts {
        let moves = animation.moves();
        let at_rest = shown.iter().zip(&moves).filter(|(_, moves)| !**moves);
        let triangles: Vec<[Vec3; 3]> = at_rest
            .flat_map(|(shown, _)| &shown.corners)
            .copied()
            .collect();
        let tree = Bvh8::build(&triangles, TriangleId::new(0)).pierced(cutouts);
        let cut = animation
            .instances
            .iter()
            .zip(&moves)
            .map(|(instance, moves)| {
                let mesh = &animation.meshes[instance.mesh];
                let material = &animation.materials[mesh.material];
                (!moves && !material.unlit).then_some(material.double_sided)
            });
        Contacts {
            triangles,
            tree,
            ray_offset: ray_offset(shown),
            cut: cut.collect(),
            light: NearLight::of(animation, shown, &moves),
        }
    }

    /// The near emitters of a mesh with these sizes, if it has any.
    pub(super) fn near_light(&self, sizes: &Sizes) -> Option<ReachedLight<'_>> {
        self.light.within(sizes.even())
    }

    /// For the edges of an instance, if it is cut.
    pub(super) fn on<'a>(
        &'a self,
        instance: usize,
        light: Option<&'a ReachedLight<'a>>,
        sizes: &'a Sizes,
    ) -> Option<Crossings<'a>> {
        let shadowed = sizes.shadowed();
        self.cut[instance].map(|double_sided| Crossings {
            contacts: self,
            double_sided,
            known: HashMap::new(),
            light,
            lit: HashMap::new(),
            shadows: shadowed.map(|shadowed| ShadowCuts::on(shadowed, instance, double_sided)),
        })
    }

    /// The first triangle that counts on the way from one point to another on a surface, `ray_offset` metres above it: where between
    /// 0 and 1, and its plane.
    fn bar(
        &self,
        [p, q]: [Vec3; 2],
        normal: Vec3,
        ray_offset: f32,
        counts: impl Fn(&ContactPlane) -> bool,
    ) -> Option<(f32, ContactPlane)> {
        let (way, length) = (q - p, p.distance(q));
        let mut ray = Ray {
            origin: p + normal * ray_offset,
            direction: way / length,
            tmin: 0.0,
            tmax: length,
        };
        while let Some(hit) = self.tree.intersect(&ray) {
            let [a, b, c] = self.triangles[hit.triangle];
            let plane = ContactPlane {
                point: a,
                normal: (b - a).cross(c - a).normalize_or_zero(),
            };
            if plane.normal.dot(normal).abs() < COVER && counts(&plane) {
                return Some((hit.t / length, plane));
            }
            ray.tmin = hit.t;
        }
        None
    }

    /// Where an edge is split because something stands across it, if it does.
    fn crossing(&self, [p, q]: [Vec3; 2], normal: Vec3) -> Option<f32> {
        let length = p.distance(q);
        if length <= self.ray_offset {
            return None;
        }
        let between = |plane: &ContactPlane| {
            let [before, behind] = [plane.away(p), plane.away(q)];
            before * behind < 0.0 && before.abs().min(behind.abs()) > CLEAR * self.ray_offset
        };
        self.ray_offsets(length).into_iter().find_map(|ray_offset| {
            let (share, wall) = self.bar([p, q], normal, ray_offset, between)?;
            // Look across its line to see whether it goes on upwards and to one side.
            let (cross, along) = (
                p + (q - p) * share,
                normal.cross(wall.normal).normalize_or_zero(),
            );
            let reach = along.cross(normal) * (TALL * length);
            let goes_on = |by: Vec3, ray_offset: f32| {
                let place = cross + by;
                let same = |plane: &ContactPlane| plane.away(place).abs() < SAME * length;
                self.bar([place - reach, place + reach], normal, ray_offset, same)
                    .is_some()
            };
            let aside = along * (WIDE * length);
            let wide = goes_on(aside, ray_offset) || goes_on(-aside, ray_offset);
            (wide && goes_on(Vec3::ZERO, TALL * length)).then_some(share)
        })
    }

    /// How far above a surface to look: for what stands on it, and for what all but does, beside an edge of so many metres.
    fn ray_offsets(&self, length: f32) -> [f32; 2] {
        [self.ray_offset, self.ray_offset.max(GAP * length)]
    }

    /// Whether something stands on the line at `place` between two parts of a surface whose middles lie in these directions
    /// from it.
    pub(super) fn parts(&self, place: Vec3, [one, other]: [Vec3; 2], normal: Vec3) -> bool {
        let step = |towards: Vec3| towards.normalize_or_zero() * (ACROSS * self.ray_offset);
        let (from, way) = (place + step(one), step(other) - step(one));
        let length = way.length();
        let ray_offsets = self.ray_offsets(one.distance(other));
        length > 0.0
            && ray_offsets.into_iter().any(|ray_offset| {
                self.tree.occluded(&Ray {
                    origin: from + normal * ray_offset,
                    direction: way / length,
                    tmin: 0.0,
                    tmax: length,
                })
            })
    }
}

/// Distance of sample origins from their surface, in metres, in a scene with these corners.
pub(super) fn ray_offset(shown: &[Shown]) -> f32 {
    let corners = shown
        .iter()
        .flat_map(|shown| shown.corners.iter().flatten());
    LIFT * corners.fold(0.0f32, |extent, p| extent.max(p.abs().max_element()))
}

impl Crossings<'_> {
    /// Goes on to a triangle of the instance.
    pub(super) fn enter(&mut self, triangle: usize) {
        if let Some(shadows) = &mut self.shadows {
            shadows.enter(triangle);
        }
    }

    /// Whether shadows cut too.
    pub(super) fn cuts_shadows(&self) -> bool {
        self.shadows.is_some()
    }

    /// Whether a cut that leads to a corner of the same triangle keeps to the boundary of a shadow.
    pub(super) fn keeps_to(&self, cut: &EdgeCut, corner: Vec3) -> bool {
        match (&self.shadows, cut.shadow) {
            (Some(shadows), Some(line)) => shadows.runs_through(line, corner),
            _ => false,
        }
    }

    /// Where an edge of a triangle with this normal is split.
    pub(super) fn split(&mut self, ends: [Vec3; 2], normal: Vec3) -> Option<EdgeCut> {
        let ([p, q], bits, turned) = ordered(ends);
        let (contacts, double_sided) = (self.contacts, self.double_sided);
        let share = *self.known.entry(bits).or_insert_with(|| {
            let front = contacts.crossing([p, q], normal);
            front.or_else(|| double_sided.then(|| contacts.crossing([p, q], -normal))?)
        });
        let shadows = share.is_none().then_some(self.shadows.as_mut()).flatten();
        let shadow = shadows.and_then(|shadows| shadows.split([p, q], bits, normal));
        let share = share.or(shadow.map(|cut| cut.share));
        share.map(|share| EdgeCut {
            share: if turned { 1.0 - share } else { share },
            point: p + (q - p) * share,
            shadow: shadow.map(|cut| cut.line),
        })
    }

    /// Whether an edge of a triangle with this normal is halved because light of near emitters differs along it.
    pub(super) fn halves(&mut self, ends: [Vec3; 2], normal: Vec3) -> bool {
        let Some(light) = self.light else {
            return false;
        };
        let (ends, bits, _) = ordered(ends);
        let double_sided = self.double_sided;
        *self.lit.entry(bits).or_insert_with(|| {
            light.differs(ends, normal) || double_sided && light.differs(ends, -normal)
        })
    }
}

/// An edge's ends in an order that does not depend on the triangle that asks, so that both compute with the same numbers;
/// their bits, and whether they were turned.
fn ordered(ends: [Vec3; 2]) -> ([Vec3; 2], EdgeBits, bool) {
    let bits = ends.map(|p| (p + Vec3::ZERO).to_array().map(f32::to_bits));
    if bits[0] > bits[1] {
        ([ends[1], ends[0]], [bits[1], bits[0]], true)
    } else {
        (ends, bits, false)
    }
}

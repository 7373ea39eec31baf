//! Bounds of a receiver's origins and probe rays: what lies outside cannot change what it sees.

use crate::formfactor::hemisphere::turn;
use crate::geometry::Bounds;
use crate::ids::SideId;
use crate::mesh::{PosedMesh, RadiosityMesh};
use crate::visibility::sample::CLEARANCE;
use glam::{Vec2, Vec3};

/// Bounds and axes of a receiver's origins, for culling.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SideFrame {
    /// Middle of the element.
    pub(crate) middle: Vec3,
    /// A ball around the middle with this radius holds all origins, in metres.
    pub(crate) radius: f32,
    /// Tangent, bitangent and normal, turned as the side's directions are.
    pub(crate) axes: [Vec3; 3],
    /// A ball with this radius holds all probe rays.
    pub(crate) near: f32,
    /// How far origins may lie below the middle, in metres: those of a cluster lie all over it.
    below: f32,
    /// The set of directions.
    pub(crate) set: u32,
}

impl SideFrame {
    /// A side's frame.
    pub(crate) fn of(patches: &RadiosityMesh, placed: &PosedMesh, side: SideId) -> SideFrame {
        let (set, angle) = turn(side, 0);
        let stand = patches.stand(placed, side, Vec2::from_angle(angle));
        let [a, b, c] = stand.corners;
        let middle = (a + b + c) / 3.0;
        let cluster = patches.clusters.cluster(patches.sides[side].element);
        let members = cluster.map_or(&[][..], |cluster| patches.clusters.members(cluster));
        let on_members = members.iter().map(|member| &patches.elements[*member]);
        let corners = on_members.flat_map(|member| placed.element_corners(member));
        let (mut radius, mut below) = (0.0f32, 0.0f32);
        for corner in corners.chain(stand.corners) {
            radius = radius.max(corner.distance(middle));
            below = below.max((middle - corner).dot(stand.normal));
        }
        let radius = radius * (1.0 + 1e-5) + 2.0 * patches.ray_offset;
        SideFrame {
            middle,
            radius,
            axes: [stand.tangent, stand.bitangent, stand.normal],
            near: radius + CLEARANCE * stand.longest_edge() * (1.0 + 1e-5),
            below: below * (1.0 + 1e-5),
            set: set as u32,
        }
    }

    /// Whether the side has no area now.
    pub(crate) fn is_flat(&self) -> bool {
        self.axes[2] == Vec3::ZERO
    }

    /// Whether all of a box lies below the plane of the side, and of what is in it.
    pub(crate) fn is_above(&self, bounds: &Bounds) -> bool {
        let normal = self.axes[2];
        let top = Vec3::select(normal.cmpgt(Vec3::ZERO), bounds.hi, bounds.lo);
        normal.dot(top - self.middle) < -self.below
    }

    /// A vector in the side's own frame.
    pub(crate) fn turned(&self, v: Vec3) -> Vec3 {
        Vec3::from(self.axes.map(|axis| axis.dot(v)))
    }

    /// A box around the origins.
    pub(crate) fn bounds(&self) -> Bounds {
        Bounds::of_points([self.middle]).padded(self.radius)
    }
}

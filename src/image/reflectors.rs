//! Bright reflectors: resting sides that reflect far more than most receivers see, at which gathering samples aim.

use crate::ids::{ElementId, SideId};
use crate::mesh::{PosedMesh, RadiosityMesh};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// The least cosine that a cluster is taken to have.
const CLUSTER_FACES: f32 = 0.25;

/// A side that is aimed at.
#[derive(Clone, Debug)]
pub(super) struct Reflector {
    pub(super) side: SideId,
    /// Its corners, or of the triangle that stands for a cluster; and the normal.
    corners: [Vec3; 3],
    normal: Vec3,
    /// The triangles of a cluster, each with the area up to it.
    members: Vec<([Vec3; 3], f32)>,
    /// Probability of each point, 1/m².
    density: f32,
}

impl Reflector {
    /// A side as it stands in a pose.
    pub(super) fn of(
        patches: &RadiosityMesh,
        placed: &PosedMesh,
        side: SideId,
        density: f32,
    ) -> Reflector {
        let stand = patches.stand(placed, side, Vec2::X);
        Reflector {
            side,
            corners: stand.corners,
            normal: stand.normal,
            members: members(patches, placed, side),
            density,
        }
    }

    /// Whether it stands in this pose where it did.
    pub(super) fn stands(&self, patches: &RadiosityMesh, placed: &PosedMesh) -> bool {
        let stand = patches.stand(placed, self.side, Vec2::X);
        (stand.corners, stand.normal) == (self.corners, self.normal)
    }

    /// The cosine under which rays of this direction meet it; of a cluster, whose triangles face other ways, no less than
    /// [`CLUSTER_FACES`].
    #[inline]
    fn faces(&self, direction: Vec3) -> f32 {
        let cosine = -self.normal.dot(direction);
        match self.members.is_empty() {
            true => cosine,
            false => cosine.max(CLUSTER_FACES),
        }
    }

    /// How many times as likely an aim is as a cosine-distributed direction is to choose a ray that hits it after `distance`
    /// metres, per sample. The points of a cluster are taken to face as it does on the whole; [`Reflector::turn`] makes up for
    /// that.
    #[inline]
    pub(super) fn odds(&self, (direction, cosine): (Vec3, f32), distance: f32) -> f32 {
        let across = cosine * self.faces(direction);
        match across > 0.0 {
            true => self.density * distance * distance * PI / across,
            false => 0.0,
        }
    }

    /// What the light that an aim finds on a triangle with this normal counts for beside the odds that its side was taken to
    /// have, for the triangle may face another way. The balance between both kinds of samples may be any, as long as both keep
    /// to it.
    #[inline]
    pub(super) fn turn(&self, normal: Vec3, direction: Vec3) -> f32 {
        match self.members.is_empty() {
            true => 1.0,
            false => (-normal.dot(direction)).max(0.0) / self.faces(direction),
        }
    }

    /// The triangle that a number from 0 to 1 chooses by area, and its unit normal on the side's front.
    pub(super) fn triangle(&self, chosen: f32) -> ([Vec3; 3], Vec3) {
        let under = |all: f32| {
            let members = &self.members;
            let under = members.partition_point(|(_, upto)| *upto <= chosen * all);
            members.get(under)
        };
        let corners = match self.members.last() {
            None => self.corners,
            Some((last, all)) => under(*all).map_or(*last, |(corners, _)| *corners),
        };
        let front = facing(self.corners).dot(self.normal).signum();
        (corners, facing(corners).normalize_or_zero() * front)
    }
}

/// The front of a triangle, as long as twice its area.
fn facing([a, b, c]: [Vec3; 3]) -> Vec3 {
    (b - a).cross(c - a)
}

/// The triangles of a side that is a cluster's, each with the area up to it; none of another.
fn members(patches: &RadiosityMesh, placed: &PosedMesh, side: SideId) -> Vec<([Vec3; 3], f32)> {
    let Some(cluster) = patches.clusters.cluster(patches.sides[side].element) else {
        return Vec::new();
    };
    let mut upto = 0.0;
    let members = patches.clusters.members(cluster).iter();
    let of = |member: &ElementId| {
        let element = &patches.elements[*member];
        upto += placed.area(element);
        (placed.element_corners(element), upto)
    };
    members.map(of).collect()
}

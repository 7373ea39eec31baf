//! The geometry at time t, ready for rays: resting and moving triangles in two trees, or all of them in one.

use crate::geometry::{Hit, Ray, Tree};
use crate::patch::{Patches, Placed};

/// All triangles at one time.
pub struct Stage<'a> {
    /// Where they are.
    pub placed: &'a Placed,
    trees: Trees<'a>,
}

enum Trees<'a> {
    /// The resting triangles' tree is kept for the whole animation, the movers' is of this frame.
    Two { resting: &'a Tree, movers: Tree },
    /// Everything in one tree, as a renderer without a back-buffer would build it.
    One(Tree),
}

impl<'a> Stage<'a> {
    /// The resting triangles' tree with the movers of this pose.
    pub fn with_movers(patches: &Patches, resting: &'a Tree, placed: &'a Placed) -> Stage<'a> {
        let movers =
            Tree::build(patches.moving(placed), patches.static_triangles).pierced(&patches.cutouts);
        Stage {
            placed,
            trees: Trees::Two { resting, movers },
        }
    }

    /// One tree over everything in this pose.
    pub fn whole(patches: &Patches, placed: &'a Placed) -> Stage<'a> {
        let tree = Tree::build(&placed.triangles, 0).pierced(&patches.cutouts);
        Stage {
            placed,
            trees: Trees::One(tree),
        }
    }

    /// The first thing a ray meets; ties go to the lower triangle.
    #[inline]
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        match &self.trees {
            Trees::One(tree) => tree.closest(ray),
            Trees::Two { resting, movers } => {
                let hit = resting.closest(ray);
                // A mover has the higher id, so it must be strictly nearer: exactly what a ray that ends there asks.
                let tmax = hit.map_or(ray.tmax, |h| h.t);
                movers.closest(&Ray { tmax, ..*ray }).or(hit)
            }
        }
    }

    /// [`Stage::closest`] for a ray that meets no mover.
    #[inline]
    pub fn closest_at_rest(&self, ray: &Ray) -> Option<Hit> {
        match &self.trees {
            Trees::One(tree) => tree.closest(ray),
            Trees::Two { resting, .. } => resting.closest(ray),
        }
    }

    /// [`Stage::blocked`] for a ray that meets no mover.
    #[inline]
    pub fn blocked_at_rest(&self, ray: &Ray) -> bool {
        match &self.trees {
            Trees::One(tree) => tree.blocked(ray),
            Trees::Two { resting, .. } => resting.blocked(ray),
        }
    }

    /// The first mover a ray meets, and whether it came near any: met a box of the movers' root.
    #[inline]
    pub fn closest_mover(&self, ray: &Ray) -> (Option<Hit>, bool) {
        match &self.trees {
            Trees::One(_) => (None, false),
            Trees::Two { movers, .. } => movers.closest_counted(ray),
        }
    }

    /// Whether anything stands in a ray's way.
    #[inline]
    pub fn blocked(&self, ray: &Ray) -> bool {
        match &self.trees {
            Trees::One(tree) => tree.blocked(ray),
            Trees::Two { resting, movers } => movers.blocked(ray) || resting.blocked(ray),
        }
    }

    /// Whether a mover stands in a ray's way.
    #[inline]
    pub fn blocked_by_mover(&self, ray: &Ray) -> bool {
        match &self.trees {
            Trees::One(_) => false,
            Trees::Two { movers, .. } => movers.blocked(ray),
        }
    }
}

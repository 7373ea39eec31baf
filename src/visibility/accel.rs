//! The triangles at time t in acceleration structures: resting and moving ones in two trees, or all of them in one.

use super::sample;
use crate::geometry::{Hit, Ray, Tree};
use crate::mesh::{Patches, Placed};

/// All triangles at one time.
pub struct Accel<'a> {
    /// Where they are.
    pub placed: &'a Placed,
    trees: Trees<'a>,
}

enum Trees<'a> {
    /// The resting triangles' tree is kept for the whole animation, the movers' is of this frame.
    Two { resting: &'a Tree, movers: Tree },
    /// Everything in one tree, as a renderer without a back-buffer would build it.
    One(Tree),
    /// Two trees whose triangles are numbered in any order, the second a small one, and whether that never shines.
    Mixed(&'a Tree, &'a Tree, bool),
}

impl<'a> Accel<'a> {
    /// The resting triangles' tree with the movers of this pose.
    pub fn with_movers(patches: &Patches, resting: &'a Tree, placed: &'a Placed) -> Accel<'a> {
        let movers =
            Tree::build(patches.moving(placed), patches.static_triangles).pierced(&patches.cutouts);
        Accel {
            placed,
            trees: Trees::Two { resting, movers },
        }
    }

    /// One tree over everything in this pose.
    pub fn whole(patches: &Patches, placed: &'a Placed) -> Accel<'a> {
        let tree = Tree::build(&placed.triangles, 0).pierced(&patches.cutouts);
        Accel {
            placed,
            trees: Trees::One(tree),
        }
    }

    /// Two trees that have all triangles between them, in any order of their numbers; the other is the
    /// smaller one, and `dark` says that nothing in it ever shines.
    pub fn mixed(placed: &'a Placed, one: &'a Tree, other: &'a Tree, dark: bool) -> Accel<'a> {
        let trees = Trees::Mixed(one, other, dark);
        Accel { placed, trees }
    }

    /// The first hit of a camera's ray, and whether it is on a back. As glTF asks, a camera does not see the back of a
    /// single-sided surface.
    pub fn primary(&self, patches: &Patches, ray: &Ray) -> Option<(Hit, bool)> {
        let mut ray = *ray;
        loop {
            let hit = self.closest(&ray)?;
            let back = patches.is_back(self.placed, hit.triangle, ray.direction);
            let surface = patches.surface_of[hit.triangle as usize];
            if !back || patches.surfaces[surface as usize].double_sided {
                return Some((hit, back));
            }
            ray.tmin = hit.t;
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
            // The other is small, and what starts in it mostly ends there: ask it first.
            Trees::Mixed(one, other, _) => nearer(other, one, ray),
        }
    }

    /// [`Accel::closest`] for a ray whose first hit in the smaller of two trees is known.
    #[inline]
    pub fn closest_beside(&self, ray: &Ray, other: Option<Hit>) -> Option<Hit> {
        match &self.trees {
            Trees::Mixed(one, ..) => nearer_than(other, one, ray),
            _ => self.closest(ray),
        }
    }

    /// [`Accel::closest`] for a ray that meets no mover.
    #[inline]
    pub fn closest_at_rest(&self, ray: &Ray) -> Option<Hit> {
        match &self.trees {
            Trees::One(tree) => tree.closest(ray),
            Trees::Two { resting, .. } => resting.closest(ray),
            Trees::Mixed(one, other, _) => nearer(other, one, ray),
        }
    }

    /// [`Accel::blocked`] for a ray that meets no mover.
    #[inline]
    pub fn blocked_at_rest(&self, ray: &Ray) -> bool {
        match &self.trees {
            Trees::One(tree) => tree.blocked(ray),
            Trees::Two { resting, .. } => resting.blocked(ray),
            Trees::Mixed(one, other, _) => one.blocked(ray) || other.blocked(ray),
        }
    }

    /// The first mover a ray meets, and whether it came near any: met a box of the movers' root.
    #[inline]
    pub fn closest_mover(&self, ray: &Ray) -> (Option<Hit>, bool) {
        match &self.trees {
            Trees::One(_) | Trees::Mixed(..) => (None, false),
            Trees::Two { movers, .. } => movers.closest_counted(ray),
        }
    }

    /// Whether anything stands in a ray's way.
    #[inline]
    pub fn blocked(&self, ray: &Ray) -> bool {
        match &self.trees {
            Trees::One(tree) => tree.blocked(ray),
            Trees::Two { resting, movers } => movers.blocked(ray) || resting.blocked(ray),
            Trees::Mixed(one, other, _) => other.blocked(ray) || one.blocked(ray),
        }
    }

    /// Whether a probe ray meets anything but emitters that shine towards it: then its origin is invalid.
    pub fn occludes_probe(&self, patches: &Patches, ray: &Ray) -> bool {
        let blocked = match &self.trees {
            Trees::Mixed(one, other, dark) => match other.blocked(ray) {
                true if *dark => return true,
                blocked => blocked || one.blocked(ray),
            },
            _ => self.blocked(ray),
        };
        blocked && sample::is_occluded(patches, self.placed, ray, |ray| self.closest(ray))
    }

    /// [`Accel::occludes_probe`] for a ray that meets no mover.
    pub fn rest_occludes_probe(&self, patches: &Patches, ray: &Ray) -> bool {
        self.blocked_at_rest(ray)
            && sample::is_occluded(patches, self.placed, ray, |ray| self.closest_at_rest(ray))
    }

    /// [`Accel::occludes_probe`] for movers alone.
    pub fn mover_occludes_probe(&self, patches: &Patches, ray: &Ray) -> bool {
        self.blocked_by_mover(ray)
            && sample::is_occluded(patches, self.placed, ray, |ray| self.closest_mover(ray).0)
    }

    /// Whether a mover stands in a ray's way.
    #[inline]
    pub fn blocked_by_mover(&self, ray: &Ray) -> bool {
        match &self.trees {
            Trees::One(_) | Trees::Mixed(..) => false,
            Trees::Two { movers, .. } => movers.blocked(ray),
        }
    }
}

/// The first hit in two trees; of two at the same distance the one with the lower number, as in a tree over both.
#[inline]
fn nearer(one: &Tree, other: &Tree, ray: &Ray) -> Option<Hit> {
    nearer_than(one.closest(ray), other, ray)
}

/// The same where the first hit in one tree is known.
#[inline]
fn nearer_than(first: Option<Hit>, other: &Tree, ray: &Ray) -> Option<Hit> {
    let Some(first) = first else {
        return other.closest(ray);
    };
    // A hit must stay below tmax: let one through that draws level.
    let tmax = first.t.next_up().min(ray.tmax);
    match other.closest(&Ray { tmax, ..*ray }) {
        Some(second) if (second.t, second.triangle) < (first.t, first.triangle) => Some(second),
        _ => Some(first),
    }
}

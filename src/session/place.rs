//! Where everything is now, and what is elsewhere than in the step before.

use super::scene::EditedScene;
use crate::error::Result;
use crate::geometry::Bounds;
use crate::ids::{SideId, SurfaceId};
use crate::mesh::{PosedMesh, RadiosityMesh};
use crate::scene::pose::{FARTHEST, Pose};
use crate::session::scene::fault;
use crate::visibility::edit::frame::SideFrame;
use crate::visibility::edit::hits::SampleTables;
use crate::visibility::edit::moved_bounds::{MovedBounds, merged, shapes};
use crate::visibility::edit::sides::Sides;
use glam::{DAffine3, Vec3};

/// The state's geometry.
pub(super) struct Place {
    /// Where nodes are, and what emits.
    pub(super) pose: Pose,
    /// Where triangles are; those of what is not seen are points.
    pub(super) placed: PosedMesh,
    /// Per surface: whether it is seen.
    pub(super) there: Vec<bool>,
    /// Per surface: whether it is where edits or clips may carry it, and takes the movers' share of samples.
    pub(super) dynamic: Vec<bool>,
    /// The samples of sides of each kind.
    tables: SampleTables,
    /// The surface of each side.
    pub(super) surface_of_side: Vec<SurfaceId>,
    /// Bounds and axes of each side.
    pub(super) frames: Vec<SideFrame>,
    /// Where the first file's nodes stood at first.
    home: Vec<DAffine3>,
    /// Instances that clips move.
    played: Vec<bool>,
}

/// The geometry of a new state, before anything is done about it.
pub(super) struct Arrival {
    pub(super) pose: Pose,
    pub(super) there: Vec<bool>,
    pub(super) dynamic: Vec<bool>,
    /// Surfaces that are elsewhere, come or go, ascending.
    pub(super) moved: Vec<PlacedSurface>,
}

/// A surface where it is now.
#[derive(PartialEq)]
pub(super) struct PlacedSurface {
    /// Its number.
    pub(super) surface: SurfaceId,
    /// World corners of its triangles; what is not seen is a point, the same in every state.
    pub(super) triangles: Vec<[Vec3; 3]>,
    /// Normals at these corners, where it is smooth.
    pub(super) normals: Vec<[Vec3; 3]>,
}

impl Place {
    /// Nothing is anywhere yet: everything arrives in the first step.
    pub(super) fn new(scene: &EditedScene, tables: SampleTables, plays: bool) -> Place {
        let pose = scene.animation.pose(0.0);
        let moves = scene.animation.moves();
        Place {
            home: pose.world.clone(),
            played: moves.iter().map(|moves| plays && *moves).collect(),
            pose,
            placed: PosedMesh::default(),
            there: Vec::new(),
            dynamic: Vec::new(),
            tables,
            surface_of_side: Vec::new(),
            frames: Vec::new(),
        }
    }

    /// All sides with their samples and bounds.
    pub(super) fn sides<'a>(&'a self, patches: &'a RadiosityMesh) -> Sides<'a> {
        Sides {
            patches,
            tables: &self.tables,
            surface_of_side: &self.surface_of_side,
            dynamic: &self.dynamic,
            frames: &self.frames,
        }
    }

    /// What the scene's state at a time of its clips brings.
    ///
    /// # Errors
    /// [`Error::Edit`](crate::error::Error::Edit) where something would be too far away.
    pub(super) fn arrival(&self, scene: &EditedScene, seconds: f64) -> Result<Arrival> {
        let pose = scene.animation.pose(seconds);
        let surfaces = scene.patches.surface_ids();
        let seen = |surface: SurfaceId| pose.visible[scene.node_of(surface)];
        let there: Vec<bool> = surfaces.clone().map(seen).collect();
        let dynamic = surfaces.clone().map(|s| self.is_dynamic(scene, &pose, s));
        let dynamic = dynamic.collect();
        let mut moved = Vec::new();
        for surface in surfaces.filter(|s| self.may_differ(scene, &pose, &there, *s)) {
            let new = arrived(scene, &pose, surface, there[surface]);
            let wild = |c: &&Vec3| !c.is_finite() || c.abs().max_element() > FARTHEST as f32;
            if let Some(corner) = new.triangles.iter().flatten().find(wild) {
                let name = &scene.animation.nodes[scene.node_of(surface)].name;
                let place = format!("node '{name}'");
                let way_out = "bring it nearer to the origin";
                return Err(fault(
                    &place,
                    "coordinates below 1e15 metres",
                    &corner.to_string(),
                    way_out,
                ));
            }
            let turned = self.placed.normals.of(surface) != new.normals;
            if turned || self.old(scene, surface) != Some(&new.triangles[..]) {
                moved.push(new);
            }
        }
        Ok(Arrival {
            pose,
            there,
            dynamic,
            moved,
        })
    }

    /// Takes the new geometry for the present one, and tells what moved.
    pub(super) fn arrive(&mut self, scene: &EditedScene, arrival: &Arrival) -> MovedBounds {
        let surfaces = &scene.patches.surfaces;
        let mut moved_bounds = MovedBounds {
            moved: vec![false; surfaces.len()],
            fresh: vec![false; surfaces.len()],
            ..MovedBounds::default()
        };
        let mut things: Vec<&[[Vec3; 3]]> = Vec::new();
        let bounds = |corners: &[[Vec3; 3]]| Bounds::of_points(corners.iter().flatten().copied());
        for PlacedSurface {
            surface,
            triangles: new,
            ..
        } in &arrival.moved
        {
            let surface = *surface;
            moved_bounds.moved[surface] = true;
            if self.there.get(surface.index()) == Some(&true) {
                moved_bounds
                    .before
                    .extend(self.old(scene, surface).map(bounds));
            }
            if arrival.there[surface] {
                moved_bounds.after.push(bounds(new));
                things.push(new);
            }
        }
        // Rounding of slabs and of rays' ends must not lead past a box.
        let room = |b: Bounds| b.padded(1e-5 * b.lo.abs().max(b.hi.abs()).max_element());
        moved_bounds.before = merged(moved_bounds.before.into_iter().map(room).collect());
        moved_bounds.after = merged(moved_bounds.after.into_iter().map(room).collect());
        moved_bounds.shapes = shapes(&things, &moved_bounds.after);
        for surface in scene.patches.surface_ids() {
            let as_before = self.dynamic.get(surface.index()) == Some(&arrival.dynamic[surface]);
            moved_bounds.fresh[surface] = moved_bounds.moved[surface] || !as_before;
        }
        self.settle(scene, arrival);
        if !moved_bounds.fresh.contains(&true) {
            return moved_bounds;
        }
        // Place the sides of what moved, and find the range of their numbers.
        let fresh = |side: usize| moved_bounds.fresh[self.surface_of_side[side]];
        let known = self.frames.len();
        let sides = self.surface_of_side.len();
        let mut frames = std::mem::take(&mut self.frames);
        frames.reserve(sides - known);
        let (mut first, mut end) = (u32::MAX, 0);
        for side in (0..sides).filter(|side| *side >= known || fresh(*side)) {
            let frame = SideFrame::of(&scene.patches, &self.placed, SideId::from_index(side));
            match frames.get_mut(side) {
                Some(old) => *old = frame,
                None => frames.push(frame),
            }
            (first, end) = (first.min(side as u32), side as u32 + 1);
        }
        self.frames = frames;
        moved_bounds.sides = first.min(end)..end;
        moved_bounds
    }

    /// Takes the new state for the present one.
    fn settle(&mut self, scene: &EditedScene, arrival: &Arrival) {
        let triangles = &mut self.placed.triangles;
        triangles.resize(scene.patches.surface_of.len(), [Vec3::ZERO; 3]);
        for new in &arrival.moved {
            let surface = new.surface;
            let (first, end) = scene.patches.surfaces[surface].triangles;
            triangles[first as usize..end as usize].copy_from_slice(&new.triangles);
            self.placed.normals.set(surface, &new.normals);
        }
        self.placed.colors = scene.patches.colors(&arrival.pose);
        self.placed.flipped = scene.patches.flipped(&scene.animation, &arrival.pose);
        self.pose = arrival.pose.clone();
        self.there.clone_from(&arrival.there);
        self.dynamic.clone_from(&arrival.dynamic);
    }

    /// A surface's triangles as they were, if it was known.
    pub(super) fn old(&self, scene: &EditedScene, surface: SurfaceId) -> Option<&[[Vec3; 3]]> {
        let known = surface.index() < self.there.len();
        known.then(|| self.placed.of(&scene.patches.surfaces[surface]))
    }

    /// Whether something that places a surface is not what it was.
    fn may_differ(
        &self,
        scene: &EditedScene,
        pose: &Pose,
        there: &[bool],
        surface: SurfaceId,
    ) -> bool {
        if self.there.get(surface.index()) != Some(&there[surface]) {
            return true;
        }
        let animation = &scene.animation;
        let instance = &animation.instances[scene.patches.surfaces[surface].instance];
        let node = instance.node.index();
        let moved = |node: usize| self.pose.world.get(node) != Some(&pose.world[node]);
        let joints = instance.skin.map(|skin| &animation.skins[skin].joints);
        let carried = match joints {
            Some(joints) => joints.iter().any(|joint| moved(joint.index())),
            None => moved(node),
        };
        there[surface] && (carried || self.pose.weights.get(node) != Some(&pose.weights[node]))
    }

    /// Whether a surface was added, is not where it was at first, or is carried by clips.
    fn is_dynamic(&self, scene: &EditedScene, pose: &Pose, surface: SurfaceId) -> bool {
        let animation = &scene.animation;
        let index = scene.patches.surfaces[surface].instance.index();
        let instance = &animation.instances[index];
        let away = |node: usize| self.home.get(node) != Some(&pose.world[node]);
        let joints = instance.skin.map(|skin| &animation.skins[skin].joints);
        let carried = match joints {
            Some(joints) => joints.iter().any(|joint| away(joint.index())),
            None => away(instance.node.index()),
        };
        carried || self.played.get(index).is_none_or(|played| *played)
    }
}

/// A surface in a pose.
pub(super) fn arrived(
    scene: &EditedScene,
    pose: &Pose,
    surface: SurfaceId,
    there: bool,
) -> PlacedSurface {
    let of = &scene.patches.surfaces[surface];
    let (instance, mirrored) = (of.instance.index(), of.mirrored);
    let normals = (scene.animation).normals_in_order(instance, pose, mirrored);
    let triangles = match there {
        true => (scene.animation).corners_in_order(instance, pose, mirrored),
        false => vec![[Vec3::ZERO; 3]; (of.triangles.1 - of.triangles.0) as usize],
    };
    PlacedSurface {
        surface,
        normals: match there {
            true => normals,
            false => vec![[Vec3::ZERO; 3]; normals.len()],
        },
        triangles,
    }
}

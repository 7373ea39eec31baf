//! The camera that a room without one is looked at with: where a person would stand, with the widest view.
//!
//! A scene is a room if from much of its box nearly all rays meet inner faces. Places to stand are those of a grid from which
//! a floor is below; the eye is as high as a person's. Each place looks all around, takes the direction in which
//! most fronts are far away, and steps back until a wall is behind.

use super::around::{Around, Facing, directions, horizon};
use super::{Animation, Lens, Node, Rest, SceneCamera};
use crate::ids::NodeId;
use glam::{DMat3, DQuat, DVec3, Vec3};

/// The name of the camera inside.
pub const INSIDE: &str = "auto-inside";

/// The name of the automatic view from outside.
pub const OUTSIDE: &str = "auto-outside";

/// Points of the box along each axis at which is asked whether it is a room.
const ASKED: [usize; 3] = [6, 4, 6];

/// Rays from each of them.
const RAYS: usize = 128;

/// From inside, this share of rays at least meets inner faces: of a box without one wall five sixths do.
const SHUT: f32 = 0.8;

/// And this share at least meets fronts: from inside a thing with two sides all rays meet backs.
const FRONTS: f32 = 0.15;

/// A room's box is inside to this share at least.
const HOLLOW: f32 = 0.25;

/// Places to stand along each horizontal axis.
const PLACES: usize = 12;

/// Metres from the floor to the eye, in a room of a height between these.
const EYE: f32 = 1.6;
const HEIGHTS: [f32; 2] = [1.9, 20.0];

/// Height of the eye in all others, as a share of the room's.
const EYE_SHARE: f32 = 0.6;

/// Air that is left around an eye, as a share of its height.
const CLEAR: f32 = 0.2;

/// Directions that are tried from each place.
const TURNS: usize = 24;

/// Vertical field of view, in radians: 55°, that of a lens of 23 mm, as rooms are photographed with.
const YFOV: f64 = 0.96;

/// Rays of a picture that is tried.
const TRIED: [usize; 2] = [16, 9];

/// How far the view dips below the horizon, as a slope.
const DIP: f32 = 0.08;

/// Places that step back to the wall behind.
const BEST: usize = 8;

/// Where to stand, and where to look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standpoint {
    /// The eye, in metres.
    pub eye: Vec3,
    /// A unit vector along the view.
    pub forward: Vec3,
}

/// Whether a scene is a room: from much of its box nearly all rays meet inner faces.
pub fn is_room(around: &Around) -> bool {
    let total: usize = ASKED.iter().product();
    let inside = grid(around, ASKED).filter(|point| is_inside(around, *point));
    inside.count() as f32 >= HOLLOW * total as f32
}

/// Whether nearly all rays from a point meet inner faces.
fn is_inside(around: &Around, point: Vec3) -> bool {
    let (mut fronts, mut backs) = (0, 0);
    for direction in directions(RAYS) {
        match around.look(point, direction).map(|sight| sight.face) {
            Some(Facing::Front) => fronts += 1,
            Some(Facing::Back) => backs += 1,
            Some(Facing::Black) | None => {}
        }
    }
    let share = |count: usize| count as f32 / RAYS as f32;
    share(fronts + backs) >= SHUT && share(fronts) >= FRONTS
}

/// The middles of the cells of a grid over the box.
fn grid(around: &Around, cells: [usize; 3]) -> impl Iterator<Item = Vec3> {
    let bounds = around.bounds();
    let cell = bounds.extent() / Vec3::from(cells.map(|count| count as f32));
    let [nx, ny, nz] = cells;
    (0..nx * ny * nz).map(move |k| {
        let at = Vec3::new(
            (k % nx) as f32,
            (k / nx % ny) as f32,
            (k / (nx * ny)) as f32,
        );
        bounds.lo + (at + 0.5) * cell
    })
}

/// The eyes of people who stand in the room, from a grid of so many cells along both horizontal axes.
pub(super) fn eyes(around: &Around, cells: usize) -> Vec<Vec3> {
    let middles = grid(around, [cells, ASKED[1], cells]);
    let mut eyes: Vec<Vec3> = middles
        .filter(|point| is_inside(around, *point))
        .filter_map(|point| eye_above(around, point))
        .collect();
    eyes.sort_by(|a, b| {
        let key = |v: &Vec3| [v.x, v.z, v.y];
        key(a)
            .partial_cmp(&key(b))
            .unwrap_or(std::cmp::Ordering::Equal)
    });
    eyes.dedup_by(|a, b| a.distance(*b) < 1e-3 * around.bounds().extent().length());
    eyes
}

/// The eye of who stands below a point.
fn eye_above(around: &Around, point: Vec3) -> Option<Vec3> {
    let floor = around.look(point, Vec3::NEG_Y)?;
    let top = around.bounds().hi.y - point.y;
    let height = floor.distance + around.room(point, Vec3::Y).min(top);
    let eye = floor.point + Vec3::Y * eye_height(height);
    let level = floor.face != Facing::Black && floor.normal.y > 0.7;
    let clear = || {
        let need = CLEAR * (eye.y - floor.point.y);
        directions(32).all(|direction| around.room(eye, direction) > need)
    };
    (level && around.is_free(point, eye) && clear()).then_some(eye)
}

/// How high an eye is above the floor of a room of this height.
pub(super) fn eye_height(room: f32) -> f32 {
    if (HEIGHTS[0]..=HEIGHTS[1]).contains(&room) {
        EYE
    } else {
        EYE_SHARE * room
    }
}

/// The best view from inside, where there is a place to stand.
pub fn standpoint(around: &Around) -> Option<Standpoint> {
    // Let every place look all around.
    let mut views: Vec<(f32, Standpoint)> = eyes(around, PLACES)
        .into_iter()
        .flat_map(|eye| horizon(TURNS).map(move |forward| Standpoint { eye, forward }))
        .map(|view| (view.worth(around), view))
        .collect();
    views.sort_by(|a, b| b.0.total_cmp(&a.0));

    // Step back from the best ones.
    let mut best = *views.first()?;
    for (worth, view) in views.into_iter().take(BEST * TURNS) {
        let back = view.back(around);
        for (worth, view) in [(worth, view), (back.worth(around), back)] {
            if worth > best.0 {
                best = (worth, view);
            }
        }
    }
    let Standpoint { eye, forward } = best.1;
    let forward = (forward + Vec3::NEG_Y * DIP).normalize();
    Some(Standpoint { eye, forward })
}

impl Standpoint {
    /// The mean over a picture of the roots of distances to fronts, less what is black or close.
    fn worth(&self, around: &Around) -> f32 {
        let forward = (self.forward + Vec3::NEG_Y * DIP).normalize();
        let right = forward.cross(Vec3::Y).normalize();
        let up = right.cross(forward);
        let half = (YFOV as f32 / 2.0).tan();
        let [columns, rows] = TRIED;
        let mut worth = 0.0;
        for k in 0..columns * rows {
            let at = |k: usize, of: usize| (2.0 * k as f32 + 1.0) / of as f32 - 1.0;
            let (x, y) = (at(k % columns, columns), at(k / columns, rows));
            let wide = half * columns as f32 / rows as f32;
            let direction = (forward + right * (x * wide) + up * (y * half)).normalize();
            worth += match around.look(self.eye, direction) {
                Some(sight) if sight.face != Facing::Black => sight.distance.sqrt(),
                Some(sight) => -sight.distance.sqrt(),
                None => 0.0,
            };
        }
        worth / (columns * rows) as f32
    }

    /// The same view from as far back as there is floor and air.
    fn back(self, around: &Around) -> Standpoint {
        let height = around.room(self.eye, Vec3::NEG_Y);
        let way = around.room(self.eye, -self.forward) - 2.0 * CLEAR * height;
        let reach = around.bounds().extent().length();
        let eye = self.eye - self.forward * way.clamp(0.0, reach);
        let below = around.room(eye, Vec3::NEG_Y);
        let clear = directions(32).all(|d| around.room(eye, d) > CLEAR * height);
        let stands = (below - height).abs() < 0.02 * height;
        match stands && clear {
            true => Standpoint { eye, ..self },
            false => self,
        }
    }

    /// The rotation of a camera that looks so.
    pub(super) fn rotation(&self) -> DQuat {
        let back = -self.forward.as_dvec3();
        let right = DVec3::Y.cross(back).normalize();
        let axes = DMat3::from_cols(right, back.cross(right), back);
        DQuat::from_mat3(&axes).normalize()
    }
}

impl Animation {
    /// Adds a camera on a node of its own; it comes after the file's.
    pub fn add_camera(&mut self, name: &str, stands: Standpoint) -> usize {
        let rest = Rest::Trs {
            translation: self.to_file(stands.eye.as_dvec3()),
            rotation: stands.rotation(),
            scale: DVec3::ONE,
        };
        let node = self.add_node(name, rest);
        self.cameras.push(SceneCamera {
            name: name.into(),
            node,
            index: self.cameras.iter().map(|c| c.index + 1).max().unwrap_or(0),
            lens: Lens::Perspective { yfov: YFOV },
            shift: [0.0; 2],
        });
        self.cameras.len() - 1
    }

    /// Adds a node without parent; it comes after the file's.
    pub(super) fn add_node(&mut self, name: &str, rest: Rest) -> NodeId {
        self.nodes.push(Node {
            name: name.into(),
            index: self
                .nodes
                .iter()
                .map(|node| node.index + 1)
                .max()
                .unwrap_or(0),
            parent: None,
            rest,
            weights: Vec::new(),
            visible: true,
        });
        NodeId::from_index(self.nodes.len() - 1)
    }
}

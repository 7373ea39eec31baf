//! The scene at time t: where every node, triangle and camera is.

use super::track::Value;
use super::{Animation, Rest};
use crate::error::{Error, Result};
use crate::settings::Choice;
use glam::{DAffine3, DQuat, DVec3, Vec3};

/// Where every node is at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// The time in seconds.
    pub seconds: f64,
    /// From each node's own coordinates to the world's, in the order of [`Animation::nodes`].
    pub world: Vec<DAffine3>,
}

/// Where the picture is taken from. `right`, `up` and `forward` are unit vectors at right angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// The pinhole, in metres.
    pub eye: Vec3,
    /// Towards the picture's right.
    pub right: Vec3,
    /// Towards the picture's top.
    pub up: Vec3,
    /// Into the picture.
    pub forward: Vec3,
    /// Vertical field of view in radians.
    pub yfov: f64,
}

/// Vertical field of view of the automatic camera: 45°, about that of a 50 mm lens held upright.
const AUTOMATIC_YFOV: f64 = std::f64::consts::FRAC_PI_4;

/// From where the automatic camera looks at the scene: the front right, from above, so that three sides show.
const THREE_QUARTERS: DVec3 = DVec3::new(0.8, 0.6, 1.2);

/// Largest coordinate in metres: its square still fits a 32-bit float, as ray tests need.
const FARTHEST: f64 = 1e15;

impl Animation {
    /// The scene at a time of the chosen clip; before its first and after its last key it stands still.
    pub fn pose(&self, seconds: f64) -> Pose {
        // Let the clip replace what it moves.
        let mut rest: Vec<Rest> = self.nodes.iter().map(|node| node.rest).collect();
        for channel in self.playing().iter().flat_map(|clip| &clip.channels) {
            if let Rest::Trs {
                translation,
                rotation,
                scale,
            } = &mut rest[channel.node as usize]
            {
                match channel.track.at(seconds) {
                    Value::Translation(value) => *translation = value,
                    Value::Rotation(value) => *rotation = value,
                    Value::Scale(value) => *scale = value,
                }
            }
        }

        // Chain every node to its parent, which stands before it.
        let mut world: Vec<DAffine3> = Vec::with_capacity(rest.len());
        for (node, rest) in self.nodes.iter().zip(rest) {
            let local = match rest {
                Rest::Trs {
                    translation,
                    rotation,
                    scale,
                } => DAffine3::from_scale_rotation_translation(scale, rotation, translation),
                Rest::Matrix(matrix) => matrix,
            };
            world.push(
                node.parent
                    .map_or(local, |parent| world[parent as usize] * local),
            );
        }
        Pose { seconds, world }
    }

    /// Whether the chosen clip changes each node's place at any time; what it does not keeps its bits in every pose.
    pub fn moves(&self) -> Vec<bool> {
        let mut moves = vec![false; self.nodes.len()];
        for channel in self.playing().iter().flat_map(|clip| &clip.channels) {
            moves[channel.node as usize] |= !channel.track.is_constant();
        }
        for (index, node) in self.nodes.iter().enumerate() {
            moves[index] |= node.parent.is_some_and(|parent| moves[parent as usize]);
        }
        moves
    }

    /// How long the chosen clip is; 0 when nothing plays.
    pub fn seconds(&self) -> f64 {
        self.playing().map_or(0.0, |clip| clip.seconds)
    }

    /// Chooses the clip that plays.
    ///
    /// # Errors
    /// [`Error::Usage`] with the names there are, when none is called so.
    pub fn choose_clip(&mut self, choice: &Choice) -> Result<()> {
        let names: Vec<&str> = self.clips.iter().map(|clip| clip.name.as_str()).collect();
        self.clip = match choice {
            Choice::First => (!names.is_empty()).then_some(0),
            Choice::Named(name) => Some(choose("--animation", name, &[&names])?),
        };
        Ok(())
    }

    /// The camera to look through; `None` where the file has none and [`Animation::view`] frames the scene.
    /// A name is compared with the cameras' names, then with their nodes' names, then read as an index from 0.
    ///
    /// # Errors
    /// [`Error::Usage`] with the names there are, when none is called so.
    pub fn choose_camera(&self, choice: &Choice) -> Result<Option<usize>> {
        let names: Vec<&str> = self
            .cameras
            .iter()
            .map(|camera| camera.name.as_str())
            .collect();
        let on = |camera: &super::Camera| self.nodes[camera.node as usize].name.as_str();
        let nodes: Vec<&str> = self.cameras.iter().map(on).collect();
        match choice {
            Choice::First => Ok((!names.is_empty()).then_some(0)),
            Choice::Named(name) => choose("--camera", name, &[&names, &nodes]).map(Some),
        }
    }

    /// World-space corners of an instance's triangles, counter-clockwise seen from the front.
    ///
    /// Each position is transformed in 64 bits and then rounded, so equal positions give equal bits. A mirroring node
    /// (negative determinant) turns front into back; as glTF asks, the second and third corner then change places.
    /// Corner k of the n-th result belongs to texture coordinates of the n-th triangle's corner k, or, when mirrored, 0 2 1:
    /// see [`Animation::mirrored`].
    pub fn corners(&self, instance: usize, pose: &Pose) -> Vec<[Vec3; 3]> {
        let mesh = &self.meshes[self.instances[instance].mesh as usize];
        let world = pose.world[self.instances[instance].node as usize];
        let placed: Vec<Vec3> = mesh
            .positions
            .iter()
            .map(|position| world.transform_point3(position.as_dvec3()).as_vec3())
            .collect();
        let [second, third] = if self.mirrored(instance, pose) {
            [2, 1]
        } else {
            [1, 2]
        };
        let corners = |triangle: &[u32; 3]| {
            [0, second, third].map(|corner| placed[triangle[corner] as usize])
        };
        mesh.triangles.iter().map(corners).collect()
    }

    /// Whether [`Animation::corners`] gives the second and third corner of this instance's triangles in swapped places.
    pub fn mirrored(&self, instance: usize, pose: &Pose) -> bool {
        pose.world[self.instances[instance].node as usize]
            .matrix3
            .determinant()
            < 0.0
    }

    /// Checks that every instance can be drawn in this pose: its corners are numbers and its triangles do not all
    /// collapse to lines or points.
    ///
    /// # Errors
    /// [`Error::Scene`] with the node's name and the time.
    pub fn check(&self, pose: &Pose) -> Result<()> {
        for (index, instance) in self.instances.iter().enumerate() {
            let corners = self.corners(index, pose);
            let node = &self.nodes[instance.node as usize].name;
            let broken = |expected: &str, got: String, way_out: &str| {
                let pointer = format!("node '{node}' at {:.3} s", pose.seconds);
                Err(super::accessor::broken(
                    &self.file, pointer, expected, got, way_out,
                ))
            };
            let wild = |corner: &&Vec3| {
                !corner.is_finite() || corner.abs().max_element() > FARTHEST as f32
            };
            if let Some(corner) = corners.iter().flatten().find(wild) {
                let way_out = "bring the node and its keyframes nearer to the origin";
                return broken(
                    "coordinates below 1e15 metres",
                    format!("{corner}"),
                    way_out,
                );
            }
            if !corners.is_empty() && corners.iter().all(|corners| !has_area(corners)) {
                let way_out = "remove the node, or the keyframe that scales it to nothing";
                return broken(
                    "triangles with an area",
                    "a node scaled to nothing".into(),
                    way_out,
                );
            }
        }
        Ok(())
    }

    /// The view of a camera, or, for `None`, one that shows the whole scene at time 0 and stays there.
    ///
    /// A camera's own scale means nothing, as glTF asks, but the node needs axes to look along.
    ///
    /// # Errors
    /// [`Error::Scene`] when the camera's node has no direction, or when there is nothing to frame.
    pub fn view(&self, camera: Option<usize>, pose: &Pose) -> Result<View> {
        let Some(camera) = camera.and_then(|camera| self.cameras.get(camera)) else {
            return self.overview();
        };
        let world = pose.world[camera.node as usize];
        let forward = (-world.matrix3.z_axis).try_normalize();
        let frame = forward.and_then(|forward| {
            Some((
                forward,
                world
                    .matrix3
                    .y_axis
                    .reject_from_normalized(forward)
                    .try_normalize()?,
            ))
        });
        match frame {
            Some((forward, up)) if world.translation.is_finite() => {
                Ok(View::along(world.translation, forward, up, camera.yfov))
            }
            _ => {
                let pointer = format!("camera '{}' at {:.3} s", camera.name, pose.seconds);
                let got = format!("axes {} and {}", world.matrix3.y_axis, world.matrix3.z_axis);
                let way_out = "give the camera's node and its parents a scale other than 0";
                Err(super::accessor::broken(
                    &self.file,
                    pointer,
                    "a node with a direction to look along",
                    got,
                    way_out,
                ))
            }
        }
    }

    /// The view of a file without a camera: everything at time 0 within [`AUTOMATIC_YFOV`], from [`THREE_QUARTERS`].
    fn overview(&self) -> Result<View> {
        // Find the bounds' centre, and the ball around it that holds every corner.
        let start = self.pose(0.0);
        let points: Vec<DVec3> = (0..self.instances.len())
            .flat_map(|instance| self.corners(instance, &start))
            .flatten()
            .map(|corner| corner.as_dvec3())
            .filter(|corner| corner.is_finite() && corner.abs().max_element() < FARTHEST)
            .collect();
        let least = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let most = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let centre = (least + most) * 0.5;
        let radius = points
            .iter()
            .map(|point| point.distance(centre))
            .fold(0.0, f64::max);
        if points.is_empty() || radius == 0.0 {
            let way_out = "put a mesh with triangles into the scene";
            return Err(super::accessor::broken(
                &self.file,
                "/scenes".into(),
                "something to show",
                "no triangle".into(),
                way_out,
            ));
        }

        // Step back until the ball touches the cone of view.
        let back = THREE_QUARTERS.normalize();
        let eye = centre + back * (radius / (AUTOMATIC_YFOV / 2.0).sin());
        let up = DVec3::Y.reject_from_normalized(back).normalize();
        Ok(View::along(eye, -back, up, AUTOMATIC_YFOV))
    }

    fn playing(&self) -> Option<&super::Clip> {
        self.clip.and_then(|clip| self.clips.get(clip))
    }
}

impl View {
    /// A view from two unit vectors at right angles.
    fn along(eye: DVec3, forward: DVec3, up: DVec3, yfov: f64) -> View {
        let right = forward.cross(up).normalize();
        View {
            eye: eye.as_vec3(),
            right: right.as_vec3(),
            up: up.as_vec3(),
            forward: forward.as_vec3(),
            yfov,
        }
    }
}

/// Whether three corners span an area that a 32-bit float can hold.
pub(super) fn has_area(corners: &[Vec3; 3]) -> bool {
    let [a, b, c] = corners.map(|corner| corner.as_dvec3());
    ((b - a).cross(c - a).length() * 0.5) as f32 > 0.0
}

/// The position of a name, else of an index, among lists of names that belong to the same things.
fn choose(flag: &str, wanted: &str, lists: &[&[&str]]) -> Result<usize> {
    let named = lists
        .iter()
        .find_map(|names| names.iter().position(|name| *name == wanted));
    let count = lists.first().map_or(0, |names| names.len());
    let numbered = wanted.parse().ok().filter(|index| *index < count);
    named.or(numbered).ok_or_else(|| {
        let listed: Vec<String> = lists
            .iter()
            .take(1)
            .flat_map(|names| names.iter().enumerate())
            .map(|(index, name)| format!("{index} '{name}'"))
            .collect();
        let none = count == 0;
        Error::Usage {
            flag: flag.into(),
            expected: if none {
                "no choice, the file has none".into()
            } else {
                format!("one of {}", listed.join(", "))
            },
            got: format!("'{wanted}'"),
            way_out: if none {
                format!("leave {flag} out")
            } else {
                "give a name or a number from the list".into()
            },
        }
    })
}

/// A rotation that a rest or key may hold: unit length, or `None` where it has no direction.
pub(super) fn unit(rotation: DQuat) -> Option<DQuat> {
    let made = super::track::unit_or(rotation, DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0));
    (made.length_squared() > 0.0).then_some(made)
}

#[cfg(test)]
mod tests;

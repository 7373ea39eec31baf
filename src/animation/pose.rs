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
mod tests {
    use super::super::track::{Interpolation, Keys, Track};
    use super::super::{Camera, Channel, Clip, Instance, Mesh, Node};
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    fn node(name: &str, parent: Option<u32>, translation: DVec3, scale: DVec3) -> Node {
        let rest = Rest::Trs {
            translation,
            rotation: DQuat::IDENTITY,
            scale,
        };
        Node {
            name: name.into(),
            index: 0,
            parent,
            rest,
        }
    }

    /// A door of one triangle on a hinge at x = 1 that opens by a quarter turn in 2 s, a static floor, and two cameras.
    fn door() -> Animation {
        let keys = Keys::Rotation(vec![DQuat::IDENTITY, DQuat::from_rotation_y(FRAC_PI_2)]);
        let opens = Track {
            times: vec![0.0, 2.0],
            keys,
            interpolation: Interpolation::Linear,
        };
        let stays = Track {
            times: vec![0.0, 1.0],
            keys: Keys::Scale(vec![DVec3::splat(2.0); 2]),
            interpolation: Interpolation::Linear,
        };
        let mesh = Mesh {
            name: "leaf".into(),
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            texcoords: Vec::new(),
            triangles: vec![[0, 1, 2]],
            material: 0,
        };
        let camera = |name: &str, node| Camera {
            name: name.into(),
            node,
            yfov: 1.0,
        };
        Animation {
            name: "door".into(),
            file: "door.glb".into(),
            nodes: vec![
                node("hinge", None, DVec3::X, DVec3::ONE),
                node("leaf", Some(0), DVec3::new(0.0, 0.0, 1.0), DVec3::ONE),
                node("floor", None, DVec3::ZERO, DVec3::ONE),
                node(
                    "eye",
                    None,
                    DVec3::new(0.0, 1.0, 5.0),
                    DVec3::new(3.0, -2.0, 1.0),
                ),
            ],
            meshes: vec![mesh],
            instances: vec![Instance { node: 1, mesh: 0 }, Instance { node: 2, mesh: 0 }],
            materials: Vec::new(),
            textures: Vec::new(),
            cameras: vec![camera("wide", 3), camera("2nd", 1)],
            clips: vec![Clip {
                name: "open".into(),
                channels: vec![
                    Channel {
                        node: 0,
                        track: opens,
                    },
                    Channel {
                        node: 2,
                        track: stays,
                    },
                ],
                seconds: 2.0,
            }],
            clip: Some(0),
            extensions: Vec::new(),
            warnings: Vec::new(),
        }
    }

    #[test]
    fn a_child_follows_its_parents_turn() {
        let door = door();
        // The quarter turn about y takes +z to +x and +x to −z: the leaf's origin goes from (1,0,1) to (2,0,0).
        let [closed, open] = [0.0, 2.0].map(|seconds| door.corners(0, &door.pose(seconds)));
        assert_eq!(
            closed,
            [[
                Vec3::new(1.0, 0.0, 1.0),
                Vec3::new(2.0, 0.0, 1.0),
                Vec3::new(1.0, 1.0, 1.0)
            ]]
        );
        let expected = [
            Vec3::new(2.0, 0.0, 0.0),
            Vec3::new(2.0, 0.0, -1.0),
            Vec3::new(2.0, 1.0, 0.0),
        ];
        for (corner, expected) in open[0].iter().zip(expected) {
            assert!(corner.distance(expected) < 1e-6, "{corner} {expected}");
        }
        let half = door.pose(1.0).world[1].translation;
        assert!(half.distance(DVec3::new(1.0 + 0.5_f64.sqrt(), 0.0, 0.5_f64.sqrt())) < 1e-12);
    }

    #[test]
    fn movers_are_what_changes_and_all_below() {
        let door = door();
        assert_eq!(door.moves(), [true, true, false, false]);
        // The floor's constant scale differs from its rest, and is the same bits in every frame.
        for frame in 0..48 {
            assert_eq!(
                door.pose(f64::from(frame) / 24.0).world[2].matrix3.x_axis,
                DVec3::new(2.0, 0.0, 0.0)
            );
        }
        assert_eq!(door.seconds(), 2.0);
    }

    #[test]
    fn a_mirrored_node_keeps_its_front() {
        let mut door = door();
        door.clip = None;
        door.nodes[2].rest = Rest::Matrix(DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0)));
        let pose = door.pose(0.0);
        assert!(door.mirrored(1, &pose));
        let [a, b, c] = door.corners(1, &pose)[0];
        assert_eq!([a, b, c], [Vec3::ZERO, Vec3::Y, Vec3::NEG_X]);
        assert!((b - a).cross(c - a).z > 0.0);
    }

    #[test]
    fn a_camera_looks_along_minus_z_whatever_its_scale() -> Result<()> {
        let door = door();
        let view = door.view(Some(0), &door.pose(0.0))?;
        assert_eq!(
            (view.eye, view.forward),
            (Vec3::new(0.0, 1.0, 5.0), Vec3::NEG_Z)
        );
        // A scale of −2 along y turns the picture's top down; right stays at the right hand of the two.
        assert_eq!((view.up, view.right), (Vec3::NEG_Y, Vec3::NEG_X));
        Ok(())
    }

    #[test]
    fn without_a_camera_everything_is_in_view() -> Result<()> {
        let door = door();
        let view = door.view(None, &door.pose(2.0))?;
        let start = door.pose(0.0);
        for corner in (0..2)
            .flat_map(|instance| door.corners(instance, &start))
            .flatten()
        {
            let seen = corner - view.eye;
            let depth = seen.dot(view.forward);
            let edge = depth * ((view.yfov / 2.0).tan() as f32) * 1.0001;
            assert!(seen.dot(view.up).abs() <= edge && seen.dot(view.right).abs() <= edge);
        }
        Ok(())
    }

    #[test]
    fn choices_go_by_name_then_number() -> Result<()> {
        let mut door = door();
        let named = |name: &str| Choice::Named(name.into());
        assert_eq!(door.choose_camera(&Choice::First)?, Some(0));
        assert_eq!(door.choose_camera(&named("2nd"))?, Some(1));
        assert_eq!(door.choose_camera(&named("leaf"))?, Some(1));
        assert_eq!(door.choose_camera(&named("1"))?, Some(1));
        let told = door
            .choose_camera(&named("7"))
            .map_err(|error| error.to_string());
        assert_eq!(told, Err("--camera: expected one of 0 'wide', 1 '2nd', got '7' — give a name or a number from the list".into()));
        assert!(door.choose_clip(&named("close")).is_err());
        door.choose_clip(&named("open"))?;
        assert_eq!(door.clip, Some(0));
        door.cameras.clear();
        assert_eq!(door.choose_camera(&Choice::First)?, None);
        assert!(door.choose_camera(&named("0")).is_err());
        Ok(())
    }

    #[test]
    fn a_pose_that_cannot_be_drawn_names_the_node() {
        let mut door = door();
        assert!(door.check(&door.pose(1.0)).is_ok());
        door.nodes[0].rest = Rest::Trs {
            translation: DVec3::ZERO,
            rotation: DQuat::IDENTITY,
            scale: DVec3::ZERO,
        };
        let told = door
            .check(&door.pose(0.5))
            .map_err(|error| error.to_string());
        assert!(told.is_err_and(|told| {
            told.starts_with("door.glb: node 'leaf' at 0.500 s: expected triangles with an area")
        }));
        door.nodes[0].rest = Rest::Trs {
            translation: DVec3::splat(1e300),
            rotation: DQuat::IDENTITY,
            scale: DVec3::ONE,
        };
        assert!(door.check(&door.pose(0.5)).is_err());
    }
}

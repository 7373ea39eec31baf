//! Viewpoints: a camera of the file, or an automatic one that shows the whole scene.

use super::fault::{broken, counted};
use super::pose::{FARTHEST, Pose};
use super::{Animation, Lens};
use crate::error::Result;
use glam::{DVec2, DVec3, Vec2, Vec3};

/// Who looks at the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Eye {
    /// A camera of the file: a position in [`Animation::cameras`].
    Camera(usize),
    /// The automatic camera, which stands still where it sees all of a ball.
    Whole(Ball),
}

/// A ball that holds what is to be framed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Its middle, in metres.
    pub centre: DVec3,
    /// Its radius in metres, above 0.
    pub radius: f64,
}

/// A viewpoint; `right`, `up` and `forward` are orthonormal.
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
    /// The lens.
    pub lens: Lens,
    /// How far the picture lies to the right of the view and above it, in heights of the picture.
    pub shift: Vec2,
}

/// Vertical field of view of the automatic camera: 45°, about that of a 50 mm lens held upright.
const AUTOMATIC_YFOV: f64 = std::f64::consts::FRAC_PI_4;

/// From where the automatic camera looks at the scene: the front right, from above, so that three sides show.
const THREE_QUARTERS: DVec3 = DVec3::new(0.8, 0.6, 1.2);

impl Animation {
    /// The view of a camera, or of the automatic one.
    ///
    /// `aspect` is the picture's width over its height. A camera's own scale means nothing, as glTF asks, but the node
    /// needs axes to look along.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::error::Error::Scene) when the camera's node has no direction, or its lens shows nothing.
    pub fn view(&self, eye: &Eye, pose: &Pose, aspect: f64) -> Result<View> {
        let at = match eye {
            Eye::Camera(at) => *at,
            Eye::Whole(ball) => return Ok(ball.view(aspect)),
        };
        let Some((camera, lens)) = self.cameras.get(at).zip(pose.lenses.get(at)) else {
            let expected = counted("camera", self.cameras.len());
            return Err(broken(
                &self.file,
                "/cameras".into(),
                expected,
                at.to_string(),
                "give the position of a camera",
            ));
        };
        if let Some((expected, got)) = lens.fault() {
            let pointer = format!("camera '{}' at {:.3} s", camera.name, pose.seconds);
            let way_out = "correct the keys of the camera's lens";
            let got = got.to_string();
            return Err(broken(&self.file, pointer, expected, got, way_out));
        }
        let world = pose.world[camera.node];
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
                let shift = DVec2::from(camera.shift).as_vec2();
                let view = View::along(world.translation, forward, up, *lens);
                Ok(View { shift, ..view })
            }
            _ => {
                let pointer = format!("camera '{}' at {:.3} s", camera.name, pose.seconds);
                let got = format!("axes {} and {}", world.matrix3.y_axis, world.matrix3.z_axis);
                let way_out = "give the camera's node and its parents a scale other than 0";
                Err(broken(
                    &self.file,
                    pointer,
                    "a node with a direction to look along",
                    got,
                    way_out,
                ))
            }
        }
    }

    /// The ball that holds every corner of what is seen at any of these times, in seconds; the first decides about what
    /// rests.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::error::Error::Scene) when nothing is seen at any of them.
    pub fn ball(&self, times: impl IntoIterator<Item = f64>) -> Result<Ball> {
        // Find the box around all corners.
        let times: Vec<f64> = times.into_iter().collect();
        let mut boxes: Vec<(DVec3, DVec3)> = Vec::new();
        self.framed(&times, |corners| {
            let each = corners.map(|corner| (corner, corner));
            boxes.extend(each.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))));
        });
        let least = boxes.iter().map(|b| b.0).fold(DVec3::INFINITY, DVec3::min);
        let most = boxes
            .iter()
            .map(|b| b.1)
            .fold(DVec3::NEG_INFINITY, DVec3::max);

        // Take the ball around its centre that holds every corner.
        let centre = (least + most) * 0.5;
        let mut radius: f64 = 0.0;
        self.framed(&times, |corners| {
            radius = corners
                .map(|corner| corner.distance(centre))
                .fold(radius, f64::max);
        });
        if boxes.is_empty() || radius == 0.0 {
            let way_out = "put a mesh with triangles into the scene";
            return Err(broken(
                &self.file,
                "/scenes".into(),
                "something to show",
                "no triangle".into(),
                way_out,
            ));
        }
        Ok(Ball { centre, radius })
    }

    /// Shows the corners of each instance that is seen: of what rests at the first of these times, of what moves at each.
    fn framed(&self, times: &[f64], mut each: impl FnMut(&mut dyn Iterator<Item = DVec3>)) {
        let moves = self.moves();
        for (index, seconds) in times.iter().enumerate() {
            let pose = self.pose(*seconds);
            for (at, instance) in self.instances.iter().enumerate() {
                if !pose.visible[instance.node] || index > 0 && !moves[at] {
                    continue;
                }
                let positions = self.positions(at, &pose);
                let corners = self.meshes[instance.mesh].triangles.iter();
                let corners = corners.flatten().map(|c| positions[*c as usize].as_dvec3());
                let known = |c: &DVec3| c.is_finite() && c.abs().max_element() < FARTHEST;
                each(&mut corners.filter(known));
            }
        }
    }
}

impl Ball {
    /// The view from [`THREE_QUARTERS`] that has all of it within [`AUTOMATIC_YFOV`] and the width that a picture of this
    /// aspect gives it.
    fn view(&self, aspect: f64) -> View {
        // Step back until the ball touches the narrower of the two angles of view.
        let back = THREE_QUARTERS.normalize();
        let up = AUTOMATIC_YFOV / 2.0;
        let across = (up.tan() * aspect).atan();
        let eye = self.centre + back * (self.radius / up.min(across).sin());
        let up = DVec3::Y.reject_from_normalized(back).normalize();
        let lens = Lens::Perspective {
            yfov: AUTOMATIC_YFOV,
        };
        View::along(eye, -back, up, lens)
    }
}

impl View {
    /// A view from two unit vectors at right angles.
    fn along(eye: DVec3, forward: DVec3, up: DVec3, lens: Lens) -> View {
        let right = forward.cross(up).normalize();
        View {
            eye: eye.as_vec3(),
            right: right.as_vec3(),
            up: up.as_vec3(),
            forward: forward.as_vec3(),
            lens,
            shift: Vec2::ZERO,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::pose::tests::door;
    use super::*;

    #[test]
    fn a_camera_looks_along_minus_z_whatever_its_scale() -> Result<()> {
        let door = door();
        let view = door.view(&Eye::Camera(0), &door.pose(0.0), 1.0)?;
        assert_eq!(
            (view.eye, view.forward),
            (Vec3::new(0.0, 1.0, 5.0), Vec3::NEG_Z)
        );
        // A scale of −2 along y turns the picture's top down; right stays at the right hand of the two.
        assert_eq!((view.up, view.right), (Vec3::NEG_Y, Vec3::NEG_X));
        Ok(())
    }

    #[test]
    fn a_lens_that_shows_nothing_is_told_with_its_time() {
        let mut door = door();
        for (lens, expected) in [
            (
                Lens::Perspective { yfov: 3.2 },
                "an angle between 0 and π, got 3.2",
            ),
            (
                Lens::Orthographic {
                    xmag: 1.0,
                    ymag: -1.0,
                },
                "half a height above 0, got -1",
            ),
        ] {
            door.cameras[0].lens = lens;
            let told = door.view(&Eye::Camera(0), &door.pose(0.5), 1.0);
            let told = told.map_err(|error| error.to_string());
            let camera = "door.glb: camera 'wide' at 0.500 s: expected";
            assert!(told.is_err_and(|told| told.starts_with(&format!("{camera} {expected}"))));
        }
    }

    #[test]
    fn without_a_camera_everything_is_in_view_at_every_time() -> Result<()> {
        let door = door();
        let times = [0.0, 1.0, 2.0];
        let ball = door.ball(times)?;
        let whole = Eye::Whole(ball);
        for aspect in [1.0, 2.0, 0.25] {
            let view = door.view(&whole, &door.pose(2.0), aspect)?;
            let Lens::Perspective { yfov } = view.lens else {
                panic!("{:?}", view.lens)
            };
            let poses = times.map(|seconds| door.pose(seconds));
            let corners = poses
                .iter()
                .flat_map(|pose| (0..2).flat_map(|instance| door.corners(instance, pose)));
            let mut farthest = 0.0_f32;
            for corner in corners.flatten() {
                let seen = corner - view.eye;
                let half = seen.dot(view.forward) * (yfov / 2.0).tan() as f32;
                let up = seen.dot(view.up).abs() / half;
                let across = seen.dot(view.right).abs() / (half * aspect as f32);
                farthest = farthest.max(up).max(across);
            }
            // It fills the picture in one direction at least: no corner is far inside of the ball that touches its edge.
            assert!((0.4..1.0001).contains(&farthest), "{aspect}: {farthest}");
        }
        // A picture that is wider than high shows the same height, from the same place.
        let start = door.pose(0.0);
        assert_eq!(
            door.view(&whole, &start, 3.0)?,
            door.view(&whole, &start, 1.0)?
        );
        assert!(door.ball([]).is_err());
        Ok(())
    }

    /// The leaf is a triangle of 1 m, 1 m before a hinge at x = 1: from (1, 0, 1) to (2, 1, 1) at first. A quarter turn
    /// about the hinge makes x of z and −z of x: it ends from (2, 0, 0) to (2, 1, −1).
    #[test]
    fn what_walks_away_is_framed_too() -> Result<()> {
        let door = door();
        let alone = |mut door: Animation| {
            door.instances.truncate(1);
            door
        };
        let door = alone(door);
        let still = door.ball([0.0])?;
        let swung = door.ball([0.0, 2.0])?;
        let [low, high] = [DVec3::new(1.0, 0.0, 1.0), DVec3::new(2.0, 1.0, 1.0)];
        assert!(
            still.centre.distance((low + high) / 2.0) < 1e-6,
            "{still:?}"
        );
        assert!((still.radius - 0.5_f64.sqrt()).abs() < 1e-6, "{still:?}");
        let low = DVec3::new(1.0, 0.0, -1.0);
        assert!(
            swung.centre.distance((low + high) / 2.0) < 1e-6,
            "{swung:?}"
        );
        assert!((swung.radius - 1.5_f64.sqrt()).abs() < 1e-6, "{swung:?}");
        Ok(())
    }
}

//! Where the picture is taken from: through a camera of the file, or from where the whole scene shows.

use super::pose::{FARTHEST, Pose};
use super::{Animation, Lens};
use crate::error::Result;
use glam::{DVec3, Vec3};

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
    /// What the camera takes in.
    pub lens: Lens,
}

/// Vertical field of view of the automatic camera: 45°, about that of a 50 mm lens held upright.
const AUTOMATIC_YFOV: f64 = std::f64::consts::FRAC_PI_4;

/// From where the automatic camera looks at the scene: the front right, from above, so that three sides show.
const THREE_QUARTERS: DVec3 = DVec3::new(0.8, 0.6, 1.2);

impl Animation {
    /// The view of a camera, or, for `None`, one that shows the whole scene at time 0 and stays there.
    ///
    /// `aspect` is the picture's width over its height. A camera's own scale means nothing, as glTF asks, but the node
    /// needs axes to look along.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::error::Error::Scene) when the camera's node has no direction, or when there is nothing to frame.
    pub fn view(&self, camera: Option<usize>, pose: &Pose, aspect: f64) -> Result<View> {
        let chosen = camera.and_then(|at| Some((self.cameras.get(at)?, pose.lenses.get(at)?)));
        let Some((camera, lens)) = chosen else {
            return self.overview(aspect);
        };
        if let Some((expected, got)) = lens.fault() {
            let pointer = format!("camera '{}' at {:.3} s", camera.name, pose.seconds);
            let way_out = "correct the keys of the camera's lens";
            let got = got.to_string();
            return Err(super::accessor::broken(
                &self.file, pointer, expected, got, way_out,
            ));
        }
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
                Ok(View::along(world.translation, forward, up, *lens))
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

    /// The view of a file without a camera: everything at time 0 within [`AUTOMATIC_YFOV`] and the width that a picture
    /// of this aspect gives it, from [`THREE_QUARTERS`].
    fn overview(&self, aspect: f64) -> Result<View> {
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

        // Step back until the ball touches the narrower of the two angles of view.
        let back = THREE_QUARTERS.normalize();
        let up = AUTOMATIC_YFOV / 2.0;
        let across = (up.tan() * aspect).atan();
        let eye = centre + back * (radius / up.min(across).sin());
        let up = DVec3::Y.reject_from_normalized(back).normalize();
        let lens = Lens::Perspective {
            yfov: AUTOMATIC_YFOV,
        };
        Ok(View::along(eye, -back, up, lens))
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
        let view = door.view(Some(0), &door.pose(0.0), 1.0)?;
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
            let told = door.view(Some(0), &door.pose(0.5), 1.0);
            let told = told.map_err(|error| error.to_string());
            let camera = "door.glb: camera 'wide' at 0.500 s: expected";
            assert!(told.is_err_and(|told| told.starts_with(&format!("{camera} {expected}"))));
        }
    }

    #[test]
    fn without_a_camera_everything_is_in_view() -> Result<()> {
        let door = door();
        let start = door.pose(0.0);
        for aspect in [1.0, 2.0, 0.25] {
            let view = door.view(None, &door.pose(2.0), aspect)?;
            let Lens::Perspective { yfov } = view.lens else {
                panic!("{:?}", view.lens)
            };
            let corners = (0..2).flat_map(|instance| door.corners(instance, &start));
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
        assert_eq!(door.view(None, &start, 3.0)?, door.view(None, &start, 1.0)?);
        Ok(())
    }
}

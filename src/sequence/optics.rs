//! What the settings say of camera and film, as shading takes it: the lens on the camera of a pose, the filter, the finish.
//!
//! glTF's cameras are pinholes. A lens is said as photographers say it, in stops of a camera whose picture is 24 mm high
//! (the 35 mm format): such a camera sees an angle y through a focal length of 12 mm / tan(y/2), and is open that ÷ N wide.

use crate::emission::Sky;
use crate::error::{Error, Result};
use crate::image::camera::ThinLens;
use crate::image::context::ImageParams;
use crate::image::{Filter, FinalGather};
use crate::scene::pose::Pose;
use crate::scene::view::{Eye, View};
use crate::scene::{Animation, Lens};
use crate::settings::{self, Settings};

/// Half the height of the film, in metres.
const HALF_FILM: f64 = 0.012;

/// The nearest distance that is made sharp, in metres: also of a node that is beside or behind the camera.
const NEAREST: f64 = 0.01;

/// A lens, with the node that it follows looked up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Optics {
    /// Focal length over diameter.
    f_stop: f64,
    focus: FocusPoint,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum FocusPoint {
    Metres(f64),
    Node(usize),
}

/// The lens of the settings for a camera, or `None` for a pinhole.
///
/// # Errors
/// [`Error::Usage`] when no node has the name, or rays are parallel.
pub fn choose(settings: &Settings, animation: &Animation, eye: &Eye) -> Result<Option<Optics>> {
    let Some(lens) = &settings.film.lens else {
        return Ok(None);
    };
    let looks = match eye {
        Eye::Camera(at) => animation.cameras.get(*at),
        Eye::Whole(_) => None,
    };
    if let Some(flat) = looks.filter(|c| matches!(c.lens, Lens::Orthographic { .. })) {
        return Err(Error::Usage {
            flag: "--f-stop".into(),
            expected: "a perspective camera, which has a focal length".into(),
            got: format!("the orthographic camera '{}'", flat.name),
            way_out: "name another with --camera, or leave the flag out".into(),
        });
    }
    let focus = match &lens.focus {
        settings::Focus::Metres(metres) => FocusPoint::Metres(*metres),
        settings::Focus::Node(name) => {
            let node = animation.nodes.iter().position(|node| node.name == *name);
            FocusPoint::Node(node.ok_or_else(|| Error::Usage {
                flag: "--focus".into(),
                expected: "metres, or the name of a node".into(),
                got: format!("'{name}', and no node has that name"),
                way_out: "write e.g. --focus 2.5".into(),
            })?)
        }
    };
    let f_stop = lens.f_stop;
    Ok(Some(Optics { f_stop, focus }))
}

/// Sampling parameters of the images.
pub fn image_params(settings: &Settings, sky: Option<&Sky>) -> ImageParams {
    let samples = settings.image.finish_samples as usize;
    ImageParams {
        samples: settings.image.pixel_samples,
        filter: match settings.film.filter {
            settings::PixelFilter::Box => Filter::Box,
            settings::PixelFilter::Gaussian => Filter::Gaussian {
                radius: settings.film.filter_radius,
            },
        },
        light_samples: settings.solve.light_samples as usize,
        finish: FinalGather::new(settings.image.finish, samples, sky),
        exact: None,
        aims: None,
    }
}

impl Optics {
    /// The lens as it stands before a view in a pose; a node is sharp where its origin is.
    pub fn lens(&self, view: &View, pose: &Pose) -> Option<ThinLens> {
        let Lens::Perspective { yfov } = view.lens else {
            return None;
        };
        let focal_length = HALF_FILM / (0.5 * yfov).tan();
        let metres = match self.focus {
            FocusPoint::Metres(metres) => metres,
            FocusPoint::Node(node) => {
                let to = pose.world[node].translation - view.eye.as_dvec3();
                to.dot(view.forward.as_dvec3())
            }
        };
        Some(ThinLens {
            radius: (0.5 * focal_length / self.f_stop) as f32,
            focus: metres.max(NEAREST) as f32,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn a_normal_lens_has_its_focal_length() {
        let animation = Animation::open("animations/cornell.glb").expect("a scene");
        let view = View {
            eye: Vec3::ZERO,
            right: Vec3::X,
            up: Vec3::Y,
            forward: Vec3::NEG_Z,
            // tan(y/2) = 0.24: 12 mm / 0.24 = 50 mm.
            lens: Lens::Perspective {
                yfov: 2.0 * 0.24f64.atan(),
            },
            shift: glam::Vec2::ZERO,
        };
        let optics = Optics {
            f_stop: 2.0,
            focus: FocusPoint::Metres(3.0),
        };
        let lens = optics.lens(&view, &animation.pose(0.0)).expect("a lens");
        // 50 mm / 2 is 25 mm wide.
        assert!((lens.radius - 0.0125).abs() < 1e-7 && lens.focus == 3.0);
    }
}

//! What a file lacks is added: a camera, a walk, light. Each addition is told in one of the scene's warnings.

use super::timeline;
use crate::error::{Error, Result};
use crate::scene::Animation;
use crate::scene::around::Around;
use crate::scene::default_light::{DefaultLight, SKY, SUN, SUN_ELEVATION, SUN_WIDTH};
use crate::scene::inside::{self, INSIDE, OUTSIDE};
use crate::scene::view::{Eye, View};
use crate::settings::{Choice, DefaultLighting, Exposure, Settings, SkyChoice, Sun};
use std::cell::OnceCell;

/// Poses at most in which the automatic camera looks for what moves: of longer clips every second, third … frame.
const MOST_FRAMED: u32 = 256;

/// Times at which it is looked for what a camera that moves shows.
const TIMES: u32 = 8;

/// Width over height of the pictures by which a scene is judged.
const ASPECT: f64 = 16.0 / 9.0;

/// The scene's triangles, brought in order only where they are asked for.
struct LazyAround(OnceCell<Around>);

impl LazyAround {
    fn around(&self, animation: &Animation) -> &Around {
        self.0.get_or_init(|| Around::of(animation))
    }
}

/// Completes a scene. Returns the settings with the light that it was given, and who looks at it.
///
/// # Errors
/// [`Error::Usage`] for a camera that is not there, and for a walk where there is no room to walk in.
pub(super) fn complete(settings: &Settings, animation: &mut Animation) -> Result<(Settings, Eye)> {
    let looks = LazyAround(OnceCell::new());
    let eye = eye(settings, animation, &looks)?;
    let mut settings = settings.clone();
    let views = views(&settings, animation, &eye)?;
    let given = settings.light.sky.is_some() || settings.light.sun.is_some();
    let auto = settings.light.default == DefaultLighting::Auto;
    let dark = auto && !given && !animation.shines() && !animation.instances.is_empty();
    if dark {
        let added = animation.add_default_light(looks.around(animation), &views);
        if let DefaultLight::Sky(azimuth) = added {
            settings.light.sky = Some(SkyChoice::Even([SKY; 3]));
            settings.light.sun = Some(Sun {
                azimuth: azimuth.into(),
                elevation: SUN_ELEVATION,
                irradiance: SUN,
                color: [1.0; 3],
                diameter: SUN_WIDTH,
            });
        }
        animation.warnings.push(added.told());
    }
    if settings.image.exposure == Exposure::ByLight {
        settings.image.exposure = match dark {
            true => Exposure::Auto,
            false => Exposure::Stops(0.0),
        };
    }
    if animation.has_single_sides() {
        let backs = animation.told_of_backs(looks.around(animation), &views);
        animation.warnings.extend(backs);
    }
    Ok((settings, eye))
}

/// What the camera sees over the whole clip.
fn views(settings: &Settings, animation: &Animation, eye: &Eye) -> Result<Vec<View>> {
    let last = u64::from(timeline::last_frame(settings, animation));
    let frame = |k: u32| (last * u64::from(k) / u64::from(TIMES - 1)) as u32;
    let mut frames: Vec<u32> = (0..TIMES).map(frame).collect();
    frames.dedup();
    let view = |frame| animation.view(eye, &timeline::pose(animation, settings, frame), ASPECT);
    let mut views: Vec<View> = frames.into_iter().map(view).collect::<Result<_>>()?;
    views.dedup();
    Ok(views)
}

/// The camera of the settings. Where the file has none, one inside of a room, else one that frames all that is seen in
/// the whole clip, whichever of its frames are rendered: a frame rendered alone must show the same.
fn eye(settings: &Settings, animation: &mut Animation, looks: &LazyAround) -> Result<Eye> {
    if let Some(seconds) = settings.scene.walk {
        let walk = animation.add_walk(looks.around(animation), seconds);
        return walk.map(Eye::Camera).ok_or_else(no_way);
    }
    let asked = match &settings.scene.camera {
        Choice::Named(name) => Some(name.as_str()),
        Choice::First => None,
    };
    let chosen = animation.choose_camera(&settings.scene.camera);
    match (chosen, asked) {
        (Ok(Some(camera)), _) => return Ok(Eye::Camera(camera)),
        (Err(_), Some(INSIDE)) => {
            let stands = inside::standpoint(looks.around(animation)).ok_or_else(no_place)?;
            return Ok(Eye::Camera(animation.add_camera(INSIDE, stands)));
        }
        (Err(_), Some(OUTSIDE)) => {}
        (Err(error), _) => return Err(error),
        (Ok(None), _) => {
            if let Some(stands) = room(looks.around(animation)) {
                let told = "the scene has no camera: looking from inside the room (--camera auto-outside shows all of it)";
                animation.warnings.push(told.into());
                return Ok(Eye::Camera(animation.add_camera(INSIDE, stands)));
            }
            let told = "the scene has no camera: looking at all of it from above the front right";
            animation.warnings.push(told.into());
        }
    }
    let last = timeline::last_frame(settings, animation);
    let step = last / MOST_FRAMED + 1;
    let frames = (0..=last).step_by(step as usize).chain([last]);
    let ball = animation.ball(frames.map(|frame| f64::from(frame) / settings.scene.fps))?;
    Ok(Eye::Whole(ball))
}

/// Where to stand, if the scene is a room.
fn room(around: &Around) -> Option<inside::Standpoint> {
    inside::is_room(around)
        .then(|| inside::standpoint(around))
        .flatten()
}

fn no_place() -> Error {
    Error::Usage {
        flag: "--camera".into(),
        expected: "a room to stand in: a floor, and inner faces all around".into(),
        got: "auto-inside, and a scene without one".into(),
        way_out: "write --camera auto-outside, or leave the flag out".into(),
    }
}

fn no_way() -> Error {
    Error::Usage {
        flag: "--walk".into(),
        expected: "a room to walk through: a floor, and inner faces all around".into(),
        got: "a scene in which there is no way to walk".into(),
        way_out: "leave the flag out".into(),
    }
}

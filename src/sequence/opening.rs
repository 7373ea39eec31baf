//! The scene of the settings, opened: the file, its clip, its frames and its camera.

use super::checks;
use super::complete;
use super::effort;
use super::observer::Event;
use super::optics::{self, Optics};
use super::sets;
use super::timeline;
use crate::error::Result;
use crate::mesh::{self, Sizes};
use crate::scene::Animation;
use crate::scene::view::Eye;
use crate::settings::{Choice, Settings};

/// A scene that can be rendered.
pub(super) struct Opened {
    /// The settings, with the light that the scene was given.
    pub(super) settings: Settings,
    /// The scene.
    pub(super) animation: Animation,
    /// The frames to render.
    pub(super) frames: Vec<u32>,
    /// The frames that movers are swept over: these, or more.
    pub(super) swept: Vec<u32>,
    /// The camera to look through, or one that frames the scene.
    pub(super) eye: Eye,
    /// The lens, or `None` for a pinhole.
    pub(super) optics: Option<Optics>,
}

impl Opened {
    /// Opens the scene of the settings, and refuses poses that cannot be rendered.
    pub(super) fn of(settings: &Settings, watch: &(dyn Fn(Event) + Sync)) -> Result<Opened> {
        let mut animation = open(settings)?;
        let (settings, eye) = complete::complete(settings, &mut animation)?;
        tell_warnings(&animation, watch);
        let frames = timeline::frames(&settings, &animation)?;
        let optics = optics::choose(&settings, &animation, &eye)?;
        checks::poses(&animation, &settings, &frames, &eye, watch)?;
        Ok(Opened {
            settings,
            animation,
            swept: frames.clone(),
            frames,
            eye,
            optics,
        })
    }
}

/// Opens the scene of the file, and the clip, that the settings choose; without what is never seen.
pub fn open(settings: &Settings) -> Result<Animation> {
    let mut animation = open_whole(settings)?;
    animation.leave_out_unseen();
    Ok(animation)
}

/// The same with what is never seen: an edit may show it.
pub(super) fn open_whole(settings: &Settings) -> Result<Animation> {
    let scene = match &settings.scene.stage {
        Choice::First => None,
        Choice::Named(name) => Some(name.as_str()),
    };
    let mut animation =
        Animation::open_within(&settings.scene.file, scene, effort::limits(settings))?;
    animation.choose_clip(&settings.scene.animation)?;
    animation.hide(&settings.scene.hide)?;
    animation.choose_sides(settings.scene.sides);
    animation.choose_light_units(settings.light.units);
    animation.shade(settings.image.shading);
    animation.move_origin();
    animation.raise_coplanar();
    Ok(animation)
}

/// Tells the warnings of a file.
pub(super) fn tell_warnings(animation: &Animation, watch: &(dyn Fn(Event) + Sync)) {
    let warnings = animation.warnings.iter();
    warnings.for_each(|warning| watch(Event::Warning(warning)));
}

/// The sizes of the settings without a pilot: an edge, or what the budget of elements gives. Where several elements send as
/// one, or near ones are paired, each is a piece of one triangle.
pub(super) fn uniform(settings: &Settings, animation: &Animation) -> Sizes {
    let solve = &settings.solve;
    let single = solve.patch_elements > 1 || sets::pair_rule(settings).is_some();
    match solve.element_size {
        None if !single => mesh::sizes_for(animation, budget(settings)),
        _ => Sizes::Even(element_size(settings, animation)),
    }
}

/// Elements for which Phong's model finds its ambient term: with 16,000 a picture is lighter or darker by half a percent.
const PREVIEWED: usize = 2000;

/// The number of elements that the longest edge is chosen for.
fn budget(settings: &Settings) -> usize {
    match (settings.image.is_phong(), settings.solve.elements) {
        (true, None) => PREVIEWED,
        _ => settings.solve.element_budget(),
    }
}

/// The longest edge of the settings, or the one that the budget of elements gives; of an even mesh.
pub fn element_size(settings: &Settings, animation: &Animation) -> f32 {
    settings
        .solve
        .element_size
        .unwrap_or_else(|| mesh::size_for(animation, budget(settings)))
}

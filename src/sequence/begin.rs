//! The beginning of a session: the scene of the settings completed, cut, traced and solved, for who drives it by edits.

use super::auto_exposure;
use super::complete;
use super::effort::Effort;
use super::exposure::Exposures;
use super::light;
use super::observer::Event;
use super::opening;
use super::optics;
use super::outputs;
use crate::error::Result;
use crate::io::ledger::Ledger;
use crate::report::FrameReport;
use crate::scene::Animation;
use crate::session::{Numbers, Session};
use crate::settings::{Settings, TOLERANCE};
use std::path::PathBuf;

/// Opens a session on the scene of the settings, and gives the settings that the scene was completed by. `plays` says that the
/// time of its clips will go on.
///
/// # Errors
/// What opening the file tells, and [`Error::Edit`](crate::error::Error::Edit) where there would be too many samples.
pub fn begin(
    settings: &Settings,
    plays: bool,
    watch: &(dyn Fn(Event) + Sync),
) -> Result<(Session, FrameReport, Settings)> {
    let mut animation = opening::open_whole(settings)?;
    let (completed, eye) = complete::complete(settings, &mut animation)?;
    let settings = &completed;
    opening::tell_warnings(&animation, watch);
    animation.check(&animation.pose(0.0), |_| true)?;
    let sizes = opening::uniform(settings, &animation);
    Effort::of(settings, &animation, &sizes).judge(settings, watch)?;
    let sky = light::sky(settings)?;
    let numbers = Numbers {
        sizes,
        samples: settings.solve.hemisphere_samples() as usize,
        tolerance: TOLERANCE,
        budget: None,
        plays,
        scales: light::scales(settings),
        sun: settings.light.sun.as_ref().map(light::sun),
        image: optics::image_params(settings, sky.as_ref()),
        sky,
    };
    let (session, report) = Session::open(animation, eye, numbers)?;
    Ok((session, report, completed))
}

/// The exposures of completed settings; what is to be found by itself is found by a look at the scene.
///
/// # Errors
/// As [`Exposures::of`].
pub fn exposures(
    completed: &Settings,
    animation: &Animation,
    watch: &(dyn Fn(Event) + Sync),
) -> Result<Exposures> {
    Exposures::of(&auto_exposure::found(completed, animation, watch)?)
}

/// The files that a session of these settings reads, and the parts of its scene: none of them may be written over.
pub fn inputs(settings: &Settings, sources: &[PathBuf]) -> Ledger {
    outputs::inputs(settings, sources)
}

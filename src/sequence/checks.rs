//! Refusal of settings that do not fit each other, and of poses that cannot be rendered.

use super::observer::Event;
use super::sets;
use super::timeline;
use crate::error::{Error, Result};
use crate::scene::Animation;
use crate::scene::view::Eye;
use crate::settings::{Memory, Pairs, Settings, Solver};

/// Refuses what reads kept rows where none are.
pub fn low_memory_fits(settings: &Settings) -> Result<()> {
    let (expected, got) = match (
        settings.solve.memory,
        settings.solve.solver,
        settings.solve.pairs,
    ) {
        (Memory::Low, Solver::Gather, _) => (
            "--solver progressive, for gathering reads all rows in every sweep",
            "--solver gather",
        ),
        (Memory::Low, _, Pairs::Near) => (
            "--pairs none, for a pair's factor goes into two rows that are kept",
            "--pairs near",
        ),
        (Memory::Low, ..) if sets::takes_all_pairs(settings) => (
            "--form-factors by samples, for a pair's factor goes into two rows that are kept",
            "contour or disks",
        ),
        _ => return Ok(()),
    };
    Err(Error::Usage {
        flag: "--memory low".into(),
        expected: expected.into(),
        got: got.into(),
        way_out: "leave out one of the two".into(),
    })
}

/// Refuses patches of several elements where light is not gathered by samples alone.
pub fn patches_fit(settings: &Settings) -> Result<()> {
    let got = match (settings.solve.solver, settings.solve.pairs) {
        (Solver::Progressive, _) => "--solver progressive",
        (_, Pairs::Near) => "--pairs near",
        _ if sets::takes_all_pairs(settings) => "--form-factors contour or disks",
        _ => return Ok(()),
    };
    if settings.solve.patch_elements == 1 {
        return Ok(());
    }
    Err(Error::Usage {
        flag: "--patch-elements".into(),
        expected: "--solver gather and --pairs none, for patches gather by their elements' samples"
            .into(),
        got: got.into(),
        way_out: "leave out one of the two".into(),
    })
}

/// Refuses poses that cannot be rendered, before anything has been computed.
pub(super) fn poses(
    animation: &Animation,
    settings: &Settings,
    frames: &[u32],
    eye: &Eye,
    watch: &(dyn Fn(Event) + Sync),
) -> Result<()> {
    let moves = animation.moves();
    let moments = frames
        .iter()
        .flat_map(|frame| timeline::times(settings, *frame));
    for (index, time) in moments.enumerate() {
        // What rests was checked in the first pose.
        let pose = animation.pose(time);
        animation.check(&pose, |instance| index == 0 || moves[instance])?;
        animation.view(eye, &pose, 1.0)?;
    }
    if frames.is_empty() {
        return Err(Error::Usage {
            flag: "--frames".into(),
            expected: "at least one frame".into(),
            got: "none".into(),
            way_out: "name one, e.g. --frames 0".into(),
        });
    }
    let end = animation.seconds();
    if let Some(frame) = frames
        .iter()
        .find(|f| **f as f64 / settings.scene.fps > end + 1.0 / settings.scene.fps)
    {
        watch(Event::Warning(&format!(
            "frame {frame} lies after the end of the animation at {end:.3} s: it holds the last pose"
        )));
    }
    Ok(())
}

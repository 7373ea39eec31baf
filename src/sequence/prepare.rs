//! Preparation of a sequence: everything that is done once.

use super::build::build;
use super::cache::{self, CacheFile};
use super::checks;
use super::observer::{self, Event};
use super::opening::{Opened, element_size, uniform};
use super::phong;
use super::pilot;
use super::prepared::Prepared;
use super::sets;
use super::source::MeshSource;
use super::stopwatch::Stopwatch;
use crate::error::{Error, Result};
use crate::mesh::{self, Sizes, budget, cuts::MOST_ELEMENTS};
use crate::scene::Animation;
use crate::settings::{Meshing, Settings};
use std::sync::Mutex;
use std::time::Instant;

/// Prepares a sequence: reads the scene, cuts its mesh, finds its light, sweeps its movers and traces the static hits.
/// Warnings come before the work that they concern.
///
/// # Errors
/// All errors of reading a scene, and [`Error::Usage`] for settings that do not fit it or each
/// other.
pub fn prepare(settings: &Settings, watch: &(dyn Fn(Event) + Sync)) -> Result<Prepared> {
    prepare_after(settings, watch, |_, _| Ok(())).map(|(prepared, ())| prepared)
}

/// Prepares a sequence as [`prepare`] does, once `begin` agrees to its scene and its frames.
pub(super) fn prepare_after<T>(
    settings: &Settings,
    watch: &(dyn Fn(Event) + Sync),
    begin: impl FnOnce(&Animation, &[u32]) -> Result<T>,
) -> Result<(Prepared, T)> {
    let start = Stopwatch::start();
    let opened = open(settings, watch)?;
    let begun = begin(&opened.animation, &opened.frames)?;
    Ok((prepare_opened(opened, start, watch)?, begun))
}

/// Opens the scene of settings that fit each other.
pub(super) fn open(settings: &Settings, watch: &(dyn Fn(Event) + Sync)) -> Result<Opened> {
    checks::low_memory_fits(settings)?;
    checks::patches_fit(settings)?;
    phong::fits(settings)?;
    sets::chosen(settings)?;
    cache::check(settings)?;
    watch(Event::Stage {
        name: "read the scene",
        total: 0,
    });
    Opened::of(settings, watch)
}

/// Prepares an opened scene, whose reading began at `start`: from the cache, if it is kept there.
pub(super) fn prepare_opened(
    mut opened: Opened,
    start: Stopwatch,
    watch: &(dyn Fn(Event) + Sync),
) -> Result<Prepared> {
    let cache = CacheFile::of(&mut opened)?;
    let mut prepared = match &cache {
        None => cut(opened, None, watch)?,
        Some(cache) => cached(opened, cache, watch)?,
    };
    prepared.seconds = start.seconds();
    prepared.cost = start.cost();
    Ok(prepared)
}

/// Prepares a scene from its file in the cache, or without it where it is missing or does not fit.
fn cached(opened: Opened, cache: &CacheFile, watch: &(dyn Fn(Event) + Sync)) -> Result<Prepared> {
    let Some(kept) = cache.open(watch) else {
        return cut(opened, Some(cache), watch);
    };
    let settings = opened.settings.clone();
    let samples = sets::chosen(&settings)?;
    let source = MeshSource::Kept(Box::new(kept));
    match build(&settings, opened, source, samples, watch) {
        Err(Error::Read { path, source, .. }) if path == cache.path() => {
            cache.told(&source.to_string(), watch);
            let mut opened = Opened::of(&settings, &observer::silence)?;
            CacheFile::of(&mut opened)?;
            cut(opened, Some(cache), watch)
        }
        built => built,
    }
}

/// Prepares a scene by cutting its mesh and tracing its hits, and keeps that in the cache.
fn cut(
    opened: Opened,
    cache: Option<&CacheFile>,
    watch: &(dyn Fn(Event) + Sync),
) -> Result<Prepared> {
    let settings = &opened.settings.clone();
    let samples = sets::chosen(settings)?;
    // Warnings are kept too: a run that reads all of this gives them again.
    let warnings = Mutex::new(Vec::new());
    let heard = |event: Event| {
        if let (Event::Warning(text), Ok(mut warnings)) = (event, warnings.lock()) {
            warnings.push(text.to_string());
        }
        watch(event);
    };
    let (sizes, pilot_seconds) = sizes(settings, &opened.animation, &heard)?;
    let source = MeshSource::Cut {
        sizes: &sizes,
        pilot_seconds,
        warnings: warnings.into_inner().unwrap_or_default(),
        cache,
    };
    build(settings, opened, source, samples, watch)
}

/// How long edges may be, and how many seconds a pilot, or a search for shadows, took to find out.
fn sizes(
    settings: &Settings,
    animation: &Animation,
    watch: &(dyn Fn(Event) + Sync),
) -> Result<(Sizes, f64)> {
    let start = Instant::now();
    if settings.solve.mesh == Meshing::Uniform || settings.image.is_phong() {
        return Ok((uniform(settings, animation), 0.0));
    }
    let even = element_size(settings, animation);
    let budget = match settings.solve.element_size {
        Some(_) => mesh::count(animation, &Sizes::Even(even), MOST_ELEMENTS),
        None => settings.solve.element_budget(),
    };
    let sizes = match settings.solve.mesh {
        Meshing::Shadows => along_shadows(settings, animation, (even, budget), watch),
        _ => pilot::sizes(settings, animation, even, budget, watch)?,
    };
    Ok((sizes, start.elapsed().as_secs_f64()))
}

/// Sizes with cuts along the boundaries of shadows that give no more than `budget` elements; `even` metres is the edge of a
/// uniform mesh of as many.
fn along_shadows(
    settings: &Settings,
    animation: &Animation,
    (even, budget): (f32, usize),
    watch: &(dyn Fn(Event) + Sync),
) -> Sizes {
    let planes = budget::shadow_planes(animation, even);
    watch(Event::Stage {
        name: "find shadows",
        total: planes.len() as u64,
    });
    let lines = planes.lines(&|done| watch(Event::Advance(done)));
    if lines.is_empty() {
        watch(Event::Warning(
            "nothing that rests casts the shadow of a glowing surface that rests: the mesh is uniform",
        ));
        return uniform(settings, animation);
    }
    watch(Event::Stage {
        name: "cut along shadows",
        total: 0,
    });
    budget::along(animation, lines, even, budget)
}

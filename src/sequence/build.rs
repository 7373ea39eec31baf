//! From an opened scene to what its frames share: mesh, light, swept volume and static hits.

use super::cache;
use super::key;
use super::light::ClipLight;
use super::observer::Event;
use super::opening::Opened;
use super::optics;
use super::prepared::{KeyLight, Prepared};
use super::sets;
use super::source::MeshSource;
use super::timeline::{self, Moment};
use super::warn;
use crate::error::{Error, Result};
use crate::formfactor::hemisphere::Set;
use crate::ids::{NodeId, SideId};
use crate::image::context::ImageParams;
use crate::image::exact_light::ExactLight;
use crate::image::spread;
use crate::mesh::group::Groups;
use crate::mesh::{PosedMesh, RadiosityMesh, probe};
use crate::report::costs::Cost;
use crate::report::{Counts, Used};
use crate::scene::Animation;
use crate::scene::pose::Pose;
use crate::scene::view::Eye;
use crate::settings::{DirectLight, Memory, Settings, TOLERANCE};
use crate::visibility::bodies::Bodies;
use crate::visibility::swept_volume::{Parts, SweptVolume};
use crate::visibility::{Accel, BackBuffer, PerKind, precompute, reachability};
use glam::Vec3;
use std::sync::Arc;
use std::time::Instant;

/// Triangles at rest of which exact direct light is found: each point's tree of shadows grows with what stands before an
/// emitter.
const MOST_EXACT: u32 = 20_000;

/// Keeps only the sides that light can reach, and warns of walls that shut the light out; gives the warnings.
fn keep_lit_sides(
    patches: &mut RadiosityMesh,
    animation: &Animation,
    light: &ClipLight,
    (eye, rest): (&Eye, &PosedMesh),
    watch: &(dyn Fn(Event) + Sync),
) -> Vec<String> {
    let poses = probe::poses(patches, animation, rest);
    let poses = poses.iter();
    let probed = poses.clone().map(|(pose, placed)| reachability::Probed {
        accel: Accel::whole(patches, placed),
        emitters: light
            .at(patches, animation, (pose, placed), light.scales)
            .emitters,
    });
    let probed: Vec<reachability::Probed> = probed.collect();
    let view = |(pose, _): &(Pose, PosedMesh)| animation.view(eye, pose, 1.0).ok();
    let views: Vec<_> = poses.map(view).collect();
    let sky = light.sky.is_some();
    let warning = warn::of_walls(patches, animation, &probed, &views, sky);
    if let Some(warning) = &warning {
        watch(Event::Warning(warning));
    }
    let lit = reachability::lit(patches, &probed, sky);
    drop(probed);
    patches.keep_sides(&lit);
    warning.into_iter().collect()
}

/// The movers' parts, and the volume that these sweep in all of the frames and in the key frame.
fn sweep(
    settings: &Settings,
    frames: &[u32],
    animation: &Animation,
    (patches, rest): (&RadiosityMesh, &PosedMesh),
    key: Moment,
    source: &mut MeshSource,
) -> Result<(Parts, SweptVolume)> {
    let parts = Parts::of(patches, rest);
    let moments = timeline::moments(settings, frames);
    let mut times: Vec<f64> = moments.iter().map(|moment| moment.time).collect();
    if !times.contains(&key.time) {
        times.push(key.time);
    }
    let swept = match source {
        MeshSource::Kept(kept) => kept.read(|from| SweptVolume::restore(&parts, times, from))?,
        MeshSource::Cut { .. } => {
            let pose = |time: f64| patches.moved(rest, animation, &animation.pose(time));
            SweptVolume::of(&parts, times, pose)
        }
    };
    Ok((parts, swept))
}

/// Traces the static hits, where the settings keep any, or reads them.
#[expect(
    clippy::too_many_arguments,
    reason = "the scene, its light, its movers, and where all comes from"
)]
fn trace(
    settings: &Settings,
    (patches, rest): (&RadiosityMesh, &PosedMesh),
    swept: &SweptVolume,
    bodies: Bodies,
    outside: precompute::Outside,
    [hemisphere, moving]: [Set; 2],
    source: &mut MeshSource,
    watch: &(dyn Fn(Event) + Sync),
) -> Result<BackBuffer> {
    let samples = precompute::SampleCounts {
        hemisphere,
        moving,
        light: settings.solve.light_samples as usize,
    };
    let mut back = BackBuffer::empty(patches, rest, outside, samples);
    back.bodies = bodies;
    if settings.image.is_phong() {
        return Ok(back);
    }
    let pairs = sets::pair_rule(settings);
    if let (MeshSource::Kept(kept), true) = (source, cache::keeps_hits(settings)) {
        kept.read(|from| back.restore((patches, rest), pairs, from))?;
        return Ok(back);
    }
    let stage = |name, total| watch(Event::Stage { name, total });
    if settings.solve.memory == Memory::Full {
        stage("trace static hits", patches.static_sides.into());
        back.trace(patches, rest, swept, &|n| watch(Event::Advance(n)));
        back.trace_own(patches);
    } else {
        stage("look around", 0);
        back.look_around(patches, rest);
    }
    if let Some(rule) = pairs {
        stage("trace pairs", 0);
        back.trace_near(patches, rest, swept, rule);
    }
    Ok(back)
}

/// Prepares an opened scene from its mesh on.
///
/// # Errors
/// As [`prepare`](super::prepare::prepare), and [`Error::Read`] where what is in the cache does not fit the scene.
pub(super) fn build(
    settings: &Settings,
    opened: Opened,
    mut source: MeshSource,
    samples: [Set; 2],
    watch: &(dyn Fn(Event) + Sync),
) -> Result<Prepared> {
    let start = Instant::now();
    let stage = |name| watch(Event::Stage { name, total: 0 });
    let (animation, frames) = (opened.animation, opened.frames);
    let (mut patches, mut keeping) = source.mesh(settings, &animation, watch)?;
    let light = ClipLight::of(settings, &animation, &mut patches)?;
    let at_zero = animation.pose(0.0);
    let rest = Arc::new(patches.at(&animation, &at_zero));
    warn::of_light(&patches, &light.peak, light.sky.is_some(), watch);

    let lights = light.at(&patches, &animation, (&at_zero, &rest), light.scales);
    let PerKind {
        resting,
        moving: movers,
    } = lights.emitters;
    let cells = resting.len() + movers.len();
    match &source {
        MeshSource::Kept(_) => {
            let warnings = keeping.warnings.iter();
            warnings.for_each(|warning| watch(Event::Warning(warning)));
        }
        // Phong's model asks no side what light it can get.
        MeshSource::Cut { .. } if settings.image.is_phong() => {}
        MeshSource::Cut { .. } => {
            stage("find what light reaches");
            let eye = (&opened.eye, &*rest);
            let warnings = keep_lit_sides(&mut patches, &animation, &light, eye, watch);
            keeping.warnings.extend(warnings);
        }
    }

    sets::pairs_fit(settings, patches.sides.len())?;
    stage("sweep the movers");
    let key_moment = key::moment(settings, &animation);
    let scene = (&patches, &*rest);
    let (parts, swept) = sweep(
        settings,
        &opened.swept,
        &animation,
        scene,
        key_moment,
        &mut source,
    )?;

    let tracing = Instant::now();
    let outside = precompute::Outside {
        emitters: resting,
        moving_lights: movers.lights.len(),
        sky: light.sky.as_ref(),
    };
    let bodies = Bodies::carried(&patches, &rest, &animation.carriers());
    let back = trace(
        settings,
        scene,
        &swept,
        bodies,
        outside,
        samples,
        &mut source,
        watch,
    )?;
    if let MeshSource::Cut { .. } = source {
        keeping.trace_seconds = tracing.elapsed().as_secs_f64();
    }

    let exact = exact_light(settings, &patches, &rest, watch)?;
    let most = settings.solve.patch_elements;
    let mut prepared = Prepared {
        indirect: spread::adjacency(&patches, &rest),
        counts: Counts {
            pairs_lit: (patches.sides.len() * cells) as u64,
            ..count(&patches, keeping.counts[1], &animation)
        },
        groups: (most > 1).then(|| Groups::of(&patches, most)),
        image: ImageParams {
            exact,
            ..optics::image_params(settings, light.sky.as_ref())
        },
        used: used(settings, patches.element_size, &back),
        settings: settings.clone(),
        light,
        animation,
        patches,
        parts,
        swept,
        back,
        moments: timeline::moments(settings, &frames),
        frames,
        key_moment,
        key: KeyLight::default(),
        eye: opened.eye,
        optics: opened.optics,
        rest,
        seconds: 0.0,
        cost: Cost::default(),
        trace_seconds: keeping.trace_seconds,
        pilot_seconds: keeping.pilot_seconds,
    };
    match source {
        MeshSource::Kept(kept) => prepared.key = kept.key(&prepared.patches)?,
        MeshSource::Cut { cache, .. } => {
            stage("solve the key frame");
            prepared.key = key::solve(&prepared);
            if let Some(cache) = cache {
                cache.write(&prepared, &keeping, watch);
            }
        }
    }
    prepared.image.aims = key::aims(&prepared).map(Arc::new);
    prepared.seconds = start.elapsed().as_secs_f64();
    Ok(prepared)
}

/// The resting scene as polygons, where direct light is to be exact.
fn exact_light(
    settings: &Settings,
    patches: &RadiosityMesh,
    rest: &PosedMesh,
    watch: &(dyn Fn(Event) + Sync),
) -> Result<Option<Arc<ExactLight>>> {
    if settings.image.direct == DirectLight::Sampled {
        return Ok(None);
    }
    if patches.static_triangles > MOST_EXACT {
        return Err(Error::Usage {
            flag: "--direct exact".into(),
            expected: format!("at most {MOST_EXACT} triangles at rest"),
            got: patches.static_triangles.to_string(),
            way_out: "leave the flag out, and give more --light-samples".into(),
        });
    }
    watch(Event::Stage {
        name: "sort polygons",
        total: 0,
    });
    let exact = ExactLight::of(patches, rest);
    if exact.emitters() == 0 {
        watch(Event::Warning(
            "--direct exact: no emitter at rest is one flat convex polygon, so that all take light samples",
        ));
    }
    Ok(Some(Arc::new(exact)))
}

fn count(patches: &RadiosityMesh, sides: u64, animation: &Animation) -> Counts {
    let emits = |s: SideId| (patches.emission(s) != Vec3::ZERO) as u64;
    let mut movers: Vec<NodeId> = patches
        .surfaces
        .iter()
        .filter(|s| s.moves)
        .map(|s| animation.instances[s.instance].node)
        .collect();
    movers.sort_unstable();
    movers.dedup();
    Counts {
        triangles: patches.surface_of.len() as u64,
        elements: patches.count() as u64,
        sides,
        sides_solved: patches.sides.len() as u64,
        movers: movers.len() as u64,
        emitters: patches.side_ids().map(emits).sum(),
        samples: 0,
        peak_bytes: None,
        memory_bytes: 0,
        memory_full_bytes: 0,
        pairs_lit: 0,
        warnings: animation.warnings.clone(),
    }
}

fn used(settings: &Settings, element_size: f32, back: &BackBuffer) -> Used {
    let tables = [&back.hemisphere, &back.moving_hemisphere];
    let samples = tables.map(|table| table.samples as u32);
    let weight_sums = tables.map(|table| table.raw);
    Used::of(
        settings,
        element_size,
        samples,
        weight_sums,
        TOLERANCE as f64,
    )
}

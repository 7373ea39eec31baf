//! Everything that is done once for a sequence: the file, the patches, the swept volume, the static answers.

use super::effort::Effort;
use super::light::{self, Lights};
use super::observer::Event;
use super::optics::{self, Optics};
use super::pilot;

use super::sets;
use super::timeline::{self, Moment};
use super::warn;
use crate::emission::current::EmissionScales;
use crate::emission::punctual::PunctualLight;
use crate::emission::{Emission, Emitters, PeakEmission, Sky};
use crate::error::{Error, Result};
use crate::ids::NodeId;
use crate::image::{Camera, Filter, FinalGather, VertexAdjacency};
use crate::mesh::group::Groups;
use crate::mesh::{self, PosedMesh, RadiosityMesh, Sizes, locate::MOST_ELEMENTS, probe};
use crate::report::{Counts, Used};
use crate::scene::Animation;
use crate::scene::pose::Pose;
use crate::scene::view::Eye;
use crate::settings::{Choice, Memory, Mesh, Pairs, Settings, Solver};
use crate::visibility::store::TraceParams;
use crate::visibility::swept_volume::{Parts, SweptVolume};
use crate::visibility::{Accel, BackBuffer, precompute, reachability};
use glam::Vec3;
use std::time::Instant;

/// The error that a solve may leave in any channel of any radiosity, relative to the root mean square over the scene:
/// a bound, of which most frames use a quarter. Two thousandths are half a step of an 8-bit image; halving it costs one
/// or two sweeps a frame.
pub const TOLERANCE: f32 = 2e-3;

/// What a sequence needs in every frame.
pub struct Prepared {
    /// The scene.
    pub animation: Animation,
    /// The identity of everything light is exchanged between.
    pub patches: RadiosityMesh,
    /// The movers' parts.
    pub parts: Parts,
    /// Everywhere they go.
    pub swept: SweptVolume,
    /// Static answers.
    pub back: BackBuffer,
    /// Which sides meet in each vertex.
    pub indirect: VertexAdjacency,
    /// What the file's lights and materials are multiplied by.
    pub scales: EmissionScales,
    /// The sun that the settings add.
    pub sun: Option<PunctualLight>,
    /// What is seen where rays leave the scene.
    pub sky: Option<Sky>,
    /// The most that everything shines over the clip.
    pub brightest: PeakEmission,
    /// The settings.
    pub settings: Settings,
    /// The frames to render.
    pub frames: Vec<u32>,
    /// The moments of all frames, in the order in which they are rendered.
    pub moments: Vec<Moment>,
    /// The camera to look through, or one that frames the scene.
    pub eye: Eye,
    /// The lens, or `None` for a pinhole.
    pub optics: Option<Optics>,
    /// How the samples of a pixel are spread.
    pub filter: Filter,
    /// The scene at time 0.
    pub rest: PosedMesh,
    /// Triangles, elements, sides, ... of the report.
    pub counts: Counts,
    /// Which sides send light as one patch, where more than one does.
    pub groups: Option<Groups>,
    /// How the light of each frame is solved.
    pub solve: Solve,
    /// How its indirect part gets to pixels.
    pub finish: FinalGather,
    /// The settings of the report, with every default filled in.
    pub used: Used,
    /// Seconds all of this took.
    pub seconds: f64,
    /// Seconds of it that tracing the static answers took.
    pub trace_seconds: f64,
    /// Seconds of it that the pilot of an adaptive mesh took.
    pub pilot_seconds: f64,
}

/// How the light of each frame is solved.
#[derive(Clone, Copy, Debug)]
pub struct Solve {
    /// By gathering or by shooting.
    pub solver: Solver,
    /// Whether answers are kept.
    pub memory: Memory,
    /// Shots at most.
    pub shots: u64,
    /// Whether the light after each power of two of shots is kept for pictures.
    pub preview: bool,
}

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

/// Opens the scene of the file, and the clip, that the settings choose.
pub fn open(settings: &Settings) -> Result<Animation> {
    let stage = match &settings.scene.stage {
        Choice::First => None,
        Choice::Named(name) => Some(name.as_str()),
    };
    let mut animation = Animation::open_scene(&settings.scene.file, stage)?;
    animation.choose_clip(&settings.scene.animation)?;
    animation.hide(&settings.scene.hide)?;
    animation.leave_out_unseen();
    Ok(animation)
}

/// The longest edge of the settings, or the one that the budget of elements gives; of an even mesh.
pub fn element_size(settings: &Settings, animation: &Animation) -> f32 {
    settings
        .solve
        .element_size
        .unwrap_or_else(|| mesh::size_for(animation, settings.solve.element_budget()))
}

/// How long edges may be, and how many seconds a pilot took to find out.
fn sizes(
    settings: &Settings,
    animation: &Animation,
    watch: &(dyn Fn(Event) + Sync),
) -> Result<(Sizes, f64)> {
    let (start, even) = (Instant::now(), element_size(settings, animation));
    if settings.solve.mesh == Mesh::Uniform {
        return Ok((Sizes::Even(even), 0.0));
    }
    let budget = match settings.solve.element_size {
        Some(_) => mesh::count(animation, &Sizes::Even(even), MOST_ELEMENTS),
        None => settings.solve.element_budget(),
    };
    let sizes = pilot::sizes(settings, animation, even, budget, watch)?;
    Ok((sizes, start.elapsed().as_secs_f64()))
}

/// The light of a clip.
struct ClipLight {
    /// Factors of the file's lights and materials.
    scales: EmissionScales,
    /// The sun that the settings add.
    sun: Option<PunctualLight>,
    /// Radiance of the sky.
    sky: Option<Sky>,
    /// Peak emission over the clip.
    peak: PeakEmission,
}

impl ClipLight {
    /// The light that the settings and the clip give these patches, which learn their peak emission.
    fn of(
        settings: &Settings,
        animation: &Animation,
        patches: &mut RadiosityMesh,
        frames: &[u32],
    ) -> Result<ClipLight> {
        let scales = light::scales(settings);
        let sun = settings.light.sun.as_ref().map(light::sun);
        let sky = light::sky(settings)?;
        let peak = light::brightest(settings, animation, patches, scales, sun, frames);
        patches.set_peak_emission(peak.surfaces.iter().map(|(emission, _)| *emission));
        Ok(ClipLight {
            scales,
            sun,
            sky,
            peak,
        })
    }

    /// Resting and moving emitters in a pose.
    fn emitters(
        &self,
        patches: &RadiosityMesh,
        animation: &Animation,
        (pose, placed): (&Pose, &PosedMesh),
    ) -> [Emitters; 2] {
        let now = Emission::at(patches, animation, pose, self.scales, self.sun);
        [false, true].map(|moving| Emitters::at(patches, placed, &now, &self.peak, moving))
    }
}

/// Keeps only the sides that light can reach, and warns of walls that shut the light out.
fn keep_lit_sides(
    patches: &mut RadiosityMesh,
    animation: &Animation,
    light: &ClipLight,
    (eye, rest): (&Eye, &PosedMesh),
    watch: &(dyn Fn(Event) + Sync),
) {
    let poses = probe::poses(patches, animation, rest);
    let poses = poses.iter();
    let probed = poses.clone().map(|(pose, placed)| reachability::Probed {
        accel: Accel::whole(patches, placed),
        lamps: light.emitters(patches, animation, (pose, placed)).into(),
    });
    let probed: Vec<reachability::Probed> = probed.collect();
    let view = |(pose, _): &(Pose, PosedMesh)| animation.view(eye, pose, 1.0).ok();
    let views: Vec<_> = poses.map(view).collect();
    let sky = light.sky.is_some();
    warn::of_walls(patches, animation, &probed, &views, sky, watch);
    let lit = reachability::lit(patches, &probed, sky);
    drop(probed);
    patches.keep_sides(&lit);
}

/// Traces the static hits, where the settings keep any.
fn trace(
    settings: &Settings,
    patches: &RadiosityMesh,
    rest: &PosedMesh,
    swept: &SweptVolume,
    mut back: BackBuffer,
    watch: &(dyn Fn(Event) + Sync),
) -> BackBuffer {
    let stage = |name, total| watch(Event::Stage { name, total });
    if settings.solve.memory == Memory::Full {
        stage("trace static answers", patches.static_sides.into());
        back.trace(patches, rest, swept, &|n| watch(Event::Advance(n)));
    } else {
        stage("look around", 0);
        back.look_around(patches, rest);
    }
    if settings.solve.pairs == Pairs::Near {
        back.trace_near(patches, rest, swept);
    }
    back
}

/// The scene of the settings, checked: its clip, its frames and its camera.
fn read(
    settings: &Settings,
    watch: &(dyn Fn(Event) + Sync),
) -> Result<(Animation, Vec<u32>, Eye, Option<Optics>)> {
    let animation = open(settings)?;
    for warning in &animation.warnings {
        watch(Event::Warning(warning));
    }
    let frames = timeline::frames(settings, &animation)?;
    let eye = eye(settings, &animation, watch)?;
    let optics = optics::choose(settings, &animation, &eye)?;
    check(&animation, settings, &frames, &eye, watch)?;
    Ok((animation, frames, eye, optics))
}

/// Prepares a sequence: reads the scene, cuts its mesh, finds its light, sweeps its movers and traces the static hits.
/// Warnings come before the work that they concern.
///
/// # Errors
/// All errors of reading a scene, and [`Error::Usage`] for settings that do not fit it or each other.
pub fn prepare(settings: &Settings, watch: &(dyn Fn(Event) + Sync)) -> Result<Prepared> {
    prepare_after(settings, watch, |_, _| Ok(())).map(|(prepared, ())| prepared)
}

/// Prepares a sequence as [`prepare`] does, once `begin` agrees to its scene and its frames.
pub(super) fn prepare_after<T>(
    settings: &Settings,
    watch: &(dyn Fn(Event) + Sync),
    begin: impl FnOnce(&Animation, &[u32]) -> Result<T>,
) -> Result<(Prepared, T)> {
    let start = Instant::now();
    let stage = |name| watch(Event::Stage { name, total: 0 });
    low_memory_fits(settings)?;
    patches_fit(settings)?;
    stage("read the scene");
    let [hemisphere, moving] = sets::chosen(settings)?;
    let (animation, frames, eye, optics) = read(settings, watch)?;
    let begun = begin(&animation, &frames)?;

    let (sizes, pilot_seconds) = sizes(settings, &animation, watch)?;
    stage("cut patches");
    Effort::of(settings, &animation, &sizes).judge(settings, watch)?;
    let mut patches = RadiosityMesh::cut_by(&animation, &sizes)?;
    let sides = patches.sides.len();
    let light = ClipLight::of(settings, &animation, &mut patches, &frames)?;
    let at_zero = animation.pose(0.0);
    let rest = patches.at(&animation, &at_zero);
    warn::of_light(&patches, &rest, &light.peak, light.sky.is_some(), watch);

    stage("find what light reaches");
    let [lamps, moving_lamps] = light.emitters(&patches, &animation, (&at_zero, &rest));
    let cells = lamps.len() + moving_lamps.len();
    keep_lit_sides(&mut patches, &animation, &light, (&eye, &rest), watch);

    stage("sweep the movers");
    let parts = Parts::of(&patches, &rest);
    let moments = timeline::moments(settings, &frames);
    let poses = moments
        .iter()
        .map(|moment| patches.moved(&rest, &animation, &animation.pose(moment.time)));
    let swept = SweptVolume::of(&parts, poses);

    let tracing = Instant::now();
    let outside = precompute::Outside {
        lamps,
        moving_lights: moving_lamps.lights.len(),
        sky: light.sky.as_ref(),
    };
    let samples = precompute::Counts {
        hemisphere,
        moving,
        light: settings.solve.light_samples as usize,
    };
    let back = BackBuffer::empty(&patches, &rest, outside, samples);
    let back = trace(settings, &patches, &rest, &swept, back, watch);
    let trace_seconds = tracing.elapsed().as_secs_f64();

    let most = settings.solve.patch_elements;
    let prepared = Prepared {
        indirect: VertexAdjacency::new(&patches),
        counts: Counts {
            pairs_lit: (patches.sides.len() * cells) as u64,
            ..count(&patches, sides, &animation)
        },
        groups: (most > 1).then(|| Groups::of(&patches, most)),
        finish: optics::finishing(settings, light.sky.as_ref()),
        used: used(settings, sizes.even(), &back),
        solve: Solve::of(settings),
        filter: optics::filter(settings),
        settings: settings.clone(),
        scales: light.scales,
        sun: light.sun,
        sky: light.sky,
        brightest: light.peak,
        animation,
        patches,
        parts,
        swept,
        back,
        frames,
        moments,
        eye,
        optics,
        rest,
        seconds: start.elapsed().as_secs_f64(),
        trace_seconds,
        pilot_seconds,
    };
    Ok((prepared, begun))
}

impl Solve {
    fn of(settings: &Settings) -> Solve {
        Solve {
            solver: settings.solve.solver,
            memory: settings.solve.memory,
            shots: settings.solve.shots.unwrap_or(u64::MAX),
            preview: settings.output.preview,
        }
    }
}

impl Prepared {
    /// What a full trace asks when these lights shine.
    pub fn questions<'a>(&'a self, lights: &'a Lights) -> TraceParams<'a> {
        TraceParams {
            hemisphere: &self.back.hemisphere,
            moving_hemisphere: &self.back.moving_hemisphere,
            light_samples: self.back.light_samples,
            misses: self.back.misses,
            lamps: lights.lamps.each_ref().into(),
            sky: self.back.sky.as_ref(),
            near: self.back.has_near(),
        }
    }

    /// The camera in a pose.
    pub fn camera_at(&self, pose: &Pose, size: (u32, u32)) -> Result<Camera> {
        let aspect = f64::from(size.0) / f64::from(size.1.max(1));
        let view = self.animation.view(&self.eye, pose, aspect)?;
        let lens = self.optics.and_then(|optics| optics.lens(&view, pose));
        let camera = Camera::new(&view, size).reaching(self.filter.radius());
        Ok(camera.through(lens))
    }
}

/// Refuses poses that cannot be rendered, before anything has been computed.
fn check(
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

/// Poses at most in which the automatic camera looks for what moves: of longer clips every second, third … frame.
const MOST_FRAMED: u32 = 256;

/// The camera of the settings; where the file has none, one that frames all that is seen in the whole clip, whichever of
/// its frames are rendered: a frame rendered alone must show the same.
pub(super) fn eye(
    settings: &Settings,
    animation: &Animation,
    watch: &(dyn Fn(Event) + Sync),
) -> Result<Eye> {
    if let Some(camera) = animation.choose_camera(&settings.scene.camera)? {
        return Ok(Eye::Camera(camera));
    }
    watch(Event::Warning(
        "the scene has no camera: looking at all of it from above the front right",
    ));
    let last = timeline::last_frame(settings, animation);
    let step = last / MOST_FRAMED + 1;
    let frames = (0..=last).step_by(step as usize).chain([last]);
    let ball = animation.ball(frames.map(|frame| f64::from(frame) / settings.scene.fps))?;
    Ok(Eye::Whole(ball))
}

fn count(patches: &RadiosityMesh, sides: usize, animation: &Animation) -> Counts {
    let emits = |s: u32| (patches.emission(s) != Vec3::ZERO) as u64;
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
        elements: patches.elements.len() as u64,
        sides: sides as u64,
        sides_solved: patches.sides.len() as u64,
        movers: movers.len() as u64,
        emitters: (0..patches.sides.len() as u32).map(emits).sum(),
        samples: 0,
        memory_bytes: 0,
        memory_full_bytes: 0,
        pairs_lit: 0,
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

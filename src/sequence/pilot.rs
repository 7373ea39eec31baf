//! The pilot: the same animation solved coarsely at a few times beforehand, to find where elements need to be small.
//!
//! Elements are sized for the whole clip, whichever of its frames are rendered, so that an element is the same in all of
//! them: what is needed is added up over the pilot's frames, and the shadow of a mover is followed wherever it goes. What
//! counts is how steeply light falls (Cohen, Greenberg, Immel, Brock 1986), times what an error is worth to the pictures
//! ([`importance`]). Light straight from emitters is found pixel by pixel, so where an element is shown only the slope of
//! its indirect light counts, and none on movers where pixels gather instead; where it shines on others that of all its
//! light. Where resting surfaces are gathered, near contacts, small elements help all the same: sparing them there lost.

use super::build::build;
use super::observer::{Event, silence};
use super::opening::Opened;
use super::prepared::Prepared;
use super::renderer::Renderer;
use super::sets;
use super::solve::sky_irradiance;
use super::source::MeshSource;
use super::step::State;
use super::timeline;
use crate::emission::Emission;
use crate::error::Result;
use crate::ids::SideId;
use crate::image::Camera;
use crate::image::importance::{self, LitScene};
use crate::image::interpolate::VertexIrradiance;
use crate::mesh::sizes::{Need, SizeField};
use crate::mesh::{RadiosityMesh, Sizes, budget, size_for};
use crate::scene::Animation;
use crate::settings::{DirectLight, HemisphereSampling, Memory, Meshing, Pairs, Settings, Solver};
use crate::visibility::Accel;
use glam::{DMat3, DVec3, Vec3};
use std::collections::HashMap;

/// Elements of the pilot are so much longer: half as many. With twice that length it missed what happens at corners.
const COARSER: f32 = 1.4;

/// The pilot has no more elements than about this: a second's work.
const MOST_ELEMENTS: usize = 30_000;

/// Hemisphere samples of the pilot's receivers: their noise, 3 %, hides below [`FLAT`]; 512 gained nothing.
const SAMPLES: u32 = 128;

/// Frames of the pilot, spread over the clip.
const FRAMES: u32 = 9;

/// Pixels through which it looks.
const PIXELS: f64 = 14_400.0;

/// Light is taken to change at least by this share of itself over an element of the pilot. None left too few elements where
/// nothing was found; twice this share was worse in rooms with shadows.
const FLAT: f64 = 0.05;

/// The shortest and the longest edge, in edges of an even mesh.
const RANGE: [f32; 2] = [0.25, 4.0];

/// Cubes that needs are kept in, in edges of the pilot.
const CUBE: f32 = 0.5;

/// How wide an element gets, in heights of the triangles there: two, for where all three edges are split it is their mean.
const WIDTH: f32 = 2.0;

/// Finds sizes that give no more than `most` elements; `even` metres is the edge of a uniform mesh of as many.
pub(super) fn sizes(
    settings: &Settings,
    animation: &Animation,
    even: f32,
    most: usize,
    watch: &(dyn Fn(Event) + Sync),
) -> Result<Sizes> {
    let size = (even * COARSER).max(size_for(animation, MOST_ELEMENTS));
    let pilot = coarse(settings, animation, size);
    watch(Event::Stage {
        name: "pilot the mesh",
        total: pilot.scene.frames.as_ref().map_or(0, Vec::len) as u64,
    });
    let (opened, samples) = (Opened::of(&pilot, &silence)?, sets::chosen(&pilot)?);
    let pilot = opened.settings.clone();
    let source = MeshSource::Cut {
        sizes: &Sizes::Even(size),
        pilot_seconds: 0.0,
        warnings: Vec::new(),
        cache: None,
    };
    let prepared = build(&pilot, opened, source, samples, &silence)?;
    let cut = cut_corners(&prepared, animation);
    let mut needs = vec![DMat3::ZERO; cut.len()];
    let mut renderer = Renderer::new(&prepared);
    for (index, moment) in prepared.moments.iter().enumerate() {
        let camera = prepared.camera_at(&animation.pose(moment.time), pilot.image.size)?;
        renderer.solve_and(index, |state, change, _| {
            let look = PilotFrame {
                prepared: &prepared,
                state,
                cut: &cut,
            };
            look.add(&change.accel, &change.lights.emission, camera, &mut needs);
        });
        watch(Event::Advance(1));
    }
    Ok(
        fill(&prepared, animation, [even, size], &cut, &needs).map_or(Sizes::Even(even), |field| {
            budget::within(animation, field, most, 1.0)
        }),
    )
}

/// The settings of the pilot, with edges of this size.
fn coarse(settings: &Settings, animation: &Animation, size: f32) -> Settings {
    let last = u64::from(timeline::last_frame(settings, animation));
    let count = u64::from(FRAMES).min(last + 1);
    let frame = |k: u64| (last * k / (count - 1).max(1)) as u32;
    let (width, height) = (
        f64::from(settings.image.size.0),
        f64::from(settings.image.size.1),
    );
    let shrink = (PIXELS / (width * height)).sqrt();
    let mut pilot = settings.clone();
    pilot.solve.mesh = Meshing::Uniform;
    pilot.solve.element_size = Some(size);
    pilot.scene.frames = Some((0..count).map(frame).collect());
    pilot.image.size = [width, height]
        .map(|side| (side * shrink).ceil() as u32)
        .into();
    pilot.solve.samples = Some(SAMPLES);
    pilot.solve.form_factors = HemisphereSampling::Cosine;
    pilot.solve.solver = Solver::Gather;
    pilot.solve.memory = Memory::Full;
    pilot.solve.pairs = Pairs::None;
    pilot.image.direct = DirectLight::Sampled;
    pilot.output.preview = false;
    pilot.output.cache = None;
    pilot.film.shutter = 0.0;
    pilot
}

/// Where the corners of each of the pilot's elements were when it was cut.
fn cut_corners(prepared: &Prepared, animation: &Animation) -> Vec<[Vec3; 3]> {
    let (patches, shown) = (&prepared.patches, animation.shown());
    let corners = patches.elements.iter().map(|element| {
        let surface = &patches.surfaces[patches.surface_of[element.triangle]];
        let triangle = element.triangle.index() - surface.triangles.0 as usize;
        let [a, b, c] = shown[surface.instance].corners[triangle];
        element.corners.map(|w| a + (b - a) * w.x + (c - a) * w.y)
    });
    corners.collect()
}

/// The light of one of the pilot's frames.
struct PilotFrame<'a> {
    prepared: &'a Prepared,
    state: &'a State,
    cut: &'a [[Vec3; 3]],
}

impl PilotFrame<'_> {
    /// Adds to each element what this frame needs of it.
    fn add(&self, accel: &Accel, emission: &Emission, camera: Camera, needs: &mut [DMat3]) {
        let placed = accel.placed;
        let (prepared, state, patches) = (self.prepared, self.state, &self.prepared.patches);
        // Find the light, without and with what comes straight from emitters, and what errors of it are worth.
        let (view, indirect) = (&state.view, &state.light.indirect);
        let indirect = sky_irradiance(prepared, view, placed, emission, indirect);
        let direct = state.view.direct();
        let both = indirect.iter().zip(&direct);
        let all: Vec<Vec3> = both.map(|(a, b)| *a + *b).collect();
        let importance = importance::importance(&LitScene {
            patches,
            accel,
            camera,
            irradiance: &all,
            reflectance: &patches.reflectances(placed),
        });
        // Smooth both over the vertices, for slopes.
        let invalid_origins: Vec<u16> = state.view.invalid_origins().collect();
        let [shown, sent] = [&indirect[..], &all].map(|light| Smooth {
            light,
            vertices: (prepared.indirect).at_vertices(patches, placed, light, &invalid_origins),
        });
        // Add up what counts, side by side.
        let gathers = prepared.image.finish.kind.gathers();
        for (side, importance) in importance.iter().enumerate() {
            let element = patches.sides[side].element;
            let Some(plane) = ElementPlane::of(&self.cut[element]) else {
                continue;
            };
            if !(gathers && patches.surface(SideId::from_index(side)).moves) {
                needs[element] += shown.need(patches, side, &plane, importance.shown);
            }
            needs[element] += sent.need(patches, side, &plane, importance.sent);
        }
    }
}

/// Irradiance of each side, and smoothed over vertices.
struct Smooth<'a> {
    light: &'a [Vec3],
    vertices: VertexIrradiance,
}

impl Smooth<'_> {
    /// What a side needs where an error is worth so much: the squares of its slopes, and of some that are always there.
    fn need(
        &self,
        patches: &RadiosityMesh,
        side: usize,
        plane: &ElementPlane,
        importance: DVec3,
    ) -> DMat3 {
        let corners = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|corner| {
            let light = self.vertices.interpolate(patches.vertex_of[side], corner);
            light.as_dvec3()
        });
        let channel = |channel: usize| {
            let slope = plane.slope(corners.map(|light| light[channel]));
            let flat = FLAT * f64::from(self.light[side][channel] / patches.element_size);
            let squares = outer(slope) + plane.within * (flat * flat);
            squares * (importance[channel] / plane.area)
        };
        channel(0) + channel(1) + channel(2)
    }
}

/// A triangle as a plane to take slopes on.
struct ElementPlane {
    edges: [DVec3; 2],
    /// What of any direction lies in the plane.
    within: DMat3,
    area: f64,
}

impl ElementPlane {
    /// The plane of three corners, if they have one.
    fn of([a, b, c]: &[Vec3; 3]) -> Option<ElementPlane> {
        let edges = [b, c].map(|corner| corner.as_dvec3() - a.as_dvec3());
        let across = edges[0].cross(edges[1]);
        let normal = across.try_normalize()?;
        Some(ElementPlane {
            edges,
            within: DMat3::IDENTITY - outer(normal),
            area: 0.5 * across.length(),
        })
    }

    /// The gradient of what has these values at the corners and is linear in between, per metre.
    fn slope(&self, values: [f64; 3]) -> DVec3 {
        let [e, f] = self.edges;
        let rises = [values[1] - values[0], values[2] - values[0]];
        let (ee, ef, ff) = (e.dot(e), e.dot(f), f.dot(f));
        let along = e * (rises[0] * ff - rises[1] * ef) + f * (rises[1] * ee - rises[0] * ef);
        along / (4.0 * self.area * self.area)
    }
}

/// v vᵀ.
fn outer(v: DVec3) -> DMat3 {
    DMat3::from_cols(v * v.x, v * v.y, v * v.z)
}

/// The needs as a field, scaled so that no split is worth more than 1; nothing where nothing is needed.
///
/// Emitters are cut evenly: their elements are what light samples aim at.
fn fill(
    prepared: &Prepared,
    animation: &Animation,
    [even, size]: [f32; 2],
    cut: &[[Vec3; 3]],
    needs: &[DMat3],
) -> Option<SizeField> {
    let patches = &prepared.patches;
    let trace = |need: &DMat3| need.x_axis.x + need.y_axis.y + need.z_axis.z;
    let steepest = needs.iter().map(trace).fold(0.0, f64::max);
    if steepest.is_nan() || steepest <= 0.0 || steepest.is_infinite() {
        return None;
    }
    let longest = f64::from(even * RANGE[1]);
    let unit = 1.0 / (steepest * longest.powi(4));
    let mut field = SizeField {
        even,
        range: RANGE,
        least: 0.0,
        cube: size * CUBE,
        needs: vec![HashMap::new(); animation.instances.len()],
    };
    for ((element, corners), need) in patches.elements.iter().zip(cut).zip(needs) {
        let surface = &patches.surfaces[patches.surface_of[element.triangle]];
        let [a, b, c] = *corners;
        let base = a.distance(b).max(b.distance(c)).max(c.distance(a));
        if surface.emission == Vec3::ZERO && base > 0.0 {
            let height = (b - a).cross(c - a).length() / base;
            let need = Need {
                slope: (*need * unit).as_mat3(),
                width: WIDTH * height,
                count: 1.0,
            };
            field.add(surface.instance.index(), *corners, need);
        }
    }
    Some(field)
}

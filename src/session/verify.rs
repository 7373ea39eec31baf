//! The proof: the same state traced and solved from nothing.
//!
//! The fresh solve knows neither shots nor residuals: it gathers from darkness, and ends by a bound of its own.

use super::light::{self, SolverInput, Sources};
use super::open::Session;
use super::place;
use crate::geometry::Bvh8;
use crate::ids::{SideId, SurfaceId, TriangleId};
use crate::mesh::PosedMesh;
use crate::report::verified::Comparison;
use crate::solver::{self, Radiosity};
use crate::visibility::Accel;
use crate::visibility::edit::emitter_samples::LightTracer;
use crate::visibility::edit::emitter_set::EmitterSet;
use crate::visibility::edit::frame::SideFrame;
use crate::visibility::edit::hits::EditHits;
use crate::visibility::edit::moved_bounds::{DirtyMask, MovedBounds};
use crate::visibility::edit::retrace::Retrace;
use crate::visibility::edit::sides::{Sides, TracedScene};
use glam::DVec3;
use std::time::Instant;

impl Session {
    /// Compares the present state with one traced and solved from nothing, through one tree over everything.
    pub fn verify(&self) -> Comparison {
        let mut verified = Comparison::default();
        let placed = self.placed_from_scratch();
        let corners = placed.triangles.iter().zip(&self.place.placed.triangles);
        verified.differ = corners.filter(|(a, b)| a != b).count() as u64;
        let start = Instant::now();
        let accel = Accel::whole(&self.scene.patches, &placed);
        let (hits, lights) = self.hits_from_scratch(&accel);
        let traced = start.elapsed();
        let light = self.light_from_scratch(&placed, &hits, &lights);
        verified.seconds = start.elapsed().as_secs_f64();
        verified.solve_seconds = verified.seconds - traced.as_secs_f64();
        verified.differ += hits.differences(&self.hits);
        verified.differ += lights.differences(&self.lights);

        // Compare ρ(D + H), what is shot and what is not together.
        let squares: f64 = light.iter().map(|r| r.length_squared()).sum();
        let rms = (squares / (3 * light.len().max(1)) as f64).sqrt();
        let pairs = light.iter().zip(self.reflected());
        let most = pairs
            .map(|(a, b)| (*a - b).abs().max_element())
            .fold(0.0, f64::max);
        verified.difference = if rms > 0.0 { most / rms } else { most };
        // Each of two solves may be off by its tolerance; what a budget cut short, by the bound that it told.
        let tolerance = f64::from(self.numbers.tolerance);
        verified.allowed = 2.0 * tolerance;
        if self.numbers.budget.is_some() {
            verified.allowed = tolerance + self.residual.max(tolerance);
        }
        verified.pixels_differ = self.different_pixels(&accel);
        verified
    }

    /// Samples whose hit, distance or weight differs from another session's on the same file.
    pub fn differences(&self, other: &Session) -> u64 {
        self.hits.differences(&other.hits) + self.lights.differences(&other.lights)
    }

    /// Radiosity R = B − E that each side reflects now, RGB.
    pub fn reflected(&self) -> Vec<DVec3> {
        let solution = &self.light.solution;
        let unshot = solution.residual(self.state.system()).unshot;
        let all = solution.shot.iter().zip(&unshot);
        all.map(|(shot, rest)| *shot + *rest).collect()
    }

    /// All corners, from the edited nodes alone.
    fn placed_from_scratch(&self) -> PosedMesh {
        let scene = &self.scene;
        let pose = scene.animation.pose(self.place.pose.seconds);
        let surfaces = scene.patches.surface_ids();
        let there = |surface: SurfaceId| pose.visible[scene.node_of(surface)];
        let mut placed = PosedMesh {
            flipped: scene.patches.flipped(&scene.animation, &pose),
            colors: self.place.placed.colors.clone(),
            ..PosedMesh::default()
        };
        for surface in surfaces {
            let new = place::arrived(scene, &pose, surface, there(surface));
            placed.triangles.extend(new.triangles);
            placed.normals.set(surface, &new.normals);
        }
        placed
    }

    fn hits_from_scratch(&self, accel: &Accel) -> (EditHits, EmitterSet) {
        let patches = &self.scene.patches;
        let nothing = Bvh8::build(&[], TriangleId::new(0));
        let mut dirty = DirtyMask::all(patches.sides.len(), self.hits.stride());
        let mut hits = EditHits::new(self.hits.stride());
        hits.grow(patches.sides.len(), patches.surfaces.len());
        let frames: Vec<SideFrame> = patches
            .side_ids()
            .map(|side| SideFrame::of(patches, accel.placed, side))
            .collect();
        let sides = Sides {
            frames: &frames,
            ..self.place.sides(patches)
        };
        let scene = TracedScene {
            sides,
            accel,
            movers: &nothing,
            alone: false,
        };
        let retrace = Retrace {
            scene,
            notes: false,
            shapes: &[],
        };
        retrace.run(&mut hits, &mut dirty);
        let tracer = LightTracer {
            scene,
            invalid_origins: &hits.hemisphere.invalid_origins,
            moved: &MovedBounds::default(),
            dirty: &dirty,
            most: self.numbers.image.light_samples,
        };
        let lights = self.lights.traced_from_scratch(&tracer);
        (hits, lights)
    }

    fn light_from_scratch(
        &self,
        placed: &PosedMesh,
        hits: &EditHits,
        lights: &EmitterSet,
    ) -> Vec<DVec3> {
        let mut state = SolverInput::default();
        let emission = self.emission();
        let sources = Sources {
            scene: &self.scene,
            placed,
            hits,
            lights,
            emission: &emission,
        };
        let sides: Vec<SideId> = self.scene.patches.side_ids().collect();
        state.refresh(sources, &sides);
        let rows = light::rows(hits, &state);
        let misses = (hits.misses.end() - hits.misses.first()) as usize;
        let (direct, reflectance) = (&state.direct, &state.reflectance);
        let (dark, tolerance) = (Radiosity::default(), self.numbers.tolerance);
        let light = solver::gather(&rows, direct, reflectance, misses, dark, tolerance);
        let sides = light.reflected[..sides.len()].iter();
        sides.map(|r| r.as_dvec3()).collect()
    }
}

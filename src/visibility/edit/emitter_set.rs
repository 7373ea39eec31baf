//! The light samples of all emitters of an edited scene: materials, lights, and the sun.

use super::emitter_samples::{LightTracer, MaterialSamples, PointSamples};
use crate::emission::Emitters;
use rayon::prelude::*;

/// The samples of all emitters.
#[derive(Clone, Debug, Default)]
pub(crate) struct EmitterSet {
    /// Emitting materials.
    pub(crate) materials: Vec<MaterialSamples>,
    /// Lights on nodes.
    pub(crate) points: Vec<PointSamples>,
    /// The sun; it counts as the last of the lights.
    pub(crate) sun: Option<PointSamples>,
}

impl EmitterSet {
    /// The lights, the sun last.
    pub(crate) fn lights(&self) -> impl Iterator<Item = &PointSamples> {
        self.points.iter().chain(&self.sun)
    }

    /// The same emitters traced from scratch.
    pub(crate) fn traced_from_scratch(&self, tracer: &LightTracer) -> EmitterSet {
        let scene = &tracer.scene;
        let material = |old: &MaterialSamples| {
            let mut samples = MaterialSamples {
                surfaces: old.surfaces.clone(),
                cells: Emitters::unit(scene.sides.patches, scene.accel.placed, &old.surfaces),
                ..MaterialSamples::of(old.material)
            };
            tracer.material(&mut samples, true);
            samples
        };
        let point = |old: &PointSamples| {
            let mut samples = PointSamples::new(old.light, old.there);
            tracer.point(&mut samples, true);
            samples
        };
        EmitterSet {
            materials: self.materials.par_iter().map(material).collect(),
            points: self.points.iter().map(point).collect(),
            sun: self.sun.as_ref().map(point),
        }
    }

    /// Samples whose visibility or weight differs from another set's; an emitter that only one has counts as one.
    pub(crate) fn differences(&self, other: &EmitterSet) -> u64 {
        let materials = self.materials.iter().zip(&other.materials);
        let lights = self.lights().zip(other.lights());
        let only_one = self.materials.len().abs_diff(other.materials.len()) as u64;
        materials.map(|(a, b)| a.differences(b)).sum::<u64>()
            + lights.map(|(a, b)| a.differences(b)).sum::<u64>()
            + only_one
    }

    /// Samples of all sides.
    pub(crate) fn samples(&self) -> u64 {
        let materials = self.materials.iter().map(MaterialSamples::samples);
        materials.sum::<u64>() + self.lights().map(PointSamples::samples).sum::<u64>()
    }

    /// Bytes held.
    pub(crate) fn memory(&self) -> usize {
        let materials = self.materials.iter().map(MaterialSamples::memory);
        materials.sum::<usize>() + self.lights().map(PointSamples::memory).sum::<usize>()
    }
}

//! What a sequence will take, from counts alone: told before the work where it is much, refused where it does not fit.

use super::machine;
use super::observer::Event;
use super::sets;
use crate::error::{Error, Result};
use crate::mesh::{self, Sizes, cuts::MOST_ELEMENTS};
use crate::report::table::grouped;
use crate::scene::{Animation, FileLimits, Instance, Target};
use crate::settings::{IndirectMode, Memory, Settings};
use glam::Vec3;

/// Samples that preparing and the first frame trace, and bytes that they hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Effort {
    triangles: u64,
    elements: u64,
    sides: u64,
    samples: u64,
    /// Bytes of the light.
    light: u64,
    /// Bytes of the picture.
    picture: u64,
    /// Surfaces that may emit.
    emitters: u64,
}

/// Samples from which on a sequence is called large: a minute's work of a few cores.
const MANY_SAMPLES: u64 = 200_000_000;

/// Bytes from which on it is called large.
const MANY_BYTES: u64 = 4_000_000_000;

/// Bytes of a triangle: corners in a few poses (36 each), its place in two trees and what building them takes.
const TRIANGLE: u64 = 500;

/// Bytes of a smooth triangle beside: the normals at its corners in as many poses.
const NORMALS: u64 = 180;

/// Bytes of an element: itself, its corners and its two sides' numbers.
const ELEMENT: u64 = 100;

/// Bytes of a side: its vertices while they are sorted and after, light from each kind of source, and the solver's.
const SIDE: u64 = 300;

/// Bytes of a hemisphere sample: its static hit, and the one at t.
const SAMPLE: u64 = 8;

/// Bytes more where something moves: of a sample that a mover may come before.
const CONTESTED: u64 = 20;

/// One in so many samples is taken to be contested where something moves.
const MAY_CONTEST: u64 = 4;

/// Bytes of a light sample: target, weight and hits.
const LIGHT_SAMPLE: u64 = 24;

/// Bytes of the factor of an emitting surface that each side keeps: how much of that surface's light it would get unhidden.
const FACTOR: u64 = 12;

/// Bytes of a light without a surface that each side keeps: which of its origins see it, and which may.
const POINT: u64 = 8;

/// Samples of such a light from each side.
const POINT_SAMPLES: u64 = 16;

/// Bytes of a pixel: its planes and their gathered light in this frame and the one before, its radiance, and the file. A
/// furnished room takes the most, a box a half.
const PIXEL: u64 = 1060;

/// Bytes more of each of its samples.
const PIXEL_SAMPLE: u64 = 20;

/// Bytes of a gather point beside its samples, and of these, aims among them, for each final-gather sample of a pixel.
const GATHER_POINT: u64 = 700;
const POINT_SAMPLE: u64 = 10 * 8;

/// Pixels for each gather point that is kept.
const PIXELS_A_POINT: u64 = 3;

/// Bytes of a layer in a pixel: three numbers, and the same in the file.
const LAYER: u64 = 24;

/// Samples that a core traces in a second, about: what a machine of 2020 does in a furnished room. The others differ by a
/// factor of two or three.
const SAMPLES_A_SECOND: f64 = 1e6;

/// Pixels that it makes in a second.
const PIXELS_A_SECOND: f64 = 2e4;

/// Bytes of gather points for each pixel.
fn points(settings: &Settings) -> u64 {
    match settings.image.finish {
        IndirectMode::Points => {
            let samples = u64::from(settings.image.finish_samples);
            (GATHER_POINT + POINT_SAMPLE * samples) / PIXELS_A_POINT
        }
        _ => 0,
    }
}

impl Effort {
    /// Counts what elements of these sizes will take.
    pub(super) fn of(settings: &Settings, animation: &Animation, sizes: &Sizes) -> Effort {
        let (elements, sides) = mesh::count_sides(animation, sizes, MOST_ELEMENTS);
        Effort::counted(settings, animation, [elements as u64, sides as u64])
    }

    /// Tells what so many elements with so many sides will take.
    pub(super) fn counted(
        settings: &Settings,
        animation: &Animation,
        [elements, sides]: [u64; 2],
    ) -> Effort {
        let count = |i: &Instance| animation.meshes[i.mesh].triangles.len() as u64;
        let triangles = animation.instances.iter().map(count).sum();
        let smooth = |i: &&Instance| animation.meshes[i.mesh].normals.are_smooth();
        let smooth: u64 = animation.instances.iter().filter(smooth).map(count).sum();
        let each = sets::samples(settings);
        let moves = animation.moves().contains(&true);
        let contested = if moves {
            CONTESTED * each / MAY_CONTEST
        } else {
            0
        };
        let emitters = emitters(animation);
        let light = if emitters > 0 {
            LIGHT_SAMPLE * u64::from(settings.solve.light_samples) + FACTOR * emitters
        } else {
            0
        };
        let lights = animation.lamps.len() as u64;
        // Phong's model traces nothing.
        let previews = settings.image.is_phong();
        let samples = match previews {
            true => 0,
            false => each + POINT_SAMPLES * lights,
        };
        let a_side = match settings.solve.memory {
            Memory::Full if !previews => SIDE + SAMPLE * each + contested + light + POINT * lights,
            _ => SIDE,
        };
        let (width, height) = settings.image.size;
        let a_pixel = PIXEL
            + PIXEL_SAMPLE * u64::from(settings.image.pixel_samples)
            + LAYER * settings.film.aovs.len() as u64
            + points(settings);
        Effort {
            triangles,
            elements,
            sides,
            samples: sides * samples,
            light: triangles * TRIANGLE + smooth * NORMALS + elements * ELEMENT + sides * a_side,
            picture: u64::from(width) * u64::from(height) * a_pixel,
            emitters,
        }
    }

    /// Bytes of everything.
    pub(super) fn bytes(&self) -> u64 {
        self.light + self.picture
    }

    /// Samples of all sides.
    pub(super) fn samples(&self) -> u64 {
        self.samples
    }

    /// Seconds that preparing takes on so many cores, and those of the picture of the first frame, about.
    pub(super) fn seconds(&self, settings: &Settings, cores: usize) -> [f64; 2] {
        let (width, height) = settings.image.size;
        let pixels = f64::from(width) * f64::from(height);
        [
            self.samples as f64 / SAMPLES_A_SECOND,
            pixels / PIXELS_A_SECOND,
        ]
        .map(|s| s / cores as f64)
    }

    /// Refuses what does not fit into the memory, and warns of what is large.
    ///
    /// # Errors
    /// [`Error::Usage`] with the bytes needed and the bytes there are.
    pub(super) fn judge(&self, settings: &Settings, watch: &(dyn Fn(Event) + Sync)) -> Result<()> {
        let (room, whose) = room(settings);
        let takes = format!(
            "{} triangles make {} elements with {} sides: {} samples, about {} and {} for a picture of {}x{}",
            grouped(self.triangles),
            grouped(self.elements),
            grouped(self.sides),
            grouped(self.samples),
            gigabytes(self.light),
            gigabytes(self.picture),
            settings.image.size.0,
            settings.image.size.1,
        );
        if self.bytes() > room {
            return Err(Error::Usage {
                flag: "--memory".into(),
                expected: format!("a scene that fits into the {} {whose}", gigabytes(room)),
                got: takes,
                way_out: self.way_out(settings),
            });
        }
        if self.samples > MANY_SAMPLES || self.bytes() > MANY_BYTES {
            watch(Event::Warning(&format!(
                "a large scene: {takes}; {} takes less",
                self.way_out(settings)
            )));
        }
        Ok(())
    }

    /// What makes it smaller, the best first.
    fn way_out(&self, settings: &Settings) -> String {
        /// The fewest samples that still make a picture.
        const FEWEST: u32 = 32;
        let mut ways = Vec::new();
        if self.picture > self.light {
            ways.push("a smaller --size".to_string());
        }
        if 2 * self.sides * FACTOR * self.emitters > self.light {
            let emitters = grouped(self.emitters);
            ways.push(format!("the {emitters} emitting objects joined into fewer"));
        }
        // Triangles are never merged: where most are whole, nothing but fewer of them helps.
        if self.elements < 2 * self.triangles {
            ways.push("a model with fewer triangles, or --hide with parts of it".to_string());
        } else {
            ways.push("a larger --element-size, or --quality draft".to_string());
        }
        if settings.solve.hemicube_resolution.is_some() {
            ways.push("a smaller --hemicube-resolution".into());
        } else if settings.solve.hemisphere_samples() > FEWEST {
            ways.push(format!("--samples {FEWEST}"));
        }
        ways.join(", or ")
    }
}

/// Bytes that a run may take, and who says so.
fn room(settings: &Settings) -> (u64, &'static str) {
    match settings.solve.memory_limit {
        Some(bytes) => (bytes, "given"),
        None => (machine::memory(), "of this machine"),
    }
}

/// What the scene file of a run may take and reach.
pub(super) fn limits(settings: &Settings) -> FileLimits {
    FileLimits {
        external: settings.scene.external,
        memory: room(settings).0,
    }
}

/// Surfaces that may emit light while the clip plays.
fn emitters(animation: &Animation) -> u64 {
    use Target::{Emissive, EmissiveStrength};
    let mut glows: Vec<bool> = (animation.materials.iter())
        .map(|material| material.emission() != Vec3::ZERO)
        .collect();
    let clips = animation
        .playing
        .iter()
        .filter_map(|clip| animation.clips.get(*clip));
    for channel in clips.flat_map(|clip| &clip.channels) {
        if let Emissive(material) | EmissiveStrength(material) = channel.target {
            glows[material.index()] = true;
        }
    }
    let emits = |instance: &&Instance| glows[animation.meshes[instance.mesh].material.index()];
    animation.instances.iter().filter(emits).count() as u64
}

fn gigabytes(bytes: u64) -> String {
    format!("{:.1} GB", bytes as f64 / 1e9)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    /// A million triangles, each one element with one side, at 128 samples and 16 light samples:
    /// 500 + 100 + 300 + 8 · 128 + 24 · 16 = 2308 bytes each.
    fn million() -> (Effort, Settings) {
        let mut settings = Settings::new("a.glb");
        settings.solve.samples = Some(128);
        let n = 1_000_000;
        let effort = Effort {
            triangles: n,
            elements: n,
            sides: n,
            samples: 128 * n,
            light: 2308 * n,
            picture: 0,
            emitters: 1,
        };
        (effort, settings)
    }

    fn told(effort: &Effort, settings: &Settings) -> (Result<()>, Vec<String>) {
        let told = Mutex::new(Vec::new());
        let judged = effort.judge(settings, &|event| {
            if let Event::Warning(text) = event {
                told.lock().expect("a lock").push(text.to_string());
            }
        });
        (judged, told.into_inner().expect("a lock"))
    }

    #[test]
    fn what_does_not_fit_is_refused_and_what_is_much_is_told() {
        let (mut effort, mut settings) = million();
        settings.solve.memory_limit = Some(2_308_000_000);
        let (judged, warned) = told(&effort, &settings);
        assert!(judged.is_ok() && warned.is_empty(), "{judged:?} {warned:?}");
        settings.solve.memory_limit = Some(2_307_999_999);
        let refused = told(&effort, &settings)
            .0
            .map_err(|error| error.to_string());
        let expected = "--memory: expected a scene that fits into the 2.3 GB given, got 1,000,000 triangles make 1,000,000 \
                        elements with 1,000,000 sides: 128,000,000 samples, about 2.3 GB and 0.0 GB for a picture of 640x360 — a model with fewer triangles, or \
                        --hide with parts of it, or --samples 32";
        assert_eq!(refused, Err(expected.into()));
        settings.solve.memory_limit = Some(u64::MAX);
        effort.samples = MANY_SAMPLES + 1;
        effort.elements = 2_000_000;
        let (judged, warned) = told(&effort, &settings);
        assert!(judged.is_ok());
        assert!(
            warned[0].ends_with(
                "a larger --element-size, or --quality draft, or --samples 32 takes less"
            ),
            "{warned:?}"
        );
    }

    #[test]
    fn what_takes_most_is_what_should_be_less() {
        let (mut effort, mut settings) = million();
        settings.solve.memory_limit = Some(1);
        effort.picture = effort.light + 1;
        let way_out = |effort: &Effort| {
            let judged = told(effort, &settings).0.map_err(|error| error.to_string());
            let told = judged.expect_err("too much");
            told.split_once(" — ")
                .map(|(_, way_out)| way_out.to_string())
        };
        let told = way_out(&effort).unwrap_or_default();
        assert!(told.starts_with("a smaller --size, or a model"), "{told}");
        effort.picture = 0;
        effort.emitters = 6000;
        effort.light = 12 * 6000 * effort.sides + 1000;
        let told = way_out(&effort).unwrap_or_default();
        assert!(
            told.starts_with("the 6,000 emitting objects joined into fewer, or"),
            "{told}"
        );
    }
}

//! Stepping through the frames of a scene, as the renderer does, with every state in sight.

use crate::support::scene::Scene;
use glam::Vec2;
use sweeplight::ids::{SideId, TriangleId};
use sweeplight::image::film::Image;
use sweeplight::report::FrameReport;
use sweeplight::sequence::prepare;
use sweeplight::sequence::prepared::Prepared;
use sweeplight::sequence::step::State;
use sweeplight::sequence::{Renderer, Verified, silence, verify};
use sweeplight::settings::{Settings, Sun};
use tempfile::TempDir;

/// The size of pictures, in pixels, and that of pictures to be verified, of which each frame takes two.
const SIZE: (u32, u32) = (48, 27);
const SIZE_VERIFIED: (u32, u32) = (28, 16);

/// Frames a second, and those of clips to be verified.
const FPS: f64 = 8.0;
const FPS_VERIFIED: f64 = 5.0;

/// A scene on disk with settings to render it; the folder lives as long as this.
pub(crate) struct Case {
    pub(crate) folder: TempDir,
    pub(crate) settings: Settings,
}

/// Saves a scene as `scene.gltf`, with settings for a quick run: elements of half a metre, 64 samples, 8 frames a second.
pub(crate) fn case(scene: &Scene) -> Case {
    let folder = tempfile::tempdir().expect("a folder");
    let mut settings = Settings::new(scene.save(folder.path(), "scene.gltf"));
    settings.scene.fps = FPS;
    settings.image.size = SIZE;
    settings.solve.element_size = Some(0.5);
    settings.solve.samples = Some(64);
    Case { folder, settings }
}

impl Case {
    /// Everything that is done once.
    pub(crate) fn prepare(&self) -> Prepared {
        prepare::prepare(&self.settings, &silence).expect("a scene that can be prepared")
    }

    /// Renders every frame from the one before and shows its state, its report and its image.
    pub(crate) fn walk(&self, prepared: &Prepared, each: impl FnMut(&State, &FrameReport, &Image)) {
        steps(Renderer::new(prepared), prepared, each);
    }

    /// The same for who looks at no image: they have one pixel.
    pub(crate) fn walk_light(
        &self,
        prepared: &Prepared,
        mut each: impl FnMut(&State, &FrameReport),
    ) {
        let renderer = Renderer::new(prepared).sized((1, 1));
        steps(renderer, prepared, |state, report, _| each(state, report));
    }

    /// The image of the first frame.
    pub(crate) fn first_image(&self) -> Image {
        let prepared = self.prepare();
        Renderer::new(&prepared).step(0).expect("a camera").image
    }

    /// The report of every frame.
    pub(crate) fn reports(&self) -> Vec<FrameReport> {
        let mut reports = Vec::new();
        self.walk(&self.prepare(), |_, report, _| reports.push(report.clone()));
        reports
    }

    /// Insists that the mesh follows from the whole clip: not from the frames that are rendered, nor from threads, nor from the
    /// picture's size where its shape is the same.
    pub(crate) fn keeps_its_mesh(mut self, frames: Vec<u32>) {
        let mesh = |case: &Case| -> Vec<(TriangleId, [Vec2; 3])> {
            let elements = case.prepare().patches.elements;
            elements.iter().map(|e| (e.triangle, e.corners)).collect()
        };
        let first = mesh(&self);
        self.settings.scene.frames = Some(frames);
        self.settings.image.size = (96, 54);
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let again = pool.expect("threads").install(|| mesh(&self));
            assert!(again == first, "{threads} threads");
        }
    }

    /// Verifies a clip in smaller pictures and at fewer moments, unless a test chose its size, rate or frames, and insists
    /// that no sample and no pixel differs from a full trace.
    pub(crate) fn exact(&self) -> Verified {
        let mut settings = self.settings.clone();
        if settings.image.size == SIZE {
            settings.image.size = SIZE_VERIFIED;
        }
        if settings.scene.fps == FPS && settings.scene.frames.is_none() {
            settings.scene.fps = FPS_VERIFIED;
        }
        let verified = verify(&settings, &silence, &|_| {}).expect("a scene that can be verified");
        assert_eq!(
            (verified.differ, verified.pixels_differ),
            (0, 0),
            "samples and pixels that differ in {}",
            self.settings.scene.file.display()
        );
        if let Err(error) = verified.check() {
            panic!("{error}");
        }
        verified
    }
}

/// Takes a renderer through all frames.
fn steps(
    mut renderer: Renderer,
    prepared: &Prepared,
    mut each: impl FnMut(&State, &FrameReport, &Image),
) {
    for index in 0..prepared.frames.len() {
        let frame = renderer.step(index).expect("a camera");
        each(renderer.state(), &frame.report, &frame.image);
    }
}

/// A sun of 1 W/m² without a width, at these degrees from -z towards +x and above the horizon.
pub(crate) fn sun(azimuth: f64, elevation: f64) -> Sun {
    Sun {
        azimuth,
        elevation,
        irradiance: 1.0,
        color: [1.0; 3],
        diameter: 0.0,
    }
}

/// The name of the node that a side belongs to.
pub(crate) fn name(prepared: &Prepared, side: usize) -> &str {
    let surface = prepared.patches.surface(SideId::from_index(side));
    let node = prepared.animation.instances[surface.instance].node;
    &prepared.animation.nodes[node].name
}

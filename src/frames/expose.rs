//! One frame: the moments in which its shutter is open, each from the one before, and their mean.
//!
//! While the shutter is closed a frame is one moment. Else it is the mean of [`Film::moments`](crate::settings::Film::moments)
//! whole pictures at even steps, their middle at the frame's own time. Each of them is solved and shaded as a frame of its own, its
//! camera and its lights where they are then, and is as exact; so what stands still keeps its light to the bit, and what
//! moved costs what it changed. Sampling time by the ray (Cook, Porter, Carpenter 1984, "Distributed ray tracing", Computer
//! Graphics 18(3):137–145) would smooth the blur, but show light of one moment only.

use super::layers;
use super::light;
use super::prepare::{self, Prepared};
use super::step::{self, State};
use crate::error::Result;
use crate::image::Image;
use crate::image::film::Mean;
use crate::io::channel::Channel;
use crate::report::FrameReport;
use crate::report::page::Gallery;
use crate::settings::Settings;
use crate::visibility::Accel;
use std::time::Instant;

/// What a frame leaves on the film.
pub struct Exposed {
    /// The picture.
    pub image: Image,
    /// The same by the light after each power of two of shots, where the settings ask for it.
    pub previews: Vec<(u64, Image)>,
    /// The layers that the settings ask for.
    pub channels: Vec<Channel>,
}

/// Renders one frame; `index` is its position in the sequence.
pub fn expose(
    settings: &Settings,
    prepared: &Prepared,
    index: usize,
    state: &mut State,
    mut gallery: Option<&mut Gallery>,
    report: &mut FrameReport,
) -> Result<Exposed> {
    let times = prepare::times(settings, report.frame);
    let (mut film, mut layers) = (Mean::default(), Vec::<Mean>::new());
    let mut middle = None;
    for (k, &time) in times.iter().enumerate() {
        let mut part = FrameReport::default();
        let step = index * times.len() + k;
        let shown = moment(settings, prepared, (step, time), state, &mut part)?;
        if let Some(gallery) = &mut gallery {
            state.counted(|counted| gallery.count(step, counted));
        }
        report.add(&part);
        if times.len() == 1 {
            return Ok(shown);
        }
        film.add(shown.image.radiance.as_flattened());
        layers.resize_with(shown.channels.len(), Mean::default);
        for (mean, channel) in layers.iter_mut().zip(&shown.channels) {
            mean.add(&channel.values);
        }
        if k == times.len() / 2 {
            middle = Some(shown);
        }
    }
    // Numbers and depths have no mean: they are those of the middle.
    let mut exposed = middle.unwrap_or_else(|| Exposed {
        image: Image::black(settings.image.size.0, settings.image.size.1),
        previews: Vec::new(),
        channels: Vec::new(),
    });
    let radiance = film.of();
    exposed.image.radiance = radiance.as_chunks::<3>().0.to_vec();
    for (channel, mean) in exposed.channels.iter_mut().zip(&layers) {
        if !channel.exact {
            channel.values = mean.of();
        }
    }
    Ok(exposed)
}

/// Renders one moment, a step of the sequence and its time.
fn moment(
    settings: &Settings,
    prepared: &Prepared,
    (step, time): (usize, f64),
    state: &mut State,
    report: &mut FrameReport,
) -> Result<Exposed> {
    let start = Instant::now();
    let pose = prepared.animation.pose(time);
    let placed = step::placed(prepared, &pose);
    let lights = light::lights(prepared, &pose, &placed);
    let camera = prepared.camera_at(&pose, settings.image.size)?;
    let channels = |state: &State, stage: &Accel, lights: &light::Lights| {
        if settings.film.aovs.is_empty() {
            return Vec::new();
        }
        let glances = state.glances(prepared, stage, lights, camera, settings);
        layers::channels(&settings.film.aovs, &glances, prepared, state, step == 0)
    };
    if settings.solve.from_scratch {
        report.seconds.place += start.elapsed().as_secs_f64();
        *state = State::from_scratch(prepared, &placed, &lights, report);
        let stage = Accel::whole(&prepared.patches, &placed);
        let image = state.image(prepared, &stage, &lights, None, camera, settings, report);
        return Ok(Exposed {
            image,
            previews: state.preview_images(prepared, &stage, &lights, camera, settings),
            channels: channels(state, &stage, &lights),
        });
    }
    let arrived = state.arrive(prepared, &placed, lights, step);
    report.seconds.place += start.elapsed().as_secs_f64();
    state.update(prepared, &arrived, report);
    let (stage, lights) = (&arrived.stage, &arrived.lights);
    let came = Some(&arrived);
    let image = state.image(prepared, stage, lights, came, camera, settings, report);
    let exposed = Exposed {
        image,
        previews: state.preview_images(prepared, stage, lights, camera, settings),
        channels: channels(state, stage, lights),
    };
    let kept = arrived.keep();
    state.leave(kept, placed);
    Ok(exposed)
}

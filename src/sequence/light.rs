//! The emission of a frame: the file's materials and lights on one scale, the sky and the sun that flags add.

use super::effort;
use super::timeline;
use crate::emission::bound;
use crate::emission::current::EmissionScales;
use crate::emission::punctual::PunctualLight;
use crate::emission::{Emission, Lights, PeakEmission, Sky};
use crate::error::Result;
use crate::io::sky_file;
use crate::mesh::{PosedMesh, RadiosityMesh};
use crate::scene::light::LightKind;
use crate::scene::{Animation, Channel, Target, pose::Pose};
use crate::settings::{Settings, SkyChoice, Sun};
use glam::Vec3;

/// The light of a clip.
pub struct ClipLight {
    /// Factors of the file's lights and materials.
    pub scales: EmissionScales,
    /// The sun that the settings add.
    pub sun: Option<PunctualLight>,
    /// Radiance of the sky.
    pub sky: Option<Sky>,
    /// Peak emission over the clip.
    pub peak: PeakEmission,
}

impl ClipLight {
    /// The light that the settings and the clip give these patches, which learn their peak emission.
    pub(super) fn of(
        settings: &Settings,
        animation: &Animation,
        patches: &mut RadiosityMesh,
    ) -> Result<ClipLight> {
        let scales = scales(settings);
        let sun = settings.light.sun.as_ref().map(sun);
        let sky = sky(settings)?;
        let peak = peak(settings, animation, patches, scales, sun)?;
        patches.set_peak_emission(peak.surfaces.iter().map(|(emission, _)| *emission));
        Ok(ClipLight {
            scales,
            sun,
            sky,
            peak,
        })
    }

    /// Emission and emitters in a pose, by these factors of the file's.
    pub fn at(
        &self,
        patches: &RadiosityMesh,
        animation: &Animation,
        (pose, placed): (&Pose, &PosedMesh),
        scales: EmissionScales,
    ) -> Lights {
        let emission = Emission::at(patches, animation, pose, scales, self.sun);
        Lights::at(patches, placed, emission, &self.peak)
    }
}

/// The factors of the settings.
pub fn scales(settings: &Settings) -> EmissionScales {
    EmissionScales {
        lights: settings.light.scale,
        emission: settings.light.emission_scale,
    }
}

/// The sun of the settings as a light: azimuth counts from −z over +x, as a compass does on a map of which −z is north.
pub fn sun(sun: &Sun) -> PunctualLight {
    let (azimuth, elevation) = (sun.azimuth.to_radians(), sun.elevation.to_radians());
    let there = Vec3::new(
        (azimuth.sin() * elevation.cos()) as f32,
        elevation.sin() as f32,
        (-azimuth.cos() * elevation.cos()) as f32,
    );
    PunctualLight {
        kind: LightKind::Directional,
        position: Vec3::ZERO,
        along: -there.normalize(),
        power: Vec3::from(sun.color) * sun.irradiance,
        range: f32::INFINITY,
        cone: [1.0, 0.0],
        spread: (sun.diameter.to_radians() * 0.5).tan() as f32,
    }
}

/// The most frames that are looked through for the brightest light: three minutes at 24 a second. Of longer clips every
/// second, third … is, and every key of what glows.
const MOST_FRAMES: u32 = 4096;

/// The most that everything emits at any frame of the whole clip, whichever of them are rendered: a frame rendered
/// alone must trace the same samples.
///
/// # Errors
/// As [`bound::check`].
fn peak(
    settings: &Settings,
    animation: &Animation,
    patches: &RadiosityMesh,
    scales: EmissionScales,
    sun: Option<PunctualLight>,
) -> Result<PeakEmission> {
    let mut fault = None;
    let mut emission = |time: f64| {
        let pose = animation.pose(time);
        let emission = Emission::at(patches, animation, &pose, scales, sun);
        if fault.is_none() {
            fault = bound::check(&emission, patches, animation).err();
        }
        emission
    };
    if !changes(animation) {
        let peak = PeakEmission::of([emission(0.0)]);
        return fault.map_or(Ok(peak), Err);
    }
    let last = timeline::last_frame(settings, animation);
    let step = last / MOST_FRAMES + 1;
    // The frame after the last shows what every later one does.
    let frames = (0..=last)
        .step_by(step as usize)
        .chain([last, last.saturating_add(1)]);
    let times = frames.flat_map(|f| timeline::times(settings, f));
    let keys = glowing(animation).flat_map(|channel| channel.track.times.iter().copied());
    let times = times.chain(keys.filter(|_| step > 1));
    let peak = PeakEmission::of(times.map(&mut emission));
    fault.map_or(Ok(peak), Err)
}

/// Whether what plays may change any light.
fn changes(animation: &Animation) -> bool {
    let moves = animation.nodes_move();
    glowing(animation).next().is_some() || animation.lamps.iter().any(|lamp| moves[lamp.node])
}

/// The playing channels that may change how much something emits.
fn glowing(animation: &Animation) -> impl Iterator<Item = &Channel> {
    let clips = animation
        .playing
        .iter()
        .filter_map(|clip| animation.clips.get(*clip));
    let channels = clips.flat_map(|clip| &clip.channels);
    channels.filter(|channel| {
        use Target::{Emissive, EmissiveStrength, Visible};
        let target = channel.target;
        matches!(target, Emissive(_) | EmissiveStrength(_) | Visible(_)) || target.light().is_some()
    })
}

/// The sky of the settings; a picture is read from its file.
pub fn sky(settings: &Settings) -> Result<Option<Sky>> {
    let sky = match &settings.light.sky {
        None => return Ok(None),
        Some(SkyChoice::Even(radiance)) => Sky::even(Vec3::from(*radiance)),
        Some(SkyChoice::Picture(path)) => sky_file::read(path, effort::limits(settings).memory)?,
    };
    Ok(Some(sky).filter(|sky| !sky.is_black()))
}

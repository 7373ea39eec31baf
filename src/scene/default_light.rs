//! The light of a scene in which nothing ever shines, so that there is a picture to begin with.
//!
//! It is an even sky with a soft sun from beside the camera, as a photographer lights a model: under the sky alone white
//! things have no shape. Where hardly any ray from what the camera sees leaves the scene, that would not do: soft lamps then hang below the ceilings of what is seen, one for each part of the room about as wide as
//! it is high; where there is no ceiling, one shines from beside the camera.

use super::around::{Around, Sight, directions, horizon};
use super::light::{Beam, Lamp, Light, LightKind, LightScale};
use super::view::View;
use super::{Animation, Rest, Target};
use crate::ids::LightId;
use glam::{DQuat, DVec3, Vec3};

/// Radiance of the sky, the same from everywhere: a white surface in the open shows it again.
pub const SKY: f32 = 0.5;

/// Irradiance of the sun on a surface that faces it: it brings a white one as much again.
pub const SUN: f32 = 2.0;

/// Elevation of the sun, in degrees.
pub const SUN_ELEVATION: f64 = 50.0;

/// Angular diameter of the sun, in degrees: wide enough for soft shadows.
pub const SUN_WIDTH: f64 = 6.0;

/// The sun stands behind the camera and so many degrees to its left.
const SUN_ASIDE: f64 = 45.0;

/// The camera is shut in where fewer rays than this share leave the scene.
const OPEN: f32 = 0.05;

/// Columns and rows of the points of a picture from which it is looked around.
const LOOKS: [usize; 2] = [16, 9];

/// Points are lifted off their surface by this share of how far they are seen.
const LIFT: f32 = 1e-3;

/// Rays from each of them.
const RAYS: usize = 24;

/// Where a lamp hangs, as a share of the way from the floor to the ceiling.
const HANG: f32 = 0.88;

/// Lamps hang this many heights of the room apart.
const APART: f32 = 1.1;

/// They keep this many heights away from walls.
const OFF: f32 = 0.5;

/// Of two that come closer than this share of that, the second is left out.
const CLOSE: f32 = 0.6;

/// Lamps at most; those above most of what is seen come first.
const MOST: usize = 12;

/// Irradiance below a lamp, at the floor.
const IRRADIANCE: f32 = 1.5;

/// The most that a surface reflects by such lamps, as Blender's own default does.
const WHITE: f32 = 0.8;

/// Radius of a lamp, as a share of the height of its room.
const RADIUS: f32 = 0.08;

/// The cone of a lamp in radians: it leaves the ceiling to what comes back from below.
const CONE: [f64; 2] = [0.5, 1.5];

/// The light of a scene without any.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DefaultLight {
    /// An even sky, of radiance [`SKY`], and a sun from this azimuth, in degrees from −z towards +x.
    Sky(u32),
    /// So many lamps below ceilings.
    Lamps(usize),
    /// A lamp beside the camera.
    Headlight,
}

impl DefaultLight {
    /// What is told of it.
    pub fn told(self) -> String {
        let what = match self {
            DefaultLight::Sky(azimuth) => format!(
                "an even sky and a soft sun do (as --sky {SKY},{SKY},{SKY} --sun {azimuth},{SUN_ELEVATION},{SUN},#ffffff,{SUN_WIDTH})"
            ),
            DefaultLight::Lamps(1) => {
                "a soft lamp below the ceiling does, for the camera is shut in".into()
            }
            DefaultLight::Lamps(count) => {
                format!("{count} soft lamps below the ceilings do, for the camera is shut in")
            }
            DefaultLight::Headlight => {
                "a soft lamp beside the camera does, for it is shut in".into()
            }
        };
        let white = match self {
            DefaultLight::Sky(_) => "",
            _ => ", and surfaces reflect 80 % at most",
        };
        format!("nothing in the scene shines: {what}{white}; --light none leaves it dark")
    }
}

impl Animation {
    /// Whether anything shines at any time: a material or a lamp that the playing clips do not keep dark, or a surface that
    /// needs no light to be seen.
    pub fn shines(&self) -> bool {
        let targets = || {
            self.played()
                .flat_map(|clip| &clip.channels)
                .map(|c| c.target)
        };
        let glows = |material| {
            let here = &self.materials[material];
            let set = |target| match target {
                Target::Emissive(at) | Target::EmissiveStrength(at) => at == material,
                _ => false,
            };
            here.emission() != Vec3::ZERO
                || here.emissive != Vec3::ZERO && targets().any(set)
                || targets().any(|target| target == Target::Emissive(material))
        };
        let mut used: Vec<_> = self
            .instances
            .iter()
            .map(|i| self.meshes[i.mesh].material)
            .collect();
        used.sort_unstable();
        used.dedup();
        let lit = |lamp: &Lamp| {
            let beam = &self.lights[lamp.light].beam;
            let bright = beam.intensity > 0.0 && beam.color.max_element() > 0.0;
            bright || targets().any(|target| target.light() == Some(lamp.light))
        };
        let all_unlit = used.iter().all(|material| self.materials[*material].unlit);
        all_unlit || used.into_iter().any(glows) || self.lamps.iter().any(lit)
    }

    /// Chooses the light for what these views show, and adds its lamps; the sky is for the caller to add.
    pub fn add_default_light(&mut self, around: &Around, views: &[View]) -> DefaultLight {
        let seen: Vec<(Vec3, Vec3)> = views.iter().flat_map(|view| seen(around, view)).collect();
        if !is_shut_in(around, &seen) {
            return DefaultLight::Sky(views.first().map_or(0, sun_azimuth));
        }
        // These lamps are in the materials' own units. What is all white would keep their light for ever.
        self.light_scale = LightScale::default();
        for material in &mut self.materials {
            let most = material.base_color.max_element();
            if most > WHITE {
                material.base_color *= WHITE / most;
            }
        }
        let lamps = hung(around, &seen);
        for (at, height) in &lamps {
            self.add_lamp(*at, *height, LightKind::Spot);
        }
        if let ([], Some(view)) = (&lamps[..], views.first()) {
            let far = seen
                .iter()
                .map(|(point, _)| point.distance(view.eye))
                .sum::<f32>()
                / seen.len().max(1) as f32;
            self.add_lamp(view.eye + view.up * (RADIUS * far), far, LightKind::Point);
            return DefaultLight::Headlight;
        }
        DefaultLight::Lamps(lamps.len())
    }

    /// Adds a lamp that shines down, or to all sides.
    fn add_lamp(&mut self, at: Vec3, height: f32, kind: LightKind) {
        let rest = Rest::Trs {
            translation: self.to_file(at.as_dvec3()),
            rotation: DQuat::from_rotation_x(-std::f64::consts::FRAC_PI_2),
            scale: DVec3::ONE,
        };
        let name = format!("default lamp {}", self.lamps.len() + 1);
        let node = self.add_node(&name, rest);
        self.lights.push(Light {
            name,
            kind,
            beam: Beam {
                intensity: f64::from(IRRADIANCE * height * height),
                inner: CONE[0],
                outer: CONE[1],
                ..Beam::default()
            },
            spread: f64::from(RADIUS * height),
        });
        let light = LightId::from_index(self.lights.len() - 1);
        self.lamps.push(Lamp { node, light });
    }
}

/// Where the sun stands for a view, in whole degrees.
fn sun_azimuth(view: &View) -> u32 {
    let along = view.forward.as_dvec3();
    let azimuth = along.x.atan2(-along.z).to_degrees() + 180.0 + SUN_ASIDE;
    (azimuth.rem_euclid(360.0).round() as u32) % 360
}

/// What a view shows, lifted off its surface, with the normals.
fn seen(around: &Around, view: &View) -> Vec<(Vec3, Vec3)> {
    let sights = view.sights(around, LOOKS).into_iter().flatten();
    let lifted = |s: Sight| (s.point + s.normal * (LIFT * s.distance), s.normal);
    sights.map(lifted).collect()
}

/// Whether hardly a ray from what is seen leaves the scene.
fn is_shut_in(around: &Around, seen: &[(Vec3, Vec3)]) -> bool {
    let (mut rays, mut left) = (0, 0);
    for (point, normal) in seen {
        for direction in directions(RAYS).filter(|d| d.dot(*normal) > 0.0) {
            rays += 1;
            left += usize::from(around.look(*point, direction).is_none());
        }
    }
    (left as f32) < OPEN * rays as f32
}

/// Places of lamps below the ceilings of what is seen, each with the height of its room.
fn hung(around: &Around, seen: &[(Vec3, Vec3)]) -> Vec<(Vec3, f32)> {
    // Find floor and ceiling at each point.
    let columns = seen.iter().filter_map(|(point, _)| {
        let ceiling = around.look(*point, Vec3::Y)?;
        let floor = around.look(*point, Vec3::NEG_Y)?;
        Some((*point, floor.distance, ceiling.distance))
    });
    let columns: Vec<(Vec3, f32, f32)> = columns.collect();
    let mut heights: Vec<f32> = columns.iter().map(|(_, down, up)| down + up).collect();
    heights.sort_by(f32::total_cmp);
    let Some(height) = heights.get(heights.len() / 2).copied() else {
        return Vec::new();
    };

    // Gather them in cells, and hang a lamp into each.
    let apart = (height * APART).max(f32::MIN_POSITIVE);
    let cell = |point: Vec3| [point.x, point.z].map(|x| (x / apart).floor());
    let mut cells: Vec<([f32; 2], Vec<Vec3>)> = Vec::new();
    for (point, down, up) in columns
        .iter()
        .filter(|(_, down, up)| down + up > height * 0.5)
    {
        let at = *point + Vec3::Y * (up - (1.0 - HANG) * (down + up));
        match cells.iter_mut().find(|(key, _)| *key == cell(*point)) {
            Some((_, places)) => places.push(at),
            None => cells.push((cell(*point), vec![at])),
        }
    }
    cells.sort_by_key(|(_, places)| std::cmp::Reverse(places.len()));
    cells.truncate(MOST);
    let lamp = |places: &Vec<Vec3>| {
        let middle = places.iter().sum::<Vec3>() / places.len() as f32;
        let near = |a: &&Vec3, b: &&Vec3| a.distance(middle).total_cmp(&b.distance(middle));
        places.iter().min_by(near).map(|place| (*place, height))
    };
    let mut lamps: Vec<(Vec3, f32)> = Vec::new();
    for (at, height) in cells.iter().filter_map(|(_, places)| lamp(places)) {
        let at = off_walls(around, at, height);
        if lamps
            .iter()
            .all(|(other, _)| other.distance(at) > CLOSE * apart)
        {
            lamps.push((at, height));
        }
    }
    lamps
}

/// The place moved away from walls that are near, as far as there is room.
fn off_walls(around: &Around, mut at: Vec3, height: f32) -> Vec3 {
    for direction in horizon(8).chain(horizon(8)) {
        let (there, back) = (around.room(at, direction), around.room(at, -direction));
        let wanted = (OFF * height - there).min((back - there) * 0.5);
        at -= direction * wanted.max(0.0);
    }
    at
}

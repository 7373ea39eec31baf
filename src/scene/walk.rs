//! A camera that walks through a room: from the best view to the place farthest from it, around what stands in the way.
//!
//! The ways between places of a grid form a graph; the shortest path is Dijkstra's (1959, "A note on two problems in
//! connexion with graphs", Numerische Mathematik 1:269–271), where a metre close to things counts for more. Its corners are
//! rounded by running means, and the camera looks ahead along it.

use super::around::{Around, horizon};
use super::inside::{self, Standpoint};
use super::track::{Interpolation, Keys, Track};
use super::{Animation, Channel, Clip, Target};
use glam::{DQuat, Vec3};

/// The name of the camera, its node and its clip.
pub const WALK: &str = "walk";

/// Places along each horizontal axis of the room.
const PLACES: usize = 20;

/// Neighbours of a place lie within so many cells of the grid.
const REACH: f32 = 1.5;

/// Keys of the walk.
const KEYS: usize = 96;

/// Keys on either side that a position is the mean of; directions take as many, and the camera looks as many ahead.
const ROUND: usize = 6;

/// A metre counts for this much more where the air around is only as wide as an eye's own.
const SHY: f32 = 3.0;

/// Air beside a place beyond which it counts as open, in heights of the eye.
const OPEN: f32 = 0.8;

impl Animation {
    /// Adds a camera that walks through the room in so many seconds, and its clip, which plays. `None` where there is no way
    /// to walk.
    pub fn add_walk(&mut self, around: &Around, seconds: f64) -> Option<usize> {
        let start = inside::standpoint(around)?;
        let stands = gaits(&path(around, start.eye)?, start);
        let camera = self.add_camera(WALK, stands[0]);
        let node = self.cameras[camera].node;
        let last = (stands.len() - 1) as f64;
        let times = (0..stands.len()).map(|k| seconds * k as f64 / last);
        let times: Vec<f64> = times.collect();
        let track = |keys: Keys| Track {
            times: times.clone(),
            keys,
            interpolation: Interpolation::Linear,
        };
        let places = stands.iter().map(|s| self.to_file(s.eye.as_dvec3()));
        let values = places.flat_map(|place| place.to_array()).collect();
        let mut turns: Vec<DQuat> = stands.iter().map(Standpoint::rotation).collect();
        for k in 1..turns.len() {
            if turns[k].dot(turns[k - 1]) < 0.0 {
                turns[k] = -turns[k];
            }
        }
        let channels = vec![
            Channel {
                target: Target::Translation(node),
                track: track(Keys::Numbers { width: 3, values }),
            },
            Channel {
                target: Target::Rotation(node),
                track: track(Keys::Rotations(turns)),
            },
        ];
        self.playing.push(self.clips.len());
        self.clips.push(Clip {
            name: WALK.into(),
            channels,
            seconds,
        });
        Some(camera)
    }
}

/// The corners of a way from a place to the farthest that can be walked to.
fn path(around: &Around, start: Vec3) -> Option<Vec<Vec3>> {
    // Join neighbouring places between which a person may pass.
    let mut places = vec![start];
    places.extend(inside::eyes(around, PLACES));
    let height = around.room(start, Vec3::NEG_Y);
    let cell = around.bounds().extent() / PLACES as f32;
    let reach = REACH * cell.x.max(cell.z);
    let dear: Vec<f32> = places
        .iter()
        .map(|place| shyness(around, *place, height))
        .collect();
    let passes = |a: Vec3, b: Vec3| {
        let knee = Vec3::Y * (height * 0.6);
        let level = (a.y - b.y).abs() < 0.3 * height;
        level && around.is_free(a, b) && around.is_free(a - knee, b - knee)
    };

    // Find the shortest ways to all of them.
    let mut best = vec![(f32::INFINITY, f32::INFINITY, 0); places.len()];
    best[0] = (0.0, 0.0, 0);
    let mut open: Vec<usize> = (0..places.len()).collect();
    while let Some(at) =
        (0..open.len()).min_by(|a, b| best[open[*a]].0.total_cmp(&best[open[*b]].0))
    {
        let here = open.swap_remove(at);
        if best[here].0.is_infinite() {
            break;
        }
        for &next in &open {
            let metres = places[here].distance(places[next]);
            let near = metres < reach || here == 0 && metres < 2.0 * reach;
            let cost = best[here].0 + metres * (dear[here] + dear[next]) * 0.5;
            if near && cost < best[next].0 && passes(places[here], places[next]) {
                best[next] = (cost, best[here].1 + metres, here);
            }
        }
    }

    // Walk back from the farthest.
    let reached = (0..places.len()).filter(|k| best[*k].0.is_finite());
    let mut at = reached.max_by(|a, b| best[*a].1.total_cmp(&best[*b].1))?;
    let mut way = vec![places[at]];
    while at != 0 {
        at = best[at].2;
        way.push(places[at]);
    }
    way.reverse();
    (way.len() > 1).then_some(way)
}

/// What a metre counts for at a place: 1 in the open, more beside things.
fn shyness(around: &Around, place: Vec3, height: f32) -> f32 {
    let air = horizon(16).map(|direction| around.room(place, direction));
    let air = air.fold(f32::INFINITY, f32::min);
    1.0 + SHY * (1.0 - air / (OPEN * height)).max(0.0)
}

/// Where the camera stands and looks at every key.
fn gaits(way: &[Vec3], start: Standpoint) -> Vec<Standpoint> {
    // Go the way at one speed, and round its corners.
    let places = means(&along(way));

    // Look ahead; begin as the best view does.
    let mut ahead: Vec<Vec3> = (0..KEYS)
        .map(|k| {
            let to = places[(k + ROUND).min(KEYS - 1)] - places[k.min(KEYS - 1 - ROUND)];
            to.normalize_or(start.forward)
        })
        .collect();
    ahead[..ROUND].fill(start.forward);
    let dip = Vec3::Y * start.forward.y;
    let ahead = means(&means(&ahead));
    let looks = places.into_iter().zip(ahead);
    looks
        .map(|(eye, ahead)| Standpoint {
            eye,
            forward: (Vec3::new(ahead.x, 0.0, ahead.z).normalize_or(start.forward) + dip)
                .normalize(),
        })
        .collect()
}

/// [`KEYS`] points at even distances along a way.
fn along(way: &[Vec3]) -> Vec<Vec3> {
    let length: f32 = way.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
    (0..KEYS)
        .map(|k| {
            let mut left = length * k as f32 / (KEYS - 1) as f32;
            for pair in way.windows(2) {
                let step = pair[0].distance(pair[1]);
                if left <= step && step > 0.0 {
                    return pair[0].lerp(pair[1], left / step);
                }
                left -= step;
            }
            way[way.len() - 1]
        })
        .collect()
}

/// The means of each vector and its neighbours, as many on both sides as there are, so that the ends stay.
fn means(of: &[Vec3]) -> Vec<Vec3> {
    let mean = |k: usize| {
        let reach = ROUND.min(k).min(of.len() - 1 - k);
        let around = &of[k - reach..=k + reach];
        around.iter().sum::<Vec3>() / around.len() as f32
    };
    (0..of.len()).map(mean).collect()
}

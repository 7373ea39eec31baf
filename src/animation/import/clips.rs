//! Clips: the file's animations as tracks on nodes of the scene.

use super::{Import, Tree, known};
use crate::animation::pose::unit;
use crate::animation::track::{Interpolation, Keys, Track};
use crate::animation::{Channel, Clip, Rest, Target};
use crate::error::Result;
use glam::DQuat;
use gltf::json;
use gltf::json::animation::{Interpolation as Mode, Property};
use std::collections::HashSet;

impl Import<'_> {
    /// Every animation; channels on nodes outside the scene and on morph weights are left out.
    pub(super) fn clips(&mut self, tree: &Tree) -> Result<Vec<Clip>> {
        let mut weights = 0;
        let mut clips = Vec::with_capacity(self.root.animations.len());
        for (index, json) in self.root.animations.iter().enumerate() {
            let mut taken = HashSet::new();
            let mut channels = Vec::new();
            for (at, channel) in json.channels.iter().enumerate() {
                // Find the node and the property.
                let pointer = format!("/animations/{index}/channels/{at}");
                let target = channel.target.node.value();
                let Some(place) = tree.place.get(target) else {
                    let pointer = format!("{pointer}/target/node");
                    return Err(self
                        .store
                        .missing(pointer, "node", target, self.root.nodes.len()));
                };
                let property = known(channel.target.path);
                if matches!(property, None | Some(Property::MorphTargetWeights)) {
                    weights += 1;
                    continue;
                }
                let (Some(node), Some(property)) = (*place, property) else {
                    continue;
                };

                // Refuse what the specification forbids and no pose could honour.
                let target = format!("{pointer}/target");
                if matches!(tree.nodes[node as usize].rest, Rest::Matrix(_)) {
                    let way_out =
                        "give the node translation, rotation and scale instead of its matrix";
                    let got = format!("node '{}' with a matrix", tree.nodes[node as usize].name);
                    return Err(self
                        .store
                        .broken(target, "a node without a matrix", got, way_out));
                }
                if !taken.insert((node, property as u8)) {
                    let got = format!("a second one on '{}'", tree.nodes[node as usize].name);
                    let way_out = "remove one of the two channels";
                    return Err(self.store.broken(
                        target,
                        "one channel for a node's property",
                        got,
                        way_out,
                    ));
                }
                let track = self.track(index, json, &pointer, channel, property)?;
                let target = match property {
                    Property::Rotation => Target::Rotation(node),
                    Property::Scale => Target::Scale(node),
                    _ => Target::Translation(node),
                };
                channels.push(Channel { target, track });
            }
            let last = |channel: &Channel| channel.track.times.last().copied().unwrap_or(0.0);
            let seconds = channels.iter().map(last).fold(0.0, f64::max);
            clips.push(Clip {
                name: json
                    .name
                    .clone()
                    .unwrap_or_else(|| format!("animation {index}")),
                channels,
                seconds,
            });
        }
        if weights > 0 {
            self.warnings.push(format!(
                "{weights} animation channels of morph weights or unknown paths are left out."
            ));
        }
        Ok(clips)
    }

    /// The track of one channel.
    fn track(
        &self,
        animation: usize,
        json: &json::Animation,
        pointer: &str,
        channel: &json::animation::Channel,
        property: Property,
    ) -> Result<Track> {
        let index = channel.sampler.value();
        let Some(sampler) = json.samplers.get(index) else {
            return Err(self.store.missing(
                format!("{pointer}/sampler"),
                "sampler",
                index,
                json.samplers.len(),
            ));
        };
        let pointer = format!("/animations/{animation}/samplers/{index}");
        let interpolation = match known(sampler.interpolation) {
            Some(Mode::Step) => Interpolation::Step,
            Some(Mode::Linear) => Interpolation::Linear,
            Some(Mode::CubicSpline) => Interpolation::CubicSpline,
            None => {
                let expected = "STEP, LINEAR or CUBICSPLINE";
                let pointer = format!("{pointer}/interpolation");
                return Err(self.store.broken(
                    pointer,
                    expected,
                    "another word".into(),
                    "export the file again",
                ));
            }
        };
        let times = self.times(&pointer, sampler.input.value())?;

        // Read the values and count them.
        let (output, place) = (sampler.output.value(), format!("{pointer}/output"));
        let (keys, count) = match property {
            Property::Rotation => {
                let keys: Vec<DQuat> = self
                    .store
                    .floats::<4>(output, &place)?
                    .into_iter()
                    .map(|key| DQuat::from_array(key.map(f64::from)))
                    .collect();
                let count = keys.len();
                (
                    Keys::Rotations(self.unit_keys(&place, keys, interpolation)?),
                    count,
                )
            }
            _ => {
                let keys = self.store.floats::<3>(output, &place)?;
                let values = keys.iter().flatten().map(|key| f64::from(*key)).collect();
                (Keys::Numbers { width: 3, values }, keys.len())
            }
        };
        let wanted = times.len()
            * if interpolation == Interpolation::CubicSpline {
                3
            } else {
                1
            };
        if count != wanted {
            let expected = format!("{wanted} values for {} times", times.len());
            return Err(self.store.broken(
                place,
                expected,
                count.to_string(),
                "export the file again",
            ));
        }
        Ok(Track {
            times,
            keys,
            interpolation,
        })
    }

    /// Key times: from 0 on, each later than the one before.
    fn times(&self, pointer: &str, accessor: usize) -> Result<Vec<f64>> {
        let pointer = format!("{pointer}/input");
        let times: Vec<f64> = self
            .store
            .floats::<1>(accessor, &pointer)?
            .into_iter()
            .map(|[time]| f64::from(time))
            .collect();
        let falls = times.windows(2).find(|pair| pair[0] >= pair[1]);
        if let Some(pair) = falls {
            let got = format!("{} s after {} s", pair[1], pair[0]);
            return Err(self.store.broken(
                pointer,
                "key times that increase",
                got,
                "export the animation again",
            ));
        }
        match times.first() {
            Some(first) if *first < 0.0 => {
                let got = format!("{first} s");
                Err(self.store.broken(
                    pointer,
                    "key times from 0 s on",
                    got,
                    "move the animation to start at 0 or later",
                ))
            }
            _ => Ok(times),
        }
    }

    /// Rotations made unit length; a cubic track's stay as they are, for its tangents belong to them.
    fn unit_keys(
        &self,
        pointer: &str,
        keys: Vec<DQuat>,
        interpolation: Interpolation,
    ) -> Result<Vec<DQuat>> {
        let cubic = interpolation == Interpolation::CubicSpline;
        let made = |(index, key): (usize, DQuat)| match unit(key) {
            Some(_) if cubic => Ok(key),
            Some(made) => Ok(made),
            None if cubic && index % 3 != 1 => Ok(key),
            None => {
                let got = format!("{key} as key {index}");
                Err(self.store.broken(
                    pointer.into(),
                    "unit quaternions",
                    got,
                    "export the animation again",
                ))
            }
        };
        keys.into_iter().enumerate().map(made).collect()
    }
}

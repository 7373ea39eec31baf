//! Clips: the file's animations, as tracks on the properties that they change.

use super::hierarchy::Hierarchy;
use super::import::{Import, known};
use super::losses::{Losses, Lost};
use super::pointers::{self, Named, Shape, Taken};
use crate::error::Result;
use crate::scene::pose::unit;
use crate::scene::track::{Interpolation, Keys, Track};
use crate::scene::{Channel, Clip, Rest, SceneCamera, Target};
use glam::DQuat;
use gltf::json;
use gltf::json::animation::{Interpolation as Mode, Property as Path};
use std::collections::HashSet;

/// A channel as the file has it: what it changes, and how.
struct ReadChannel {
    /// The channel's place in the file.
    pointer: String,
    sampler: Option<usize>,
    named: Named,
    /// The positions that hold the property.
    places: Vec<usize>,
}

impl Import<'_> {
    /// Every animation; channels on what is not in the scene are left out.
    pub(super) fn clips(
        &mut self,
        tree: &Hierarchy,
        cameras: &[SceneCamera],
        taken: &[Taken],
    ) -> Result<Vec<Clip>> {
        let mut losses = Losses::default();
        let mut clips = Vec::with_capacity(self.root.animations.len());
        for (index, json) in self.root.animations.iter().enumerate() {
            let nothing = Taken::default();
            let taken = taken.get(index).unwrap_or(&nothing);
            let found = self.found(index, json, taken, tree, cameras, &mut losses)?;
            let mut set = HashSet::new();
            let mut channels = Vec::new();
            for channel in &found {
                self.channel(
                    index,
                    json,
                    channel,
                    tree,
                    &mut set,
                    &mut channels,
                    &mut losses,
                )?;
            }
            let last = |channel: &Channel| channel.track.times.last().copied().unwrap_or(0.0);
            let seconds = channels.iter().map(last).fold(0.0, f64::max);
            clips.push(Clip {
                name: called(index, json),
                channels,
                seconds,
            });
        }
        self.losses.extend(losses);
        Ok(clips)
    }

    /// The channels of one animation that change something known: those on nodes, then those that point.
    fn found(
        &self,
        index: usize,
        json: &json::Animation,
        taken: &Taken,
        tree: &Hierarchy,
        cameras: &[SceneCamera],
        losses: &mut Losses,
    ) -> Result<Vec<ReadChannel>> {
        let on_nodes = json.channels.iter().enumerate().map(|(at, channel)| {
            let path = match known(channel.target.path) {
                Some(Path::Translation) => "translation",
                Some(Path::Rotation) => "rotation",
                Some(Path::Scale) => "scale",
                Some(Path::MorphTargetWeights) => "weights",
                None => "an unknown path",
            };
            let pointer = format!("/nodes/{}/{path}", channel.target.node.value());
            let at = taken.kept.get(at).copied().unwrap_or(at);
            (at, Some(channel.sampler.value()), pointer, "node")
        });
        let pointing = taken.pointed.iter().map(|channel| {
            let field = "extensions/KHR_animation_pointer/pointer";
            (
                channel.channel,
                channel.sampler,
                channel.pointer.clone(),
                field,
            )
        });
        let mut found = Vec::new();
        for (at, sampler, target, field) in on_nodes.chain(pointing) {
            let pointer = format!("/animations/{index}/channels/{at}");
            let Some(named) = pointers::find(&target) else {
                let property = pointers::pattern(&target);
                losses.note_of(Lost::Channel, &property, called(index, json));
                continue;
            };
            let by = format!("{pointer}/target/{field}");
            let places = self.places(&by, named.property, named.item, tree, cameras)?;
            if let (Some(weight), Some(place)) = (named.weight, places.first()) {
                let count = tree.nodes[*place].weights.len();
                if weight >= count {
                    return Err(self.store.missing(by, "morph target", weight, count));
                }
            }
            if places.is_empty() {
                losses.note(Lost::Elsewhere, called(index, json));
            }
            found.push(ReadChannel {
                pointer,
                sampler,
                named,
                places,
            });
        }
        Ok(found)
    }

    /// Reads one channel's track, and appends it for each place that holds its property.
    #[expect(
        clippy::too_many_arguments,
        reason = "the channel, the scene, and what was read so far"
    )]
    fn channel(
        &self,
        index: usize,
        json: &json::Animation,
        found: &ReadChannel,
        tree: &Hierarchy,
        set: &mut HashSet<Target>,
        channels: &mut Vec<Channel>,
        losses: &mut Losses,
    ) -> Result<()> {
        // Refuse what the specification forbids and no pose could honour.
        let target = format!("{}/target", found.pointer);
        for place in &found.places {
            let set_here = found.named.target(*place);
            let node = set_here.node().map(|node| &tree.nodes[node]);
            let matrix = node.is_some_and(|node| matches!(node.rest, Rest::Matrix(_)));
            if matrix && set_here.is_transform() {
                let way_out = "give the node translation, rotation and scale instead of its matrix";
                let got = node.map_or(String::new(), |node| {
                    format!("node '{}' with a matrix", node.name)
                });
                return Err(self
                    .store
                    .broken(target, "a node without a matrix", got, way_out));
            }
            // A weight alone and all of them together are one property; a weight's own channel says that there is one.
            let one = |node| Target::Weight(node, u32::MAX);
            let overlaps = match set_here {
                Target::Weight(of, _) => {
                    set.insert(one(of));
                    set.contains(&Target::Weights(of))
                }
                Target::Weights(of) => set.contains(&one(of)),
                _ => false,
            };
            if overlaps || !set.insert(set_here) {
                let of = node.map_or(String::new(), |node| format!(" of '{}'", node.name));
                let got = format!("a second one for this property{of}");
                let way_out = "remove one of the two channels";
                return Err(self
                    .store
                    .broken(target, "one channel for a property", got, way_out));
            }
        }

        // Read the keys, as wide as the property is; of nothing there is nothing to read.
        let Some(first) = found.places.first() else {
            return Ok(());
        };
        let width = match found.named.property.shape {
            Shape::Weights if found.named.weight.is_some() => 1,
            Shape::Weights => tree.nodes[*first].weights.len(),
            Shape::Numbers(width) => width,
            Shape::Rotation | Shape::Switch => 1,
        };
        if width == 0 {
            losses.note(Lost::Weightless, called(index, json));
            return Ok(());
        }
        let track = self.track(index, json, found, width)?;
        channels.extend(found.places.iter().map(|place| Channel {
            target: found.named.target(*place),
            track: track.clone(),
        }));
        Ok(())
    }

    /// The track of one channel.
    fn track(
        &self,
        animation: usize,
        json: &json::Animation,
        found: &ReadChannel,
        width: usize,
    ) -> Result<Track> {
        // Find the sampler.
        let at = format!("{}/sampler", found.pointer);
        let count = json.samplers.len();
        let Some(index) = found.sampler else {
            let way_out = "export the file again";
            return Err(self
                .store
                .broken(at, "a sampler's index", "none".into(), way_out));
        };
        let Some(sampler) = json.samplers.get(index) else {
            return Err(self.store.missing(at, "sampler", index, count));
        };
        let pointer = format!("/animations/{animation}/samplers/{index}");
        let interpolation = self.interpolation(&pointer, sampler, found.named.property.shape)?;
        let times = self.times(&pointer, sampler.input.value())?;

        // Read the values and count them.
        let (output, place) = (sampler.output.value(), format!("{pointer}/output"));
        let each = if interpolation == Interpolation::CubicSpline {
            3
        } else {
            1
        };
        let counted = |count: usize, width: usize| {
            let wanted = times.len() * each * width;
            if count == wanted {
                return Ok(());
            }
            let expected = format!("{wanted} values for {} times", times.len());
            let way_out = "export the file again";
            Err(self
                .store
                .broken(place.clone(), expected, count.to_string(), way_out))
        };
        let keys = match found.named.property.shape {
            Shape::Rotation => {
                let keys = self.store.floats::<4>(output, &place)?;
                counted(keys.len(), 1)?;
                let turn = |key: &[f32; 4]| DQuat::from_array(key.map(f64::from));
                let keys = keys.iter().map(turn).collect();
                Keys::Rotations(self.unit_keys(&place, keys, interpolation)?)
            }
            Shape::Numbers(3) => {
                let keys = self.store.floats::<3>(output, &place)?;
                counted(keys.len(), 1)?;
                numbers(&keys)
            }
            Shape::Numbers(4) => {
                let keys = self.store.floats::<4>(output, &place)?;
                counted(keys.len(), 1)?;
                numbers(&keys)
            }
            Shape::Numbers(_) | Shape::Weights | Shape::Switch => {
                let values = self.store.floats::<1>(output, &place)?;
                counted(values.len(), width)?;
                let values = values.into_iter().map(|[value]| f64::from(value)).collect();
                Keys::Numbers { width, values }
            }
        };
        Ok(Track {
            times,
            keys,
            interpolation,
        })
    }

    /// The interpolation of a sampler; booleans only step.
    fn interpolation(
        &self,
        pointer: &str,
        sampler: &json::animation::Sampler,
        shape: Shape,
    ) -> Result<Interpolation> {
        let (expected, got) = match known(sampler.interpolation) {
            // Exporters forget to say so, and the default is a line.
            Some(Mode::Step | Mode::Linear) if shape == Shape::Switch => {
                return Ok(Interpolation::Step);
            }
            Some(Mode::CubicSpline) if shape == Shape::Switch => {
                ("STEP for what is true or false", "CUBICSPLINE")
            }
            Some(Mode::Step) => return Ok(Interpolation::Step),
            Some(Mode::Linear) => return Ok(Interpolation::Linear),
            Some(Mode::CubicSpline) => return Ok(Interpolation::CubicSpline),
            None => ("STEP, LINEAR or CUBICSPLINE", "another word"),
        };
        let pointer = format!("{pointer}/interpolation");
        let way_out = "export the file again";
        Err(self.store.broken(pointer, expected, got.into(), way_out))
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

/// An animation's name.
fn called(index: usize, json: &json::Animation) -> String {
    let name = json.name.clone();
    name.unwrap_or_else(|| format!("animation {index}"))
}

/// Keys of N numbers each.
fn numbers<const N: usize>(keys: &[[f32; N]]) -> Keys {
    Keys::Numbers {
        width: N,
        values: keys.iter().flatten().map(|key| f64::from(*key)).collect(),
    }
}

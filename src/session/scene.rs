//! The scene as edited, and the notes to undo each edit.
//!
//! Whatever an edit sets is written down as it was. Taking a step back, or out again because a later edit of it cannot be made,
//! is one walk through these notes: there is no second way to undo. What a playing clip would set too is *held*: its
//! channel is left out as long as the edit stands.

use super::edit::Edit;
use crate::error::{Error, Result};
use crate::ids::{MaterialId, NodeId, SurfaceId};
use crate::mesh::RadiosityMesh;
use crate::scene::light::Beam;
use crate::scene::pose::Pose;
use crate::scene::view::{Eye, View};
use crate::scene::{Animation, Clip, Lens, Rest, Target};
use glam::{DVec3, Vec2, Vec3};

/// The scene of a session.
pub struct EditedScene {
    /// Nodes, materials, lights and cameras as they are now; its clips are without what edits hold.
    pub animation: Animation,
    /// Who exchanges light; numbers never change, and what is added comes after all else.
    pub patches: RadiosityMesh,
    /// Nodes that were removed, or whose adding was undone.
    pub gone: Vec<bool>,
    /// Materials that have light samples, since they emit or did.
    pub emits: Vec<bool>,
    /// The viewpoint.
    pub looks: Looks,
    /// Nodes of the first file: what comes after was added.
    pub own: usize,
    /// Nodes that are seen unless they are gone.
    pub(super) shown: Vec<bool>,
    clips: Vec<Clip>,
    held: Vec<Target>,
}

/// The viewpoint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Looks {
    /// As one who looks at the file does.
    Through(Eye),
    /// From a point at another, with a vertical field of view in radians.
    At {
        /// The eye.
        eye: DVec3,
        /// The point in the middle of the picture.
        at: DVec3,
        /// Radians.
        yfov: f64,
    },
}

/// Something as it was before an edit.
#[derive(Clone, Debug)]
pub enum Was {
    /// A node's transform.
    Rest(usize, Rest),
    /// Whether a node was shown, and whether it was gone.
    Presence(usize, bool, bool),
    /// A material's base colour, emission and its factor, and whether it had light samples.
    Material(usize, Vec3, Vec3, f32, bool),
    /// A light's beam.
    Beam(usize, Beam),
    /// The viewpoint.
    Looks(Looks),
    /// So many properties were held.
    Held(usize),
}

impl EditedScene {
    /// The scene of a file, as its playing clips begin.
    pub fn new(animation: Animation, patches: RadiosityMesh, eye: Eye) -> EditedScene {
        let channels = animation
            .playing
            .iter()
            .filter_map(|clip| animation.clips.get(*clip));
        let glows = |target: Target, material: MaterialId| {
            target == Target::Emissive(material) || target == Target::EmissiveStrength(material)
        };
        let targets: Vec<Target> = channels
            .flat_map(|clip| clip.channels.iter().map(|c| c.target))
            .collect();
        let emits = animation
            .materials
            .iter()
            .enumerate()
            .map(|(index, material)| {
                let index = MaterialId::from_index(index);
                material.emission() != Vec3::ZERO || targets.iter().any(|t| glows(*t, index))
            });
        EditedScene {
            emits: emits.collect(),
            gone: vec![false; animation.nodes.len()],
            shown: animation.nodes.iter().map(|node| node.visible).collect(),
            looks: Looks::Through(eye),
            own: animation.nodes.len(),
            clips: animation.clips.clone(),
            held: Vec::new(),
            animation,
            patches,
        }
    }

    /// Makes the edits of a step; `seconds` is the time of the clips that play.
    ///
    /// Gives what undoes them.
    ///
    /// # Errors
    /// [`Error::Edit`] for an edit that cannot be made, and what opening a file tells: then nothing has changed.
    pub fn apply(&mut self, edits: &[Edit], seconds: f64) -> Result<Vec<Was>> {
        let mut notes = Vec::new();
        for (index, edit) in edits.iter().enumerate() {
            if let Err(error) = self.make(edit, &format!("edits[{index}]"), seconds, &mut notes) {
                self.undo(notes);
                return Err(error);
            }
        }
        Ok(notes)
    }

    /// Takes back what the notes tell of.
    pub fn undo(&mut self, notes: Vec<Was>) {
        for was in notes.into_iter().rev() {
            match was {
                Was::Rest(node, rest) => self.animation.nodes[node].rest = rest,
                Was::Presence(node, shown, gone) => {
                    (self.shown[node], self.gone[node]) = (shown, gone);
                    self.animation.nodes[node].visible = shown && !gone;
                }
                Was::Material(index, color, emissive, strength, emits) => {
                    let material = &mut self.animation.materials[index];
                    (material.base_color, material.emissive) = (color, emissive);
                    (material.emissive_strength, self.emits[index]) = (strength, emits);
                }
                Was::Beam(index, beam) => self.animation.lights[index].beam = beam,
                Was::Looks(looks) => self.looks = looks,
                Was::Held(count) => {
                    self.held.truncate(count);
                    self.leave_out_held();
                }
            }
        }
    }
    /// The viewpoint in a pose; `aspect` is the picture's width over its height.
    ///
    /// # Errors
    /// As [`Animation::view`].
    pub fn view(&self, pose: &Pose, aspect: f64) -> Result<View> {
        self.view_by(self.looks, pose, aspect)
    }

    /// Another viewpoint in a pose.
    ///
    /// # Errors
    /// As [`Animation::view`].
    pub fn view_by(&self, looks: Looks, pose: &Pose, aspect: f64) -> Result<View> {
        match looks {
            Looks::Through(eye) => self.animation.view(&eye, pose, aspect),
            Looks::At { eye, at, yfov } => {
                let forward = (at - eye).normalize();
                let upright = if forward.y.abs() > 0.9999 {
                    DVec3::NEG_Z
                } else {
                    DVec3::Y
                };
                let up = upright.reject_from_normalized(forward).normalize();
                Ok(View {
                    eye: eye.as_vec3(),
                    right: forward.cross(up).normalize().as_vec3(),
                    up: up.as_vec3(),
                    forward: forward.as_vec3(),
                    lens: Lens::Perspective { yfov },
                    shift: Vec2::ZERO,
                })
            }
        }
    }

    /// The material of a surface.
    pub fn material_of(&self, surface: SurfaceId) -> MaterialId {
        let instance = &self.animation.instances[self.patches.surfaces[surface].instance];
        self.animation.meshes[instance.mesh].material
    }

    /// The node of a surface.
    pub fn node_of(&self, surface: SurfaceId) -> NodeId {
        self.animation.instances[self.patches.surfaces[surface].instance].node
    }

    /// Makes room for nodes and materials that were added.
    pub(super) fn grow(&mut self) {
        self.gone.resize(self.animation.nodes.len(), false);
        let nodes = self.animation.nodes.iter().skip(self.shown.len());
        self.shown.extend(nodes.map(|node| node.visible));
        let materials = self.animation.materials.iter().skip(self.emits.len());
        self.emits
            .extend(materials.map(|material| material.emission() != Vec3::ZERO));
    }

    /// Per node whether it, or one above it, was removed.
    pub(super) fn away(&self) -> Vec<bool> {
        let mut away = self.gone.clone();
        for (index, node) in self.animation.nodes.iter().enumerate() {
            away[index] |= node.parent.is_some_and(|parent| away[parent]);
        }
        away
    }

    pub(super) fn plays(&self, target: Target) -> bool {
        let mut channels = (self.animation.playing.iter())
            .filter_map(|clip| self.animation.clips.get(*clip))
            .flat_map(|clip| &clip.channels);
        channels.any(|channel| channel.target == target)
    }

    /// Lets edits rather than clips set these properties.
    pub(super) fn hold(&mut self, targets: impl IntoIterator<Item = Target>, notes: &mut Vec<Was>) {
        let played = targets.into_iter().filter(|target| self.plays(*target));
        let played: Vec<Target> = played.collect();
        if !played.is_empty() {
            notes.push(Was::Held(self.held.len()));
            self.held.extend(played);
            self.leave_out_held();
        }
    }

    fn leave_out_held(&mut self) {
        self.animation.clips = self.clips.clone();
        for clip in &mut self.animation.clips {
            clip.channels
                .retain(|channel| !self.held.contains(&channel.target));
        }
    }
}

/// An edit that cannot be made.
pub(super) fn fault(place: &str, expected: &str, got: &str, way_out: &str) -> Error {
    Error::Edit {
        place: place.into(),
        expected: expected.into(),
        got: got.into(),
        way_out: way_out.into(),
    }
}

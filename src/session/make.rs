//! Making one edit: check it, note the old state, change the scene.

use super::add;
use super::edit::{self, Edit, Which};
use super::find::find;
use super::scene::{EditedScene, Looks, Was, fault};
use super::transform::{check_scale, quaternion};
use crate::error::{Error, Result};
use crate::ids::{LightId, MaterialId, NodeId};
use crate::scene::pose::FARTHEST;
use crate::scene::view::Eye;
use crate::scene::{Lens, Rest, Target};
use glam::{DAffine3, DQuat, DVec3, Vec3};
use std::f64::consts::{FRAC_PI_4, PI};

/// Vertical field of view of a camera that had none: 45°.
const USUAL_YFOV: f64 = FRAC_PI_4;

/// One edit while it is made.
struct Making<'a> {
    scene: &'a mut EditedScene,
    /// Its path in the step, e.g. `edits[0].move`.
    at: String,
    /// The time of the clips.
    seconds: f64,
    /// The old state of everything it changes.
    notes: &'a mut Vec<Was>,
}

impl EditedScene {
    /// Makes one edit, `at` its place in the step, and notes what was there before.
    pub(super) fn make(
        &mut self,
        edit: &Edit,
        at: &str,
        seconds: f64,
        notes: &mut Vec<Was>,
    ) -> Result<()> {
        let making = Making {
            scene: self,
            at: at.into(),
            seconds,
            notes,
        };
        match edit {
            Edit::Move(to) => making.of("move").translate(to),
            Edit::Rotate(to) => making.of("rotate").rotate(to),
            Edit::Scale(to) => making.of("scale").scale(to),
            Edit::Add(what) => making.of("add").add(what),
            Edit::Remove(what) => making.of("remove").present(what, None, true),
            Edit::Hide(what) => making.of("hide").present(what, Some(false), false),
            Edit::Show(what) => making.of("show").present(what, Some(true), false),
            Edit::Emission(what) => making.of("emission").emission(what),
            Edit::Color(what) => making.of("color").color(what),
            Edit::Light(what) => making.of("light").light(what),
            Edit::Camera(what) => making.of("camera").camera(what),
            Edit::Undo(_) => Err(making.of("undo").fault(
                "a step of its own",
                "other edits beside it",
                "write {\"edits\": [{\"undo\": 1}]} on a line of its own",
            )),
        }
    }
}

impl Making<'_> {
    /// The edit of this name.
    fn of(mut self, name: &str) -> Self {
        self.at = format!("{}.{name}", self.at);
        self
    }

    fn fault(&self, expected: &str, got: &str, way_out: &str) -> Error {
        fault(&self.at, expected, got, way_out)
    }

    fn add(&mut self, what: &edit::Add) -> Result<()> {
        let node = add::add(self.scene, what, &self.at)?;
        // Undoing it takes the node away; its numbers stay taken.
        self.notes.push(Was::Presence(node, true, true));
        Ok(())
    }

    fn translate(&mut self, to: &edit::Move) -> Result<()> {
        let node = self.scene.node(&to.node, &self.at)?;
        let (value, absolute) = either(&to.to, &to.by, &self.at)?;
        let value = DVec3::from(value);
        self.transform(node, |(old, ..), _| {
            *old = if absolute { value } else { *old + value };
            Ok(())
        })
    }

    fn rotate(&mut self, to: &edit::Rotate) -> Result<()> {
        let node = self.scene.node(&to.node, &self.at)?;
        let (value, absolute) = either(&to.to, &to.by, &self.at)?;
        let turn = quaternion(value, &self.at)?;
        self.transform(node, |(_, old, _), _| {
            *old = if absolute {
                turn
            } else {
                (turn * *old).normalize()
            };
            Ok(())
        })
    }

    fn scale(&mut self, to: &edit::Move) -> Result<()> {
        let node = self.scene.node(&to.node, &self.at)?;
        let (value, absolute) = either(&to.to, &to.by, &self.at)?;
        let value = DVec3::from(value);
        self.transform(node, |(_, _, old), at| {
            let new = if absolute { value } else { *old * value };
            check_scale(new, *old, at)?;
            *old = new;
            Ok(())
        })
    }

    /// Changes a node's translation, rotation and scale; what a clip sets of them is taken as it is now, and held.
    fn transform(
        &mut self,
        node: usize,
        change: impl FnOnce((&mut DVec3, &mut DQuat, &mut DVec3), &str) -> Result<()>,
    ) -> Result<()> {
        let number = NodeId::from_index(node);
        let targets = [Target::Translation, Target::Rotation, Target::Scale].map(|of| of(number));
        let (mut translation, mut rotation, mut scale) = self.rest(node, &targets)?;
        change((&mut translation, &mut rotation, &mut scale), &self.at)?;
        // Numbers of a file have 32 bits: so what is said to stand where its file put it does, to the bit.
        (translation, scale) = (translation.as_vec3().as_dvec3(), scale.as_vec3().as_dvec3());
        if !(translation.is_finite() && scale.is_finite() && rotation.is_finite()) {
            let got = format!("translation {translation}, scale {scale}");
            return Err(self.fault("finite numbers", &got, "give smaller numbers"));
        }
        let rest = &mut self.scene.animation.nodes[node].rest;
        self.notes.push(Was::Rest(node, *rest));
        *rest = Rest::Trs {
            translation,
            rotation,
            scale,
        };
        self.scene.hold(targets, self.notes);
        Ok(())
    }

    /// The translation, rotation and scale of a node: those of its file, or, where a clip plays them, of now.
    fn rest(&self, node: usize, targets: &[Target]) -> Result<(DVec3, DQuat, DVec3)> {
        let animation = &self.scene.animation;
        let rest = if targets.iter().any(|target| self.scene.plays(*target)) {
            // The node's place in its parent.
            let pose = animation.pose(self.seconds);
            Rest::Matrix(animation.parent_to_world(node, &pose).inverse() * pose.world[node])
        } else {
            animation.nodes[node].rest
        };
        match rest {
            Rest::Trs {
                translation,
                rotation,
                scale,
            } => Ok((translation, rotation, scale)),
            Rest::Matrix(matrix) => {
                let (scale, rotation, translation) = matrix.to_scale_rotation_translation();
                let made = DAffine3::from_scale_rotation_translation(scale, rotation, translation);
                if !made.abs_diff_eq(matrix, 1e-6 * (1.0 + scale.abs().max_element())) {
                    return Err(self.fault(
                        "a node with translation, rotation and scale",
                        "a matrix that slants",
                        "put a node above it in the file, and edit that",
                    ));
                }
                Ok((translation, rotation, scale))
            }
        }
    }

    /// Shows or hides a node, or leaves that as it is, and removes it or not.
    fn present(&mut self, what: &edit::NodeEdit, shown: Option<bool>, gone: bool) -> Result<()> {
        let node = self.scene.node(&what.node, &self.at)?;
        let (old_shown, old_gone) = (self.scene.shown[node], self.scene.gone[node]);
        let shown = shown.unwrap_or(old_shown);
        self.notes.push(Was::Presence(node, old_shown, old_gone));
        (self.scene.shown[node], self.scene.gone[node]) = (shown, gone);
        self.scene.animation.nodes[node].visible = shown && !gone;
        let target = Target::Visible(NodeId::from_index(node));
        self.scene.hold([target], self.notes);
        Ok(())
    }

    /// Notes a material as it is.
    fn note_material(&mut self, index: usize) {
        let material = &self.scene.animation.materials[index];
        let (emissive, strength) = (material.emissive, material.emissive_strength);
        let (color, emits) = (material.base_color, self.scene.emits[index]);
        let was = Was::Material(index, color, emissive, strength, emits);
        self.notes.push(was);
    }

    fn emission(&mut self, what: &edit::EmissionEdit) -> Result<()> {
        let index = self.scene.material(&what.material, &self.at)?;
        let (color, strength) = (what.color.map(Vec3::from), what.strength);
        self.check_light(color, strength.map(f64::from), ["strength", "emits"])?;
        self.note_material(index);
        let material = &mut self.scene.animation.materials[index];
        material.emissive = color.unwrap_or(material.emissive);
        material.emissive_strength = strength.unwrap_or(material.emissive_strength);
        self.scene.emits[index] |= material.emission() != Vec3::ZERO;
        let number = MaterialId::from_index(index);
        let color = color.map(|_| Target::Emissive(number));
        let strength = strength.map(|_| Target::EmissiveStrength(number));
        let targets = color.into_iter().chain(strength);
        self.scene.hold(targets, self.notes);
        Ok(())
    }

    fn color(&mut self, what: &edit::Color) -> Result<()> {
        let index = self.scene.material(&what.material, &self.at)?;
        let color = Vec3::from(what.to);
        if !(color.cmpge(Vec3::ZERO).all() && color.cmple(Vec3::ONE).all()) {
            let (at, got) = (format!("{}.to", self.at), format!("{color}"));
            let way_out = "give each channel from 0 to 1, linear";
            return Err(fault(&at, "numbers from 0 to 1", &got, way_out));
        }
        self.note_material(index);
        self.scene.animation.materials[index].base_color = color;
        let target = Target::BaseColor(MaterialId::from_index(index));
        self.scene.hold([target], self.notes);
        Ok(())
    }

    fn light(&mut self, what: &edit::LightEdit) -> Result<()> {
        let names = self.scene.animation.lights.iter().map(|light| &light.name);
        let index = self.named(&what.light, names, "light")?;
        let (color, intensity) = (what.color.map(Vec3::from), what.intensity);
        self.check_light(color, intensity, ["intensity", "sends out"])?;
        let beam = &mut self.scene.animation.lights[index].beam;
        self.notes.push(Was::Beam(index, *beam));
        beam.color = color.unwrap_or(beam.color);
        beam.intensity = intensity.unwrap_or(beam.intensity);
        let number = LightId::from_index(index);
        let color = color.map(|_| Target::LightColor(number));
        let intensity = intensity.map(|_| Target::LightIntensity(number));
        let targets = color.into_iter().chain(intensity);
        self.scene.hold(targets, self.notes);
        Ok(())
    }

    /// The number of the light or camera that an edit means.
    fn named<'b>(
        &self,
        which: &Which,
        names: impl Iterator<Item = &'b String>,
        what: &str,
    ) -> Result<usize> {
        let names: Vec<(usize, &str)> = names.map(String::as_str).enumerate().collect();
        find(which, &names, &format!("{}.{what}", self.at), what)
    }

    /// Refuses a light of which nothing is said, or of which an amount is negative.
    fn check_light(
        &self,
        color: Option<Vec3>,
        amount: Option<f64>,
        [name, does]: [&str; 2],
    ) -> Result<()> {
        if color.is_none() && amount.is_none() {
            let expected = format!("color, {name} or both");
            let way_out = format!("say what it {does}, e.g. \"{name}\": 0");
            return Err(self.fault(&expected, "neither", &way_out));
        }
        let good_color = color.is_none_or(|c| c.is_finite() && c.min_element() >= 0.0);
        let good_amount = amount.is_none_or(|a| a.is_finite() && a >= 0.0);
        if good_color && good_amount {
            return Ok(());
        }
        let got = format!("{color:?} and {amount:?}");
        let way_out = "give what it sends out; 0 switches it off";
        Err(self.fault("numbers from 0", &got, way_out))
    }

    fn camera(&mut self, what: &edit::CameraEdit) -> Result<()> {
        let looks = match (&what.camera, what.eye, what.at) {
            (Some(which), None, None) => {
                let names = self.scene.animation.cameras.iter().map(|c| &c.name);
                Looks::Through(Eye::Camera(self.named(which, names, "camera")?))
            }
            (None, Some(eye), Some(target)) => {
                let yfov = what.degrees.map(f64::to_radians);
                self.look_from(DVec3::from(eye), DVec3::from(target), yfov)?
            }
            _ => {
                let got = format!(
                    "camera {:?}, eye {:?}, at {:?}",
                    what.camera, what.eye, what.at
                );
                let way_out = "name a camera of the file, or give eye and at";
                return Err(self.fault("camera alone, or eye and at", &got, way_out));
            }
        };
        self.notes.push(Was::Looks(self.scene.looks));
        self.scene.looks = looks;
        Ok(())
    }

    /// The look from a point at another; without an angle, with the present one.
    fn look_from(&self, eye: DVec3, at: DVec3, yfov: Option<f64>) -> Result<Looks> {
        let yfov = yfov.unwrap_or_else(|| self.scene.yfov(self.seconds));
        if !(yfov > 0.0 && yfov < PI) {
            let (place, got) = (
                format!("{}.degrees", self.at),
                yfov.to_degrees().to_string(),
            );
            let expected = "an angle between 0 and 180";
            return Err(fault(&place, expected, &got, "write e.g. 45"));
        }
        let near = eye.abs().max_element() <= FARTHEST;
        if !(eye.is_finite() && near && (at - eye).try_normalize().is_some()) {
            let got = format!("eye {eye}, at {at}");
            let expected = "two different points with coordinates below 1e15 metres";
            return Err(self.fault(expected, &got, "look at another point"));
        }
        let [eye, at] = [eye, at].map(|point| self.scene.animation.to_world(point));
        Ok(Looks::At { eye, at, yfov })
    }
}

impl EditedScene {
    fn yfov(&self, seconds: f64) -> f64 {
        match self.looks {
            Looks::At { yfov, .. } => yfov,
            Looks::Through(eye) => {
                let lenses = self.animation.pose(seconds).lenses;
                let lens = match eye {
                    Eye::Camera(camera) => lenses.get(camera).copied(),
                    Eye::Whole(_) => None,
                };
                match lens {
                    Some(Lens::Perspective { yfov }) => yfov,
                    _ => USUAL_YFOV,
                }
            }
        }
    }
}

/// The value that is given, and whether it replaces the old one.
fn either<T: Copy>(to: &Option<T>, by: &Option<T>, at: &str) -> Result<(T, bool)> {
    match (to, by) {
        (Some(to), None) => Ok((*to, true)),
        (None, Some(by)) => Ok((*by, false)),
        (to, _) => {
            let got = if to.is_some() { "both" } else { "neither" };
            Err(fault(
                at,
                "either to or by",
                got,
                "give the new value as to, or the change as by",
            ))
        }
    }
}

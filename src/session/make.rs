//! Making one edit: check it, note the old state, change the scene.

use super::add;
use super::edit::{self, Edit};
use super::find::find;
use super::scene::{EditedScene, Looks, Was, fault};
use crate::error::Result;
use crate::ids::{LightId, MaterialId, NodeId};
use crate::scene::pose::FARTHEST;
use crate::scene::view::Eye;
use crate::scene::{Lens, Rest, Target};
use glam::{DQuat, DVec3, Vec3};

/// Smallest factor of scale, of either sign: below, corners would fall together.
const LEAST_SCALE: f64 = 1e-6;

/// Vertical field of view of a camera that had none: 45°.
const USUAL_YFOV: f64 = std::f64::consts::FRAC_PI_4;

impl EditedScene {
    /// Makes one edit, `at` its place in the step, and notes what was there before.
    pub(super) fn make(
        &mut self,
        edit: &Edit,
        at: &str,
        seconds: f64,
        notes: &mut Vec<Was>,
    ) -> Result<()> {
        match edit {
            Edit::Move(to) => self.translate(to, &format!("{at}.move"), seconds, notes),
            Edit::Rotate(to) => self.rotate(to, &format!("{at}.rotate"), seconds, notes),
            Edit::Scale(to) => self.scale(to, &format!("{at}.scale"), seconds, notes),
            Edit::Add(what) => {
                let node = add::add(self, what, &format!("{at}.add"))?;
                // Undoing it takes the node away; its numbers stay taken.
                notes.push(Was::Presence(node, true, true));
                Ok(())
            }
            Edit::Remove(what) => {
                let node = self.node(&what.node, &format!("{at}.remove"))?;
                self.present(node, self.shown[node], true, notes);
                Ok(())
            }
            Edit::Hide(what) => {
                let node = self.node(&what.node, &format!("{at}.hide"))?;
                self.present(node, false, false, notes);
                Ok(())
            }
            Edit::Show(what) => {
                let node = self.node(&what.node, &format!("{at}.show"))?;
                self.present(node, true, false, notes);
                Ok(())
            }
            Edit::Emission(what) => self.emission(what, &format!("{at}.emission"), notes),
            Edit::Color(what) => self.color(what, &format!("{at}.color"), notes),
            Edit::Light(what) => self.light(what, &format!("{at}.light"), notes),
            Edit::Camera(what) => self.camera(what, &format!("{at}.camera"), seconds, notes),
            Edit::Undo(_) => Err(fault(
                &format!("{at}.undo"),
                "a step of its own",
                "other edits beside it",
                "write {\"edits\": [{\"undo\": 1}]} on a line of its own",
            )),
        }
    }

    fn translate(
        &mut self,
        to: &edit::Move,
        at: &str,
        seconds: f64,
        notes: &mut Vec<Was>,
    ) -> Result<()> {
        let node = self.node(&to.node, at)?;
        let (value, absolute) = either(&to.to, &to.by, at)?;
        let value = DVec3::from(value);
        self.transform(node, at, seconds, notes, |(translation, ..)| {
            *translation = if absolute {
                value
            } else {
                *translation + value
            };
            Ok(())
        })
    }

    fn rotate(
        &mut self,
        to: &edit::Rotate,
        at: &str,
        seconds: f64,
        notes: &mut Vec<Was>,
    ) -> Result<()> {
        let node = self.node(&to.node, at)?;
        let (value, absolute) = either(&to.to, &to.by, at)?;
        let turn = quaternion(value, at)?;
        self.transform(node, at, seconds, notes, |(_, rotation, _)| {
            *rotation = if absolute {
                turn
            } else {
                (turn * *rotation).normalize()
            };
            Ok(())
        })
    }

    fn scale(
        &mut self,
        to: &edit::Move,
        at: &str,
        seconds: f64,
        notes: &mut Vec<Was>,
    ) -> Result<()> {
        let node = self.node(&to.node, at)?;
        let (value, absolute) = either(&to.to, &to.by, at)?;
        let value = DVec3::from(value);
        self.transform(node, at, seconds, notes, |(_, _, scale)| {
            let new = if absolute { value } else { *scale * value };
            check_scale(new, *scale, at)?;
            *scale = new;
            Ok(())
        })
    }

    /// Changes a node's translation, rotation and scale; what a clip sets of them is taken as it is now, and held.
    fn transform(
        &mut self,
        node: usize,
        at: &str,
        seconds: f64,
        notes: &mut Vec<Was>,
        change: impl FnOnce((&mut DVec3, &mut DQuat, &mut DVec3)) -> Result<()>,
    ) -> Result<()> {
        let number = NodeId::from_index(node);
        let targets = [
            Target::Translation(number),
            Target::Rotation(number),
            Target::Scale(number),
        ];
        let played = targets.iter().any(|target| self.plays(*target));
        let rest = if played {
            // What the clip makes of it now: the node's place in its parent.
            let pose = self.animation.pose(seconds);
            let parent = self.animation.nodes[node].parent;
            let world = pose.world[node];
            let local = parent.map_or(world, |p| pose.world[p].inverse() * world);
            Rest::Matrix(local)
        } else {
            self.animation.nodes[node].rest
        };
        let (mut translation, mut rotation, mut scale) = match rest {
            Rest::Trs {
                translation,
                rotation,
                scale,
            } => (translation, rotation, scale),
            Rest::Matrix(matrix) => {
                let (scale, rotation, translation) = matrix.to_scale_rotation_translation();
                let made =
                    glam::DAffine3::from_scale_rotation_translation(scale, rotation, translation);
                if !made.abs_diff_eq(matrix, 1e-6 * (1.0 + scale.abs().max_element())) {
                    return Err(fault(
                        at,
                        "a node with translation, rotation and scale",
                        "a matrix that slants",
                        "put a node above it in the file, and edit that",
                    ));
                }
                (translation, rotation, scale)
            }
        };
        change((&mut translation, &mut rotation, &mut scale))?;
        // Numbers of a file have 32 bits: so what is said to stand where its file put it does, to the bit.
        (translation, scale) = (translation.as_vec3().as_dvec3(), scale.as_vec3().as_dvec3());
        if !(translation.is_finite() && scale.is_finite() && rotation.is_finite()) {
            let got = format!("translation {translation}, scale {scale}");
            return Err(fault(at, "finite numbers", &got, "give smaller numbers"));
        }
        notes.push(Was::Rest(node, self.animation.nodes[node].rest));
        self.animation.nodes[node].rest = Rest::Trs {
            translation,
            rotation,
            scale,
        };
        self.hold(&targets, notes);
        Ok(())
    }

    fn present(&mut self, node: usize, shown: bool, gone: bool, notes: &mut Vec<Was>) {
        notes.push(Was::Presence(node, self.shown[node], self.gone[node]));
        (self.shown[node], self.gone[node]) = (shown, gone);
        self.animation.nodes[node].visible = shown && !gone;
        self.hold(&[Target::Visible(NodeId::from_index(node))], notes);
    }

    fn note_material(&self, index: usize) -> Was {
        let material = &self.animation.materials[index];
        let (emissive, strength) = (material.emissive, material.emissive_strength);
        Was::Material(
            index,
            material.base_color,
            emissive,
            strength,
            self.emits[index],
        )
    }

    fn emission(&mut self, what: &edit::Emission, at: &str, notes: &mut Vec<Was>) -> Result<()> {
        let index = self.material(&what.material, at)?;
        if what.color.is_none() && what.strength.is_none() {
            return Err(fault(
                at,
                "color, strength or both",
                "neither",
                "say what it emits, e.g. \"strength\": 0",
            ));
        }
        let color = what.color.map(Vec3::from);
        check_light(color, what.strength.map(f64::from), at)?;
        notes.push(self.note_material(index));
        let material = &mut self.animation.materials[index];
        material.emissive = color.unwrap_or(material.emissive);
        material.emissive_strength = what.strength.unwrap_or(material.emissive_strength);
        self.emits[index] |= material.emission() != Vec3::ZERO;
        let number = MaterialId::from_index(index);
        let color = color.map(|_| Target::Emissive(number));
        let strength = what.strength.map(|_| Target::EmissiveStrength(number));
        let targets: Vec<Target> = color.into_iter().chain(strength).collect();
        self.hold(&targets, notes);
        Ok(())
    }

    fn color(&mut self, what: &edit::Color, at: &str, notes: &mut Vec<Was>) -> Result<()> {
        let index = self.material(&what.material, at)?;
        let color = Vec3::from(what.to);
        if !(color.cmpge(Vec3::ZERO).all() && color.cmple(Vec3::ONE).all()) {
            let way_out = "give each channel from 0 to 1, linear";
            return Err(fault(
                &format!("{at}.to"),
                "numbers from 0 to 1",
                &format!("{color}"),
                way_out,
            ));
        }
        notes.push(self.note_material(index));
        self.animation.materials[index].base_color = color;
        self.hold(&[Target::BaseColor(MaterialId::from_index(index))], notes);
        Ok(())
    }

    fn light(&mut self, what: &edit::Light, at: &str, notes: &mut Vec<Was>) -> Result<()> {
        let lights = self.animation.lights.iter().enumerate();
        let names: Vec<(usize, &str)> = lights.map(|(i, light)| (i, light.name.as_str())).collect();
        let index = find(&what.light, &names, &format!("{at}.light"), "light")?;
        if what.color.is_none() && what.intensity.is_none() {
            return Err(fault(
                at,
                "color, intensity or both",
                "neither",
                "say what it sends out, e.g. \"intensity\": 0",
            ));
        }
        let color = what.color.map(Vec3::from);
        check_light(color, what.intensity, at)?;
        notes.push(Was::Beam(index, self.animation.lights[index].beam));
        let beam = &mut self.animation.lights[index].beam;
        beam.color = color.unwrap_or(beam.color);
        beam.intensity = what.intensity.unwrap_or(beam.intensity);
        let color = color.map(|_| Target::LightColor(LightId::from_index(index)));
        let intensity = what
            .intensity
            .map(|_| Target::LightIntensity(LightId::from_index(index)));
        let targets: Vec<Target> = color.into_iter().chain(intensity).collect();
        self.hold(&targets, notes);
        Ok(())
    }

    fn camera(
        &mut self,
        what: &edit::Camera,
        at: &str,
        seconds: f64,
        notes: &mut Vec<Was>,
    ) -> Result<()> {
        let looks = match (&what.camera, what.eye, what.at) {
            (Some(which), None, None) => {
                let cameras = self.animation.cameras.iter().enumerate();
                let names: Vec<(usize, &str)> =
                    cameras.map(|(i, c)| (i, c.name.as_str())).collect();
                Looks::Through(Eye::Camera(find(
                    which,
                    &names,
                    &format!("{at}.camera"),
                    "camera",
                )?))
            }
            (None, Some(eye), Some(target)) => {
                let yfov = match what.degrees {
                    Some(degrees) => degrees.to_radians(),
                    None => self.yfov(seconds),
                };
                let (eye, target) = (DVec3::from(eye), DVec3::from(target));
                if !(yfov > 0.0 && yfov < std::f64::consts::PI) {
                    let got = format!("{}", yfov.to_degrees());
                    return Err(fault(
                        &format!("{at}.degrees"),
                        "an angle between 0 and 180",
                        &got,
                        "write e.g. 45",
                    ));
                }
                let near = eye.abs().max_element() <= FARTHEST;
                if !(eye.is_finite() && near && (target - eye).try_normalize().is_some()) {
                    let got = format!("eye {eye}, at {target}");
                    return Err(fault(
                        at,
                        "two different points with coordinates below 1e15 metres",
                        &got,
                        "look at another point",
                    ));
                }
                Looks::At {
                    eye,
                    at: target,
                    yfov,
                }
            }
            _ => {
                let got = format!(
                    "camera {:?}, eye {:?}, at {:?}",
                    what.camera, what.eye, what.at
                );
                let way_out = "name a camera of the file, or give eye and at";
                return Err(fault(at, "camera alone, or eye and at", &got, way_out));
            }
        };
        notes.push(Was::Looks(self.looks));
        self.looks = looks;
        Ok(())
    }

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

/// The rotation that a turn is.
pub(super) fn quaternion(turn: edit::Turn, at: &str) -> Result<DQuat> {
    let made = match turn {
        edit::Turn::Quaternion([x, y, z, w]) => {
            let length = DQuat::from_xyzw(x, y, z, w).length();
            let usable = length.is_finite() && length > f64::MIN_POSITIVE;
            usable.then(|| DQuat::from_xyzw(x / length, y / length, z / length, w / length))
        }
        edit::Turn::Axis { axis, degrees } => DVec3::from(axis)
            .try_normalize()
            .filter(|_| degrees.is_finite())
            .map(|axis| DQuat::from_axis_angle(axis, degrees.to_radians())),
    };
    made.ok_or_else(|| {
        let way_out = "write e.g. {\"axis\": [0, 1, 0], \"degrees\": 90}";
        fault(
            at,
            "a rotation with a direction",
            &format!("{turn:?}"),
            way_out,
        )
    })
}

/// Refuses a scale that leaves no area, or that would turn front and back about.
pub(super) fn check_scale(new: DVec3, old: DVec3, at: &str) -> Result<()> {
    let got = format!("{new}");
    if !(new.is_finite() && new.abs().min_element() >= LEAST_SCALE) {
        let way_out = "hide the node instead, {\"hide\": {\"node\": …}}, or give another scale";
        return Err(fault(at, "factors other than 0", &got, way_out));
    }
    if (new.element_product() < 0.0) != (old.element_product() < 0.0) {
        let way_out = "mirror the object in its file and add that";
        return Err(fault(
            at,
            "a scale that does not mirror the node",
            &got,
            way_out,
        ));
    }
    Ok(())
}

fn check_light(color: Option<Vec3>, amount: Option<f64>, at: &str) -> Result<()> {
    let good_color = color.is_none_or(|c| c.is_finite() && c.min_element() >= 0.0);
    let good_amount = amount.is_none_or(|a| a.is_finite() && a >= 0.0);
    if good_color && good_amount {
        return Ok(());
    }
    let got = format!("{color:?} and {amount:?}");
    Err(fault(
        at,
        "numbers from 0",
        &got,
        "give what it sends out; 0 switches it off",
    ))
}

//! Surfaces in one plane: posters on walls, decals, lamps let into a ceiling.
//!
//! Which of two triangles in one plane a ray meets first is rounding, so that both show as noise. The rule here: the surface
//! with less area lies on top, and of two with as much the later one in the file. Its flat faces are raised, by so little that
//! samples, which start a little above a surface, start above it too: light falls on what is beneath as if it were not there,
//! and nothing gets darker around it.

use super::Animation;
use super::faces::{faces, is_sheet};
use super::planes::{Flat, Planes};
use super::pose::FARTHEST;
use super::raised::Raised;
use crate::ids::{InstanceId, MaterialId};
use glam::Vec3;
use rayon::prelude::*;
use std::collections::HashMap;

/// One on top of another is raised by this share of the scene's largest coordinate: sixteen steps of a 32-bit number there, or
/// more, and a tenth of what samples start above a surface.
const RAISE: f32 = 1.0 / (1 << 19) as f32;

/// At most so many lie on each other, and stay below where samples start.
const MOST: u32 = 6;

/// Triangles are in one plane when no corner is off it by more than this share of how much one is raised.
const OFF: f64 = 0.5;

/// A face of an instance.
type Face = (u32, u32);

/// How a face is raised.
#[derive(Clone, Copy, Default)]
struct Raise {
    /// How many lie beneath each other under it.
    rank: u32,
    /// Whether it lies there with its front below.
    is_turned: bool,
}

impl Animation {
    /// Finds the surfaces that lie in the plane of others at time 0, and raises them in all poses.
    pub fn raise_coplanar(&mut self) {
        self.raised.clear();
        let pose = self.pose(0.0);
        let corners = (0..self.instances.len()).map(|instance| self.corners(instance, &pose));
        let corners: Vec<Vec<[Vec3; 3]>> = corners.collect();
        let extent = corners.iter().flatten().flatten();
        let extent = extent.fold(0.0f32, |extent, p| extent.max(p.abs().max_element()));
        if extent > FARTHEST as f32 {
            return;
        }
        let by = RAISE * extent;
        let planes = Planes::of(&corners, f64::from(by) * OFF);
        let involved = planes.involved(corners.len());
        let faces = corners.par_iter().zip(involved).map(|(corners, involved)| {
            if involved { faces(corners) } else { Vec::new() }
        });
        let faces: Vec<Vec<u32>> = faces.collect();
        let raises = self.raises(&planes, &faces, &upwards(&corners));
        if raises.is_empty() {
            return;
        }
        let of_instance = |(instance, faces): (u32, &Vec<u32>)| {
            let all = (0..).zip(faces).filter_map(|(triangle, face)| {
                let raise = raises.get(&(instance, *face))?;
                let up = if raise.is_turned { -by } else { by };
                let by = up * raise.rank as f32;
                Some(Raised { triangle, by })
            });
            all.collect()
        };
        self.raised = (0..).zip(&faces).map(of_instance).collect();
    }

    /// The faces that lie on others. A face is raised as a whole, for its triangles share their light.
    fn raises(&self, planes: &Planes, faces: &[Vec<u32>], order: &[usize]) -> HashMap<Face, Raise> {
        // Bring the pairs in order: what lies on most surfaces comes last, so that all beneath it are known.
        let place = |flat: &Flat| (order[flat.instance as usize], flat.triangle);
        let is_sheet: Vec<bool> = faces.iter().map(|faces| is_sheet(faces)).collect();
        let pairs = planes.overlaps(|one, other| {
            let [top, beneath] = topmost([one, other], place);
            self.compete((top, is_sheet[top.instance as usize]), beneath)
        });
        let pairs = pairs.into_iter().map(|pair| topmost(pair, place));
        let mut pairs: Vec<[&Flat; 2]> = pairs.collect();
        pairs.sort_by_key(|pair| pair.map(place));

        let face = |flat: &Flat| {
            (
                flat.instance,
                faces[flat.instance as usize][flat.triangle as usize],
            )
        };
        let mut raises: HashMap<Face, Raise> = HashMap::new();
        for [top, beneath] in pairs {
            let below = raises.get(&face(beneath)).map_or(0, |raise| raise.rank);
            let raise = raises.entry(face(top)).or_default();
            raise.rank = raise.rank.max(below + 1).min(MOST);
            // It lies on the front of what is beneath, if that can be seen there.
            raise.is_turned |= top.normal.dot(beneath.normal) < 0.0 && self.is_double(top.instance);
        }
        raises
    }

    fn material(&self, instance: u32) -> MaterialId {
        self.meshes[self.instances[InstanceId::new(instance)].mesh].material
    }

    fn is_double(&self, instance: u32) -> bool {
        self.materials[self.material(instance)].double_sided
    }

    /// Whether two surfaces look alike all over, so that it does not matter which of them is seen.
    fn look_alike(&self, one: &Flat, other: &Flat) -> bool {
        let instances = [one.instance, other.instance];
        let [first, second] = instances.map(|instance| self.material(instance));
        let colored = |instance: u32| {
            let mesh = self.instances[InstanceId::new(instance)].mesh;
            !self.meshes[mesh].colors.is_empty()
        };
        let material = &self.materials[first];
        let painted = material.base_map.is_some() || material.emission_map.is_some();
        first == second && !painted && !instances.into_iter().any(colored)
    }

    /// Whether two triangles of different looks may both be seen from one side of their plane. What solids that touch turn to
    /// each other is not seen; a sheet may show its back.
    fn compete(&self, (top, is_sheet): (&Flat, bool), beneath: &Flat) -> bool {
        let unseen = |flat: &Flat| self.materials[self.material(flat.instance)].unseen;
        let same_side = top.normal.dot(beneath.normal) > 0.0;
        let double = self.is_double(top.instance) || self.is_double(beneath.instance);
        (same_side || is_sheet && double)
            && !self.look_alike(top, beneath)
            && !unseen(top)
            && !unseen(beneath)
    }
}

/// Where each instance stands in the order of surfaces from the largest to the smallest, and from the first to the last.
fn upwards(corners: &[Vec<[Vec3; 3]>]) -> Vec<usize> {
    let of = |[a, b, c]: &[Vec3; 3]| f64::from((b - a).cross(c - a).length());
    let area = corners
        .iter()
        .map(|triangles| triangles.iter().map(of).sum());
    let area: Vec<f64> = area.collect();
    let mut instances: Vec<usize> = (0..area.len()).collect();
    instances.sort_by(|a, b| area[*b].total_cmp(&area[*a]).then(a.cmp(b)));
    let mut order = vec![0; instances.len()];
    (0..).zip(instances).for_each(|(at, i)| order[i] = at);
    order
}

/// Two triangles, the one on top first.
fn topmost([one, other]: [&Flat; 2], place: impl Fn(&Flat) -> (usize, u32)) -> [&Flat; 2] {
    match place(one) > place(other) {
        true => [one, other],
        false => [other, one],
    }
}

//! Skins: the joints of a skin, and how they pull at the positions of a primitive.
//!
//! glTF 2.0 specification, Khronos Group 2021, section 3.7.3. Weights are made to sum to 1, which files with rounded ones
//! need; `skeleton` only says where the joints' common root is, and nothing depends on it.

use super::hierarchy::Hierarchy;
use super::import::Import;
use crate::error::Result;
use crate::ids::NodeId;
use crate::scene::{Influences, Skin};
use glam::{DAffine3, DMat4};
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::validation::Checked;

/// How far from 1 the weights of a position may sum before the author is told: rounding to floats or shorts stays below.
const UNEVEN: f64 = 1e-3;

/// How far from 0, 0, 0, 1 the last row of an inverse bind matrix may be: exporters round what they invert.
const ROUNDED: f32 = 1e-3;

/// Four joints and their weights for each position.
type JointSet = (Vec<[u16; 4]>, Vec<[f32; 4]>);

impl Import<'_> {
    /// A skin of the file whose joints stand in the scene; `user` is the pointer to who asks for it.
    pub(super) fn skin(&self, tree: &Hierarchy, skin: usize, user: &str) -> Result<Skin> {
        let again = "export the file again";
        let Some(json) = self.root.skins.get(skin) else {
            let count = self.root.skins.len();
            return Err(self.store.missing(user.into(), "skin", skin, count));
        };

        // Find the joints among the scene's nodes.
        let pointer = format!("/skins/{skin}");
        if json.joints.is_empty() {
            let pointer = format!("{pointer}/joints");
            return Err(self
                .store
                .broken(pointer, "at least one joint", "none".into(), again));
        }
        let node = |index: usize, pointer: String| match tree.place.get(index) {
            Some(Some(place)) => Ok(*place),
            Some(None) => {
                let got = format!("node {index}, which is not in it");
                Err(self
                    .store
                    .broken(pointer, "a node of the scene", got, again))
            }
            None => Err(self.store.missing(pointer, "node", index, tree.place.len())),
        };
        let joint = |(at, joint): (usize, &gltf::json::Index<gltf::json::Node>)| {
            node(joint.value(), format!("{pointer}/joints/{at}"))
        };
        let joints: Vec<NodeId> = json
            .joints
            .iter()
            .enumerate()
            .map(joint)
            .collect::<Result<_>>()?;

        // Read where they were at the time of binding.
        let pointer = format!("{pointer}/inverseBindMatrices");
        let mut inverse_binds = match &json.inverse_bind_matrices {
            None => vec![DAffine3::IDENTITY; joints.len()],
            Some(accessor) => self.inverse_binds(accessor.value(), &pointer)?,
        };
        if inverse_binds.len() < joints.len() {
            let expected = format!("{} matrices, one a joint", joints.len());
            let got = inverse_binds.len().to_string();
            return Err(self.store.broken(pointer, expected, got, again));
        }
        inverse_binds.truncate(joints.len());
        Ok(Skin {
            joints,
            inverse_binds,
        })
    }

    fn inverse_binds(&self, accessor: usize, pointer: &str) -> Result<Vec<DAffine3>> {
        let made = |(index, matrix): (usize, [f32; 16])| {
            let last = [matrix[3], matrix[7], matrix[11], matrix[15] - 1.0];
            if last.iter().all(|number| number.abs() < ROUNDED) {
                let matrix = DMat4::from_cols_array(&matrix.map(f64::from));
                return Ok(DAffine3::from_mat4(matrix));
            }
            let expected = "matrices with 0, 0, 0, 1 as the last row";
            let got = format!("{matrix:?} as matrix {index}");
            let way_out = "export the file again";
            Err(self.store.broken(pointer.into(), expected, got, way_out))
        };
        let matrices = self.store.floats::<16>(accessor, pointer)?;
        matrices.into_iter().enumerate().map(made).collect()
    }

    /// The influences of a primitive's `count` positions, and whether positions have uneven weights; nothing where the
    /// primitive has no joints.
    pub(super) fn influences(
        &self,
        pointer: &str,
        json: &Primitive,
        count: usize,
    ) -> Result<Option<(Influences, bool)>> {
        // Read the sets side by side: JOINTS_0 and WEIGHTS_0, then 1, 2 …
        let mut sets: Vec<JointSet> = Vec::new();
        loop {
            let set = sets.len();
            let of = |semantic| json.attributes.get(&Checked::Valid(semantic));
            let pair = (
                of(Semantic::Joints(set as u32)),
                of(Semantic::Weights(set as u32)),
            );
            let [joints, weights] =
                ["JOINTS", "WEIGHTS"].map(|name| format!("{pointer}/attributes/{name}_{set}"));
            let (joints, weights) = match pair {
                (None, None) => break,
                (Some(j), Some(w)) => (
                    self.each(&joints, self.store.joints(j.value(), &joints)?, count)?,
                    self.each(
                        &weights,
                        self.store.floats::<4>(w.value(), &weights)?,
                        count,
                    )?,
                ),
                (Some(_), None) => return Err(self.lonely(weights, "weights for the joints")),
                (None, Some(_)) => return Err(self.lonely(joints, "joints for the weights")),
            };
            if let Some(at) = weights.iter().position(|w| w.iter().any(|w| *w < 0.0)) {
                let pointer = format!("{pointer}/attributes/WEIGHTS_{set}");
                let got = format!("{:?} at position {at}", weights[at]);
                let expected = "weights of at least 0";
                let way_out = "normalize the weights and export the file again";
                return Err(self.store.broken(pointer, expected, got, way_out));
            }
            sets.push((joints, weights));
        }
        Ok((!sets.is_empty()).then(|| join(&sets, count)))
    }

    /// Refuses an attribute that has not one value a position.
    pub(super) fn each<T>(&self, pointer: &str, values: Vec<T>, count: usize) -> Result<Vec<T>> {
        if values.len() == count {
            return Ok(values);
        }
        let expected = format!("{count} values, one per position");
        let got = values.len().to_string();
        let way_out = "export the file again";
        Err(self.store.broken(pointer.into(), expected, got, way_out))
    }

    fn lonely(&self, pointer: String, expected: &str) -> crate::error::Error {
        self.store.faulty(pointer, expected, "none")
    }

    /// Refuses influences of joints that a skin does not have.
    pub(super) fn check_joints(
        &self,
        pointer: &str,
        influences: &Influences,
        skin: &Skin,
    ) -> Result<()> {
        let most = influences.joints.iter().max().copied().unwrap_or(0);
        if usize::from(most) < skin.joints.len() {
            return Ok(());
        }
        let expected = format!(
            "a mesh that uses the {} joints of the skin",
            skin.joints.len()
        );
        let got = format!("joint {most} in its JOINTS");
        let way_out = "export the file again; mesh and skin do not belong together";
        Err(self.store.broken(pointer.into(), expected, got, way_out))
    }
}

/// The sets of each position one after the other, with weights that sum to 1, and whether some did not.
fn join(sets: &[JointSet], count: usize) -> (Influences, bool) {
    let each = 4 * sets.len();
    let mut influences = Influences {
        each,
        joints: Vec::with_capacity(count * each),
        weights: Vec::with_capacity(count * each),
    };
    let mut uneven = false;
    for position in 0..count {
        let sum: f64 = sets
            .iter()
            .flat_map(|(_, weights)| weights[position])
            .map(f64::from)
            .sum();
        uneven |= (sum - 1.0).abs() > UNEVEN;
        let first = influences.weights.len();
        for (joints, weights) in sets {
            for (joint, weight) in joints[position].iter().zip(weights[position]) {
                // A joint without weight may be any number: it must not be looked up.
                let pulls = weight > 0.0;
                influences.joints.push(if pulls { *joint } else { 0 });
                let share = if pulls { f64::from(weight) / sum } else { 0.0 };
                influences.weights.push(share);
            }
        }
        // What nothing pulls at hangs on the joint that is named first.
        if sum == 0.0 {
            influences.joints[first] = sets[0].0[position][0];
            influences.weights[first] = 1.0;
        }
    }
    (influences, uneven)
}

//! The form factors of all sides at one time: sampled rows, corrected where pairs lie close.

use super::near::Extras;
use super::prepared::Prepared;
use crate::ids::SideId;
use crate::mesh::PosedMesh;
use crate::solver::Rows;
use crate::visibility::Visibility;
use std::collections::BTreeMap;

/// Form factors, a row for each side.
pub struct FormFactors<'a> {
    prepared: &'a Prepared,
    view: &'a Visibility,
    /// The worth of a sample of each row: 1 / Σ of the weights that count, or less where near pairs have taken a part.
    pub share: Vec<f32>,
    extras: Extras,
}

impl<'a> FormFactors<'a> {
    /// The form factors of these hits, in this geometry.
    pub fn of(prepared: &'a Prepared, view: &'a Visibility, placed: &PosedMesh) -> FormFactors<'a> {
        let mut share = prepared.back.shares(view);
        let extras = Extras::of(prepared, view, placed, &mut share);
        FormFactors {
            prepared,
            view,
            share,
            extras,
        }
    }

    /// As the solver reads them.
    pub fn rows(&self) -> Rows<'_> {
        Rows {
            correction: self.extras.as_correction(),
            ..self.prepared.rows(self.view, &self.share)
        }
    }

    /// The form factors from a side to all sides that it sees, in the order of their numbers. They sum to 1, less what
    /// goes to the sky and to black surfaces.
    ///
    /// # Panics
    /// If there is no such side, or the settings keep no hits ([`Memory::Low`](crate::settings::Memory::Low)).
    pub fn row(&self, side: SideId) -> Vec<(SideId, f32)> {
        let (rows, side) = (self.rows(), side.index());
        let (weights, sides) = (rows.weights(side), rows.len() as u32);
        let mut factors = BTreeMap::<u32, f32>::new();
        for (k, hit) in rows.row(side).iter().enumerate() {
            if hit < sides {
                let weight = weights.get(k).copied().unwrap_or(1.0);
                *factors.entry(hit).or_default() += weight * self.share[side];
            }
        }
        for (other, added) in rows.correction.of(side) {
            *factors.entry(other).or_default() += added;
        }
        let sides = factors
            .into_iter()
            .map(|(side, factor)| (SideId::new(side), factor));
        sides.collect()
    }
}

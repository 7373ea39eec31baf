//! The form factors of all sides at one time: sampled rows, corrected where pairs lie close, and where samples go by way of
//! mirrors and glass.

use super::near::Extras;
use super::prepared::Prepared;
use crate::ids::SideId;
use crate::mesh::PosedMesh;
use crate::solver::{Radiosity, RowCorrection, Rows};
use crate::visibility::Visibility;
use crate::visibility::specular_factors::{SpecularFactors, SpecularRows};
use crate::visibility::translucent::{self, PlainRows, Sheet};
use glam::Vec3;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// The worth of a sample of each row, and the corrections of near pairs.
pub(super) fn shares(
    prepared: &Prepared,
    view: &Visibility,
    placed: &PosedMesh,
) -> (Vec<f32>, Extras) {
    let mut share = prepared.back.shares(view);
    let extras = Extras::of(prepared, view, placed, &mut share);
    (share, extras)
}

/// Form factors, a row for each side.
pub struct FormFactors<'a> {
    prepared: &'a Prepared,
    view: &'a Visibility,
    /// The worth of a sample of each row: 1 / Σ of the weights that count, or less where near pairs have taken a part.
    pub share: Vec<f32>,
    corrections: SpecularFactors,
    sheets: Vec<Sheet>,
    /// The corrections with the rows of translucent sheets mixed, where there are any.
    mixed: Option<SpecularFactors>,
}

impl<'a> FormFactors<'a> {
    /// The form factors of these hits, in this geometry.
    pub fn of(prepared: &'a Prepared, view: &'a Visibility, placed: &PosedMesh) -> FormFactors<'a> {
        let (share, extras) = shares(prepared, view, placed);
        let sides = prepared.patches.sides.len();
        let specular = SpecularFactors::of(&prepared.specular_rows(view), &share, sides);
        let mut factors = FormFactors {
            prepared,
            view,
            share,
            corrections: specular.after(extras.parts()),
            sheets: translucent::sheets(&prepared.patches, placed),
            mixed: None,
        };
        if !factors.sheets.is_empty() {
            let blocks = prepared.specular_rows(view);
            factors.mixed = Some(factors.plain(&blocks).mixed(&factors.sheets));
        }
        factors
    }

    fn plain<'b>(&'b self, blocks: &'b [SpecularRows<'b>]) -> PlainRows<'b> {
        PlainRows {
            blocks,
            share: &self.share,
            corrections: &self.corrections,
        }
    }

    /// Mixes what falls straight on the two sides of translucent sheets, as the solver takes it.
    pub fn mix(&self, direct: &mut [Vec3]) {
        translucent::mix(&self.sheets, direct);
    }

    /// Gives the sides of translucent sheets what falls on themselves alone, for pixels.
    pub fn part(&self, light: &mut Radiosity) {
        let blocks = self.prepared.specular_rows(self.view);
        let plain = self.plain(&blocks);
        let reflected = |side: u32| Vec3::from(light.reflected[side as usize]);
        let own = self.sheets.par_iter();
        let own: Vec<Vec3> = own
            .map(|sheet| plain.gather(sheet.side, reflected))
            .collect();
        for (sheet, own) in self.sheets.iter().zip(own) {
            light.indirect[sheet.side] = own;
        }
    }

    /// As the solver reads them: a translucent sheet's row is mixed with that of its other side.
    pub fn rows(&self) -> Rows<'_> {
        self.rows_with(self.mixed.as_ref().unwrap_or(&self.corrections))
    }

    fn rows_with<'b>(&'b self, corrections: &'b SpecularFactors) -> Rows<'b> {
        Rows {
            correction: RowCorrection {
                start: &corrections.start,
                patch: &corrections.side,
                factor: &corrections.factor,
            },
            ..self.prepared.rows(self.view, &self.share)
        }
    }

    /// The form factors from a side to all sides that it sees, in the order of their numbers. They sum to 1, less what
    /// goes to the sky and to black surfaces. A factor by way of mirrors and glass is the mean over the channels.
    ///
    /// # Panics
    /// If there is no such side, or the settings keep no hits ([`Memory::Low`](crate::settings::Memory::Low)).
    pub fn row(&self, side: SideId) -> Vec<(SideId, f32)> {
        let (rows, side) = (self.rows_with(&self.corrections), side.index());
        let (weights, sides) = (rows.weights(side), rows.len() as u32);
        let mut factors = BTreeMap::<u32, f32>::new();
        for (k, hit) in rows.row(side).iter().enumerate() {
            if hit < sides {
                let weight = weights.get(k).copied().unwrap_or(1.0);
                *factors.entry(hit).or_default() += weight * self.share[side];
            }
        }
        for (other, added) in rows.correction.of(side) {
            *factors.entry(other).or_default() += added.element_sum() / 3.0;
        }
        let sides = factors
            .into_iter()
            .map(|(side, factor)| (SideId::new(side), factor));
        sides.collect()
    }
}

//! Translucent sheets: a side of one sends on what falls on either of the two.
//!
//! H. E. Rushmeier, K. E. Torrance 1990, "Extending the radiosity method to include specularly reflecting and translucent
//! materials", ACM Transactions on Graphics 9(1):1–27: R_i = ρ_i I_i + τ_i I_o, with I_o the irradiance of the opposite side o.
//! With q = ρ + τ this is R_i = q (ρ/q I_i + τ/q I_o): a side of reflectance q, whose row of form factors and whose direct
//! light are mixtures of both sides'. So every solver takes it as it is, and its bounds hold, since rows of the mixture sum to
//! at most 1.

use super::specular_factors::{SpecularFactors, SpecularRows};
use crate::ids::SideId;
use crate::mesh::{PosedMesh, RadiosityMesh};
use glam::Vec3;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// A side of a sheet.
#[derive(Clone, Copy, Debug)]
pub struct Sheet {
    /// The side.
    pub side: SideId,
    /// The one behind it; none where no light can reach that.
    pub opposite: Option<SideId>,
    /// ρ/q and τ/q, RGB: what the irradiance of the side and of the opposite one count for.
    pub weights: [Vec3; 2],
}

/// All sides of translucent sheets in a pose, in order.
pub fn sheets(patches: &RadiosityMesh, placed: &PosedMesh) -> Vec<Sheet> {
    if !patches.any_translucent {
        return Vec::new();
    }
    let sheet = |side: SideId| {
        let surface = patches.surface_at(side);
        patches.surfaces[surface].transmission?;
        let reflectance = patches.reflectance(side) * placed.colors[surface];
        let transmittance = patches.transmittance(side);
        let sum = (reflectance + transmittance).max(Vec3::splat(f32::MIN_POSITIVE));
        let own = &patches.sides[side];
        Some(Sheet {
            side,
            opposite: patches.side_of[own.element][!own.back as usize],
            weights: [reflectance / sum, transmittance / sum],
        })
    };
    patches.side_ids().filter_map(sheet).collect()
}

/// Mixes what falls straight on the sides of sheets.
pub fn mix(sheets: &[Sheet], direct: &mut [Vec3]) {
    let mixed: Vec<Vec3> = sheets.iter().map(|sheet| mixture(sheet, direct)).collect();
    for (sheet, mixed) in sheets.iter().zip(mixed) {
        direct[sheet.side] = mixed;
    }
}

fn mixture(sheet: &Sheet, light: &[Vec3]) -> Vec3 {
    let [front, back] = sheet.weights;
    let behind = sheet.opposite.map_or(Vec3::ZERO, |side| light[side]);
    light[sheet.side] * front + behind * back
}

/// The rows of all sides as corrections know them.
pub struct PlainRows<'a> {
    /// Their samples, block after block.
    pub blocks: &'a [SpecularRows<'a>],
    /// The worth of a sample of each row.
    pub share: &'a [f32],
    /// The corrections of rows.
    pub corrections: &'a SpecularFactors,
}

impl PlainRows<'_> {
    /// The form factors of a row by side, RGB.
    fn row(&self, side: SideId) -> BTreeMap<u32, Vec3> {
        let (row, sides) = (side.index(), self.share.len());
        let mut at = row;
        let mut factors = BTreeMap::<u32, Vec3>::new();
        for block in self.blocks {
            let rows = block.hits.ids.rows();
            if at < rows {
                for (k, id) in block.hits.ids.row(at).iter().enumerate() {
                    if (id as usize) < sides {
                        let weight = block.weights.get(k).copied().unwrap_or(1.0);
                        *factors.entry(id).or_default() += Vec3::splat(weight * self.share[row]);
                    }
                }
                break;
            }
            at -= rows;
        }
        for (id, more) in self.corrections.of_row(row) {
            *factors.entry(id).or_default() += more;
        }
        factors
    }

    /// Irradiance that a side receives from all sides, given what they reflect.
    pub fn gather(&self, side: SideId, reflected: impl Fn(u32) -> Vec3) -> Vec3 {
        let row = self.row(side);
        row.into_iter()
            .map(|(j, factor)| reflected(j) * factor)
            .sum()
    }

    /// The corrections of rows with those of sheets in place of their own: they make a sheet's row the mixture of both sides'.
    pub fn mixed(&self, sheets: &[Sheet]) -> SpecularFactors {
        let rows = sheets.par_iter().map(|sheet| {
            let [front, back] = sheet.weights;
            let own = self.row(sheet.side);
            let behind = sheet
                .opposite
                .map(|side| self.row(side))
                .unwrap_or_default();
            // The samples' own part stays in the row: take away what was there before the mixture.
            let known: BTreeMap<u32, Vec3> = self.corrections.of_row(sheet.side.index()).collect();
            let mut more = BTreeMap::<u32, Vec3>::new();
            for (j, factor) in &own {
                let before = known.get(j).copied().unwrap_or_default();
                *more.entry(*j).or_default() += *factor * front - (*factor - before);
            }
            for (j, factor) in behind {
                *more.entry(j).or_default() += factor * back;
            }
            (sheet.side.index(), more)
        });
        let rows: Vec<(usize, BTreeMap<u32, Vec3>)> = rows.collect();
        let mut mixed = SpecularFactors {
            start: vec![0],
            ..SpecularFactors::default()
        };
        let mut rows = rows.into_iter().peekable();
        for row in 0..self.share.len() {
            let entries: Vec<(u32, Vec3)> = match rows.next_if(|(side, _)| *side == row) {
                Some((_, more)) => more.into_iter().collect(),
                None => self.corrections.of_row(row).collect(),
            };
            mixed.push(entries);
        }
        mixed
    }
}

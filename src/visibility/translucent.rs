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
    /// Irradiance that a side receives from all sides, given what they reflect.
    pub fn gather(&self, side: SideId, reflected: impl Fn(u32) -> Vec3) -> Vec3 {
        let mut sum = Vec3::ZERO;
        self.each_sample(side, |id, factor| sum += reflected(id) * factor);
        for (id, more) in self.corrections.of_row(side.index()) {
            sum += reflected(id) * more;
        }
        sum
    }

    /// Calls for each sample of a row that hits a side, with the factor that it adds.
    fn each_sample(&self, side: SideId, mut add: impl FnMut(u32, f32)) {
        let (row, sides) = (side.index(), self.share.len());
        let mut at = row;
        for block in self.blocks {
            let rows = block.hits.ids.rows();
            if at < rows {
                for (k, id) in block.hits.ids.row(at).iter().enumerate() {
                    if (id as usize) < sides {
                        let weight = block.weights.get(k).copied().unwrap_or(1.0);
                        add(id, weight * self.share[row]);
                    }
                }
                return;
            }
            at -= rows;
        }
    }

    /// What the row of a sheet's side takes on to become the mixture of both sides' rows. Its samples stay in it, so that
    /// they are taken away as far as they count less.
    fn mixture(&self, sheet: &Sheet, sum: &mut SparseRow) -> Vec<(u32, Vec3)> {
        let [front, back] = sheet.weights;
        self.each_sample(sheet.side, |id, factor| sum.add(id, factor * (front - 1.0)));
        for (id, more) in self.corrections.of_row(sheet.side.index()) {
            sum.add(id, more * front);
        }
        if let Some(opposite) = sheet.opposite {
            self.each_sample(opposite, |id, factor| sum.add(id, factor * back));
            for (id, more) in self.corrections.of_row(opposite.index()) {
                sum.add(id, more * back);
            }
        }
        sum.drain()
    }

    /// The corrections of rows with those of sheets in place of their own: they make a sheet's row the mixture of both sides'.
    pub fn mixed(&self, sheets: &[Sheet]) -> SpecularFactors {
        let chunks = sheets.par_chunks(SHEETS).map(|chunk| {
            let mut sum = SparseRow::of(self.share.len());
            let rows = chunk.iter().map(|sheet| self.mixture(sheet, &mut sum));
            rows.collect()
        });
        let chunks: Vec<Vec<Vec<(u32, Vec3)>>> = chunks.collect();
        let mut mixed = SpecularFactors {
            start: vec![0],
            ..SpecularFactors::default()
        };
        let mut rows = sheets.iter().zip(chunks.into_iter().flatten()).peekable();
        for row in 0..self.share.len() {
            match rows.next_if(|(sheet, _)| sheet.side.index() == row) {
                Some((_, more)) => mixed.push(more),
                None => mixed.push(self.corrections.of_row(row).collect()),
            }
        }
        mixed
    }
}

/// Sheets whose rows one task mixes.
const SHEETS: usize = 64;

/// A row that is added up, and which places of it something was added to, in the order of the first times.
struct SparseRow {
    factor: Vec<Vec3>,
    touched: Vec<u32>,
    is_touched: Vec<bool>,
}

impl SparseRow {
    fn of(sides: usize) -> SparseRow {
        SparseRow {
            factor: vec![Vec3::ZERO; sides],
            touched: Vec::new(),
            is_touched: vec![false; sides],
        }
    }

    fn add(&mut self, side: u32, factor: Vec3) {
        let at = side as usize;
        if !self.is_touched[at] {
            self.is_touched[at] = true;
            self.touched.push(side);
        }
        self.factor[at] += factor;
    }

    /// The entries; the row is empty again.
    fn drain(&mut self) -> Vec<(u32, Vec3)> {
        let entries = self.touched.drain(..).map(|side| {
            self.is_touched[side as usize] = false;
            (side, std::mem::take(&mut self.factor[side as usize]))
        });
        entries.collect()
    }
}

//! Radiosity of all rows as hit ids find it: a table that a row's samples look up by thousands.
//!
//! For ids of 16 bits the table has a place for each that there can be, so that none needs to be compared with its length:
//! three instructions a sample, half of what they are otherwise.

use super::rows::{Rows, sum};
use glam::{DVec3, Vec3A};

/// Ids of 16 bits.
const IDS: usize = 1 << 16;

/// R of each row in 32 bits; darkness wherever ids are misses.
#[derive(Clone, Debug)]
pub(super) enum GatherTable {
    /// A place for every id of 16 bits.
    Narrow(Box<[Vec3A; IDS]>),
    /// A place for each row, and one behind them for all other ids.
    Wide(Vec<Vec3A>),
}

impl Default for GatherTable {
    fn default() -> GatherTable {
        GatherTable::Wide(Vec::new())
    }
}

impl GatherTable {
    /// A table for a few rows to look up.
    pub(super) fn short(light: &[DVec3]) -> GatherTable {
        let light = light.iter().map(|r| r.as_vec3a());
        GatherTable::Wide(light.chain([Vec3A::ZERO]).collect())
    }

    /// Takes the light of these rows instead of the old one, of no more rows, for all to look up.
    pub(super) fn take(&mut self, rows: &Rows, light: &[DVec3]) {
        let narrow = rows.blocks.iter().all(|block| block.high.is_empty());
        let fits = narrow && light.len() <= IDS;
        if fits && !matches!(self, GatherTable::Narrow(_)) {
            let none = vec![Vec3A::ZERO; IDS].into_boxed_slice();
            if let Ok(none) = none.try_into() {
                *self = GatherTable::Narrow(none);
            }
        }
        match self {
            GatherTable::Narrow(all) if fits => {
                let all = all.iter_mut().zip(light);
                all.for_each(|(to, r)| *to = r.as_vec3a());
            }
            _ => *self = GatherTable::short(light),
        }
    }

    /// H of a row whose samples weigh the same.
    #[inline]
    pub(super) fn gather(&self, rows: &Rows, row: usize) -> DVec3 {
        let all = match self {
            GatherTable::Narrow(light) => sum(rows.row(row), |id| light[id]),
            GatherTable::Wide(light) => {
                let miss = light.len() - 1;
                sum(rows.row(row), |id| light[id.min(miss)])
            }
        };
        (all * rows.share[row]).as_dvec3()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::visibility::packed_ids::PackedIds;

    #[test]
    fn answers_of_16_bits_and_of_32_find_the_same_light() {
        // Seven samples of two rows; 65,535 and 70,000 are nothing.
        let light = [DVec3::new(1.0, 2.0, 3.0), DVec3::splat(0.5)];
        let ids = [0, 1, 1, 0, 65_535, 1, 0, 1, 1, 1, 65_535, 65_535, 0, 0];
        let mut wider = ids;
        wider[4] = 70_000;
        for ids in [ids, wider] {
            let ids = PackedIds::of(7, &ids);
            let rows = Rows {
                count: &[7, 6],
                ..Rows::of(&ids, &[0.25, 1.0])
            };
            let mut seen = GatherTable::default();
            // Something else was there before.
            seen.take(&rows, &[DVec3::ONE; 2]);
            seen.take(&rows, &light);
            assert_eq!(matches!(seen, GatherTable::Wide(_)), !ids.high.is_empty());
            for seen in [seen, GatherTable::short(&light)] {
                let expected = 3.0 * light[0] + 3.0 * light[1];
                assert_eq!(seen.gather(&rows, 0), expected * 0.25);
                assert_eq!(seen.gather(&rows, 1), light[0] + 3.0 * light[1]);
            }
        }
    }
}

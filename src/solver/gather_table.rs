//! The light of all rows as answers find it: a table that a row's samples look up by thousands.
//!
//! Of answers of 16 bits the table has a place for each that there can be, so that none needs to be compared with its
//! length: three instructions a sample, half of what they are otherwise.

use super::redistribution::Sampled;
use crate::visibility::packed_ids::Row;
use glam::{DVec3, Vec4};

/// Numbers of 16 bits.
const NUMBERS: usize = 1 << 16;

/// R of each row in 32 bits, RGB and 0; darkness wherever answers are nothing.
#[derive(Clone, Debug)]
pub(super) enum GatherTable {
    /// A place for every answer of 16 bits.
    Narrow(Box<[[f32; 4]; NUMBERS]>),
    /// A place for each row, and one behind them for all other answers.
    Wide(Vec<[f32; 4]>),
}

impl Default for GatherTable {
    fn default() -> GatherTable {
        GatherTable::Wide(Vec::new())
    }
}

impl GatherTable {
    /// The light of rows, for a few to look at.
    pub(super) fn short(light: &[DVec3]) -> GatherTable {
        GatherTable::Wide(light.iter().map(thin).chain([[0.0; 4]]).collect())
    }

    /// Takes the light of these rows instead of what was there, of no more of them, for all to look at.
    pub(super) fn take(&mut self, rows: &Sampled, light: &[DVec3]) {
        let fits = rows.ids.high.is_empty() && light.len() <= NUMBERS;
        if fits && !matches!(self, GatherTable::Narrow(_)) {
            let none = vec![[0.0; 4]; NUMBERS].into_boxed_slice();
            if let Ok(none) = none.try_into() {
                *self = GatherTable::Narrow(none);
            }
        }
        match self {
            GatherTable::Narrow(all) if fits => {
                all.iter_mut().zip(light).for_each(|(to, r)| *to = thin(r))
            }
            _ => *self = GatherTable::short(light),
        }
    }

    /// H of a row: the light at its answers, added up in four strands.
    #[inline]
    pub(super) fn by(&self, rows: &Sampled, row: usize) -> DVec3 {
        let sum = match self {
            GatherTable::Narrow(light) => narrow(light, rows.row(row).low),
            GatherTable::Wide(light) => wide(light, rows.row(row)),
        };
        (sum.truncate() * rows.share[row]).as_dvec3()
    }
}

fn thin(light: &DVec3) -> [f32; 4] {
    light.as_vec3().extend(0.0).to_array()
}

fn narrow(light: &[[f32; 4]; NUMBERS], answers: &[u16]) -> Vec4 {
    let mut strands = [Vec4::ZERO; 4];
    let (fours, rest) = answers.as_chunks::<4>();
    for four in fours {
        for (strand, id) in strands.iter_mut().zip(four) {
            *strand += Vec4::from_array(light[*id as usize]);
        }
    }
    for id in rest {
        strands[0] += Vec4::from_array(light[*id as usize]);
    }
    (strands[0] + strands[1]) + (strands[2] + strands[3])
}

fn wide(light: &[[f32; 4]], answers: Row) -> Vec4 {
    let nothing = light.len() - 1;
    let at = |k: usize| Vec4::from_array(light[(answers.get(k) as usize).min(nothing)]);
    let mut strands = [Vec4::ZERO; 4];
    let whole = answers.len() / 4 * 4;
    for first in (0..whole).step_by(4) {
        for (lane, strand) in strands.iter_mut().enumerate() {
            *strand += at(first + lane);
        }
    }
    for k in whole..answers.len() {
        strands[0] += at(k);
    }
    (strands[0] + strands[1]) + (strands[2] + strands[3])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::visibility::packed_ids::Answers;

    #[test]
    fn answers_of_16_bits_and_of_32_find_the_same_light() {
        // Seven samples of two rows; 65,535 and 70,000 are nothing.
        let light = [DVec3::new(1.0, 2.0, 3.0), DVec3::splat(0.5)];
        let ids = [0, 1, 1, 0, 65_535, 1, 0, 1, 1, 1, 65_535, 65_535, 0, 0];
        let mut wider = ids;
        wider[4] = 70_000;
        for ids in [ids, wider] {
            let ids = Answers::of(7, &ids);
            let rows = Sampled {
                ids: &ids,
                count: &[7, 6],
                share: &[0.25, 1.0],
            };
            let mut seen = GatherTable::default();
            // Something else was there before.
            seen.take(&rows, &[DVec3::ONE; 2]);
            seen.take(&rows, &light);
            assert_eq!(matches!(seen, GatherTable::Wide(_)), !ids.high.is_empty());
            for seen in [seen, GatherTable::short(&light)] {
                let expected = 3.0 * light[0] + 3.0 * light[1];
                assert_eq!(seen.by(&rows, 0), expected * 0.25);
                assert_eq!(seen.by(&rows, 1), light[0] + 3.0 * light[1]);
            }
        }
    }
}

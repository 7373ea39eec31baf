//! Where light can arrive: rows that no light can reach take no part in a solve.
//!
//! A row is lit where it reflects direct light, or sees a row that is lit. All others have R = 0, whatever they reflect:
//! the insides of closed things, for which a reflectance of 1 would leave the equation without a single solution. Each
//! channel is found apart. This is a breadth-first search through the samples, of which a lit row reads few.

use super::rows::Rows;
use super::solution::System;
use glam::{BVec3, Vec3};
use rayon::prelude::*;

/// Rows that one task looks at.
const CHUNK: usize = 256;

/// Reflectance of each row in the channels in which light can arrive, and 0 in the others.
pub(super) fn lit_reflectance(rows: &Rows, system: System) -> Vec<Vec3> {
    let reflects: Vec<u8> = system.reflectance.iter().map(|r| channels(*r)).collect();
    let direct = system.direct.iter().map(|light| channels(*light));
    let mut lit: Vec<u8> = direct.zip(&reflects).map(|(d, r)| d & r).collect();
    loop {
        let look = |row: usize| {
            let wanted = reflects[row];
            let mut found = lit[row];
            if found != wanted {
                found |= seen(rows, row, &lit, wanted) & wanted;
            }
            found
        };
        let all = (0..lit.len()).into_par_iter().with_min_len(CHUNK);
        let next: Vec<u8> = all.map(look).collect();
        if next == lit {
            break;
        }
        lit = next;
    }
    let all = system.reflectance.iter().zip(&lit);
    all.map(|(reflectance, lit)| {
        let mask = BVec3::new(lit & 1 != 0, lit & 2 != 0, lit & 4 != 0);
        Vec3::select(mask, *reflectance, Vec3::ZERO)
    })
    .collect()
}

/// A bit for each channel that is not 0.
fn channels(light: Vec3) -> u8 {
    light.cmpne(Vec3::ZERO).bitmask() as u8
}

/// The channels that are lit in what a row sees; it looks no further than `wanted`.
fn seen(rows: &Rows, row: usize, lit: &[u8], wanted: u8) -> u8 {
    let of = |j: u32| lit.get(j as usize).copied().unwrap_or(0);
    let mut found = 0;
    let corrected = rows.correction.of(row);
    let corrected = corrected
        .filter(|(_, more)| more.max_element() > 0.0)
        .map(|(j, _)| j);
    for j in rows.row(row).iter().chain(corrected) {
        found |= of(j);
        if found & wanted == wanted {
            break;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::visibility::packed_ids::PackedIds;

    /// 0 sees 1, 1 sees 2, 2 sees nothing; 3 and 4 see each other alone. Light falls on 2, red alone; 0 is black in blue.
    #[test]
    fn light_goes_as_far_as_rows_see_each_other() {
        let ids = PackedIds::of(1, &[1, 2, 9, 4, 3]);
        let share = [1.0; 5];
        let white = Vec3::ONE;
        let system = System {
            area: &share,
            direct: &[Vec3::Z, Vec3::ZERO, Vec3::X, Vec3::ZERO, Vec3::ZERO],
            reflectance: &[Vec3::new(0.5, 0.5, 0.0), white, white, white, white],
        };
        let lit = lit_reflectance(&Rows::of(&ids, &share), system);
        let red = Vec3::X;
        assert_eq!(lit, [0.5 * red, red, red, Vec3::ZERO, Vec3::ZERO]);
    }
}

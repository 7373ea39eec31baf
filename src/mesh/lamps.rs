//! Lamps: the parts of an emitting surface that lie far apart. Each has a shadow of its own, though one mesh holds all of them, as
//! where a row of ceiling lights was joined into one object.

use super::union_find::DisjointSets;
use crate::geometry::Bounds;
use glam::Vec3;

/// The most lamps of a surface; one with more is a lamp by itself.
const MOST: usize = 16;

/// The most pieces that are looked at: bulbs of a chandelier may lie close together, and are one lamp.
const MOST_PIECES: usize = 256;

/// A connected piece: the lowest corner that it was joined to, its triangles, and a box around them.
type Piece = (usize, Vec<u32>, Bounds);

/// The triangles of each lamp, by their places in the list; nothing where all of them are one.
///
/// Triangles that share a corner's place belong together, and so do pieces that lie no farther apart than the larger is long.
pub(super) fn lamps(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec<u32>> {
    let mut places: Vec<u32> = (0..positions.len() as u32).collect();
    let bits = |at: &u32| (positions[*at as usize] + 0.0).to_array().map(f32::to_bits);
    places.sort_unstable_by_key(bits);
    let mut joined = DisjointSets::new(positions.len());
    for pair in places.windows(2) {
        if bits(&pair[0]) == bits(&pair[1]) {
            joined.join(pair[0] as usize, pair[1] as usize);
        }
    }
    for [a, b, c] in triangles {
        joined.join(*a as usize, *b as usize);
        joined.join(*a as usize, *c as usize);
    }
    let mut pieces: Vec<Piece> = Vec::new();
    for (number, corners) in (0..).zip(triangles) {
        let root = joined.root(corners[0] as usize);
        let bounds = Bounds::of_points(corners.map(|corner| positions[corner as usize]));
        match pieces.iter().position(|(known, ..)| *known == root) {
            Some(at) => {
                let (_, numbers, all) = &mut pieces[at];
                numbers.push(number);
                *all = all.union(bounds);
            }
            None if pieces.len() == MOST_PIECES => return Vec::new(),
            None => pieces.push((root, vec![number], bounds)),
        }
    }
    while let Some((one, other)) = close_pair(&pieces) {
        let (_, numbers, bounds) = pieces.remove(other);
        let (_, all, around) = &mut pieces[one];
        all.extend(numbers);
        *around = around.union(bounds);
    }
    match pieces.len() {
        2..=MOST => pieces.into_iter().map(|(_, numbers, _)| numbers).collect(),
        _ => Vec::new(),
    }
}

/// The first two pieces that lie no farther apart than the larger is long.
fn close_pair(pieces: &[Piece]) -> Option<(usize, usize)> {
    let close = |one: &Bounds, other: &Bounds| {
        let gap = (other.lo - one.hi).max(one.lo - other.hi).max(Vec3::ZERO);
        let long = |b: &Bounds| (b.hi - b.lo).length();
        gap.length() <= long(one).max(long(other))
    };
    (0..pieces.len()).find_map(|one| {
        let mut others = one + 1..pieces.len();
        let other = others.find(|other| close(&pieces[one].2, &pieces[*other].2))?;
        Some((one, other))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Squares of a metre on the ground, each with corners of its own.
    fn squares(at: &[f32]) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        for x in at {
            // The two halves share no index.
            for half in [[0, 1, 2], [0, 2, 3]] {
                let first = positions.len() as u32;
                triangles.push([first, first + 1, first + 2]);
                positions
                    .extend(half.map(|k: usize| Vec3::new(x + corners[k][0], 0.0, corners[k][1])));
            }
        }
        (positions, triangles)
    }

    #[test]
    fn what_lies_apart_is_a_lamp_of_its_own() {
        // The second and the third lie half a metre apart: they are one.
        let (positions, triangles) = squares(&[0.0, 5.0, 6.5, 12.0]);
        let found = lamps(&positions, &triangles);
        assert_eq!(found, [vec![0, 1], vec![2, 3, 4, 5], vec![6, 7]]);
    }

    #[test]
    fn one_lamp_and_too_many_are_not_parted() {
        for many in [1, MOST + 1, MOST_PIECES + 1] {
            let at: Vec<f32> = (0..many).map(|k| 9.0 * k as f32).collect();
            let (positions, triangles) = squares(&at);
            assert!(lamps(&positions, &triangles).is_empty(), "{many}");
        }
    }
}

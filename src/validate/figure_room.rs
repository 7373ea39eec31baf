//! A furnished room of the project's own, whose form factors are closed forms times a visibility by a few fixed rays.
//!
//! All surfaces are rectangles along the axes on one grid, so that none reaches through another's plane, and
//! [`rectangles`] gives each pair's exchange. Factors are found pair by pair when they are asked for, the same from both ends:
//! so gathering and shooting solve one and the same matrix.

use crate::formfactor::rectangles::{self, Rectangle};
use glam::DVec3;
use rayon::prelude::*;

/// Size of the room in metres.
const ROOM: DVec3 = DVec3::new(6.0, 3.0, 4.0);

/// A table, a cupboard and a chest: where they begin, and their sizes, on a grid of half metres.
const BLOCKS: [(DVec3, DVec3); 3] = [
    (DVec3::new(1.5, 0.0, 1.0), DVec3::new(1.5, 1.0, 1.0)),
    (DVec3::new(4.5, 0.0, 0.0), DVec3::new(1.5, 2.0, 0.5)),
    (DVec3::new(4.0, 0.0, 2.5), DVec3::new(0.5, 0.5, 1.0)),
];

/// Where the lamp is on the ceiling: from and to, along x and z.
const LAMP: [[f64; 2]; 2] = [[2.0, 4.0], [1.5, 2.5]];

/// What the lamp emits, as a radiosity.
const EMISSION: DVec3 = DVec3::new(30.0, 26.0, 20.0);

/// Reflectances: of the lamp, the floor, the ceiling, two walls, the other two, and the furniture.
const LAMP_WHITE: DVec3 = DVec3::splat(0.6);
const FLOOR: DVec3 = DVec3::new(0.45, 0.35, 0.25);
const WHITE: DVec3 = DVec3::splat(0.8);
const RED: DVec3 = DVec3::new(0.65, 0.2, 0.15);
const WOOD: DVec3 = DVec3::new(0.5, 0.35, 0.2);

/// Points of each end of a ray between two tiles, as shares of their sides; the n-th of one sees the n-th of the other.
const ENDS: [[f64; 2]; 4] = [[0.25, 0.3], [0.7, 0.2], [0.3, 0.75], [0.8, 0.7]];

/// Rays end so much before their tiles, as a share of their length, so that no block stops a ray to its own face.
const SHORT: f64 = 1e-6;

/// A tile of the room.
#[derive(Clone, Copy, Debug)]
pub struct RoomTile {
    /// Its place.
    pub rectangle: Rectangle,
    /// Its area in m².
    pub area: f64,
    /// Its reflectance.
    pub reflectance: DVec3,
    /// Its emitted radiosity.
    pub emission: DVec3,
}

/// The tiles of the room, with edges of `edge` metres, of which half a metre is a multiple.
pub fn tiles(edge: f64) -> Vec<RoomTile> {
    let inside = box_tiles(DVec3::ZERO, ROOM, edge, true);
    let open = inside.into_iter().filter(|tile| !is_covered(tile));
    let furniture = BLOCKS
        .iter()
        .flat_map(|(low, size)| box_tiles(*low, *size, edge, false));
    // What stands on the floor or against a wall has no face there.
    let free = |tile: &Rectangle| tile.at > 0.0 && tile.at < ROOM[tile.axis];
    let furniture = furniture.filter(|tile| free(tile) && !is_covered(tile));
    let of_room = open.map(|rectangle| finished(rectangle, false));
    of_room
        .chain(furniture.map(|rectangle| finished(rectangle, true)))
        .collect()
}

/// A tile with its paint.
fn finished(rectangle: Rectangle, furniture: bool) -> RoomTile {
    let middle = point(&rectangle, [0.5, 0.5]);
    let within = |[from, to]: [f64; 2], x: f64| from < x && x < to;
    let lamp = !furniture
        && rectangle.axis == 1
        && rectangle.down
        && within(LAMP[0], middle.x)
        && within(LAMP[1], middle.z);
    let reflectance = match (furniture, lamp, rectangle.axis, rectangle.down) {
        (true, ..) => WOOD,
        (_, true, ..) => LAMP_WHITE,
        (_, _, 1, false) => FLOOR,
        (_, _, 0, false) => RED,
        _ => WHITE,
    };
    RoomTile {
        rectangle,
        area: rectangle.area(),
        reflectance,
        emission: if lamp { EMISSION } else { DVec3::ZERO },
    }
}

/// The tiles of a box, their fronts inside or outside.
fn box_tiles(low: DVec3, size: DVec3, edge: f64, inside: bool) -> Vec<Rectangle> {
    let mut tiles = Vec::new();
    for face in 0..6 {
        let (axis, far) = (face % 3, face >= 3);
        let along = [(axis + 1) % 3, (axis + 2) % 3];
        let cuts = along.map(|axis| (size[axis] / edge).round() as usize);
        let span = |which: usize, k: usize| [k, k + 1].map(|k| low[along[which]] + edge * k as f64);
        for tile in 0..cuts[0] * cuts[1] {
            tiles.push(Rectangle {
                axis,
                at: low[axis] + if far { size[axis] } else { 0.0 },
                down: far == inside,
                spans: [span(0, tile % cuts[0]), span(1, tile / cuts[0])],
            });
        }
    }
    tiles
}

/// Whether a block lies right before a tile.
fn is_covered(tile: &Rectangle) -> bool {
    let ahead = point(tile, [0.5, 0.5]) + normal(tile) * 1e-3;
    BLOCKS
        .iter()
        .any(|(low, size)| ahead.cmpgt(*low).all() && ahead.cmplt(*low + *size).all())
}

/// The unit normal of a tile's front.
fn normal(tile: &Rectangle) -> DVec3 {
    let mut normal = DVec3::ZERO;
    normal[tile.axis] = if tile.down { -1.0 } else { 1.0 };
    normal
}

/// The point at these shares of a tile's sides.
fn point(tile: &Rectangle, shares: [f64; 2]) -> DVec3 {
    let mut point = DVec3::ZERO;
    point[tile.axis] = tile.at;
    for (which, share) in shares.into_iter().enumerate() {
        let [from, to] = tile.spans[which];
        point[(tile.axis + 1 + which) % 3] = from + (to - from) * share;
    }
    point
}

/// Area × form factor in m² between two tiles, times their visible share; the same from either end.
pub fn exchange(p: &Rectangle, q: &Rectangle) -> f64 {
    if !rises(p, q) || !rises(q, p) {
        return 0.0;
    }
    let free = |ends: &[f64; 2]| u32::from(is_free(point(p, *ends), point(q, *ends)));
    let seen: u32 = ENDS.iter().map(free).sum();
    match seen {
        0 => 0.0,
        seen => rectangles::exchange(p, q) * f64::from(seen) / ENDS.len() as f64,
    }
}

/// Whether a tile rises before another's front.
fn rises(tile: &Rectangle, over: &Rectangle) -> bool {
    let corners = tile.corners();
    let height = |corner: &DVec3| (corner[over.axis] - over.at) * normal(over)[over.axis];
    corners.iter().map(height).fold(0.0, f64::max) > 0.0
}

/// Whether no block stands between two points.
fn is_free(from: DVec3, to: DVec3) -> bool {
    let way = to - from;
    let inside = |(low, size): &(DVec3, DVec3)| {
        // The slabs of a box (Kay, Kajiya 1986).
        let (mut near, mut far) = (SHORT, 1.0 - SHORT);
        for axis in 0..3 {
            let [a, b] = [low[axis], low[axis] + size[axis]].map(|plane| plane - from[axis]);
            if way[axis] == 0.0 {
                if a >= 0.0 || b <= 0.0 {
                    return false;
                }
                continue;
            }
            let (a, b) = (a / way[axis], b / way[axis]);
            near = near.max(a.min(b));
            far = far.min(a.max(b));
        }
        far - near > SHORT
    };
    !BLOCKS.iter().any(inside)
}

/// The exchange of one tile with all, found anew.
pub fn exchanges(tiles: &[RoomTile], i: usize) -> Vec<f64> {
    let of = |(j, tile): (usize, &RoomTile)| match j == i {
        true => 0.0,
        // Both orders are the same to rounding; take the same one of them.
        false if j < i => exchange(&tile.rectangle, &tiles[i].rectangle),
        false => exchange(&tiles[i].rectangle, &tile.rectangle),
    };
    tiles
        .par_iter()
        .enumerate()
        .with_min_len(64)
        .map(of)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_fill_the_room_and_its_furniture() {
        let all = tiles(0.5);
        let area: f64 = all.iter().map(|tile| tile.area).sum();
        // The room has 108 m². Of the table's 1.5 m² on the floor, of the cupboard's 0.75 on it, 3 + 1 on walls and of the chest's
        // ½ nothing is left, and as much is hidden of the blocks; their other faces are 1.5 + 5, 0.75 + 3 + 1 and 0.5 + 1.5.
        let covered = 1.5 + (0.75 + 3.0 + 1.0) + 0.5;
        assert!(
            (area - (108.0 - covered + 6.5 + 4.75 + 2.0)).abs() < 1e-9,
            "{area}"
        );
        let lamp: f64 = all
            .iter()
            .filter(|t| t.emission.x > 0.0)
            .map(|t| t.area)
            .sum();
        assert!((lamp - 2.0).abs() < 1e-9, "{lamp}");
    }

    /// The room is closed: what a tile sees sums to 1, but for the few rays that speak for what is half hidden.
    #[test]
    fn rows_sum_to_one_about() {
        let all = tiles(0.5);
        let mut mean = 0.0;
        for (i, tile) in all.iter().enumerate() {
            let sum: f64 = exchanges(&all, i).iter().sum::<f64>() / tile.area;
            assert!((0.85..1.15).contains(&sum), "{i}: {sum}");
            mean += sum / all.len() as f64;
        }
        assert!((mean - 1.0).abs() < 0.01, "{mean}");
    }

    #[test]
    fn blocks_stop_rays() {
        let table = DVec3::new(2.0, 0.5, 1.5);
        assert!(!is_free(table - DVec3::X * 1.5, table + DVec3::X * 1.5));
        assert!(is_free(table + DVec3::Y, table + DVec3::Y + DVec3::X));
        // From the table's own top a ray goes up.
        assert!(is_free(
            DVec3::new(2.0, 1.0, 1.5),
            DVec3::new(2.5, 3.0, 1.7)
        ));
    }
}

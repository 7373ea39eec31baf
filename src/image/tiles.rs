//! Tiles of pixels, among which gathering samples are dealt: the pixels of a tile have parts of one set, neighbouring tiles
//! different sets.
//!
//! Keller, Heidrich 2001, "Interleaved sampling", Eurographics Workshop on Rendering.

/// Pixels along a tile that share one set.
const TILE: u32 = 4;

/// Tiles along a block, each with a set of its own: no filter reaches the same set twice in a row or column.
const BLOCK: u32 = 8;

/// Pixels of a tile.
pub(super) const PIXELS: u32 = TILE * TILE;

/// Tiles of a block.
pub(super) const TILES: u32 = BLOCK * BLOCK;

/// The number of a pixel among those of its block, tile by tile.
pub(super) fn number(index: u32, width: u32) -> usize {
    let (x, y) = (index % width, index / width);
    let tile = y / TILE % BLOCK * BLOCK + x / TILE % BLOCK;
    (tile * PIXELS + y % TILE * TILE + x % TILE) as usize
}

/// A pixel's part of what is dealt to a block.
pub(super) fn of_pixel<T>(block: &[T], number: usize) -> &[T] {
    let each = block.len() / (PIXELS * TILES) as usize;
    &block[number * each..(number + 1) * each]
}

/// What is dealt to a tile, of any number.
pub(super) fn of_tile<T>(block: &[T], number: u32) -> &[T] {
    let each = block.len() / TILES as usize;
    let tile = (number % TILES) as usize;
    &block[tile * each..(tile + 1) * each]
}

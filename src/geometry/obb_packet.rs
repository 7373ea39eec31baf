//! OBBs against packets of sixteen rays, one from each origin of a receiver, in vector lanes.
//!
//! The test is that of [`LocalObb::touches`], lane by lane. It serves where most rays miss and only those that do not are
//! wanted.

use super::obb::LocalObb;

/// Rays of a packet.
pub const PACKET: usize = 16;

/// A box in a receiver's frame, relative to each of its origins, in vector lanes.
#[derive(Clone, Debug)]
pub struct ObbPacket16 {
    /// Rotation from the receiver's frame to the box's axes, by rows.
    turn: [[f32; 3]; 3],
    /// From each origin to the lower and to the upper end of the box, along its axes, in metres.
    lo: [[f32; PACKET]; 3],
    hi: [[f32; PACKET]; 3],
}

impl ObbPacket16 {
    /// Spreads a box over the lanes.
    pub fn of(seen: &LocalObb<PACKET>) -> ObbPacket16 {
        let apart = |from: &dyn Fn(usize, usize) -> f32| {
            std::array::from_fn(|axis| std::array::from_fn(|origin| from(axis, origin)))
        };
        ObbPacket16 {
            turn: std::array::from_fn(|row| std::array::from_fn(|col| seen.turn.col(col)[row])),
            lo: apart(&|axis, origin| seen.lo[axis] - seen.origins[origin][axis]),
            hi: apart(&|axis, origin| seen.hi[axis] - seen.origins[origin][axis]),
        }
    }
}

/// Clears the bits of those samples of a receiver whose rays miss all boxes before the distance in `tmax`. `directions`
/// are in the receiver's frame, one list an axis; packets without a set bit are skipped. The bit of a ray that would hit a
/// triangle inside a box always stays.
#[multiversion::multiversion(targets("x86_64+avx2"))]
pub fn clear_misses(
    boxes: &[ObbPacket16],
    directions: [&[f32]; 3],
    tmax: &[f32],
    bits: &mut [u64],
) {
    let [x, y, z] = directions.map(|axis| axis.as_chunks::<PACKET>().0);
    let tmax = tmax.as_chunks::<PACKET>().0;
    let blocks = x.iter().zip(y).zip(z).zip(tmax);
    for (block, (((x, y), z), tmax)) in blocks.enumerate() {
        let (word, shift) = (block / 4, block % 4 * PACKET);
        if bits[word] >> shift & BLOCK == 0 {
            continue;
        }
        let mut kept = 0u64;
        for one in boxes {
            let (mut entry, mut exit) = ([0.0f32; PACKET], [f32::INFINITY; PACKET]);
            for axis in 0..3 {
                let ([a, b, c], lo, hi) = (one.turn[axis], &one.lo[axis], &one.hi[axis]);
                for k in 0..PACKET {
                    let along = a * x[k] + b * y[k] + c * z[k];
                    // Keep reciprocals finite.
                    let along = 1.0 / if along.abs() < LEAST { LEAST } else { along };
                    let (first, second) = (lo[k] * along, hi[k] * along);
                    let (near, far) = match first < second {
                        true => (first, second),
                        false => (second, first),
                    };
                    entry[k] = if near > entry[k] { near } else { entry[k] };
                    exit[k] = if far < exit[k] { far } else { exit[k] };
                }
            }
            // Most packets miss: only for the others load the rays' lengths, which lie elsewhere in memory.
            if which(&entry, &exit) != 0 {
                let ends = std::array::from_fn(|k| exit[k].min(tmax[k]));
                kept |= which(&entry, &ends);
            }
        }
        bits[word] &= !(BLOCK << shift) | kept << shift;
    }
}

/// A bit for each lane that begins before it ends.
#[inline(always)]
fn which(entry: &[f32; PACKET], exit: &[f32; PACKET]) -> u64 {
    let lanes: [u32; PACKET] = std::array::from_fn(|k| u32::from(entry[k] <= exit[k]) << k);
    u64::from(lanes.iter().fold(0, |all, lane| all | lane))
}

/// The bits of one packet.
const BLOCK: u64 = (1 << PACKET) - 1;

/// Direction components below this count as this.
const LEAST: f32 = super::obb::LEAST_COMPONENT;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Obb;
    use crate::geometry::obb::Axes;
    use glam::Vec3;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::property::config(256))]

        #[test]
        fn sixteen_at_once_are_each_alone(
            corners in prop::array::uniform3(prop::array::uniform3(-3.0f32..3.0)),
            origins in prop::array::uniform16(prop::array::uniform3(-4.0f32..4.0)),
            directions in prop::array::uniform16(prop::array::uniform3(-1.0f32..1.0)),
            tmax in prop::array::uniform16(0.0f32..9.0),
        ) {
            let triangles = [corners.map(Vec3::from)];
            let oriented = Obb::around(&triangles, Axes::fitting(&triangles));
            let origins = origins.map(Vec3::from);
            let seen = oriented.seen_from([Vec3::X, Vec3::Y, Vec3::Z], &origins);
            let directions = directions.map(|d| Vec3::from(d).normalize_or(Vec3::Z));
            let apart: [Vec<f32>; 3] = std::array::from_fn(|axis| directions.iter().map(|d| d[axis]).collect());
            let mut bits = [0xffff];
            clear_misses(&[ObbPacket16::of(&seen)], apart.each_ref().map(Vec::as_slice), &tmax, &mut bits);
            for k in 0..PACKET {
                // Rounding differs by a few units: a box a little larger and a little smaller than this one must agree.
                let touches = |tmax: f32| seen.touches(k, directions[k], tmax);
                let (sooner, later) = (touches(tmax[k] * 0.9999), touches(tmax[k] * 1.0001));
                if sooner == later {
                    prop_assert_eq!(bits[0] >> k & 1 == 1, sooner);
                }
            }
        }
    }
}

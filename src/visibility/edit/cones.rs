//! Which of a receiver's hemisphere samples may go towards a thing: a hierarchy over directions.
//!
//! Directions of a set are sorted along a curve, so sixteen that follow one another lie in a narrow cone. A thing in a ball
//! is tested against those cones alone that come within the ball's angle.

use crate::formfactor::Hemisphere;
use crate::formfactor::hemisphere::SETS;
use glam::Vec3;

/// Samples of one cone.
const BLOCK: usize = 16;

/// Cosines are compared with this much room, far above rounding.
const SLACK: f32 = 1e-5;

/// The cones of all sets of a table: axes and half angles, `SETS × samples / 16`, apart by component for vector lanes.
pub(crate) struct Cones {
    blocks: usize,
    /// The directions themselves, `SETS × samples`, apart by component too.
    directions: [Vec<f32>; 3],
    axis: [Vec<f32>; 3],
    cos: Vec<f32>,
    sin: Vec<f32>,
}

impl Cones {
    /// The cones of a table's directions.
    pub(crate) fn of(table: &Hemisphere) -> Cones {
        let mut cones = Cones {
            blocks: table.samples / BLOCK,
            directions: Default::default(),
            axis: Default::default(),
            cos: Vec::new(),
            sin: Vec::new(),
        };
        for block in (0..SETS).flat_map(|set| table.directions(set).chunks(BLOCK)) {
            for direction in block {
                (0..3).for_each(|k| cones.directions[k].push(direction[k]));
            }
            let axis = block.iter().sum::<Vec3>().normalize_or(Vec3::Z);
            let cos = block.iter().map(|d| d.dot(axis)).fold(1.0, f32::min);
            (0..3).for_each(|k| cones.axis[k].push(axis[k]));
            cones.cos.push(cos);
            cones.sin.push((1.0 - cos * cos).max(0.0).sqrt());
        }
        cones
    }

    /// The directions of a set, apart by component.
    pub(crate) fn directions(&self, set: usize) -> [&[f32]; 3] {
        let here = set * self.blocks * BLOCK..(set + 1) * self.blocks * BLOCK;
        self.directions.each_ref().map(|axis| &axis[here.clone()])
    }

    /// Sets the bits of a set's samples that may meet a ball, seen from some point of another ball around the receiver's
    /// origins; `towards` leads from its middle to the first ball's, in the receiver's own frame.
    pub(crate) fn mark(&self, set: usize, towards: Vec3, radii: f32, bits: &mut [u64]) {
        let squared = towards.length_squared();
        if squared <= radii * radii {
            bits.fill(u64::MAX);
            return;
        }
        let distance = squared.sqrt();
        let sin = radii / distance;
        let cos = (1.0 - sin * sin).max(0.0).sqrt();
        let to = towards / distance;
        let here = set * self.blocks..(set + 1) * self.blocks;
        let [x, y, z] = self.axis.each_ref().map(|axis| &axis[here.clone()]);
        let (cosines, sines) = (&self.cos[here.clone()], &self.sin[here]);
        for block in 0..self.blocks {
            let along = x[block] * to.x + y[block] * to.y + z[block] * to.z;
            let meets = along >= cos * cosines[block] - sin * sines[block] - SLACK;
            bits[block / 4] |= (u64::from(meets) * 0xffff) << (block % 4 * BLOCK);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formfactor::hemisphere::Set;

    #[test]
    fn no_sample_that_meets_the_ball_is_left_out_and_most_others_are() {
        let table = Hemisphere::new(Set::Cosine(256), 1);
        let cones = Cones::of(&table);
        let (towards, radius) = (Vec3::new(1.0, -0.5, 2.0), 0.4f32);
        let half = (radius / towards.length()).asin();
        let mut kept = 0;
        for set in 0..SETS {
            let mut bits = [0; 4];
            cones.mark(set, towards, radius, &mut bits);
            for (k, direction) in table.directions(set).iter().enumerate() {
                let marked = bits[k / 64] >> (k % 64) & 1 == 1;
                assert!(
                    marked || direction.angle_between(towards) > half,
                    "{set} {k}"
                );
                kept += u32::from(marked);
            }
        }
        // The ball's share of a cosine-distributed hemisphere is sin² of its half angle × the cosine of its middle: 2.7 %; cones of
        // sixteen of 256 directions are much wider than that.
        assert!(kept < 32 * 256 / 2, "{kept}");
    }

    #[test]
    fn inside_of_the_ball_all_are_asked() {
        let cones = Cones::of(&Hemisphere::new(Set::Cosine(64), 1));
        let mut bits = [0];
        cones.mark(3, Vec3::new(0.1, 0.0, -0.1), 0.5, &mut bits);
        assert_eq!(bits, [u64::MAX]);
    }
}

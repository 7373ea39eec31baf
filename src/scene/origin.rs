//! The world's origin, moved to the scene where that lies far off.
//!
//! Rays have 32-bit coordinates, which a million metres from the origin are 0.06 m apart. Maps, cities and what an author put
//! somewhere else are of that kind. Places of nodes have 64 bits: so as long as these carry the distance nothing is lost.

use super::Animation;
use glam::DVec3;

/// The origin is moved where the scene lies farther from it than this many times its own radius.
const FAR: f64 = 16.0;

/// The warning comes where a file's numbers are coarser than this share of the scene's radius: 0.5 mm in a room.
const COARSE: f64 = 1e-4;

impl Animation {
    /// A point of the world in the coordinates of the file.
    pub fn to_file(&self, point: DVec3) -> DVec3 {
        point + self.origin
    }

    /// A point of the file in the coordinates of the world.
    pub fn to_world(&self, point: DVec3) -> DVec3 {
        point - self.origin
    }

    /// Moves the origin to the middle of the scene at time 0, if that lies far off; whole metres, so that coordinates that the
    /// file rounded to some step stay on it. Warns where the file's numbers are too coarse for its scene.
    pub fn move_origin(&mut self) {
        let pose = self.pose(0.0);
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for instance in 0..self.instances.len() {
            for position in self.world_positions(instance, &pose) {
                (low, high) = (low.min(position), high.max(position));
            }
        }
        let (middle, radius) = ((low + high) * 0.5, low.distance(high) * 0.5);
        if !(middle.is_finite() && radius > 0.0 && middle.length() > FAR * radius) {
            return;
        }
        self.origin += middle.round();
        let positions = self.meshes.iter().flat_map(|mesh| &mesh.positions);
        let largest = positions.fold(0.0, |largest: f32, p| largest.max(p.abs().max_element()));
        let step = f64::from(largest) * f64::from(f32::EPSILON);
        if step > COARSE * radius {
            self.warnings.push(format!(
                "coordinates of meshes go up to {largest} m, where 32-bit numbers are {step:.1e} m apart, in a scene {:.1} m wide: \
                 surfaces are bent and edges gape — move the objects to the origin, and carry the distance by their nodes",
                2.0 * radius,
            ));
        }
    }
}

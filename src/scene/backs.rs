//! Surfaces that a camera sees from behind: solids with all fronts inwards, and walls that face away.
//!
//! The back of a single-sided surface is black here, as glTF culls it; Blender and many viewers show both sides. A solid is
//! known by the sum of the areas of its triangles, each along its front, which is 0 where it is closed, and by its volume,
//! which is negative where fronts look inwards (Zhang, Chen 2001, "Efficient feature extraction for 2D/3D objects in mesh
//! representation", ICIP 2001, III:935–938).

use super::around::{Around, Facing};
use super::view::View;
use super::{Animation, SidesShown};
use glam::DVec3;

/// Columns and rows of the rays of a picture.
const LOOKS: [usize; 2] = [32, 18];

/// It is told where one of so many things that are seen is a back.
const MANY: usize = 20;

/// Names that are told.
const NAMES: usize = 4;

/// A surface is closed where the sum of its areas is less than this share of them.
const CLOSED: f64 = 1e-3;

impl Animation {
    /// Gives every surface the sides that are asked for.
    pub fn choose_sides(&mut self, sides: SidesShown) {
        if sides == SidesShown::Both {
            for material in &mut self.materials {
                material.double_sided = true;
            }
        }
    }

    /// Whether any surface has one side alone.
    pub fn has_single_sides(&self) -> bool {
        let mut shown = self.instances.iter();
        shown.any(|i| !self.materials[self.meshes[i.mesh].material].double_sided)
    }

    /// A warning, where these views show many backs that are black.
    pub fn told_of_backs(&self, around: &Around, views: &[View]) -> Option<String> {
        // Count the rays that meet black backs, node by node.
        let (mut rays, mut black) = (0, 0);
        let mut met = vec![0usize; self.instances.len()];
        for view in views {
            for sight in view.sights(around, LOOKS).into_iter().flatten() {
                rays += 1;
                if sight.face == Facing::Black {
                    met[sight.instance] += 1;
                    black += 1;
                }
            }
        }
        if black * MANY < rays || black == 0 {
            return None;
        }

        // Name those that are met most.
        let mut order: Vec<usize> = (0..met.len()).filter(|at| met[*at] > 0).collect();
        order.sort_by_key(|at| std::cmp::Reverse(met[*at]));
        let mut names: Vec<&str> = Vec::new();
        for at in &order {
            let name = self.nodes[self.instances[*at].node].name.as_str();
            if !names.contains(&name) {
                names.push(name);
            }
        }
        let more = match names.len().saturating_sub(NAMES) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        let named: Vec<String> = names
            .iter()
            .take(NAMES)
            .map(|name| format!("'{name}'"))
            .collect();
        let solids = order.iter().filter(|at| self.is_inside_out(**at)).count();
        let why = match solids {
            0 => "",
            _ => "; closed solids among them have all fronts inwards",
        };
        Some(format!(
            "{:.0} % of what is seen are backs of single-sided surfaces, which are black: {}{more}{why}: \
             --sides both shows both sides, as Blender does",
            100.0 * black as f64 / rays as f64,
            named.join(", "),
        ))
    }

    /// Whether an instance is a closed solid at time 0 whose fronts look inwards.
    fn is_inside_out(&self, instance: usize) -> bool {
        let corners = self.corners(instance, &self.pose(0.0));
        let first = corners.first().map_or(DVec3::ZERO, |c| c[0].as_dvec3());
        let (mut volume, mut sum, mut area) = (0.0, DVec3::ZERO, 0.0);
        for triangle in &corners {
            let [a, b, c] = triangle.map(|corner| corner.as_dvec3() - first);
            let across = (b - a).cross(c - a);
            volume += a.dot(b.cross(c));
            sum += across;
            area += across.length();
        }
        volume < 0.0 && sum.length() < CLOSED * area
    }
}

//! Averages over an element: reflectance without holes, glow, and the fraction without holes.
//!
//! An element is laid out in a grid of small triangles, and each is asked for its mean: pictures are looked up at the
//! size of a small triangle, so that a pattern finer than that comes out as its mean and not as what one point met.

use super::Element;
use crate::ids::{CutoutId, InstanceId, TriangleId};
use crate::scene::paint::{Paint, Rasters};
use crate::scene::{Animation, deform::Shown};
use crate::texture::Cutouts;
use glam::{Vec2, Vec3};

/// Most small triangles along an edge: 256 look-ups, which blur what lies across the element's edge by a sixteenth of it.
const FINEST: usize = 16;

/// Small triangles along an edge where a surface has holes: 1024 points, each there or not, find their share within
/// about 1 %.
const HOLES: usize = 32;

/// Side of the square that stands for one small triangle, in its edges: their areas agree, but for the angle.
const SQUARE: f32 = std::f32::consts::FRAC_1_SQRT_2;

/// A surface to be averaged.
pub struct Source<'a> {
    /// Its textures and colours.
    pub paint: Paint<'a>,
    /// The holes of all surfaces.
    pub cutouts: &'a Cutouts,
    /// The id of its first triangle.
    pub first: TriangleId,
}

impl Source<'_> {
    /// The element with these corners, as weights of the corners of the surface's n-th triangle.
    pub(super) fn element(&self, triangle: usize, corners: [Vec2; 3]) -> Element {
        let id = self.first.after(triangle);
        let mut element = Element {
            triangle: id,
            corners,
            tint: Vec3::ONE,
            glow: Vec3::ONE,
            share: 1.0,
        };
        // What nobody sees glows all over, and holds no light.
        let unseen = self.paint.is_unseen();
        let pierced = self.cutouts.pierces(id) && !unseen;
        if unseen {
            element.share = 0.0;
        }
        if self.paint.is_even() && !pierced {
            return element;
        }

        // Choose the grid: fine enough for the pattern, and for holes.
        let edges = [corners[1] - corners[0], corners[2] - corners[0]];
        let wanted = self.paint.pixels(triangle, edges).ceil() as usize;
        let grid = if pierced {
            HOLES
        } else {
            wanted.clamp(1, FINEST)
        };
        let sides = edges.map(|edge| edge * (SQUARE / grid as f32));

        // Add up what is there.
        let (mut tint, mut glow, mut there) = (Vec3::ZERO, Vec3::ZERO, 0.0);
        for at in middles(grid) {
            let at = corners[0] + edges[0] * at.x + edges[1] * at.y;
            if unseen || self.cutouts.there(id, at.x, at.y) {
                tint += self.paint.tint(triangle, at, sides);
                glow += self.paint.glow(triangle, at, sides);
                there += 1.0;
            }
        }
        let all = (grid * grid) as f32;
        element.tint = tint / f32::max(there, 1.0);
        element.glow = glow / all;
        element.share = if unseen { 0.0 } else { there / all };
        element
    }
}

/// The middles of the `grid`² small triangles of a triangle, as weights of its second and third corner.
fn middles(grid: usize) -> impl Iterator<Item = Vec2> {
    let rows = (0..grid).flat_map(move |i| (0..grid - i).map(move |j| (i, j)));
    rows.flat_map(move |(i, j)| {
        // One points the triangle's way; between it and the next row stands one that points the other way.
        let at = move |inside: f32| Vec2::new(i as f32 + inside, j as f32 + inside) / grid as f32;
        let other = (i + j + 1 < grid).then(|| at(2.0 / 3.0));
        [Some(at(1.0 / 3.0)), other].into_iter().flatten()
    })
}

/// The holes in all triangles of the instances in this order.
pub(super) fn cutouts(animation: &Animation, order: &[InstanceId], shown: &[Shown]) -> Cutouts {
    let mut cutouts = Cutouts::default();
    let mut rasters = Rasters::default();
    let mut clear = Vec::new();
    for &instance in order {
        let mesh = &animation.meshes[animation.instances[instance].mesh];
        let paint = Paint::of(animation, instance.index(), shown[instance].mirrored);
        for triangle in 0..mesh.triangles.len() {
            let next = CutoutId::from_index(cutouts.cutouts.len());
            let cutout = paint.cutout(triangle, &mut rasters);
            cutouts.of.push(cutout.map(|_| next));
            cutouts.cutouts.extend(cutout);
        }
        let passes = paint.specular().is_some_and(|specular| specular.passes());
        clear.resize(cutouts.of.len(), passes);
    }
    cutouts.rasters = rasters.rasters;
    if clear.contains(&true) {
        cutouts.clear = clear;
    }
    cutouts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_triangles_are_as_many_as_squares_and_their_middles_meet_in_the_middle() {
        for grid in [1, 2, 5, 16] {
            let all: Vec<Vec2> = middles(grid).collect();
            assert_eq!(all.len(), grid * grid);
            let mean = all.iter().sum::<Vec2>() / all.len() as f32;
            assert!(mean.distance(Vec2::splat(1.0 / 3.0)) < 1e-6, "{mean}");
            // Over a triangle the mean of x² is 1/6; small triangles of edge 1/n miss their own 1/36 n².
            let square = all.iter().map(|at| at.x * at.x).sum::<f32>() / all.len() as f32;
            let own = 1.0 / 18.0 / (grid * grid) as f32;
            assert!((square + own - 1.0 / 6.0).abs() < 1e-6, "{grid}: {square}");
        }
    }
}

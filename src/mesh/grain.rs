//! Clusters of small triangles: which triangles are one element, so that dense meshes take no more elements than even ones.
//!
//! A. Willmott, P. Heckbert, M. Garland, "Face cluster radiosity", Eurographics Workshop on Rendering 1999, pp. 293–304: the
//! elements of a dense surface are groups of its faces that look much the same way. We depart in how they are found: the
//! hierarchy of Garland, Willmott and Heckbert (2001, "Hierarchical face clustering on polygonal surfaces", I3D 2001,
//! pp. 49–58) is built for one cut of it, which a grid finds without: triangles of a surface are one cluster if their middles
//! lie in one cube, their normals in one cell of a cube map, and a chain of common edges joins them. One length is the
//! measure of all: triangles longer than it are cut by it, those shorter than half of it are clustered. What a budget has left
//! is used by halving the largest clusters (`halving.rs`).

use super::halving::{Spots, halve};
use super::union_find::DisjointSets;
use crate::scene::deform::Shown;
use glam::Vec3;
use std::collections::HashMap;

/// Triangles with a longest edge below this share of an element's are clustered.
const SMALL: f32 = 0.5;

/// The edge of a cube, as a share of an element's longest edge: what lies in it is no longer than that.
const CUBE: f32 = 0.58;

/// Clusters of so few triangles are crumbs.
const CRUMB: u32 = 2;

/// Cosine of the turn up to which a crumb looks like its neighbour: 37°.
const ALIKE: f32 = 0.8;

/// How alike the triangles of a cluster are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Likeness {
    /// Cells along each edge of the cube map of normals: 6 keep normals within 15° of each other, mostly. Samples below a
    /// triangle's own plane are lost to it: ½ (1 − cos θ) where it is turned by θ from the mean.
    pub cells: u8,
    /// Whether common edges join them.
    pub joined: bool,
}

/// From the most alike on; coarser ones are for meshes that would leave too many clusters whatever their length.
pub const LIKENESSES: [Likeness; 6] = [
    Likeness {
        cells: 6,
        joined: true,
    },
    Likeness {
        cells: 4,
        joined: true,
    },
    Likeness {
        cells: 3,
        joined: true,
    },
    Likeness {
        cells: 2,
        joined: true,
    },
    Likeness {
        cells: 1,
        joined: true,
    },
    Likeness {
        cells: 1,
        joined: false,
    },
];

/// Lengths where small triangles are clustered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clustering {
    /// The longest edge of a triangle that is cut, in metres.
    pub edge: f32,
    /// The longest edge that clusters stand for: as long, or a little longer.
    pub size: f32,
    /// How alike the triangles of a cluster are.
    pub likeness: Likeness,
    /// How many times the largest cluster is halved.
    pub halvings: u32,
}

/// What is asked of every triangle of a scene, instance by instance.
pub struct Grains {
    /// The first triangle of each instance, and one past the last of all.
    pub first: Vec<u32>,
    middle: Vec<Vec3>,
    normal: Vec<Vec3>,
    area: Vec<f32>,
    /// Longest edges, in metres.
    pub longest: Vec<f32>,
    /// Pairs of triangles of a surface that share an edge.
    pairs: Vec<(u32, u32)>,
}

impl Grains {
    /// The triangles as they are cut.
    pub fn of(shown: &[Shown]) -> Grains {
        let mut grains = Grains {
            first: vec![0],
            middle: Vec::new(),
            normal: Vec::new(),
            area: Vec::new(),
            longest: Vec::new(),
            pairs: Vec::new(),
        };
        for shown in shown {
            grains.add(&shown.corners);
        }
        grains
    }

    /// Adds the triangles of an instance.
    fn add(&mut self, triangles: &[[Vec3; 3]]) {
        let first = self.middle.len() as u32;
        let bits = |p: Vec3| [p.x, p.y, p.z].map(|x| (x + 0.0).to_bits());
        let mut edges: Vec<([[u32; 3]; 2], u32)> = Vec::with_capacity(3 * triangles.len());
        for (id, corners) in (first..).zip(triangles) {
            let [a, b, c] = *corners;
            self.middle.push((a + b + c) / 3.0);
            let across = (b - a).cross(c - a);
            self.normal.push(across.normalize_or_zero());
            self.area.push(across.length() * 0.5);
            let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
            self.longest.push(longest);
            for [p, q] in [[a, b], [b, c], [c, a]].map(|ends| ends.map(bits)) {
                edges.push(([p.min(q), p.max(q)], id));
            }
        }
        edges.sort_unstable();
        let shared = edges.windows(2).filter(|pair| pair[0].0 == pair[1].0);
        self.pairs.extend(shared.map(|pair| (pair[0].1, pair[1].1)));
        self.first.push(self.middle.len() as u32);
    }

    /// Whether a triangle is clustered where edges are this long.
    pub fn is_small(&self, triangle: usize, size: f32) -> bool {
        self.longest[triangle] < SMALL * size
    }

    /// Joins what a cube's faces cut off to a neighbour that looks alike, wherever that lies.
    fn join_crumbs(&self, sets: &mut DisjointSets, size: f32) {
        let mut count = vec![0u32; self.middle.len()];
        for triangle in 0..count.len() {
            count[sets.root(triangle)] += 1;
        }
        for (a, b) in &self.pairs {
            let [a, b] = [*a as usize, *b as usize];
            let [one, other] = [sets.root(a), sets.root(b)];
            let crumb = count[one].min(count[other]) <= CRUMB;
            let small = self.is_small(a, size) && self.is_small(b, size);
            if one != other && crumb && small && self.normal[a].dot(self.normal[b]) > ALIKE {
                sets.join(one, other);
                count[one.min(other)] = count[one] + count[other];
            }
        }
    }

    /// The lowest triangle of each triangle's cluster, itself where it is in none.
    pub fn clusters(&self, clustering: &Clustering) -> Vec<u32> {
        let Clustering { size, likeness, .. } = *clustering;
        // Name the cell of each small triangle.
        let cube = CUBE * size;
        let key = |triangle: usize| {
            let place = (self.middle[triangle] / cube).floor().as_ivec3();
            (place, direction(self.normal[triangle], likeness.cells))
        };
        let keys: Vec<_> = (0..self.middle.len())
            .map(|triangle| self.is_small(triangle, size).then(|| key(triangle)))
            .collect();

        // Join those of one cell, along common edges or all of an instance.
        let mut sets = DisjointSets::new(keys.len());
        if likeness.joined {
            for (a, b) in &self.pairs {
                let [a, b] = [*a as usize, *b as usize];
                if keys[a].is_some() && keys[a] == keys[b] {
                    sets.join(a, b);
                }
            }
        } else {
            for range in self.first.windows(2) {
                let mut known = HashMap::new();
                let here = &keys[range[0] as usize..range[1] as usize];
                for (triangle, key) in (range[0] as usize..).zip(here) {
                    if let Some(key) = key {
                        sets.join(*known.entry(key).or_insert(triangle), triangle);
                    }
                }
            }
        }
        self.join_crumbs(&mut sets, size);
        let roots = (0..keys.len()).map(|triangle| sets.root(triangle) as u32);
        let mut roots: Vec<u32> = roots.collect();
        let spots = Spots {
            middle: &self.middle,
            area: &self.area,
        };
        halve(spots, &mut roots, clustering.halvings);
        roots
    }
}

/// The cell of a direction on a cube map of `cells` × `cells` on each face.
fn direction(normal: Vec3, cells: u8) -> u32 {
    let size = normal.abs();
    let (axis, across) = if size.x >= size.y && size.x >= size.z {
        (0, [normal.y, normal.z])
    } else if size.y >= size.z {
        (1, [normal.z, normal.x])
    } else {
        (2, [normal.x, normal.y])
    };
    let along = normal[axis];
    let cells = u32::from(cells);
    // Tangents of angles become angles, so that cells are about as wide everywhere.
    let cell = |v: f32| {
        let angle =
            (v / along.abs().max(f32::MIN_POSITIVE)).atan() / std::f32::consts::FRAC_PI_2 + 0.5;
        ((angle * cells as f32) as u32).min(cells - 1)
    };
    let face = 2 * axis as u32 + u32::from(along < 0.0);
    (face * cells + cell(across[0])) * cells + cell(across[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A flat square of n × n quads of 1/n m.
    fn sheet(n: usize) -> Vec<[Vec3; 3]> {
        let at = |i: usize, j: usize| Vec3::new(i as f32 / n as f32, j as f32 / n as f32, 0.0);
        let quads = (0..n * n).map(|k| (k % n, k / n));
        let both = quads.flat_map(|(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        });
        both.collect()
    }

    fn of(size: f32, likeness: Likeness) -> Clustering {
        Clustering {
            edge: size,
            size,
            likeness,
            halvings: 0,
        }
    }

    fn count(clusters: &[u32]) -> usize {
        (0..).zip(clusters).filter(|(k, root)| k == *root).count()
    }

    #[test]
    fn a_dense_sheet_has_a_cluster_in_each_cube() {
        let mut grains = Grains::of(&[]);
        grains.add(&sheet(64));
        // Cubes of 0.58 · 0.4 = 0.232 m: five along a metre.
        for likeness in LIKENESSES {
            let clusters = count(&grains.clusters(&of(0.4, likeness)));
            assert!((25..=27).contains(&clusters), "{clusters}");
        }
        // Edges of √2/64 are not small for elements of 0.04 m, of which they are more than half.
        assert_eq!(
            count(&grains.clusters(&of(0.04, LIKENESSES[0]))),
            2 * 64 * 64
        );
    }

    #[test]
    fn halvings_make_as_many_clusters_more() {
        let mut grains = Grains::of(&[]);
        grains.add(&sheet(64));
        let all = 2 * 64 * 64;
        // A cluster in each of 4 × 4 cubes.
        let (size, few) = (0.25 / CUBE, 16);
        for halvings in [1, 100, 3000, all as u32] {
            let clustering = Clustering {
                halvings,
                ..of(size, LIKENESSES[0])
            };
            let clusters = grains.clusters(&clustering);
            assert_eq!(count(&clusters), all.min(few + halvings as usize));
            // The largest are halved first, into halves that differ by a triangle at most.
            let mut sizes = vec![0; all];
            clusters.iter().for_each(|root| sizes[*root as usize] += 1);
            let there = sizes.iter().filter(|size| **size > 0);
            let (most, least) = (there.clone().max().unwrap(), there.min().unwrap());
            assert!(*most <= 2 * least + 1, "{halvings}: {most}, {least}");
        }
    }

    #[test]
    fn what_lies_apart_or_turned_is_not_joined() {
        let mut grains = Grains::of(&[]);
        let mut two = sheet(8);
        two.extend(sheet(8).iter().map(|t| t.map(|p| p + Vec3::Z * 0.1)));
        two.extend(
            sheet(8)
                .iter()
                .map(|[a, b, c]| [*a, *c, *b].map(|p| p + Vec3::Z * 0.2)),
        );
        grains.add(&two);
        // Two sheets that face alike and one that faces away, all in one cube.
        assert_eq!(count(&grains.clusters(&of(9.0, LIKENESSES[4]))), 3);
        assert_eq!(count(&grains.clusters(&of(9.0, LIKENESSES[5]))), 2);
    }

    #[test]
    fn directions_fill_their_cells() {
        let mut seen = vec![0; 54];
        for k in 0..5400 {
            let y = 1.0 - 2.0 * (k as f32 + 0.5) / 5400.0;
            let (sin, cos) = (k as f32 * 2.4).sin_cos();
            let across = (1.0 - y * y).sqrt();
            seen[direction(Vec3::new(cos * across, y, sin * across), 3) as usize] += 1;
        }
        // No cell holds less than half or more than twice its share.
        assert!(seen.iter().all(|n| (50..200).contains(n)), "{seen:?}");
    }
}

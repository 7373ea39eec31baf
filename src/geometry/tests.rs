//! Trees against brute force, bit for bit, where rounding hurts most.

use super::{AabbBvh8, Bounds, Bvh8, Hit, Ray, intersect_all, triangle};
use crate::ids::{CutoutId, TriangleId};
use crate::texture::raster::{Raster, Wrap};
use crate::texture::{Cutouts, coverage::Cutout};
use glam::{Vec2, Vec3, vec3};
use std::f32::consts::TAU;
use std::sync::Arc;

/// SplitMix64: G. L. Steele, D. Lea and C. H. Flood, "Fast Splittable Pseudorandom Number Generators", OOPSLA 2014.
struct Dice(u64);

impl Dice {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [0, 1).
    fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1 << 24) as f32
    }

    fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    /// Uniform in the cube from −1 to 1.
    fn point(&mut self) -> Vec3 {
        vec3(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }

    fn direction(&mut self) -> Vec3 {
        let z = 2.0 * self.unit() - 1.0;
        let (sin, cos) = (TAU * self.unit()).sin_cos();
        let r = (1.0 - z * z).sqrt();
        vec3(r * cos, r * sin, z).normalize()
    }
}

fn ray(origin: Vec3, direction: Vec3) -> Ray {
    Ray {
        origin,
        direction,
        tmin: 0.0,
        tmax: f32::INFINITY,
    }
}

fn toward(origin: Vec3, target: Vec3) -> Ray {
    ray(origin, (target - origin).normalize())
}

fn bits(hit: Option<Hit>) -> Option<[u32; 4]> {
    hit.map(|hit| {
        [
            hit.t.to_bits(),
            hit.triangle.number(),
            hit.u.to_bits(),
            hit.v.to_bits(),
        ]
    })
}

/// Asks both kernels everything about rays, and wants brute force's answers.
fn check(triangles: &[[Vec3; 3]], rays: impl IntoIterator<Item = Ray>) {
    check_pierced(triangles, Cutouts::default(), rays);
}

/// The same of triangles with holes.
fn check_pierced(triangles: &[[Vec3; 3]], cutouts: Cutouts, rays: impl IntoIterator<Item = Ray>) {
    let cutouts = Arc::new(cutouts);
    let fast = Bvh8::build(triangles, TriangleId::new(7)).pierced(&cutouts);
    let slow = fast.clone().portable();
    let around: Vec<Bounds> = triangles
        .iter()
        .filter(|triangle| !triangle::is_flat(triangle))
        .map(Bounds::of_points)
        .collect();
    let boxes = AabbBvh8::build(&around);
    for ray in rays {
        let truth = intersect_all(triangles, TriangleId::new(7), &cutouts, &ray);
        for tree in [&fast, &slow] {
            assert_eq!(bits(tree.intersect(&ray)), bits(truth), "{ray:?}");
            assert_eq!(tree.occluded(&ray), truth.is_some(), "{ray:?}");
        }
        let meets = boxes.meets(&ray);
        assert_eq!(boxes.clone().portable().meets(&ray), meets);
        assert!(meets || truth.is_none());
    }
}

/// Random triangles of all sizes in a cube of half side 1, some of them needles.
fn soup(dice: &mut Dice, count: usize) -> Vec<[Vec3; 3]> {
    (0..count)
        .map(|_| {
            let size = 10f32.powf(-3.0 * dice.unit());
            let middle = dice.point();
            let mut corners = [0; 3].map(|_| middle + size * dice.point());
            if dice.below(4) == 0 {
                corners[2] = corners[1] + 1e-6 * dice.point();
            }
            corners
        })
        .collect()
}

/// A point on an edge, at a corner or inside of a random triangle.
fn target(dice: &mut Dice, triangles: &[[Vec3; 3]]) -> Vec3 {
    let [a, b, c] = triangles[dice.below(triangles.len())];
    let (s, t) = (dice.unit(), dice.unit());
    match dice.below(4) {
        0 => a,
        1 => a.midpoint(b),
        2 => a.lerp(b, s),
        _ => a.lerp(b, s).lerp(c, t),
    }
}

/// Six sides of the cube from −1 to 1, each of n × n squares cut in two.
fn cube(n: usize) -> Vec<[Vec3; 3]> {
    let at = |i: usize| i as f32 / n as f32 * 2.0 - 1.0;
    let mut triangles = Vec::new();
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let point = |i: usize, j: usize| {
                let mut p = [0.0; 3];
                (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (side, at(i), at(j));
                Vec3::from_array(p)
            };
            for i in 0..n {
                for j in 0..n {
                    let [a, b, c, d] = [
                        point(i, j),
                        point(i + 1, j),
                        point(i + 1, j + 1),
                        point(i, j + 1),
                    ];
                    triangles.extend([[a, b, c], [a, c, d]]);
                }
            }
        }
    }
    triangles
}

/// The cube blown up to the unit sphere.
fn sphere(n: usize) -> Vec<[Vec3; 3]> {
    cube(n)
        .into_iter()
        .map(|t| t.map(Vec3::normalize))
        .collect()
}

#[test]
fn random_soups_agree_with_brute_force() {
    let mut dice = Dice(1);
    for count in [0, 1, 2, 7, 8, 9, 60, 400, 3000] {
        let triangles = soup(&mut dice, count);
        let rays: Vec<Ray> = (0..1500)
            .map(|i| {
                let mut one = match i % 3 {
                    _ if count == 0 => ray(dice.point(), dice.direction()),
                    0 => ray(dice.point(), dice.direction()),
                    1 => toward(2.0 * dice.point(), target(&mut dice, &triangles)),
                    _ => toward(target(&mut dice, &triangles), target(&mut dice, &triangles)),
                };
                if dice.below(2) == 0 {
                    one.tmin = 0.3 * dice.unit();
                    one.tmax = 2.0 * dice.unit();
                }
                one
            })
            .filter(|one| one.direction.is_finite())
            .collect();
        check(&triangles, rays);
    }
}

#[test]
fn triangles_seen_edge_on_agree_with_brute_force() {
    // Needles and blades whose planes hold the ray: the distance is at its worst conditioned.
    let mut dice = Dice(2);
    for offset in [0.0, 3.0, 1000.0] {
        let [origin, direction] = [dice.point() + offset, dice.direction()];
        let triangles: Vec<[Vec3; 3]> = (0..600)
            .map(|_| {
                let side = direction.cross(dice.direction());
                [0; 3].map(|_| {
                    let width = 10f32.powf(-8.0 * dice.unit());
                    origin
                        + direction * (4.0 * dice.unit() - 1.0)
                        + side * (dice.unit() - 0.5) * width
                })
            })
            .collect();
        let rays = (0..1500).map(|_| {
            ray(
                origin,
                (direction + dice.point() * 10f32.powf(-8.0 + 4.0 * dice.unit())).normalize(),
            )
        });
        let rays: Vec<Ray> = rays.chain([ray(origin, direction)]).collect();
        check(&triangles, rays);
    }
}

#[test]
fn flat_triangles_are_never_hit() {
    let mut dice = Dice(3);
    let mut triangles = Vec::new();
    for _ in 0..40 {
        let [a, b] = [dice.point(), dice.point()];
        triangles.extend([
            [a, a, a],
            [a, b, b],
            [a, b, a],
            [a, a.midpoint(a), b],
            [a, b, Vec3::NAN],
        ]);
        triangles.push([
            vec3(a.x, 0.5, 0.25),
            vec3(b.x, 0.5, 0.25),
            vec3(b.y, 0.5, 0.25),
        ]);
    }
    let tree = Bvh8::build(&triangles, TriangleId::new(0));
    assert!(tree.is_empty() && tree.bounds().is_empty() && tree.memory() < 4096);
    let rays: Vec<Ray> = (0..300)
        .map(|_| {
            toward(
                dice.point() * 3.0,
                triangles[dice.below(triangles.len())][0],
            )
        })
        .collect();
    assert!(
        rays.iter()
            .all(|ray| tree.intersect(ray).is_none() && !tree.occluded(ray))
    );
    check(&triangles, rays);
}

#[test]
fn closed_surfaces_do_not_leak() {
    // From inside, every ray aimed at a corner, an edge or a face must hit, wherever the world's origin is.
    let mut dice = Dice(4);
    for (shape, offset) in [
        (cube(13), Vec3::ZERO),
        (cube(16), vec3(1000.0, -2000.0, 500.0)),
        (sphere(12), Vec3::ZERO),
        (sphere(12), vec3(0.3, 4000.0, -77.0)),
    ] {
        let triangles: Vec<[Vec3; 3]> = shape.iter().map(|t| t.map(|p| p + offset)).collect();
        let rays: Vec<Ray> = (0..6000)
            .map(|_| toward(offset + 0.6 * dice.point(), target(&mut dice, &triangles)))
            .collect();
        let tree = Bvh8::build(&triangles, TriangleId::new(0));
        for ray in &rays {
            assert!(tree.intersect(ray).is_some(), "leak along {ray:?}");
            assert!(tree.occluded(ray));
        }
        check(&triangles, rays.into_iter().take(600));
    }
}

#[test]
fn rays_from_afar_do_not_leak() {
    let mut dice = Dice(5);
    let triangles = cube(8);
    let tree = Bvh8::build(&triangles, TriangleId::new(0));
    let rays: Vec<Ray> = (0..3000)
        .map(|_| {
            let origin = dice.direction() * 10f32.powf(1.0 + 3.0 * dice.unit());
            toward(origin, target(&mut dice, &triangles) * 0.9)
        })
        .collect();
    assert!(rays.iter().all(|ray| tree.occluded(ray)));
    check(&triangles, rays.into_iter().take(600));
}

#[test]
fn rays_along_the_axes_hit_grids() {
    // Origins on grid lines, in the planes of walls, and zeros of either sign.
    let mut dice = Dice(6);
    let triangles = cube(8);
    let tree = Bvh8::build(&triangles, TriangleId::new(0));
    let mut rays = Vec::new();
    for _ in 0..2000 {
        let axis = dice.below(3);
        let mut zero = || if dice.below(2) == 0 { 0.0 } else { -0.0 };
        let mut direction = [zero(), zero(), zero()];
        direction[axis] = if dice.below(2) == 0 { 1.0 } else { -1.0 };
        let mut origin = [0; 3].map(|_| dice.below(9) as f32 / 4.0 - 1.0);
        origin[axis] = 0.25 * dice.unit();
        rays.push(ray(Vec3::from_array(origin), Vec3::from_array(direction)));
    }
    for ray in &rays {
        let hit = tree
            .intersect(ray)
            .expect("the cube is closed, and its walls' edges belong to it");
        let axis = ray.direction.abs().max_position();
        assert_eq!(hit.t, (ray.direction[axis] - ray.origin[axis]).abs());
    }
    check(&triangles, rays);
}

#[test]
fn rays_with_tiny_components_hit_grids() {
    let mut dice = Dice(7);
    let triangles = cube(8);
    let tree = Bvh8::build(&triangles, TriangleId::new(0));
    let rays: Vec<Ray> = (0..2000)
        .map(|_| {
            let tiny = |dice: &mut Dice| (dice.unit() - 0.5) * 10f32.powf(-45.0 * dice.unit());
            let direction = vec3(tiny(&mut dice), -1.0, tiny(&mut dice)).normalize();
            let on = |dice: &mut Dice| dice.below(7) as f32 / 4.0 - 0.75;
            ray(
                vec3(on(&mut dice), 0.9 * dice.unit(), on(&mut dice)),
                direction,
            )
        })
        .collect();
    assert!(rays.iter().all(|ray| tree.occluded(ray)));
    check(&triangles, rays);
}

#[test]
fn of_coincident_triangles_the_lowest_id_wins() {
    let mut dice = Dice(8);
    let single = sphere(6);
    let mut triangles = single.clone();
    for _ in 0..4 {
        triangles.extend(&single);
    }
    triangles.extend(vec![single[5]; 300]);
    let tree = Bvh8::build(&triangles, TriangleId::new(0));
    let rays: Vec<Ray> = (0..1500)
        .map(|_| ray(Vec3::ZERO, dice.direction()))
        .collect();
    for ray in &rays {
        assert!((tree.intersect(ray).expect("closed").triangle.index()) < single.len());
    }
    check(&triangles, rays);
}

#[test]
fn the_span_is_open_at_both_ends() {
    let tree = Bvh8::build(
        &[[
            vec3(-1.0, -1.0, 2.0),
            vec3(3.0, -1.0, 2.0),
            vec3(-1.0, 3.0, 2.0),
        ]],
        TriangleId::new(3),
    );
    let spanned = |tmin, tmax| Ray {
        tmin,
        tmax,
        ..ray(Vec3::ZERO, Vec3::Z)
    };
    let hit = Hit {
        t: 2.0,
        triangle: TriangleId::new(3),
        u: 0.25,
        v: 0.25,
    };
    assert_eq!(tree.intersect(&spanned(0.0, 3.0)), Some(hit));
    assert_eq!(
        tree.intersect(&spanned(2.0f32.next_down(), 2.0f32.next_up())),
        Some(hit)
    );
    assert_eq!(tree.intersect(&spanned(2.0, 3.0)), None);
    assert_eq!(tree.intersect(&spanned(0.0, 2.0)), None);
    assert!(
        tree.occluded(&spanned(0.0, 3.0))
            && !tree.occluded(&spanned(2.0, 3.0))
            && !tree.occluded(&spanned(0.0, 2.0))
    );
}

#[test]
fn the_tree_does_not_depend_on_threads() {
    let triangles = soup(&mut Dice(9), 20_000);
    let built = [1, 2, 5].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let tree = pool
            .expect("threads")
            .install(|| Bvh8::build(&triangles, TriangleId::new(0)));
        format!("{tree:?}")
    });
    assert!(built[0] == built[1] && built[0] == built[2]);
}

#[test]
fn equal_and_nested_boxes_stay_shallow() {
    // Equal centres cannot be told apart by place; exponentially spaced ones shed one a split.
    let mut triangles = vec![[Vec3::X, Vec3::Y, Vec3::Z]; 5000];
    for i in 0..250 {
        let size = 1.5f32.powi(i - 160);
        triangles.push([Vec3::X * size, Vec3::Y * size, Vec3::Z * size]);
    }
    let mut dice = Dice(10);
    let rays: Vec<Ray> = (0..100)
        .map(|_| ray(dice.point().abs(), -dice.direction().abs()))
        .collect();
    check(&triangles, rays);
}

#[test]
fn box_trees_agree_with_brute_force() {
    let mut dice = Dice(11);
    let mut boxes: Vec<Bounds> = (0..500)
        .map(|_| {
            let [a, b] = [dice.point(), 0.2 * dice.point()];
            Bounds::of_points([a, a + b])
        })
        .collect();
    boxes.extend([Bounds::EMPTY; 3]);
    let tree = AabbBvh8::build(&boxes);
    let mut met = 0;
    for _ in 0..4000 {
        let mut one = ray(1.5 * dice.point(), dice.direction());
        one.tmax = 0.5 * dice.unit();
        // Touching in f64 must be found; what is found must be touched by the boxes grown by a hundred-thousandth.
        let touched = |grown: f32| {
            boxes.iter().any(|bounds| {
                let bounds = bounds.padded(grown);
                let inverse = one.direction.as_dvec3().recip();
                let [a, b] = [bounds.lo, bounds.hi]
                    .map(|p| (p.as_dvec3() - one.origin.as_dvec3()) * inverse);
                let entry = a.min(b).max_element().max(f64::from(one.tmin));
                !bounds.is_empty() && entry <= a.max(b).min_element().min(f64::from(one.tmax))
            })
        };
        let meets = tree.meets(&one);
        assert_eq!(tree.clone().portable().meets(&one), meets);
        assert!(meets || !touched(0.0));
        assert!(!meets || touched(1e-5));
        met += usize::from(meets);
    }
    assert!((100..3990).contains(&met), "{met}");
    assert!(
        AabbBvh8::build(&[Bounds::EMPTY]).is_empty()
            && !AabbBvh8::build(&[]).meets(&ray(Vec3::ZERO, Vec3::X))
    );
}

#[test]
fn bounds_measure_what_they_hold() {
    let bounds = Bounds::of_points([vec3(1.0, 5.0, 2.0), vec3(-1.0, 2.0, 2.5)]);
    assert_eq!(bounds.extent(), vec3(2.0, 3.0, 0.5));
    assert_eq!(bounds.area(), 2.0 * (6.0 + 1.5 + 1.0));
    assert_eq!(bounds.center(), vec3(0.0, 3.5, 2.25));
    assert!(
        bounds.contains(bounds.lo) && bounds.contains(bounds.hi) && !bounds.contains(Vec3::ZERO)
    );
    assert_eq!(
        bounds.padded(1.0).union(bounds),
        bounds.include(bounds.lo - 1.0).include(bounds.hi + 1.0)
    );
    assert_eq!(Bounds::EMPTY.union(bounds), bounds);
    assert!(Bounds::EMPTY.is_empty() && Bounds::EMPTY.padded(9.0).is_empty());
    assert_eq!(
        (Bounds::EMPTY.area(), Bounds::EMPTY.extent()),
        (0.0, Vec3::ZERO)
    );
}

/// Every other triangle of a soup has holes: a picture of random alpha over it, or alpha at its corners alone.
fn moth_eaten(dice: &mut Dice, triangles: usize) -> Cutouts {
    let raster = |wrap: [Wrap; 2], dice: &mut Dice| Raster {
        size: [5, 3],
        wrap,
        nearest: dice.bits() & 1 == 1,
        values: (0..15).map(|_| dice.bits() as u16).collect(),
    };
    let rasters = vec![
        raster([Wrap::Repeat, Wrap::Mirror], dice),
        raster([Wrap::Clamp, Wrap::Repeat], dice),
    ];
    let cutout = |dice: &mut Dice| Cutout {
        texcoords: [0; 3].map(|_| Vec2::new(dice.unit(), dice.unit()) * 4.0 - 2.0),
        alpha: [0; 3].map(|_| dice.unit()),
        raster: [None, Some(0), Some(1)][dice.below(3)],
        cutoff: 0.5 * dice.unit(),
    };
    let mut cutouts = Cutouts {
        // Ids start at 7, and those beyond the end have no holes.
        of: vec![None; 7],
        rasters,
        ..Cutouts::default()
    };
    for id in 0..triangles - 5 {
        let pierced = id % 2 == 0;
        let next = CutoutId::from_index(cutouts.cutouts.len());
        cutouts.of.push(pierced.then_some(next));
        if pierced {
            cutouts.cutouts.push(cutout(dice));
        }
    }
    cutouts
}

#[test]
fn holes_are_the_same_for_trees_kernels_and_brute_force() {
    let mut dice = Dice(11);
    let triangles = soup(&mut dice, 300);
    let cutouts = moth_eaten(&mut dice, triangles.len());
    let rays: Vec<Ray> = (0..4000)
        .map(|_| toward(1.5 * dice.point(), target(&mut dice, &triangles)))
        .collect();
    let whole = Cutouts::default();
    let differ = |ray: &&Ray| {
        let seen = |cutouts| bits(intersect_all(&triangles, TriangleId::new(7), cutouts, ray));
        seen(&cutouts) != seen(&whole)
    };
    assert!(rays.iter().filter(differ).count() > 400, "holes matter");
    check_pierced(&triangles, cutouts, rays);
}

#[test]
fn a_hole_lets_through_exactly_what_its_alpha_says() {
    // Alpha falls from 1 at the first corner to 0 at the others: 1 − u − v ≥ 3/4 near the first corner alone.
    let near = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let far = near.map(|corner| corner - Vec3::Z);
    let cutouts = Cutouts {
        of: vec![Some(CutoutId::new(0))],
        cutouts: vec![Cutout {
            texcoords: [Vec2::ZERO; 3],
            alpha: [1.0, 0.0, 0.0],
            raster: None,
            cutoff: 0.75,
        }],
        rasters: Vec::new(),
        clear: Vec::new(),
    };
    let tree = Bvh8::build(&[near, far], TriangleId::new(0)).pierced(&Arc::new(cutouts));
    let down = |x: f32, y: f32| ray(vec3(x, y, 1.0), Vec3::NEG_Z);
    let seen = |ray: Ray| tree.intersect(&ray).map(|hit| hit.triangle.number());
    assert_eq!(seen(down(0.125, 0.125)), Some(0), "at the cutoff itself");
    assert_eq!(seen(down(0.125, 0.126)), Some(1));
    assert_eq!(seen(down(0.6, 0.6)), None);
    let short = Ray {
        tmax: 1.5,
        ..down(0.3, 0.3)
    };
    assert!(!tree.occluded(&short) && tree.occluded(&down(0.3, 0.3)));
}

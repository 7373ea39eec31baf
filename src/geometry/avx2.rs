//! The two tests in AVX2, eight lanes an instruction: the only unsafe code of the crate.
//!
//! After I. Wald, S. Woop, C. Benthin, G. S. Johnson and M. Ernst, "Embree: A Kernel Framework for Efficient CPU Ray
//! Tracing", ACM Transactions on Graphics 33(4), 2014, article 143. No fused multiply-add: each lane does exactly what
//! `portable.rs` does. Unsafe are the loads, each from a whole `[f32; 8]`, and the step from a [`Token`], which only
//! [`Token::detect`] gives out, into code that needs AVX2.
#![expect(
    unsafe_code,
    reason = "measured: eight-lane intrinsics trace 1.3 times as fast as plain loops"
)]

use super::{
    Bounds, Hit, Ray,
    node::{BvhNode, Leaf},
    slabs::{LEAST_COMPONENT, MARGIN, Slabs, ULP},
    traverse::{self, Query},
    triangle::{Shear, meet},
};
use glam::Vec3;
use std::arch::x86_64::*;

/// The proof that this machine has AVX2.
#[derive(Clone, Copy, Debug)]
pub(super) struct Token(());

impl Token {
    /// Asks the processor.
    pub(super) fn detect() -> Option<Token> {
        is_x86_feature_detected!("avx2").then_some(Token(()))
    }

    /// See [`traverse::intersect`].
    #[inline]
    pub(super) fn intersect(self, query: &Query) -> Option<Hit> {
        // SAFETY: a token exists only where AVX2 was detected.
        unsafe { intersect(query) }
    }

    /// See [`traverse::occluded`].
    #[inline]
    pub(super) fn occluded(self, query: &Query) -> bool {
        // SAFETY: a token exists only where AVX2 was detected.
        unsafe { occluded(query) }
    }

    /// See [`traverse::meets`].
    #[inline]
    pub(super) fn meets(self, nodes: &[BvhNode], ray: &Ray, bounds: &Bounds) -> bool {
        // SAFETY: a token exists only where AVX2 was detected.
        unsafe { meets(nodes, ray, bounds) }
    }
}

#[target_feature(enable = "avx2")]
fn intersect(query: &Query) -> Option<Hit> {
    let ray = WideRay::new(query.ray, query.bounds);
    traverse::intersect(
        query,
        |node, tmax| boxes(node, &ray.slabs, tmax),
        |leaf, tmax| triangles(leaf, &ray, tmax),
    )
}

#[target_feature(enable = "avx2")]
fn occluded(query: &Query) -> bool {
    let ray = WideRay::new(query.ray, query.bounds);
    traverse::occluded(
        query,
        |node, tmax| boxes(node, &ray.slabs, tmax),
        |leaf, tmax| triangles(leaf, &ray, tmax),
    )
}

#[target_feature(enable = "avx2")]
fn meets(nodes: &[BvhNode], ray: &Ray, bounds: &Bounds) -> bool {
    let slabs = WideSlabs::new(ray, bounds);
    traverse::meets(nodes, |node| boxes(node, &slabs, ray.tmax).0)
}

/// [`Slabs`], made by the same arithmetic, four lanes at once: x, y, z and an unused lane.
struct WideSlabs {
    /// The origin, as it is and as seen by the planes of entry and by those of exit.
    origin: [f32; 4],
    entry: [f32; 4],
    exit: [f32; 4],
    /// 1 / direction.
    reciprocal: [f32; 4],
    /// The direction's signs alone: 0 or −0.
    sign: [f32; 4],
    /// The same as bits.
    negative: usize,
    tmin: f32,
}

/// A ray's constants for boxes and for triangles.
struct WideRay<'a> {
    ray: &'a Ray,
    slabs: WideSlabs,
    shear: Shear,
}

impl<'a> WideRay<'a> {
    #[inline]
    #[target_feature(enable = "avx2")]
    fn new(ray: &'a Ray, bounds: &Bounds) -> WideRay<'a> {
        let slabs = WideSlabs::new(ray, bounds);
        let [x, y, z, _] = slabs.reciprocal;
        let shear = Shear::new(ray, [x, y, z]);
        WideRay { ray, slabs, shear }
    }
}

impl WideSlabs {
    #[inline]
    #[target_feature(enable = "avx2")]
    fn new(ray: &Ray, bounds: &Bounds) -> WideSlabs {
        let signs = _mm_set1_ps(-0.0);
        let (origin, direction) = (quad(ray.origin), quad(ray.direction));
        let sign = _mm_and_ps(direction, signs);
        let size = _mm_andnot_ps(signs, direction);
        let reciprocal = _mm_div_ps(
            _mm_or_ps(_mm_set1_ps(1.0), sign),
            _mm_max_ps(size, _mm_set1_ps(LEAST_COMPONENT)),
        );

        // The largest difference between bounds and origin, in every lane.
        let lower = _mm_andnot_ps(signs, _mm_sub_ps(quad(bounds.lo), origin));
        let upper = _mm_andnot_ps(signs, _mm_sub_ps(quad(bounds.hi), origin));
        let reach = _mm_max_ps(lower, upper);
        let reach = _mm_max_ps(reach, _mm_movehl_ps(reach, reach));
        let reach = _mm_max_ps(reach, _mm_shuffle_ps::<0b01_01_01_01>(reach, reach));
        let reach = _mm_shuffle_ps::<0>(reach, reach);

        // See `Slabs::apart`.
        let ahead = _mm_or_ps(_mm_mul_ps(_mm_set1_ps(MARGIN), reach), sign);
        let (from, to) = (_mm_add_ps(origin, ahead), _mm_sub_ps(origin, ahead));
        let ulp = _mm_set1_ps(ULP);
        let from_ulp = _mm_or_ps(_mm_andnot_ps(signs, _mm_mul_ps(from, ulp)), sign);
        let to_ulp = _mm_or_ps(_mm_andnot_ps(signs, _mm_mul_ps(to, ulp)), sign);
        WideSlabs {
            origin: store(origin),
            entry: store(_mm_add_ps(from, from_ulp)),
            exit: store(_mm_sub_ps(to, to_ulp)),
            reciprocal: store(reciprocal),
            sign: store(sign),
            negative: _mm_movemask_ps(sign) as usize,
            tmin: ray.tmin,
        }
    }
}

/// Three numbers and a zero.
#[inline]
#[target_feature(enable = "avx2")]
fn quad(v: Vec3) -> __m128 {
    _mm_set_ps(0.0, v.z, v.y, v.x)
}

#[inline]
#[target_feature(enable = "avx2")]
fn store(lanes: __m128) -> [f32; 4] {
    let mut out = [0.0; 4];
    // SAFETY: the array holds the four floats written; the store asks for no alignment.
    unsafe { _mm_storeu_ps(out.as_mut_ptr(), lanes) };
    out
}

#[inline]
#[target_feature(enable = "avx2")]
fn store_wide(lanes: __m256) -> [f32; 8] {
    let mut out = [0.0; 8];
    // SAFETY: the array holds the eight floats written; the store asks for no alignment.
    unsafe { _mm256_storeu_ps(out.as_mut_ptr(), lanes) };
    out
}

#[inline]
#[target_feature(enable = "avx2")]
fn load(lanes: &[f32; 8]) -> __m256 {
    // SAFETY: the reference covers the eight floats read; the load asks for no alignment.
    unsafe { _mm256_loadu_ps(lanes.as_ptr()) }
}

/// See `portable::boxes`.
#[inline]
#[target_feature(enable = "avx2")]
fn boxes(node: &BvhNode, slabs: &WideSlabs, tmax: f32) -> (u32, [f32; 8]) {
    let mut entry = _mm256_set1_ps(slabs.tmin);
    let mut exit = _mm256_set1_ps(tmax);
    for axis in 0..3 {
        let side = 3 * (slabs.negative >> axis & 1);
        let lower = load(&node.planes[axis + side]);
        let upper = load(&node.planes[axis + 3 - side]);
        let reciprocal = _mm256_set1_ps(slabs.reciprocal[axis]);
        let enters = _mm256_sub_ps(lower, _mm256_set1_ps(slabs.entry[axis]));
        let leaves = _mm256_sub_ps(upper, _mm256_set1_ps(slabs.exit[axis]));
        entry = _mm256_max_ps(_mm256_mul_ps(enters, reciprocal), entry);
        exit = _mm256_min_ps(_mm256_mul_ps(leaves, reciprocal), exit);
    }
    let mask = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(entry, exit)) as u32;
    (mask, store_wide(entry))
}

/// See `portable::triangles`: [`meet`] in every lane at once. What passes through an edge is left to [`meet`] itself.
#[inline]
#[target_feature(enable = "avx2")]
fn triangles(leaf: &Leaf, ray: &WideRay, tmax: f32) -> (u32, [f32; 8]) {
    // Map the corners. Written out without closures, which would be called instead of inlined.
    let (slabs, shear) = (&ray.slabs, &ray.shear);
    let [x, y, z] = shear.axes;
    let [x_origin, y_origin, z_origin] = [
        _mm256_set1_ps(slabs.origin[x & 3]),
        _mm256_set1_ps(slabs.origin[y & 3]),
        _mm256_set1_ps(slabs.origin[z & 3]),
    ];
    let [x_slope, y_slope, z_slope] = [
        _mm256_set1_ps(shear.slope[0]),
        _mm256_set1_ps(shear.slope[1]),
        _mm256_set1_ps(shear.slope[2]),
    ];
    let mut across = [[_mm256_setzero_ps(); 2]; 3];
    let mut along = [_mm256_setzero_ps(); 3];
    for (corner, lanes) in leaf.corners.iter().enumerate() {
        let depth = _mm256_sub_ps(load(&lanes[z]), z_origin);
        let [dx, dy] = [_mm256_mul_ps(x_slope, depth), _mm256_mul_ps(y_slope, depth)];
        across[corner][0] = _mm256_sub_ps(_mm256_sub_ps(load(&lanes[x]), x_origin), dx);
        across[corner][1] = _mm256_sub_ps(_mm256_sub_ps(load(&lanes[y]), y_origin), dy);
        along[corner] = _mm256_mul_ps(z_slope, depth);
    }

    // Compare the signs of the edge functions; zeros count as either.
    let [a, b, c] = across;
    let u = _mm256_sub_ps(_mm256_mul_ps(c[0], b[1]), _mm256_mul_ps(c[1], b[0]));
    let v = _mm256_sub_ps(_mm256_mul_ps(a[0], c[1]), _mm256_mul_ps(a[1], c[0]));
    let w = _mm256_sub_ps(_mm256_mul_ps(b[0], a[1]), _mm256_mul_ps(b[1], a[0]));
    let zero = _mm256_setzero_ps();
    let least = _mm256_min_ps(_mm256_min_ps(u, v), w);
    let most = _mm256_max_ps(_mm256_max_ps(u, v), w);
    let inside = _mm256_or_ps(
        _mm256_cmp_ps::<_CMP_GE_OQ>(least, zero),
        _mm256_cmp_ps::<_CMP_LE_OQ>(most, zero),
    );
    if _mm256_testz_ps(inside, inside) == 1 {
        return (0, [0.0; 8]);
    }

    // The distance, kept inside of each triangle's own box and compared with the span.
    let sum = _mm256_add_ps(_mm256_add_ps(u, v), w);
    let [u, v, w] = [
        _mm256_mul_ps(u, along[0]),
        _mm256_mul_ps(v, along[1]),
        _mm256_mul_ps(w, along[2]),
    ];
    let t = _mm256_div_ps(_mm256_add_ps(_mm256_add_ps(u, v), w), sum);
    let (entry, exit) = span(leaf, slabs);
    let t = _mm256_min_ps(_mm256_max_ps(t, entry), exit);
    let after = _mm256_cmp_ps::<_CMP_GT_OQ>(t, _mm256_set1_ps(slabs.tmin));
    let before = _mm256_cmp_ps::<_CMP_LE_OQ>(t, _mm256_set1_ps(tmax));
    let boxed = _mm256_cmp_ps::<_CMP_LE_OQ>(entry, exit);
    let hits = _mm256_and_ps(_mm256_and_ps(inside, boxed), _mm256_and_ps(after, before));
    let (mut hits, mut t) = (_mm256_movemask_ps(hits) as u32, store_wide(t));

    // An edge function that is zero makes the least or the greatest zero.
    let edges = _mm256_or_ps(
        _mm256_cmp_ps::<_CMP_EQ_OQ>(least, zero),
        _mm256_cmp_ps::<_CMP_EQ_OQ>(most, zero),
    );
    let edges = _mm256_movemask_ps(_mm256_and_ps(inside, edges)) as u32;
    if edges != 0 {
        hits = settle(leaf, ray.ray, tmax, (edges, hits & !edges), &mut t);
    }
    (hits, t)
}

/// The hits of a leaf after [`meet`] decided the lanes that pass through an edge.
#[cold]
fn settle(
    leaf: &Leaf,
    ray: &Ray,
    tmax: f32,
    (mut edges, mut hits): (u32, u32),
    distances: &mut [f32; 8],
) -> u32 {
    let slabs = Slabs::new(ray, &Bounds::EMPTY);
    let shear = Shear::new(ray, slabs.reciprocal);
    while edges != 0 {
        let lane = (edges.trailing_zeros() & 7) as usize;
        edges &= edges - 1;
        if let Some(t) = meet(ray, &slabs, &shear, &leaf.triangle(lane))
            && ray.tmin < t
            && t <= tmax
        {
            hits |= 1 << lane;
            distances[lane] = t;
        }
    }
    hits
}

/// See `Slabs::span`: where the ray enters and leaves the box of each triangle, with the box's own margin.
#[inline]
#[target_feature(enable = "avx2")]
fn span(leaf: &Leaf, slabs: &WideSlabs) -> (__m256, __m256) {
    let signs = _mm256_set1_ps(-0.0);
    let mut reach = _mm256_setzero_ps();
    let mut boxes = [[reach; 2]; 3];
    for (axis, ends) in boxes.iter_mut().enumerate() {
        let [a, b, c] = [
            load(&leaf.corners[0][axis]),
            load(&leaf.corners[1][axis]),
            load(&leaf.corners[2][axis]),
        ];
        let origin = _mm256_set1_ps(slabs.origin[axis]);
        let lower = _mm256_min_ps(_mm256_min_ps(a, b), c);
        let upper = _mm256_max_ps(_mm256_max_ps(a, b), c);
        let [below, above] = [_mm256_sub_ps(lower, origin), _mm256_sub_ps(upper, origin)];
        reach = _mm256_max_ps(reach, _mm256_andnot_ps(signs, below));
        reach = _mm256_max_ps(reach, _mm256_andnot_ps(signs, above));
        *ends = [lower, upper];
    }

    let margin = _mm256_mul_ps(_mm256_set1_ps(MARGIN), reach);
    let ulp = _mm256_set1_ps(ULP);
    let mut entry = _mm256_set1_ps(f32::NEG_INFINITY);
    let mut exit = _mm256_set1_ps(f32::INFINITY);
    for (axis, [lower, upper]) in boxes.into_iter().enumerate() {
        let origin = _mm256_set1_ps(slabs.origin[axis]);
        let sign = _mm256_set1_ps(slabs.sign[axis]);
        let reciprocal = _mm256_set1_ps(slabs.reciprocal[axis]);
        let ahead = _mm256_or_ps(margin, sign);
        let [from, to] = [_mm256_add_ps(origin, ahead), _mm256_sub_ps(origin, ahead)];
        let from_ulp = _mm256_or_ps(_mm256_andnot_ps(signs, _mm256_mul_ps(from, ulp)), sign);
        let to_ulp = _mm256_or_ps(_mm256_andnot_ps(signs, _mm256_mul_ps(to, ulp)), sign);
        let [from, to] = [_mm256_add_ps(from, from_ulp), _mm256_sub_ps(to, to_ulp)];
        let near = _mm256_blendv_ps(lower, upper, sign);
        let far = _mm256_blendv_ps(upper, lower, sign);
        entry = _mm256_max_ps(_mm256_mul_ps(_mm256_sub_ps(near, from), reciprocal), entry);
        exit = _mm256_min_ps(_mm256_mul_ps(_mm256_sub_ps(far, to), reciprocal), exit);
    }
    (entry, exit)
}

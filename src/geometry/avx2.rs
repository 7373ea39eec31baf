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
    Hit, Ray,
    node::{BvhNode, Leaf},
    slabs::Slabs,
    traverse::{self, Query},
    triangle::Shear,
};
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
    pub(super) fn meets(self, nodes: &[BvhNode], ray: &Ray, slabs: &Slabs) -> bool {
        // SAFETY: a token exists only where AVX2 was detected.
        unsafe { meets(nodes, ray, slabs) }
    }
}

#[target_feature(enable = "avx2")]
fn intersect(query: &Query) -> Option<Hit> {
    let slabs = WideSlabs::new(query.ray, &query.slabs);
    let shear = WideShear::new(query.ray, &query.slabs, &query.shear);
    traverse::intersect(
        query,
        |node, tmax| boxes(node, &slabs, tmax),
        |leaf, tmax| triangles(leaf, &shear, tmax),
    )
}

#[target_feature(enable = "avx2")]
fn occluded(query: &Query) -> bool {
    let slabs = WideSlabs::new(query.ray, &query.slabs);
    let shear = WideShear::new(query.ray, &query.slabs, &query.shear);
    traverse::occluded(
        query,
        |node, tmax| boxes(node, &slabs, tmax),
        |leaf, tmax| triangles(leaf, &shear, tmax),
    )
}

#[target_feature(enable = "avx2")]
fn meets(nodes: &[BvhNode], ray: &Ray, slabs: &Slabs) -> bool {
    let slabs = WideSlabs::new(ray, slabs);
    traverse::meets(nodes, |node| boxes(node, &slabs, ray.tmax).0)
}

/// [`Slabs`] in every lane.
struct WideSlabs {
    entry: [__m256; 3],
    exit: [__m256; 3],
    reciprocal: [__m256; 3],
    /// The indices of the planes of entry and of exit.
    lower: [usize; 3],
    upper: [usize; 3],
    tmin: __m256,
}

impl WideSlabs {
    #[inline]
    #[target_feature(enable = "avx2")]
    fn new(ray: &Ray, slabs: &Slabs) -> WideSlabs {
        let side = |axis: usize, negative: usize| axis + 3 * (negative & 1);
        WideSlabs {
            entry: spread(slabs.entry),
            exit: spread(slabs.exit),
            reciprocal: spread(slabs.reciprocal),
            lower: [0, 1, 2].map(|axis| side(axis, slabs.negative[axis])),
            upper: [0, 1, 2].map(|axis| side(axis, 1 ^ slabs.negative[axis])),
            tmin: _mm256_set1_ps(ray.tmin),
        }
    }
}

/// [`Shear`] in every lane, and the slab of the depth axis.
struct WideShear {
    axes: [usize; 3],
    origin: [__m256; 3],
    slope: [__m256; 2],
    from_lower: __m256,
    from_upper: __m256,
    reciprocal: __m256,
    tmin: __m256,
}

impl WideShear {
    #[inline]
    #[target_feature(enable = "avx2")]
    fn new(ray: &Ray, slabs: &Slabs, shear: &Shear) -> WideShear {
        let z = shear.axes[2];
        let [mut from_lower, mut from_upper] = [slabs.entry[z], slabs.exit[z]];
        if slabs.negative[z] == 1 {
            (from_lower, from_upper) = (from_upper, from_lower);
        }
        let origin = ray.origin.to_array();
        WideShear {
            axes: shear.axes,
            origin: spread(shear.axes.map(|axis| origin[axis])),
            slope: [
                _mm256_set1_ps(shear.slope[0]),
                _mm256_set1_ps(shear.slope[1]),
            ],
            from_lower: _mm256_set1_ps(from_lower),
            from_upper: _mm256_set1_ps(from_upper),
            reciprocal: _mm256_set1_ps(slabs.reciprocal[z]),
            tmin: _mm256_set1_ps(ray.tmin),
        }
    }
}

/// Three numbers, each in every lane.
#[inline]
#[target_feature(enable = "avx2")]
fn spread(values: [f32; 3]) -> [__m256; 3] {
    [
        _mm256_set1_ps(values[0]),
        _mm256_set1_ps(values[1]),
        _mm256_set1_ps(values[2]),
    ]
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
    let mut entry = slabs.tmin;
    let mut exit = _mm256_set1_ps(tmax);
    for axis in 0..3 {
        let lower = load(&node.planes[slabs.lower[axis]]);
        let upper = load(&node.planes[slabs.upper[axis]]);
        let enters = _mm256_mul_ps(
            _mm256_sub_ps(lower, slabs.entry[axis]),
            slabs.reciprocal[axis],
        );
        let leaves = _mm256_mul_ps(
            _mm256_sub_ps(upper, slabs.exit[axis]),
            slabs.reciprocal[axis],
        );
        entry = _mm256_max_ps(enters, entry);
        exit = _mm256_min_ps(leaves, exit);
    }
    let mask = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(entry, exit)) as u32;
    let mut entries = [0.0; 8];
    // SAFETY: the array holds the eight floats written; the store asks for no alignment.
    unsafe { _mm256_storeu_ps(entries.as_mut_ptr(), entry) };
    (mask, entries)
}

/// See `portable::triangles`.
#[inline]
#[target_feature(enable = "avx2")]
fn triangles(leaf: &Leaf, shear: &WideShear, tmax: f32) -> u32 {
    // Map the corners. Written out without closures, which would be called instead of inlined.
    let [x, y, z] = shear.axes;
    let mut depths = [_mm256_setzero_ps(); 3];
    let mut across = [[_mm256_setzero_ps(); 2]; 3];
    for (corner, lanes) in leaf.corners.iter().enumerate() {
        depths[corner] = load(&lanes[z]);
        let depth = _mm256_sub_ps(depths[corner], shear.origin[2]);
        let [dx, dy] = [
            _mm256_mul_ps(shear.slope[0], depth),
            _mm256_mul_ps(shear.slope[1], depth),
        ];
        across[corner][0] = _mm256_sub_ps(_mm256_sub_ps(load(&lanes[x]), shear.origin[0]), dx);
        across[corner][1] = _mm256_sub_ps(_mm256_sub_ps(load(&lanes[y]), shear.origin[1]), dy);
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
        return 0;
    }

    // Drop those wholly before or behind the span, by the slab of the depth axis.
    let lower = _mm256_min_ps(_mm256_min_ps(depths[0], depths[1]), depths[2]);
    let upper = _mm256_max_ps(_mm256_max_ps(depths[0], depths[1]), depths[2]);
    let lower = _mm256_mul_ps(_mm256_sub_ps(lower, shear.from_lower), shear.reciprocal);
    let upper = _mm256_mul_ps(_mm256_sub_ps(upper, shear.from_upper), shear.reciprocal);
    let reached = _mm256_cmp_ps::<_CMP_LE_OQ>(_mm256_min_ps(lower, upper), _mm256_set1_ps(tmax));
    let after = _mm256_cmp_ps::<_CMP_GE_OQ>(_mm256_max_ps(lower, upper), shear.tmin);
    _mm256_movemask_ps(_mm256_and_ps(inside, _mm256_and_ps(reached, after))) as u32
}

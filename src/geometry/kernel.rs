//! The two kernels that traverse a BVH; each BVH chooses one when it is built.

#[cfg(target_arch = "x86_64")]
use super::avx2;
use super::{Bounds, Hit, Ray, node::BvhNode, portable, ray_count, traverse::Query};

/// A kernel that this machine can run.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kernel {
    /// Plain loops.
    Portable,
    /// Eight-lane intrinsics.
    #[cfg(target_arch = "x86_64")]
    Avx2(avx2::Token),
}

/// Name of the kernel that this machine runs: `avx2` or `portable`.
pub fn kernel_name() -> &'static str {
    match Kernel::fastest() {
        Kernel::Portable => "portable",
        #[cfg(target_arch = "x86_64")]
        Kernel::Avx2(_) => "avx2",
    }
}

impl Kernel {
    /// The fastest kernel that this machine can run.
    pub(super) fn fastest() -> Kernel {
        #[cfg(target_arch = "x86_64")]
        if let Some(token) = avx2::Token::detect() {
            return Kernel::Avx2(token);
        }
        Kernel::Portable
    }

    /// The first hit.
    #[inline]
    pub(super) fn intersect(self, query: &Query) -> Option<Hit> {
        ray_count::count();
        match self {
            Kernel::Portable => portable::intersect(query),
            #[cfg(target_arch = "x86_64")]
            Kernel::Avx2(token) => token.intersect(query),
        }
    }

    /// Whether anything is hit.
    #[inline]
    pub(super) fn occluded(self, query: &Query) -> bool {
        ray_count::count();
        match self {
            Kernel::Portable => portable::occluded(query),
            #[cfg(target_arch = "x86_64")]
            Kernel::Avx2(token) => token.occluded(query),
        }
    }

    /// Whether any leaf's box is met.
    #[inline]
    pub(super) fn meets(self, nodes: &[BvhNode], ray: &Ray, bounds: &Bounds) -> bool {
        match self {
            Kernel::Portable => portable::meets(nodes, ray, bounds),
            #[cfg(target_arch = "x86_64")]
            Kernel::Avx2(token) => token.meets(nodes, ray, bounds),
        }
    }
}

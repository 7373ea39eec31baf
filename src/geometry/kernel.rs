//! The two kernels that traverse a BVH; each BVH chooses one when it is built.

#[cfg(target_arch = "x86_64")]
use super::avx2;
use super::{Hit, Ray, node::BvhNode, portable, slabs::Slabs, traverse::Query};

/// A kernel that this machine can run.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kernel {
    /// Plain loops.
    Portable,
    /// Eight-lane intrinsics.
    #[cfg(target_arch = "x86_64")]
    Avx2(avx2::Token),
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
        match self {
            Kernel::Portable => portable::intersect(query),
            #[cfg(target_arch = "x86_64")]
            Kernel::Avx2(token) => token.intersect(query),
        }
    }

    /// Whether anything is hit.
    #[inline]
    pub(super) fn occluded(self, query: &Query) -> bool {
        match self {
            Kernel::Portable => portable::occluded(query),
            #[cfg(target_arch = "x86_64")]
            Kernel::Avx2(token) => token.occluded(query),
        }
    }

    /// Whether any leaf's box is met.
    #[inline]
    pub(super) fn meets(self, nodes: &[BvhNode], ray: &Ray, slabs: &Slabs) -> bool {
        match self {
            Kernel::Portable => portable::meets(nodes, ray, slabs),
            #[cfg(target_arch = "x86_64")]
            Kernel::Avx2(token) => token.meets(nodes, ray, slabs),
        }
    }
}

//! Which of the two kernels walks a tree: chosen once, when the tree is built.

#[cfg(target_arch = "x86_64")]
use super::avx2;
use super::{
    Cutouts, Hit, Ray,
    node::{Leaf, Node},
    portable,
    slab::Slabs,
};

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

    /// The first hit, and whether the ray met any box of the root.
    #[inline]
    pub(super) fn closest(
        self,
        nodes: &[Node],
        leaves: &[Leaf],
        ray: &Ray,
        slabs: &Slabs,
        cutouts: Option<&Cutouts>,
    ) -> (Option<Hit>, bool) {
        match self {
            Kernel::Portable => portable::closest(nodes, leaves, ray, slabs, cutouts),
            #[cfg(target_arch = "x86_64")]
            Kernel::Avx2(token) => token.closest(nodes, leaves, ray, slabs, cutouts),
        }
    }

    /// Whether anything is hit.
    #[inline]
    pub(super) fn blocked(
        self,
        nodes: &[Node],
        leaves: &[Leaf],
        ray: &Ray,
        slabs: &Slabs,
        cutouts: Option<&Cutouts>,
    ) -> bool {
        match self {
            Kernel::Portable => portable::blocked(nodes, leaves, ray, slabs, cutouts),
            #[cfg(target_arch = "x86_64")]
            Kernel::Avx2(token) => token.blocked(nodes, leaves, ray, slabs, cutouts),
        }
    }

    /// Whether any leaf's box is met.
    #[inline]
    pub(super) fn meets(self, nodes: &[Node], ray: &Ray, slabs: &Slabs) -> bool {
        match self {
            Kernel::Portable => portable::meets(nodes, ray, slabs),
            #[cfg(target_arch = "x86_64")]
            Kernel::Avx2(token) => token.meets(nodes, ray, slabs),
        }
    }

    /// Whether any of a node's boxes is met.
    #[inline]
    pub(super) fn near(self, node: &Node, ray: &Ray, slabs: &Slabs) -> bool {
        match self {
            Kernel::Portable => portable::near(node, ray, slabs),
            #[cfg(target_arch = "x86_64")]
            Kernel::Avx2(token) => token.near(node, ray, slabs),
        }
    }
}

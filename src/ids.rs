//! Numbers of things, each kind a type of its own, so that a node is never taken for a material.
//!
//! A number is a position in the list of its kind; `list[id]` looks it up in any list that runs along with that one.
//! `Option` of an id takes no more memory than the id: the bits of the position are kept inverted, so that no id has the
//! bits of 0. An id is never 2³² − 1.

use std::cmp::Ordering;
use std::fmt;
use std::num::NonZeroU32;
use std::ops::{Index, IndexMut, Range};

/// Defines id types: positions in 32 bits.
macro_rules! ids {
    ($($(#[$doc:meta])* $name:ident)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, PartialEq, Eq, Hash)]
        #[repr(transparent)]
        pub struct $name(NonZeroU32);

        impl $name {
            /// The id of a position.
            #[inline]
            pub const fn from_index(index: usize) -> $name {
                debug_assert!(index < u32::MAX as usize);
                $name::new(index as u32)
            }

            /// The id of a position below 2³² − 1.
            #[inline]
            pub const fn new(position: u32) -> $name {
                match NonZeroU32::new(!position) {
                    Some(inverted) => $name(inverted),
                    None => panic!("no list is as long as that"),
                }
            }

            /// The position.
            #[inline]
            pub const fn index(self) -> usize {
                self.number() as usize
            }

            /// The position in 32 bits, for packed words and seeds.
            #[inline]
            pub const fn number(self) -> u32 {
                !self.0.get()
            }

            /// The ids of a range of positions, in order.
            pub fn range(positions: Range<usize>) -> impl ExactSizeIterator<Item = $name> + Clone {
                positions.map($name::from_index)
            }

            /// The id after `count` others were put before the list.
            #[must_use]
            pub const fn after(self, count: usize) -> $name {
                $name::from_index(self.index() + count)
            }
        }

        impl Ord for $name {
            fn cmp(&self, other: &$name) -> Ordering {
                self.number().cmp(&other.number())
            }
        }

        impl PartialOrd for $name {
            fn partial_cmp(&self, other: &$name) -> Option<Ordering> {
                Some(self.cmp(other))
            }
        }

        impl fmt::Debug for $name {
            fn fmt(&self, to: &mut fmt::Formatter) -> fmt::Result {
                write!(to, "{}({})", stringify!($name), self.number())
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, to: &mut fmt::Formatter) -> fmt::Result {
                self.number().fmt(to)
            }
        }

        impl<T> Index<$name> for [T] {
            type Output = T;

            fn index(&self, id: $name) -> &T {
                &self[id.index()]
            }
        }

        impl<T> IndexMut<$name> for [T] {
            fn index_mut(&mut self, id: $name) -> &mut T {
                &mut self[id.index()]
            }
        }

        impl<T> Index<$name> for Vec<T> {
            type Output = T;

            fn index(&self, id: $name) -> &T {
                &self[id.index()]
            }
        }

        impl<T> IndexMut<$name> for Vec<T> {
            fn index_mut(&mut self, id: $name) -> &mut T {
                &mut self[id.index()]
            }
        }
    )*};
}

ids! {
    /// A node of the scene.
    NodeId
    /// A mesh of the scene: one glTF primitive.
    MeshId
    /// An instance: a mesh on a node.
    InstanceId
    /// A skin.
    SkinId
    /// A material.
    MaterialId
    /// A texture.
    TextureId
    /// A punctual light of the file.
    LightId
    /// A camera.
    CameraId
    /// A cutout: the holes in one triangle.
    CutoutId
    /// A surface of the radiosity mesh.
    SurfaceId
    /// A rigid body: surfaces that one node carries.
    BodyId
    /// A triangle of the radiosity mesh.
    TriangleId
    /// An element of the radiosity mesh.
    ElementId
    /// A side of an element: a receiver.
    SideId
    /// An emitting surface or punctual light among the emitters of one kind.
    EmitterId
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_keep_the_order_of_positions_and_none_takes_no_memory() {
        let ids: Vec<SideId> = SideId::range(0..3).collect();
        assert!(ids.is_sorted() && ids[0] < ids[2]);
        assert_eq!(
            ids.iter().map(|id| id.index()).collect::<Vec<_>>(),
            [0, 1, 2]
        );
        let last = SideId::new(u32::MAX - 1);
        assert_eq!((last.number(), [7, 8, 9][ids[1]]), (u32::MAX - 1, 8));
        assert_eq!(size_of::<Option<SideId>>(), 4);
    }
}

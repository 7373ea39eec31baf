//! Numbers of things, each kind a type of its own, so that a node is never taken for a material.
//!
//! A number is a position in the list of its kind; `list[id]` looks it up in any list that runs along with that one.

use std::fmt;
use std::ops::{Index, IndexMut};

/// Defines id types: positions in 32 bits.
macro_rules! ids {
    ($($(#[$doc:meta])* $name:ident)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[repr(transparent)]
        pub struct $name(u32);

        impl $name {
            /// The id of a position.
            pub const fn from_index(index: usize) -> $name {
                debug_assert!(index <= u32::MAX as usize);
                $name(index as u32)
            }

            /// The position.
            pub const fn index(self) -> usize {
                self.0 as usize
            }

            /// The id after `count` others were put before the list.
            #[must_use]
            pub const fn after(self, count: usize) -> $name {
                $name::from_index(self.index() + count)
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, to: &mut fmt::Formatter) -> fmt::Result {
                self.0.fmt(to)
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
}

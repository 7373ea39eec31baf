//! Axis-aligned boxes in world coordinates.

use glam::Vec3;

/// An axis-aligned box, both ends included, in metres; empty when any `lo` exceeds its `hi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The corner with the smallest coordinates, in metres.
    pub lo: Vec3,
    /// The corner with the largest coordinates, in metres.
    pub hi: Vec3,
}

impl Bounds {
    /// The box that holds nothing: the neutral element of [`Bounds::union`].
    pub const EMPTY: Bounds = Bounds {
        lo: Vec3::INFINITY,
        hi: Vec3::NEG_INFINITY,
    };

    /// The smallest box around points, given by value or by reference.
    pub fn of_points<P: std::borrow::Borrow<Vec3>>(points: impl IntoIterator<Item = P>) -> Bounds {
        points.into_iter().fold(Bounds::EMPTY, |bounds, point| {
            bounds.include(*point.borrow())
        })
    }

    /// The smallest box around both.
    #[must_use]
    pub fn union(self, other: Bounds) -> Bounds {
        Bounds {
            lo: self.lo.min(other.lo),
            hi: self.hi.max(other.hi),
        }
    }

    /// The smallest box around this one and a point.
    #[must_use]
    pub fn include(self, point: Vec3) -> Bounds {
        Bounds {
            lo: self.lo.min(point),
            hi: self.hi.max(point),
        }
    }

    /// The box grown by `margin` metres on all six sides; an empty box stays empty.
    #[must_use]
    pub fn padded(self, margin: f32) -> Bounds {
        if self.is_empty() {
            return Bounds::EMPTY;
        }
        Bounds {
            lo: self.lo - margin,
            hi: self.hi + margin,
        }
    }

    /// The surface area in m²; 0 when empty.
    pub fn area(&self) -> f32 {
        let size = self.extent();
        2.0 * (size.x * size.y + size.y * size.z + size.z * size.x)
    }

    /// The middle, in metres; meaningless when empty.
    pub fn center(&self) -> Vec3 {
        0.5 * self.lo + 0.5 * self.hi
    }

    /// The lengths of the sides in metres; zero when empty.
    pub fn extent(&self) -> Vec3 {
        if self.is_empty() {
            Vec3::ZERO
        } else {
            self.hi - self.lo
        }
    }

    /// Whether no point lies inside.
    pub fn is_empty(&self) -> bool {
        !self.lo.cmple(self.hi).all()
    }

    /// Whether it has a point in common with another box.
    #[inline]
    pub fn meets(&self, other: &Bounds) -> bool {
        self.lo.cmple(other.hi).all() && other.lo.cmple(self.hi).all()
    }

    /// Whether a point lies inside or on the surface.
    pub fn contains(&self, point: Vec3) -> bool {
        self.lo.cmple(point).all() && point.cmple(self.hi).all()
    }
}

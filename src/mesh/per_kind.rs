//! Pairs of a value for what rests and one for what moves.

use std::ops::{Index, IndexMut};

/// Emitters, receivers or surfaces that never move, or those that do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Never moves.
    Resting,
    /// Moves in some frame.
    Moving,
}

/// One value for each [`Kind`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PerKind<T> {
    /// For those that rest.
    pub resting: T,
    /// For those that move.
    pub moving: T,
}

impl Kind {
    /// Both kinds, in the order in which they are added up.
    pub const BOTH: [Kind; 2] = [Kind::Resting, Kind::Moving];

    /// The kind of what moves or not.
    pub fn of(moves: bool) -> Kind {
        if moves { Kind::Moving } else { Kind::Resting }
    }
}

impl<T> PerKind<T> {
    /// The same for references.
    pub fn as_ref(&self) -> PerKind<&T> {
        PerKind {
            resting: &self.resting,
            moving: &self.moving,
        }
    }

    /// Another value for each.
    pub fn map<U>(self, mut f: impl FnMut(T) -> U) -> PerKind<U> {
        PerKind {
            resting: f(self.resting),
            moving: f(self.moving),
        }
    }

    /// Both values, paired with those of another.
    pub fn zip<U>(self, other: PerKind<U>) -> PerKind<(T, U)> {
        PerKind {
            resting: (self.resting, other.resting),
            moving: (self.moving, other.moving),
        }
    }

    /// Both values, resting first.
    pub fn into_array(self) -> [T; 2] {
        [self.resting, self.moving]
    }
}

impl<T> From<[T; 2]> for PerKind<T> {
    fn from([resting, moving]: [T; 2]) -> PerKind<T> {
        PerKind { resting, moving }
    }
}

impl<T> Index<Kind> for PerKind<T> {
    type Output = T;
    #[inline]
    fn index(&self, kind: Kind) -> &T {
        match kind {
            Kind::Resting => &self.resting,
            Kind::Moving => &self.moving,
        }
    }
}

impl<T> IndexMut<Kind> for PerKind<T> {
    #[inline]
    fn index_mut(&mut self, kind: Kind) -> &mut T {
        match kind {
            Kind::Resting => &mut self.resting,
            Kind::Moving => &mut self.moving,
        }
    }
}

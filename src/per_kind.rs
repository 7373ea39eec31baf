//! A pair of values, one for resting and one for moving surfaces or lights.
//!
//! Receivers and emitters that never move keep their visibility over the whole animation; those that move are traced in
//! every frame. Wherever the two are kept apart, this pair holds both.

use std::ops::{Index, IndexMut};

/// Whether a surface or a light moves during the animation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// It never does.
    Resting,
    /// It does at some time.
    Moving,
}

impl Kind {
    /// Both kinds, in the order in which they are visited.
    pub const BOTH: [Kind; 2] = [Kind::Resting, Kind::Moving];

    /// The kind of something that moves, or does not.
    pub fn of(moves: bool) -> Kind {
        if moves { Kind::Moving } else { Kind::Resting }
    }

    /// A bit of its own for each kind: 1 or 2.
    pub fn bit(self) -> u8 {
        1 << self as u8
    }
}

/// A value for each [`Kind`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PerKind<T> {
    /// The value for what rests.
    pub resting: T,
    /// The value for what moves.
    pub moving: T,
}

impl<T> PerKind<T> {
    /// The value of each kind, resting first.
    pub fn from_fn(mut of: impl FnMut(Kind) -> T) -> PerKind<T> {
        let resting = of(Kind::Resting);
        PerKind {
            resting,
            moving: of(Kind::Moving),
        }
    }

    /// References to both.
    pub fn as_ref(&self) -> PerKind<&T> {
        PerKind {
            resting: &self.resting,
            moving: &self.moving,
        }
    }

    /// What a function makes of each.
    pub fn map<U>(self, mut of: impl FnMut(T) -> U) -> PerKind<U> {
        let resting = of(self.resting);
        PerKind {
            resting,
            moving: of(self.moving),
        }
    }

    /// Each with its partner in another pair.
    pub fn zip<U>(self, other: PerKind<U>) -> PerKind<(T, U)> {
        PerKind {
            resting: (self.resting, other.resting),
            moving: (self.moving, other.moving),
        }
    }

    /// Both, resting first.
    pub fn iter(&self) -> impl Iterator<Item = &T> {
        [&self.resting, &self.moving].into_iter()
    }
}

impl<T> Index<Kind> for PerKind<T> {
    type Output = T;

    fn index(&self, kind: Kind) -> &T {
        match kind {
            Kind::Resting => &self.resting,
            Kind::Moving => &self.moving,
        }
    }
}

impl<T> IndexMut<Kind> for PerKind<T> {
    fn index_mut(&mut self, kind: Kind) -> &mut T {
        match kind {
            Kind::Resting => &mut self.resting,
            Kind::Moving => &mut self.moving,
        }
    }
}

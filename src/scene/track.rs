//! Keys over time, and the value between them.
//!
//! glTF 2.0 specification, Khronos Group 2021, section 3.11 "Animations" and appendix C "Animation Sampler
//! Interpolation Modes". We depart in one point: between two equal keys the value is that key, bit for bit, so that what
//! does not move gives the same corners in every frame.

use glam::{DQuat, DVec3};

/// The keys of one property.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Key times in seconds, strictly increasing; at least one.
    pub times: Vec<f64>,
    /// One value per time; three (in-tangent, value, out-tangent) when cubic.
    pub keys: Keys,
    /// How to go from key to key.
    pub interpolation: Interpolation,
}

/// The values of a track.
#[derive(Clone, Debug, PartialEq)]
pub enum Keys {
    /// Unit quaternions; a cubic track's values and tangents are as the file gives them.
    Rotations(Vec<DQuat>),
    /// Numbers that go their ways one by one.
    Numbers {
        /// Numbers in a value; at least 1.
        width: usize,
        /// Value after value.
        values: Vec<f64>,
    },
}

/// A property's value at one time.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A unit quaternion.
    Rotation(DQuat),
    /// As many numbers as the track is wide.
    Numbers(Vec<f64>),
}

impl Value {
    /// The numbers; none of a rotation.
    pub fn numbers(self) -> Vec<f64> {
        match self {
            Value::Numbers(numbers) => numbers,
            Value::Rotation(_) => Vec::new(),
        }
    }

    /// The first number; 0 where there is none.
    pub fn number(&self) -> f64 {
        self.vector().x
    }

    /// The first three numbers; 0 where there is none.
    pub fn vector(&self) -> DVec3 {
        let at = |place: usize| match self {
            Value::Numbers(numbers) => numbers.get(place).copied().unwrap_or(0.0),
            Value::Rotation(_) => 0.0,
        };
        DVec3::new(at(0), at(1), at(2))
    }
}

/// How a track goes from key to key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// The value of the last key passed.
    Step,
    /// A straight line; for rotations the shortest arc at constant speed.
    Linear,
    /// Hermite splines with the tangents of the file.
    CubicSpline,
}

/// Position of a time among the keys.
enum KeyPlace {
    /// On a key, or before the first or after the last one.
    At(usize),
    /// Between key `left` and the next: `step` seconds long, `along` of it passed, in (0, 1).
    Between { left: usize, step: f64, along: f64 },
}

impl Track {
    /// The value at a time; outside the keys it stays at the first or last.
    ///
    /// # Panics
    /// When the track has no key, or fewer values than its times ask for; an imported track never has.
    pub fn at(&self, seconds: f64) -> Value {
        let place = self.place(seconds);
        match &self.keys {
            Keys::Rotations(keys) => Value::Rotation(self.rotation(keys, &place)),
            Keys::Numbers { width, values } => Value::Numbers(self.numbers(*width, values, &place)),
        }
    }

    /// Whether the value is the same, bit for bit, at every time.
    pub fn is_constant(&self) -> bool {
        let cubic = self.interpolation == Interpolation::CubicSpline;
        match &self.keys {
            Keys::Rotations(keys) => {
                let still = DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0);
                let keys: Vec<&[DQuat]> = keys.chunks(if cubic { 3 } else { 1 }).collect();
                constant(&keys, cubic, |key| *key == still)
            }
            Keys::Numbers { width, values } => {
                let keys: Vec<&[f64]> = values.chunks((*width).max(1)).collect();
                let keys: Vec<&[&[f64]]> = keys.chunks(if cubic { 3 } else { 1 }).collect();
                constant(&keys, cubic, |key| key.iter().all(|number| *number == 0.0))
            }
        }
    }

    fn place(&self, seconds: f64) -> KeyPlace {
        let passed = self.times.partition_point(|time| *time <= seconds);
        if passed == 0 {
            return KeyPlace::At(0);
        }
        let left = passed - 1;
        if passed == self.times.len()
            || self.times[left] == seconds
            || self.interpolation == Interpolation::Step
        {
            return KeyPlace::At(left);
        }
        let step = self.times[passed] - self.times[left];
        KeyPlace::Between {
            left,
            step,
            along: (seconds - self.times[left]) / step,
        }
    }

    fn numbers(&self, width: usize, values: &[f64], place: &KeyPlace) -> Vec<f64> {
        let cubic = self.interpolation == Interpolation::CubicSpline;
        let key = |at: usize| &values[at * width..(at + 1) * width];
        match *place {
            KeyPlace::At(at) if cubic => key(3 * at + 1).to_vec(),
            KeyPlace::At(at) => key(at).to_vec(),
            KeyPlace::Between { left, step, along } if cubic => {
                let [a, b] = [key(3 * left + 1), key(3 * left + 4)];
                let [leaving, arriving] = [key(3 * left + 2), key(3 * left + 3)];
                let [pa, pleaving, pb, parriving] = hermite(along, step);
                let between = |n: usize| {
                    if a[n] == b[n] && leaving[n] == 0.0 && arriving[n] == 0.0 {
                        return a[n];
                    }
                    a[n] * pa + leaving[n] * pleaving + b[n] * pb + arriving[n] * parriving
                };
                (0..width).map(between).collect()
            }
            KeyPlace::Between { left, along, .. } => {
                let pairs = key(left).iter().zip(key(left + 1));
                pairs.map(|(a, b)| a + (b - a) * along).collect()
            }
        }
    }

    fn rotation(&self, keys: &[DQuat], place: &KeyPlace) -> DQuat {
        let cubic = self.interpolation == Interpolation::CubicSpline;
        match *place {
            KeyPlace::At(key) if cubic => unit_or(keys[3 * key + 1], DQuat::IDENTITY),
            KeyPlace::At(key) => keys[key],
            KeyPlace::Between { left, step, along } if cubic => {
                let [a, b] = [keys[3 * left + 1], keys[3 * left + 4]];
                let [leaving, arriving] = [keys[3 * left + 2], keys[3 * left + 3]];
                let still = DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0);
                if a == b && leaving == still && arriving == still {
                    return unit_or(a, DQuat::IDENTITY);
                }
                let [pa, pleaving, pb, parriving] = hermite(along, step);
                unit_or(
                    a * pa + leaving * pleaving + b * pb + arriving * parriving,
                    unit_or(a, DQuat::IDENTITY),
                )
            }
            KeyPlace::Between { left, along, .. } => slerp(keys[left], keys[left + 1], along),
        }
    }
}

/// Whether all keys hold one value, and tangents nowhere lead away from it; a key is (in-tangent, value, out-tangent)
/// when cubic.
fn constant<T: PartialEq>(keys: &[&[T]], cubic: bool, still: impl Fn(&T) -> bool) -> bool {
    let value = usize::from(cubic);
    keys.iter().all(|key| key[value] == keys[0][value])
        && (!cubic || keys.len() == 1 || keys.iter().all(|key| still(&key[0]) && still(&key[2])))
}

/// The four weights of a Hermite spline: value left, tangent leaving, value right, tangent arriving.
fn hermite(s: f64, step: f64) -> [f64; 4] {
    let [s2, s3] = [s * s, s * s * s];
    [
        2.0 * s3 - 3.0 * s2 + 1.0,
        step * (s3 - 2.0 * s2 + s),
        3.0 * s2 - 2.0 * s3,
        step * (s3 - s2),
    ]
}

/// The shortest arc from `a` to `b` at constant speed.
fn slerp(a: DQuat, b: DQuat, along: f64) -> DQuat {
    // q and −q are one rotation: go to the nearer one.
    let (b, cosine) = if a.dot(b) < 0.0 {
        (-b, -a.dot(b))
    } else {
        (b, a.dot(b))
    };
    if a == b {
        return a;
    }
    // The sines vanish for nearly equal keys; there the chord is the arc to within (angle²)/24 ≈ 4e-8 of its length.
    const NEARLY_EQUAL: f64 = 1.0 - 5e-7;
    if cosine > NEARLY_EQUAL {
        return unit_or(a * (1.0 - along) + b * along, a);
    }
    let angle = cosine.acos();
    let sum = a * ((1.0 - along) * angle).sin() + b * (along * angle).sin();
    unit_or(sum, a)
}

/// The quaternion made unit length, or the other one when it has none.
pub(super) fn unit_or(quaternion: DQuat, other: DQuat) -> DQuat {
    let length = quaternion.length();
    if length.is_finite() && length > 1e-30 {
        quaternion * (1.0 / length)
    } else {
        other
    }
}

#[cfg(test)]
mod tests;

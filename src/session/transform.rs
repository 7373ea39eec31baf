//! Rotations and scales as edits give them.

use super::edit;
use super::scene::fault;
use crate::error::Result;
use glam::{DQuat, DVec3};

/// Smallest factor of scale, of either sign: below, corners would fall together.
const LEAST_SCALE: f64 = 1e-6;

/// The rotation that a turn is.
pub(super) fn quaternion(turn: edit::Turn, at: &str) -> Result<DQuat> {
    let made = match turn {
        edit::Turn::Quaternion([x, y, z, w]) => {
            let length = DQuat::from_xyzw(x, y, z, w).length();
            let usable = length.is_finite() && length > f64::MIN_POSITIVE;
            usable.then(|| DQuat::from_xyzw(x / length, y / length, z / length, w / length))
        }
        edit::Turn::Axis { axis, degrees } => DVec3::from(axis)
            .try_normalize()
            .filter(|_| degrees.is_finite())
            .map(|axis| DQuat::from_axis_angle(axis, degrees.to_radians())),
    };
    made.ok_or_else(|| {
        let way_out = "write e.g. {\"axis\": [0, 1, 0], \"degrees\": 90}";
        fault(
            at,
            "a rotation with a direction",
            &format!("{turn:?}"),
            way_out,
        )
    })
}

/// Refuses a scale that leaves no area, or that would turn front and back about.
pub(super) fn check_scale(new: DVec3, old: DVec3, at: &str) -> Result<()> {
    let got = format!("{new}");
    if !(new.is_finite() && new.abs().min_element() >= LEAST_SCALE) {
        let way_out = "hide the node instead, {\"hide\": {\"node\": …}}, or give another scale";
        return Err(fault(at, "factors other than 0", &got, way_out));
    }
    if (new.element_product() < 0.0) != (old.element_product() < 0.0) {
        let way_out = "mirror the object in its file and add that";
        return Err(fault(
            at,
            "a scale that does not mirror the node",
            &got,
            way_out,
        ));
    }
    Ok(())
}

//! The profile of a run as a table for the terminal.

use crate::report::profile::Profile;
use crate::report::table::grouped;
use std::fmt::Write;

/// The profile as a table.
pub fn text(profile: &Profile) -> String {
    let mut text = format!(
        "{:<14} {:>10} {:>10} {:>16} {:>10}\n",
        "phase", "s", "CPU s", "rays", "M/CPU s"
    );
    let parts = [
        ("prepare", profile.prepare),
        ("place", profile.place),
        ("trace", profile.trace),
        ("solve", profile.solve),
        ("image", profile.image),
        ("write", profile.write),
    ];
    for (name, part) in parts {
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{name:<14} {:>10.3} {:>10.3} {:>16} {:>10.2}",
            part.seconds,
            part.cpu_seconds,
            grouped(part.rays),
            part.rays_per_cpu_second / 1e6
        );
    }
    let bytes = [
        ("mesh", profile.bytes.mesh),
        ("back-buffer", profile.bytes.back_buffer),
        ("key light", profile.bytes.key_light),
        ("frame", profile.bytes.frame),
    ];
    for (name, bytes) in bytes {
        let _ = writeln!(text, "{name:<14} {:>10.1} MB", bytes as f64 / 1e6);
    }
    text
}

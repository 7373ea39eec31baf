//! Figures in the words of the page: shares, seconds and ratios, no longer than a reader needs them.

use crate::report::table::grouped;

/// A share as a percentage, with two decimals where one would make it 0 % or 100 %.
pub(super) fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    match percent.abs() {
        0.0 | 100.0 => format!("{percent:.0} %"),
        size if !(0.095..99.95).contains(&size) => format!("{percent:.2} %"),
        _ => format!("{percent:.1} %"),
    }
}

/// Seconds in the unit that suits them.
pub(super) fn seconds(value: f64) -> String {
    let (value, unit) = match value.abs() {
        0.0 => return "0".into(),
        size if size >= 0.9995 => (value, "s"),
        size if size >= 0.9995e-3 => (1e3 * value, "ms"),
        _ => (1e6 * value, "µs"),
    };
    format!("{} {unit}", short(value))
}

/// A ratio with two or three digits.
pub(super) fn times(value: f64) -> String {
    if value.is_finite() {
        format!("{}×", short(value))
    } else {
        "∞×".into()
    }
}

/// A number with at least two digits, and none that nobody reads.
fn short(value: f64) -> String {
    let digits = match value.abs() {
        size if size >= 99.5 => return grouped(value.abs().round() as u64),
        size if size >= 9.95 => 0,
        size if size >= 0.995 => 1,
        _ => 2,
    };
    let text = format!("{value:.digits$}");
    match text.split_once('.') {
        Some((whole, rest)) if rest.chars().all(|digit| digit == '0') => whole.into(),
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_for_people() {
        assert_eq!(
            [0.964, 0.0, 1.0, 0.0004].map(percent),
            ["96.4 %", "0 %", "100 %", "0.04 %"]
        );
        assert_eq!(
            [0.0, 2.5, 0.026, 0.00004, 70.0, 1234.0].map(seconds),
            ["0", "2.5 s", "26 ms", "40 µs", "70 s", "1,234 s"]
        );
        assert_eq!(
            [15.84, 0.5, 1.0, f64::INFINITY].map(times),
            ["16×", "0.50×", "1×", "∞×"]
        );
    }
}

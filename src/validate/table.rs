//! What came out: a line for each case and estimator, and the table of them.

use crate::error::{Error, Result};
use serde::Serialize;

/// One case with one estimator.
#[derive(Clone, Debug, Serialize)]
pub struct TableLine {
    /// What is known.
    pub case: String,
    /// How it was found.
    pub estimator: String,
    /// The value beforehand.
    pub expected: f64,
    /// The value found.
    pub got: f64,
    /// The difference's size.
    pub error: f64,
    /// One standard error of the samples' mean, or what half the effort changes; 0 where only rounding is left.
    pub sampling_error: f64,
    /// The error up to which it passes.
    pub allowed: f64,
    /// Whether it does.
    pub pass: bool,
}

impl TableLine {
    /// Judges a value.
    pub fn new(
        case: &str,
        estimator: &str,
        expected: f64,
        got: f64,
        sampling_error: f64,
        allowed: f64,
    ) -> TableLine {
        let error = (got - expected).abs();
        TableLine {
            case: case.into(),
            estimator: estimator.into(),
            expected,
            got,
            error,
            sampling_error,
            allowed,
            pass: error <= allowed,
        }
    }
}

/// All lines.
#[derive(Clone, Debug, Serialize)]
pub struct Validation {
    /// Case after case.
    pub lines: Vec<TableLine>,
}

impl Validation {
    /// The table, ending in a line that counts.
    pub fn text(&self) -> String {
        let wide = self.lines.iter().map(|l| l.case.chars().count()).max();
        let wide = wide.unwrap_or(0);
        let mut text = format!(
            "{:wide$}  {:12} {:>13} {:>13} {:>9} {:>9} {:>9}\n",
            "case", "estimator", "expected", "got", "error", "sampling", "allowed"
        );
        for l in &self.lines {
            let pass = if l.pass { "pass" } else { "FAIL" };
            text += &format!(
                "{:wide$}  {:12} {:13.9} {:13.9} {:9.1e} {:9.1e} {:9.1e} {pass}\n",
                l.case, l.estimator, l.expected, l.got, l.error, l.sampling_error, l.allowed
            );
        }
        let passed = self.lines.iter().filter(|l| l.pass).count();
        text + &format!("{passed} of {} pass\n", self.lines.len())
    }

    /// An error that names the first line that fails, if one does.
    pub fn check(&self) -> Result<()> {
        let mut failed = self.lines.iter().filter(|l| !l.pass);
        let Some(first) = failed.next() else {
            return Ok(());
        };
        Err(Error::Unproven {
            case: format!("{}, {}", first.case, first.estimator),
            expected: format!("{:.9} ± {:.1e}", first.expected, first.allowed),
            got: format!("{:.9}, and {} more failures", first.got, failed.count()),
            way_out: "this is a fault of sweeplight; please report it with the table".into(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_outside_its_bound_fails_the_whole() {
        let good = TableLine::new("a", "x", 1.0, 1.25, 0.1, 0.25);
        let bad = TableLine::new("b", "x", 1.0, 1.5, 0.1, 0.25);
        let nan = TableLine::new("c", "x", 1.0, f64::NAN, 0.1, 0.25);
        assert!(good.pass && !bad.pass && !nan.pass);
        let all = Validation {
            lines: vec![good, bad, nan],
        };
        assert!(all.text().ends_with("1 of 3 pass\n"));
        let told = all.check().expect_err("fails");
        assert_eq!(told.exit_code(), 1);
        assert!(
            told.to_string()
                .starts_with("validate: b, x: expected 1.000000000 ± 2.5e-1"),
            "{told}"
        );
    }
}

//! Figure 16 as a page: error against rows of form factors, and against time.

use super::convergence::ErrorCurve;
use super::figure_16::{Figure16, SolveCurve, SolveOrder};
use crate::error::Result;
use crate::report::page::chart::{Chart, Mark, Scale, Series};
use crate::report::page::plots::Plots;

/// Errors below this are not told apart.
const LEAST: f64 = 1e-4;

/// Columns of the plot against time.
const COLUMNS: usize = 48;

impl SolveOrder {
    /// The class that has its colour.
    fn class(self) -> &'static str {
        match self {
            SolveOrder::Gathering => "scratch",
            SolveOrder::Shooting => "traced",
            SolveOrder::Sorting => "solve",
            SolveOrder::Ambient => "changed",
        }
    }
}

/// The page, with the slopes of the estimators below.
///
/// # Errors
/// As [`Plots::page`].
pub fn page(figure: &Figure16, slopes: &[ErrorCurve]) -> Result<String> {
    let about = format!(
        "A furnished room of {} patches, solved in four ways; each row of form factors is found when it is asked for",
        figure.patches
    );
    let text = figure.text() + "\n" + &super::convergence::text(slopes);
    let charts = vec![against_rows(figure), against_time(figure)];
    Plots::page("Convergence", about, charts, text)
}

/// Error against rows.
fn against_rows(figure: &Figure16) -> Chart {
    let values = |curve: &SolveCurve| curve.errors.clone();
    let rows = figure.curves[0].rows.iter().map(|rows| *rows as u32);
    Chart {
        title: "Error against rows of form factors",
        meaning: format!(
            "Root mean square error of reflected light, relative to that light, after so many steps. A step finds one row of {} form factors.",
            figure.patches
        ),
        axis: "rows",
        frames: rows.collect(),
        ..chart(figure, values)
    }
}

/// Error against time, by the last note before each moment.
fn against_time(figure: &Figure16) -> Chart {
    let last = |curve: &SolveCurve| curve.seconds.last().copied().unwrap_or(0.0);
    let end = figure.curves.iter().map(last).fold(f64::INFINITY, f64::min);
    let moment = |column: usize| end * column as f64 / COLUMNS as f64;
    let values = |curve: &SolveCurve| {
        let error = |column: usize| {
            let noted = curve
                .seconds
                .partition_point(|seconds| *seconds <= moment(column));
            curve.errors[noted.saturating_sub(1)]
        };
        (0..=COLUMNS).map(error).collect()
    };
    Chart {
        title: "Error against time",
        meaning: "The same against wall-clock time on this machine, form factors included, up to the end of the quickest.".into(),
        axis: "ms",
        frames: (0..=COLUMNS).map(|column| (1e3 * moment(column)).round() as u32).collect(),
        ..chart(figure, values)
    }
}

/// A chart of the four curves, without its axis.
fn chart(figure: &Figure16, values: impl Fn(&SolveCurve) -> Vec<f64>) -> Chart {
    let series = figure.curves.iter().map(|curve| Series {
        name: curve.order.name(),
        class: curve.order.class(),
        mark: Mark::Line,
        values: values(curve)
            .into_iter()
            .map(|error| error.max(LEAST))
            .collect(),
    });
    Chart {
        title: "",
        meaning: String::new(),
        summary: "Gathering falls slowest, shooting faster, sorted shooting much faster, with the ambient term the fastest at first.".into(),
        series: series.collect(),
        scale: Scale::Log(LEAST, 2.0),
        write: |error| format!("{error:.4}"),
        level: None,
        notes: Vec::new(),
        axis: "",
        frames: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_curves_are_drawn_and_tabled() {
        let curve = |order: SolveOrder| SolveCurve {
            order,
            rows: vec![0, 10, 20],
            factors: vec![0, 100, 200],
            seconds: vec![0.0, 0.5, 1.0],
            errors: vec![1.0, 0.25, 0.0],
        };
        let figure = Figure16 {
            patches: 10,
            curves: SolveOrder::ALL.map(curve).to_vec(),
        };
        let page = page(&figure, &[]).expect("a page");
        assert_eq!(page.matches("<svg").count(), 2);
        for order in SolveOrder::ALL {
            assert!(page.contains(order.name()), "{order:?}");
        }
        assert!(page.contains("0.2500") && page.contains("ms 500"), "{page}");
        // Half way in time the second note holds, and no error is drawn below the least.
        let time = against_time(&figure);
        assert_eq!(time.series[0].values[24], 0.25);
        assert_eq!(time.series[0].values[48], LEAST);
    }
}

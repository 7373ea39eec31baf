//! Form factors between two ends as a table.

use super::pair::{FactorEstimate, PairFactors, PairFrame};
use crate::options::name_of;
use crate::report::table::grouped;
use std::fmt::Write;

impl PairFactors {
    /// The table: a block a frame, a row an estimator.
    pub fn text(&self) -> String {
        let sides = |count: usize| match count {
            1 => "1 side".to_string(),
            count => format!("{} sides", grouped(count as u64)),
        };
        let (from, to) = (&self.from, &self.to);
        let mut text = format!(
            "{}: from {} ({}) to {} ({})\n",
            self.scene,
            from.name,
            sides(from.sides.len()),
            to.name,
            sides(to.sides.len())
        );
        self.frames.iter().for_each(|frame| frame.write(&mut text));
        text + "± is one standard error, of the solve's row its deviation; all may be off alike by the bias. Factors are reciprocal \
                where A F and A′ F′ agree within that.\n\
                Where something covers part of a side, as a block the floor below it, solve, cosine, hemicube and plane leave that \
                part out; points, disks and contour do not.\n"
    }
}

impl PairFrame {
    /// Appends the frame's block.
    fn write(&self, text: &mut String) {
        let [from, to] = self.areas;
        let blocked = match self.blocked_by_movers {
            Some(share) => format!(
                "movers stop {:.2} % of what passes all that rests",
                100.0 * share
            ),
            None => "nothing passes all that rests".into(),
        };
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "\nframe {} at {:.3} s: areas {from:.6} and {to:.6} m²; {blocked}",
            self.frame, self.time
        );
        let _ = writeln!(
            text,
            "{:9} {:>12} {:>9} {:>9} {:>12} {:>9} {:>12} {:>12} {:>10} {:>12}",
            "by", "factor", "±", "bias", "back", "±", "A F, m²", "A′ F′, m²", "reciprocal", "rays"
        );
        for estimate in &self.estimates {
            let _ = writeln!(text, "{}", row(estimate));
        }
        for (method, reason) in &self.left_out {
            let name = name_of(method);
            let _ = writeln!(text, "{name:9} left out: {reason}");
        }
    }
}

/// A row of the table.
fn row(e: &FactorEstimate) -> String {
    let name = name_of(&e.by);
    format!(
        "{name:9} {:12.9} {:9.1e} {:9.1e} {:12.9} {:9.1e} {:12.9} {:12.9} {:>10} {:>12}",
        e.factor,
        e.error,
        e.bias,
        e.back,
        e.back_error,
        e.exchange,
        e.back_exchange,
        if e.reciprocal { "yes" } else { "NO" },
        grouped(e.rays)
    )
}

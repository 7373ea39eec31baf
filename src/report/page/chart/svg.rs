//! The drawing of a chart, as SVG that stretches.
//!
//! It has a width of one a frame and a height of 1000, whatever room it gets. Colours come from the page's style sheet by
//! class.

use std::fmt::Write;

use super::{Chart, Mark, Series};

/// Height of the drawing in its own units.
const HEIGHT: f64 = 1000.0;

impl Chart {
    /// The drawing.
    pub fn svg(&self) -> String {
        let columns = self.frames.len().max(1);
        let mut svg = format!(
            "<svg viewBox=\"0 0 {columns} {HEIGHT}\" preserveAspectRatio=\"none\" role=\"img\">"
        );
        let _ = write!(
            svg,
            "<title>{}</title><desc>{}</desc>",
            escaped(self.title),
            escaped(&self.summary)
        );
        for rung in self.rungs() {
            let _ = write!(
                svg,
                "<path class=\"rung\" d=\"M0 {0}H{columns}\"/>",
                at(rung.up / 100.0)
            );
        }
        let mut ground = vec![0.0; self.frames.len()];
        for series in &self.series {
            match series.mark {
                Mark::Line => self.line(series, &mut svg),
                Mark::Bar => self.bars(series, &vec![0.0; ground.len()], &mut svg),
                Mark::Stack => {
                    self.bars(series, &ground, &mut svg);
                    for (ground, value) in ground.iter_mut().zip(&series.values) {
                        *ground += value;
                    }
                }
            }
        }
        if let Some((level, _)) = self
            .level
            .as_ref()
            .filter(|level| !self.scale.is_beyond(level.0))
        {
            let _ = write!(
                svg,
                "<path class=\"level\" d=\"M0 {}H{columns}\"/>",
                at(self.scale.height(*level))
            );
        }
        for (column, tip) in self.tips().iter().enumerate() {
            let _ = write!(
                svg,
                "<rect class=\"tip\" x=\"{column}\" width=\"1\" height=\"{HEIGHT}\"><title>{}</title></rect>",
                escaped(tip)
            );
        }
        svg + "</svg>"
    }

    /// A bar a frame; the gaps close where columns get narrow.
    fn bars(&self, series: &Series, ground: &[f64], svg: &mut String) {
        let gap = if self.frames.len() > 150 { 0.0 } else { 0.12 };
        let _ = write!(svg, "<path class=\"bar {}\" d=\"", series.class);
        for (column, (value, ground)) in series.values.iter().zip(ground).enumerate() {
            let (low, high) = (
                self.scale.height(*ground),
                self.scale.height(ground + value),
            );
            let left = column as f64 + gap;
            let _ = write!(
                svg,
                "M{left} {}h{}V{}h-{1}z",
                at(low),
                1.0 - 2.0 * gap,
                at(high)
            );
        }
        svg.push_str("\"/>");
    }

    /// A line, and a point a frame.
    fn line(&self, series: &Series, svg: &mut String) {
        let points = || {
            let heights = series.values.iter().enumerate();
            heights.map(|(column, value)| (column as f64 + 0.5, at(self.scale.height(*value))))
        };
        let _ = write!(svg, "<polyline class=\"line {}\" points=\"", series.class);
        for (x, y) in points() {
            let _ = write!(svg, "{x},{y} ");
        }
        let _ = write!(svg, "\"/><path class=\"dots {}\" d=\"", series.class);
        for (x, y) in points() {
            let _ = write!(svg, "M{x} {y}h0");
        }
        svg.push_str("\"/>");
    }

    /// What each column says when it is pointed at.
    fn tips(&self) -> Vec<String> {
        let tip = |(column, frame): (usize, &u32)| {
            let words = |series: &Series| {
                let value = series.values.get(column).copied().unwrap_or(0.0);
                format!("{} {}", series.name, (self.write)(value))
            };
            let all: Vec<String> = self.series.iter().map(words).collect();
            format!("{} {frame}: {}", self.axis, all.join(", "))
        };
        self.frames.iter().enumerate().map(tip).collect()
    }
}

/// A height in the drawing, from its top.
fn at(height: f64) -> f64 {
    (10.0 * HEIGHT * (1.0 - height)).round() / 10.0
}

/// Text that may stand in a document.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::super::tests::chart;
    use super::super::{Mark, Scale};

    #[test]
    fn bars_stand_where_the_numbers_say() {
        // Of a height of 10 numbers, 1000 units: 2 ends at 800, and 1 on top of it at 700.
        let svg = chart([Mark::Stack, Mark::Stack], Scale::Linear(10.0)).svg();
        assert!(svg.contains("M1.12 1000h0.76V800h-0.76z"), "{svg}");
        assert!(svg.contains("M1.12 800h0.76V700h-0.76z"), "{svg}");
        // What is beyond the top ends there.
        assert!(svg.contains("M0.12 0h0.76V0h-0.76z"), "{svg}");
        let svg = chart([Mark::Bar, Mark::Bar], Scale::Linear(10.0)).svg();
        assert!(svg.contains("M1.12 1000h0.76V900h-0.76z"), "{svg}");
        assert!(svg.contains("<title>a &lt; b</title>"), "{svg}");
    }

    #[test]
    fn lines_have_a_point_a_frame() {
        let svg = chart([Mark::Line, Mark::Line], Scale::Log(1.0, 100.0)).svg();
        // Ten is halfway from 1 to 100; 0 lies below the ground and stays on it.
        assert!(svg.contains("points=\"0.5,500 "), "{svg}");
        assert!(svg.contains(" 2.5,1000 \""), "{svg}");
        assert_eq!(svg.matches("h0").count(), 6);
        assert_eq!(svg.matches("<rect class=\"tip\"").count(), 3);
        assert!(
            svg.contains("<title>frame 7: one 2, two 1</title>"),
            "{svg}"
        );
    }
}

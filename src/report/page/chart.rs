//! A chart: one column a frame, drawn as SVG with its words in HTML around it.
//!
//! Words are placed by percentages, so that they stay as large as the page's text on a phone.

mod svg;

/// Words below the chart: no more than fit on a phone.
const MOST_FEET: usize = 7;

/// Lines across the chart: no more than this many.
const MOST_RUNGS: f64 = 5.0;

/// What is drawn for a series.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mark {
    /// A bar from the ground; later series stand in front of earlier ones.
    Bar,
    /// A bar on top of the series before.
    Stack,
    /// A line with a point a frame.
    Line,
}

/// How heights are measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    /// From 0 to this.
    Linear(f64),
    /// From the first to the second, by ratios.
    Log(f64, f64),
}

/// A number for each frame.
#[derive(Clone, Debug)]
pub struct Series {
    /// Its name, in the key and the table.
    pub name: &'static str,
    /// Its class, which has its colour.
    pub class: &'static str,
    /// What is drawn.
    pub mark: Mark,
    /// The numbers.
    pub values: Vec<f64>,
}

/// Words at a place, in percent from the left and from the ground.
#[derive(Clone, Debug)]
pub struct Words {
    /// From the left.
    pub left: f64,
    /// From the ground.
    pub up: f64,
    /// The words.
    pub text: String,
    /// Their class.
    pub class: &'static str,
}

/// A chart as the page needs it.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Its title.
    pub title: &'static str,
    /// What it shows, in a sentence or two.
    pub meaning: String,
    /// What there is to see in it, for who cannot.
    pub summary: String,
    /// The series, in the order in which they are drawn.
    pub series: Vec<Series>,
    /// How heights are measured.
    pub scale: Scale,
    /// How a number is written.
    pub write: fn(f64) -> String,
    /// A height that is marked, with its name.
    pub level: Option<(f64, String)>,
    /// Further words in the chart.
    pub notes: Vec<Words>,
    /// What a column is, below the chart: a frame, unless it plots something else.
    pub axis: &'static str,
    /// The columns' numbers, of frames as a rule.
    pub frames: Vec<u32>,
}

impl Scale {
    /// Where a number stands, 0 at the ground and 1 at the top.
    pub fn height(self, value: f64) -> f64 {
        let share = match self {
            Scale::Linear(top) => value / top,
            Scale::Log(low, top) => (value / low).ln() / (top / low).ln(),
        };
        share.clamp(0.0, 1.0)
    }

    /// Whether a number lies above the top.
    pub fn is_beyond(self, value: f64) -> bool {
        match self {
            Scale::Linear(top) | Scale::Log(_, top) => value > top,
        }
    }
}

/// The nearest of 1, 2, 5, 10 … not below a number.
pub fn round_up(value: f64) -> f64 {
    if !(value.is_finite() && value > 0.0) {
        return 1.0;
    }
    let power = 10f64.powf(value.log10().floor());
    let digit = [1.0, 2.0, 5.0]
        .into_iter()
        .find(|digit| digit * power >= value * (1.0 - 1e-9));
    digit.unwrap_or(10.0) * power
}

/// A number more than so many times as large as nine tenths of them may leave the scale.
const FAR_OFF: f64 = 4.0;

/// A scale from 0 that holds most numbers: few that are much larger leave it, so that the others can be told apart.
pub fn scale_for(values: &[f64]) -> Scale {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let usual = (sorted.get(sorted.len().saturating_sub(1) * 9 / 10)).map_or(0.0, |most| *most);
    let near = |value: &&f64| usual <= 0.0 || **value <= FAR_OFF * usual;
    let top = values.iter().filter(near).copied().fold(0.0, f64::max);
    if top <= 0.0 {
        return Scale::Linear(1.0);
    }
    // End at a rung, with a little air.
    let step = round_up(1.05 * top / MOST_RUNGS);
    Scale::Linear((1.05 * top / step).ceil() * step)
}

impl Chart {
    /// The lines across, with their numbers.
    pub fn rungs(&self) -> Vec<Words> {
        let values: Vec<f64> = match self.scale {
            Scale::Linear(top) => {
                let step = round_up(top / MOST_RUNGS);
                let count = (top / step + 1e-6).floor() as usize;
                (0..=count).map(|rung| rung as f64 * step).collect()
            }
            Scale::Log(low, top) => {
                let decades = (top / low).log10();
                let digits: &[f64] = if decades > 2.5 {
                    &[1.0]
                } else {
                    &[1.0, 2.0, 5.0]
                };
                let first = low.log10().floor() as i32;
                let last = top.log10().ceil() as i32;
                (first..=last)
                    .flat_map(|power| digits.iter().map(move |digit| digit * 10f64.powi(power)))
                    .filter(|value| (low * 0.999..=top * 1.001).contains(value))
                    .collect()
            }
        };
        let rung = |value: f64| Words {
            left: 0.0,
            up: 100.0 * self.scale.height(value),
            text: (self.write)(value),
            class: "rung",
        };
        values.into_iter().map(rung).collect()
    }

    /// Numbers of frames below the chart.
    pub fn feet(&self) -> Vec<Words> {
        let count = self.frames.len();
        let step = (round_up(count as f64 / MOST_FEET as f64) as usize).max(1);
        let foot = |column: usize| Words {
            left: 100.0 * (column as f64 + 0.5) / count as f64,
            up: 0.0,
            text: self.frames[column].to_string(),
            class: "foot",
        };
        (0..count).step_by(step).map(foot).collect()
    }

    /// The words in the chart: its notes, and its level by name.
    pub fn words(&self) -> Vec<Words> {
        let level = self.level.as_ref().map(|(level, name)| {
            let beyond = self.scale.is_beyond(*level);
            Words {
                left: 100.0,
                up: 100.0 * self.scale.height(*level),
                text: if beyond {
                    format!("{name} ↑")
                } else {
                    name.clone()
                },
                class: if beyond { "end beyond" } else { "end" },
            }
        });
        self.notes.iter().cloned().chain(level).collect()
    }

    /// The rows of the table below it: a frame's number, and its cells.
    pub fn rows(&self) -> Vec<(u32, Vec<String>)> {
        let row = |(column, frame): (usize, &u32)| {
            let cell = |series: &Series| {
                series
                    .values
                    .get(column)
                    .map_or(String::new(), |value| (self.write)(*value))
            };
            (*frame, self.series.iter().map(cell).collect())
        };
        self.frames.iter().enumerate().map(row).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(super) fn chart(marks: [Mark; 2], scale: Scale) -> Chart {
        let series = |(name, mark, values): (&'static str, Mark, [f64; 3])| Series {
            name,
            class: name,
            mark,
            values: values.to_vec(),
        };
        Chart {
            title: "a < b",
            meaning: String::new(),
            summary: String::new(),
            series: vec![
                series(("one", marks[0], [10.0, 2.0, 0.0])),
                series(("two", marks[1], [5.0, 1.0, 4.0])),
            ],
            scale,
            write: |value| format!("{value}"),
            level: None,
            notes: Vec::new(),
            axis: "frame",
            frames: vec![0, 7, 8],
        }
    }

    #[test]
    fn numbers_are_rounded_up_to_what_people_count_in() {
        let rounded = [0.011, 0.02, 0.3, 1.0, 6.0, 70.0].map(round_up);
        let expected = [0.02, 0.02, 0.5, 1.0, 10.0, 100.0];
        for (rounded, expected) in rounded.into_iter().zip(expected) {
            assert!((rounded / expected - 1.0).abs() < 1e-12, "{rounded}");
        }
        assert_eq!((round_up(0.0), round_up(f64::NAN)), (1.0, 1.0));
    }

    #[test]
    fn what_is_far_off_may_leave_the_scale() {
        // 3.6 × 1.05 = 3.78 in steps of 1; without a later frame the first decides: 105 in steps of 50.
        assert_eq!(scale_for(&[100.0, 3.6, 2.0]), Scale::Linear(4.0));
        assert_eq!(scale_for(&[100.0]), Scale::Linear(150.0));
        assert_eq!(scale_for(&[0.0, 0.0]), Scale::Linear(1.0));
        assert_eq!(scale_for(&[4.0, 3.6]), Scale::Linear(5.0));
    }

    #[test]
    fn rungs_and_feet_are_few() {
        let chart = chart([Mark::Bar, Mark::Bar], Scale::Linear(4.0));
        let texts = |words: Vec<Words>| {
            words
                .into_iter()
                .map(|words| words.text)
                .collect::<Vec<_>>()
        };
        assert_eq!(texts(chart.rungs()), ["0", "1", "2", "3", "4"]);
        assert_eq!(texts(chart.feet()), ["0", "7", "8"]);
    }
}

//! The bars of a terminal: all of the frames below the stage at hand.

use std::time::Duration;

use indicatif::{MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle};

/// The bar of the stage: it tells only of its own steps.
const STAGE: &str = "{msg:24!} {wide_bar} {percent:>3}%";

/// The spinner of a stage whose steps are not known.
const SPINNER: &str = "{msg:24!} {spinner} {elapsed}";

/// Between two turns of the spinner.
const TURN: Duration = Duration::from_millis(200);

/// The bar of the frames.
const FRAMES: &str = "frames {pos:>5}/{len:<5}       {wide_bar} {msg}";

/// The two bars: all of the frames below the stage at hand.
pub(super) struct Bars {
    pub(super) both: MultiProgress,
    pub(super) stage: ProgressBar,
    pub(super) frames: ProgressBar,
}

impl Bars {
    /// Bars on standard error, still empty.
    pub(super) fn new() -> Bars {
        let both = MultiProgress::with_draw_target(ProgressDrawTarget::stderr());
        let stage = both.add(ProgressBar::new(0).with_style(style(SPINNER)));
        let frames = both.add(ProgressBar::new(0).with_style(style(FRAMES)));
        Bars {
            both,
            stage,
            frames,
        }
    }

    /// A stage of so many steps begins; 0 where their number is not known.
    pub(super) fn begin(&self, name: &str, total: u64) {
        let stage = &self.stage;
        stage.set_style(style(if total == 0 { SPINNER } else { STAGE }));
        stage.set_length(total);
        stage.set_position(0);
        stage.set_message(name.to_string());
        stage.reset_elapsed();
        stage.enable_steady_tick(TURN);
    }

    /// Takes them away.
    pub(super) fn finish(&self) {
        self.stage.finish_and_clear();
        self.frames.finish_and_clear();
        let _ = self.both.clear();
    }
}

/// A bar's style; a template that indicatif does not take leaves its default bar.
fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_templates_are_taken() {
        for template in [STAGE, SPINNER, FRAMES] {
            assert!(ProgressStyle::with_template(template).is_ok(), "{template}");
        }
    }
}

//! The progress of a run on a terminal.

use indicatif::{ProgressBar, ProgressStyle};
use quadmosaic::pipeline::Stage;
use std::ops::ControlFlow;

/// A progress bar on stderr, hidden where that is no terminal.
pub struct Progress {
    bar: ProgressBar,
}

impl Progress {
    pub fn new(quiet: bool) -> Self {
        let bar = if quiet { ProgressBar::hidden() } else { ProgressBar::new(100) };
        let style = ProgressStyle::with_template("{msg:12} {bar:40} {percent:>3} %").expect("the template is right");
        Self { bar: bar.with_style(style) }
    }

    pub fn show(&self, stage: Stage, share: f32) -> ControlFlow<()> {
        self.bar.set_message(stage.name());
        self.bar.set_position((100.0 * share) as u64);
        ControlFlow::Continue(())
    }

    /// Takes the bar away.
    pub fn end(&self) {
        self.bar.finish_and_clear();
    }
}

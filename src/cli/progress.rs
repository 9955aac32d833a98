//! The progress of a run on a terminal.

use indicatif::{ProgressBar, ProgressStyle};
use quadmosaic::pipeline::Stage;
use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// The steps of the bar.
const STEPS: u64 = 1000;
/// The time between two looks at the clock.
const TICK: Duration = Duration::from_millis(200);
/// The remaining time is told from here on: before, it would be a guess.
const KNOWN: (f32, Duration) = (0.1, Duration::from_secs(2));

/// A progress bar on stderr, hidden where that is no terminal.
pub struct Progress {
    bar: ProgressBar,
    /// The last share, and the time since it began at 0; it does so again where a mesh is made again.
    reached: Mutex<(f32, Instant)>,
}

impl Progress {
    pub fn new(quiet: bool) -> Self {
        let bar = if quiet { ProgressBar::hidden() } else { ProgressBar::new(STEPS) };
        let template = "{msg:12} {bar:40} {percent:>3} %  {elapsed}{prefix}";
        let bar = bar.with_style(ProgressStyle::with_template(template).expect("the template is right"));
        bar.enable_steady_tick(TICK);
        Self { bar, reached: Mutex::new((0.0, Instant::now())) }
    }

    pub fn show(&self, stage: Stage, share: f32) -> ControlFlow<()> {
        let share_of_run = of_run(stage, share);
        let mut reached = self.reached.lock().unwrap_or_else(PoisonError::into_inner);
        let started = if share_of_run < reached.0 { Instant::now() } else { reached.1 };
        *reached = (share_of_run, started);
        let left = left(share_of_run, started.elapsed());
        let told = left.map_or(String::new(), |left| format!(", about {} s left", left.as_secs().max(1)));
        self.bar.set_prefix(told);
        self.bar.set_message(stage.name());
        self.bar.set_position((STEPS as f32 * share_of_run) as u64);
        ControlFlow::Continue(())
    }

    /// Takes the bar away.
    pub fn end(&self) {
        self.bar.finish_and_clear();
    }
}

/// The share of a run that is done with a share of a stage, by the time that stages take on large meshes.
fn of_run(stage: Stage, share: f32) -> f32 {
    let percent = |stage: Stage| match stage {
        Stage::Surface => 8.0,
        Stage::Field => 6.0,
        Stage::Mosaic => 48.0,
        Stage::Connect => 15.0,
        Stage::Fill => 1.0,
        Stage::Connectivity => 11.0,
        Stage::Relocate => 8.0,
        Stage::Finish => 3.0,
    };
    let before: f32 = Stage::ALL.into_iter().take_while(|one| *one != stage).map(percent).sum();
    (before + percent(stage) * share) / 100.0
}

/// The remaining time of a run of which a share is done, once it is known.
fn left(share: f32, elapsed: Duration) -> Option<Duration> {
    (share >= KNOWN.0 && elapsed >= KNOWN.1).then(|| elapsed.mul_f32((1.0 - share) / share))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_grows_from_stage_to_stage_to_the_whole() {
        let mut last = 0.0;
        for stage in Stage::ALL {
            assert!((of_run(stage, 0.0) - last).abs() < 1e-6, "{stage:?} begins where the last one ends");
            last = of_run(stage, 1.0);
            assert!(of_run(stage, 0.5) > of_run(stage, 0.0) && of_run(stage, 0.5) < last);
        }
        assert!((last - 1.0).abs() < 1e-6);
    }

    #[test]
    fn the_remaining_time_is_told_once_it_is_known() {
        let seconds = Duration::from_secs;
        assert_eq!(left(0.25, seconds(10)), Some(seconds(30)));
        assert_eq!(left(1.0, seconds(10)), Some(seconds(0)));
        assert_eq!((left(0.05, seconds(10)), left(0.25, seconds(1))), (None, None));
    }
}

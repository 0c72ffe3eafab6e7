//! The state of a recording at one moment, and what is said of it in lines.

use std::path::PathBuf;

use inm_protocol::{AxisCounters, Health, Settings};

use super::Phase;
use crate::source::assemble::Losses;
use crate::source::audit::Proof;

/// What the view shows.
#[derive(Debug, Clone, Default)]
pub struct Snapshot {
    /// Port or file that the samples come from.
    pub source: String,
    /// What the bench does.
    pub phase: Phase,
    /// Capture that they go to.
    pub capture: Option<PathBuf>,
    /// The board's settings, where a board is asked.
    pub settings: Option<Settings>,
    /// Address of the page, where one is served.
    pub page: Option<String>,
    /// Samples a second.
    pub rate_hz: f64,
    /// Samples an axis so far, lost ones included.
    pub samples: u64,
    /// Samples an axis at the end, where that is known.
    pub expected: Option<u64>,
    /// Bytes in the capture so far.
    pub bytes: u64,
    /// Samples lost and flagged.
    pub losses: Losses,
    /// Frames that arrived damaged.
    pub damaged: u64,
    /// The board's last health record.
    pub health: Option<Health>,
    /// What the board's own bins prove.
    pub proof: Option<Proof>,
    /// Names of the axes with their unit.
    pub axes: Vec<String>,
    /// The Allan table, shortest averaging time first.
    pub table: Vec<Row>,
    /// The coefficients of the likelihood fit, once there is one.
    pub noise: Vec<NoiseRow>,
    /// The last things that happened, oldest first.
    pub news: Vec<String>,
}

/// One averaging time.
#[derive(Debug, Clone)]
pub struct Row {
    /// Averaging time, seconds.
    pub tau_s: f64,
    /// One cell an axis; `None` where there is no estimate yet.
    pub cells: Vec<Option<Cell>>,
}

/// One coefficient.
#[derive(Debug, Clone)]
pub struct NoiseRow {
    /// Its letter.
    pub symbol: &'static str,
    /// One cell an axis; `None` where there is no fit yet.
    pub cells: Vec<Option<Noise>>,
}

/// What the record shows of a coefficient up to now.
#[derive(Debug, Clone, Copy)]
pub enum Noise {
    /// Its value, and half the width of its 95 % interval as a fraction of it.
    Value(f64, f64),
    /// Not resolved from zero.
    Below {
        /// Its 95 % bound.
        bound: f64,
        /// How much longer the record has to be to show it half of the time, seconds, if it is what the
        /// best estimate says; `None` where no length would.
        more_s: Option<f64>,
    },
}

/// One Allan deviation.
#[derive(Debug, Clone, Copy)]
pub struct Cell {
    /// Allan deviation, in the unit of the axis.
    pub adev: f64,
    /// Half the width of its 95 % interval, as a fraction of it.
    pub relative: f64,
}

/// Characters of the progress bar: with its figures it fits 80 columns.
const BAR: usize = 12;

/// News among the lines: what happened last.
const LINES_OF_NEWS: usize = 4;

impl Snapshot {
    /// The state as lines of text: what is recorded, how far, what was lost, what is proven, and the
    /// last of the news.
    pub fn render(&self) -> String {
        let mut progress = self.progress();
        if self.phase != Phase::Recording {
            progress = format!("{}  {progress}", self.phase.word());
        }
        let mut lines = vec![self.headline(), progress];
        lines.extend(self.state());
        let first = self.news.len().saturating_sub(LINES_OF_NEWS);
        lines.extend(self.news[first..].iter().map(|line| format!("! {line}")));
        lines.join("\n") + "\n"
    }

    /// Where the samples come from and go to, in a line.
    pub fn headline(&self) -> String {
        let capture = self.capture.as_ref();
        let capture = capture.map_or(String::new(), |path| format!(" -> {}", path.display()));
        format!("{}{capture}   {} samples/s", self.source, self.rate_hz)
    }

    /// How far the recording is, in a line.
    pub fn progress(&self) -> String {
        let elapsed_s = self.samples as f64 / self.rate_hz;
        let mut line = clock(elapsed_s);
        if let Some(expected) = self.expected.filter(|expected| *expected > 0) {
            let done = (self.samples as f64 / expected as f64).min(1.0);
            let filled = (done * BAR as f64) as usize;
            line += &format!(
                " of {}  [{:#<filled$}{:->rest$}] {:3.0} %",
                clock(expected as f64 / self.rate_hz),
                "",
                "",
                100.0 * done,
                rest = BAR - filled,
            );
        }
        line += &format!("  {} samples an axis", self.samples);
        if self.bytes > 0 {
            line += &format!("  {:.1} MB", self.bytes as f64 / 1e6);
        }
        line
    }

    /// What was lost, how the board is, and what is proven: a line each, as far as it is known.
    pub fn state(&self) -> Vec<String> {
        let mut lines = vec![self.losses()];
        lines.extend(self.board());
        lines.extend(self.proof.map(|proof| proof.to_string()));
        lines
    }

    fn losses(&self) -> String {
        let Losses {
            lost_samples,
            gaps,
            flagged: [x, y, z],
            ..
        } = self.losses;
        format!(
            "lost {lost_samples} samples in {gaps} gaps, {} damaged frames; flagged X {x} Y {y} Z {z}",
            self.damaged
        )
    }

    fn board(&self) -> Option<String> {
        let health = self.health.as_ref()?;
        let mut said = Vec::new();
        if let Some(t) = health.mcu_centi_celsius {
            said.push(format!("board {:.1} degC", f64::from(t) / 100.0));
        }
        if let Some(mv) = health.supply_mv {
            said.push(format!("sensor supply {:.3} V", f64::from(mv) / 1000.0));
        }
        let trouble: u32 = health.axes.iter().map(trouble).sum();
        if trouble > 0 {
            said.push(format!("converter trouble {trouble} times"));
        }
        (!said.is_empty()).then(|| said.join(", "))
    }
}

/// Times that a converter had to be reset because of something that went wrong.
fn trouble(axis: &AxisCounters) -> u32 {
    axis.slipped + axis.stuck + axis.stalled + axis.registers_lost
}

/// `hh:mm:ss`.
fn clock(seconds: f64) -> String {
    let s = seconds as u64;
    format!("{:02}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lines_tell_progress_loss_and_what_happened_last() {
        let snapshot = Snapshot {
            source: "virtual".into(),
            capture: Some("run.inmcap".into()),
            rate_hz: 2000.0,
            samples: 5_400_000,
            expected: Some(10_800_000),
            losses: Losses {
                lost_samples: 32,
                gaps: 1,
                ..Losses::default()
            },
            news: (0..9)
                .map(|k| format!("sample {k}: X: the converter clips"))
                .collect(),
            ..Snapshot::default()
        };
        let text = snapshot.render();
        assert!(text.contains("00:45:00 of 01:30:00"), "{text}");
        assert!(text.contains(" 50 %"), "{text}");
        assert!(text.contains("lost 32 samples in 1 gaps"), "{text}");
        assert!(text.contains("! sample 5"), "{text}");
        assert!(!text.contains("! sample 4"), "{text}");
    }
}

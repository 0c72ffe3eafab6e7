//! What a process holds in memory while it runs.

use std::fs;
use std::io;
use std::process::Child;
use std::thread;
use std::time::Duration;

/// Between two looks: often enough for hundreds of them in the shortest night.
const PERIOD: Duration = Duration::from_millis(100);

/// What may still come, MB: longer averaging times, the fits of an axis more, and what an allocator
/// keeps. A byte kept for each of the samples of half a night at 4000/s would be 250 MB.
const GROWTH_MB: f64 = 16.0;

/// Resident memory, kB, in the order of time.
#[derive(Debug)]
pub struct Memory(Vec<u64>);

impl Memory {
    /// Looks until `child` has ended.
    pub(super) fn of(child: &mut Child) -> io::Result<Self> {
        let path = format!("/proc/{}/status", child.id());
        let mut looks = Vec::new();
        while child.try_wait()?.is_none() {
            if let Some(resident) = resident(&fs::read_to_string(&path).unwrap_or_default()) {
                looks.push(resident);
            }
            thread::sleep(PERIOD);
        }
        Ok(Self(looks))
    }

    /// Whether the last half holds no more than the first, but for what may be chance.
    pub fn is_flat(&self) -> bool {
        match self.most_mb(2)[..] {
            [first, last] => last <= first + GROWTH_MB,
            _ => false,
        }
    }

    /// The most in each of `parts` parts of the time, MB; empty where it was not seen.
    pub fn most_mb(&self, parts: usize) -> Vec<f64> {
        let part = self.0.len().div_ceil(parts).max(1);
        let most = |looks: &[u64]| looks.iter().max().map_or(0.0, |&kb| kb as f64 / 1024.0);
        self.0.chunks(part).map(most).collect()
    }
}

fn resident(status: &str) -> Option<u64> {
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmRSS:"))?;
    line.trim().strip_suffix(" kB")?.parse().ok()
}

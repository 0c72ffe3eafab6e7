//! What a tab holds from state to state.

use crate::browser::gauge::Held;

/// Looks at the beginning that do not count: code is still being compiled.
const WARMING: usize = 2;

/// States from the first look to the last that a judgement needs: a step of some 10 kB, which comes once or twice
/// after seventy states, must not be taken for a slope.
const LONG: f64 = 35.0;

/// Standard errors that a slope may be off by.
const SIGMAS: f64 = 3.0;

/// What a page that kept one picture of each state would keep of each, kB: half of what was measured with a page that
/// kept one on purpose.
const KEPT_KB: f64 = 0.5;

/// The same of nodes: the elements of the smallest picture.
const KEPT_NODES: f64 = 40.0;

/// The same of listeners: pointer, wheel, double click and keys.
const KEPT_LISTENERS: f64 = 4.0;

/// States that a tab has shown, and what it held then.
#[derive(Debug, Default)]
pub struct Course(Vec<(f64, Held)>);

impl Course {
    /// Adds a look.
    pub fn push(&mut self, states: f64, held: Held) {
        self.0.push((states, held));
    }

    /// Tells what a state costs, and where there are enough of them checks that nothing of it is kept.
    #[track_caller]
    pub fn tell(&self, name: &str) {
        for (what, of, kept) in [
            (
                "heap, kB",
                (|held| held.heap_kb) as fn(&Held) -> f64,
                KEPT_KB,
            ),
            ("nodes", |held| held.nodes, KEPT_NODES),
            ("listeners", |held| held.listeners, KEPT_LISTENERS),
        ] {
            let looks = self.0.iter().skip(WARMING);
            let looks: Vec<[f64; 2]> = looks.map(|(states, held)| [*states, of(held)]).collect();
            let [Some([first, _]), Some([last, _])] = [looks.first(), looks.last()] else {
                println!("{name}: too short for anything");
                return;
            };
            let is_long = last - first >= LONG;
            let values = looks.iter().map(|[_, value]| *value);
            let least = values.clone().fold(f64::INFINITY, f64::min);
            let most = values.fold(f64::NEG_INFINITY, f64::max);
            let [slope, error] = slope(&looks);
            println!("{name}: {what}: {least:.0} to {most:.0}, a state {slope:.3} +- {error:.3}");
            assert!(
                !is_long || slope + SIGMAS * error < kept,
                "{name}: {what}: {slope:.3} +- {error:.3} a state; less than {kept} was to be shown"
            );
        }
    }
}

/// Least squares: the slope, and its standard error.
fn slope(points: &[[f64; 2]]) -> [f64; 2] {
    let count = points.len() as f64;
    let mean = |of: usize| points.iter().map(|point| point[of]).sum::<f64>() / count;
    let [x, y] = [mean(0), mean(1)];
    let spread: f64 = points.iter().map(|point| (point[0] - x).powi(2)).sum();
    let together: f64 = points
        .iter()
        .map(|point| (point[0] - x) * (point[1] - y))
        .sum();
    let slope = together / spread;
    let left = points
        .iter()
        .map(|point| (point[1] - y - slope * (point[0] - x)).powi(2));
    [slope, (left.sum::<f64>() / (count - 2.0) / spread).sqrt()]
}

#[test]
fn a_course_that_rises_is_told_from_one_that_does_not() {
    let points = [0.0, 1.0, 2.0, 3.0].map(|x| [x, 5.0 + 2.0 * x]);
    assert_eq!(slope(&points), [2.0, 0.0]);
    let held = |heap_kb| Held {
        heap_kb,
        nodes: 9.0,
        listeners: 4.0,
    };
    let course = |rise: f64| {
        let looks = (0..40).map(|look| (f64::from(look), held(500.0 + rise * f64::from(look))));
        Course(looks.collect())
    };
    course(0.1).tell("still");
    for rise in [0.6, 2.0] {
        let told = std::panic::catch_unwind(|| course(rise).tell("grows"));
        assert!(told.is_err(), "{rise}");
    }
}

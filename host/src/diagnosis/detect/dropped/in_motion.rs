//! A loss of samples that was taken for motion.

use super::loss::Loss;
use super::{search, strongest};
use crate::diagnosis::detect::lines;
use crate::diagnosis::detect::look::Look;
use crate::model::motion;

/// The loss as it is without the motion that is known, where its moment lies within all of that: what a loss makes of lines
/// moves the axis, and hides its moment once it is left out.
pub fn loss(look: &Look<'_>) -> Option<Loss> {
    let values = look.axis.explanation(motion::KIND)?.effect.plain();
    let mut without = look.axis.clone();
    without.withdraw_where(|one| one.kind() == motion::KIND);
    without.refresh().ok()?;
    let found = strongest(lines::lines(&without, look.level()));
    let loss = search::lost_samples(&without, &found, look.level())?;
    let time_s = loss.index as f64 / look.axis.rate_hz;
    let mut stretches = values.chunks_exact(motion::ROW).map(motion::Stretch::of);
    let is_then =
        |one: motion::Stretch| (one.time_s..one.time_s + one.duration_s).contains(&time_s);
    stretches.all(is_then).then_some(loss)
}

#[cfg(test)]
mod tests {
    use super::super::tests::trial as losing;
    use super::super::{DETECTOR, KIND};
    use super::*;
    use crate::diagnosis::detect::trial;
    use crate::diagnosis::explanation::Change;

    #[test]
    fn motion_in_which_a_loss_lies_is_the_loss_itself() {
        // Left out, it hides the moment.
        for (from_end, is_loss) in [(0.01, true), (0.3, false)] {
            let mut trial = losing(0, 9);
            let len = trial.axis.residual.len();
            let from = ((0.5 - from_end) * len as f64) as usize;
            let stretch = from..from + len / 50;
            let [time_s, duration_s] =
                [stretch.start, stretch.len()].map(|n| n as f64 / trial.axis.rate_hz);
            let change = Change::Happened {
                masked: vec![stretch],
                waves: Vec::new(),
            };
            let values = [time_s, duration_s, 0.0, 12.0, 1.0, 0.1, 0.0, 0.0];
            trial.know(motion::KIND, values, change);
            let mut proposals = trial.ask(&DETECTOR);
            let last = proposals.pop().into_iter().collect();
            let found = trial::candidate(last).expect("a loss");
            assert_eq!(found.effect.kind, KIND, "seed 0");
            let goes = found.supersedes.contains(&motion::KIND);
            assert_eq!(goes, is_loss, "seed 0: {from_end}");
            let off = found.effect.plain()[0] * trial.axis.rate_hz - 0.5 * len as f64;
            assert!(off.abs() < 20.0, "seed 0: {off} samples off");
        }
    }
}

//! Which lines can have nothing to do with one another: a machine's harmonics and side lines are one source.

use super::mark::{Log, SAME};

/// Highest harmonic that counts as the same source: a choice.
const HARMONICS: f64 = 20.0;

/// Side lines on either side of a harmonic that do: a machine that is modulated. Two are a choice.
const SIDE_LINES: i32 = 2;

/// The source of each line, numbered from 0: multiples of one base, with side lines at equal
/// distances, are one source.
pub(super) fn sources(lines: &[Log]) -> Vec<usize> {
    let hertz: Vec<f64> = lines.iter().map(|line| line.log.exp()).collect();
    let sd_hz = |line: usize| lines[line].sd * hertz[line];
    // Which lines a base and a distance of side lines explain.
    let explained = |base: usize, side_hz: f64, side_sd_hz: f64| -> Vec<bool> {
        (0..lines.len())
            .map(|line| {
                (-SIDE_LINES..=SIDE_LINES).any(|side| {
                    let side = f64::from(side);
                    let number = ((hertz[line] - side * side_hz) / hertz[base]).round();
                    let off = hertz[line] - side * side_hz - number * hertz[base];
                    let sd = sd_hz(line)
                        .hypot(number * sd_hz(base))
                        .hypot(side * side_sd_hz);
                    (1.0..=HARMONICS).contains(&number) && off.abs() < SAME * sd
                })
            })
            .collect()
    };
    let count = |explained: &[bool]| explained.iter().filter(|one| **one).count();
    let mut source = vec![usize::MAX; lines.len()];
    let mut next = 0;
    while source.contains(&usize::MAX) {
        let left = |line: &usize| source[*line] == usize::MAX;
        let mut best: Vec<bool> = Vec::new();
        let mut most = 0;
        for base in (0..lines.len()).filter(left) {
            let plain = explained(base, 0.0, 0.0);
            let own = (0..lines.len())
                .filter(left)
                .filter(|&line| plain[line])
                .count();
            if own > most {
                (best, most) = (plain.clone(), own);
            }
            // A distance is known by one line; it must explain another to be believed.
            for other in (0..lines.len()).filter(left).filter(|&line| !plain[line]) {
                let side_hz = (hertz[other] - hertz[base]).abs();
                if side_hz > 0.4 * hertz[base] {
                    continue;
                }
                let all = explained(base, side_hz, sd_hz(other).hypot(sd_hz(base)));
                let own = (0..lines.len())
                    .filter(left)
                    .filter(|&line| all[line])
                    .count();
                if own > most && count(&all) > count(&plain) + 1 {
                    (best, most) = (all, own);
                }
            }
        }
        for (line, explained) in best.iter().enumerate() {
            if *explained && source[line] == usize::MAX {
                source[line] = next;
            }
        }
        if most == 0 {
            break;
        }
        next += 1;
    }
    source
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source_of(f_hz: &[f64]) -> Vec<usize> {
        let line = |f_hz: &f64| Log {
            log: f_hz.ln(),
            sd: 1e-5,
            wanders: false,
        };
        sources(&f_hz.iter().map(line).collect::<Vec<_>>())
    }

    #[test]
    fn a_distance_of_side_lines_is_believed_if_it_explains_another() {
        assert_eq!(source_of(&[10.0, 11.3]), [0, 1]);
        assert_eq!(source_of(&[10.0, 11.3, 8.7]), [0, 0, 0]);
        assert_eq!(source_of(&[10.0, 11.3, 31.3]), [0, 0, 0]);
    }
}

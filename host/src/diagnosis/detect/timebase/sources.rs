//! Which lines can have nothing to do with one another: a machine's harmonics and side lines are one source.

use super::mark::{Log, SAME};

/// Highest harmonic that counts as the same source: a choice.
const HARMONICS: f64 = 20.0;

/// Side lines on either side of a harmonic that do: a machine that is modulated. Two are a choice.
const SIDE_LINES: i32 = 2;

/// A frequency and its standard deviation, hertz.
#[derive(Clone, Copy)]
struct Hertz {
    f_hz: f64,
    sd_hz: f64,
}

/// No side lines.
const NONE: Hertz = Hertz {
    f_hz: 0.0,
    sd_hz: 0.0,
};

/// Which lines the multiples of the line `base` are, with side lines at the distance `apart`.
fn explained(lines: &[Hertz], base: usize, apart: Hertz) -> Vec<bool> {
    let base = lines[base];
    let is_explained = |line: &Hertz| {
        (-SIDE_LINES..=SIDE_LINES).any(|side| {
            let side = f64::from(side);
            let number = ((line.f_hz - side * apart.f_hz) / base.f_hz).round();
            let off = line.f_hz - side * apart.f_hz - number * base.f_hz;
            let sd = line
                .sd_hz
                .hypot(number * base.sd_hz)
                .hypot(side * apart.sd_hz);
            (1.0..=HARMONICS).contains(&number) && off.abs() < SAME * sd
        })
    };
    lines.iter().map(is_explained).collect()
}

/// The source of each line, numbered from 0: multiples of one base, with side lines at equal
/// distances, are one source.
pub(super) fn sources(lines: &[Log]) -> Vec<usize> {
    let hertz = |line: &Log| Hertz {
        f_hz: line.log.exp(),
        sd_hz: line.sd * line.log.exp(),
    };
    let hertz: Vec<Hertz> = lines.iter().map(hertz).collect();
    let count = |explained: &[bool]| explained.iter().filter(|one| **one).count();
    let mut source = vec![usize::MAX; lines.len()];
    let mut next = 0;
    while source.contains(&usize::MAX) {
        let left = |line: &usize| source[*line] == usize::MAX;
        let mut best: Vec<bool> = Vec::new();
        let mut most = 0;
        for base in (0..lines.len()).filter(left) {
            let plain = explained(&hertz, base, NONE);
            let own = (0..lines.len())
                .filter(left)
                .filter(|&line| plain[line])
                .count();
            if own > most {
                (best, most) = (plain.clone(), own);
            }
            // A distance is known by one line; it must explain another to be believed.
            for other in (0..lines.len()).filter(left).filter(|&line| !plain[line]) {
                let side = Hertz {
                    f_hz: (hertz[other].f_hz - hertz[base].f_hz).abs(),
                    sd_hz: hertz[other].sd_hz.hypot(hertz[base].sd_hz),
                };
                if side.f_hz > 0.4 * hertz[base].f_hz {
                    continue;
                }
                let all = explained(&hertz, base, side);
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

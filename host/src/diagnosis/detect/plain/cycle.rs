//! What comes again and again: the frequency at which a cycle with all its multiples leaves least.

use realfft::num_complex::Complex64;

use super::fit::{Course, Cycle, Fitted};
use super::means::Means;
use super::settlings;
use crate::fft;
use crate::numeric::product::dot;
use crate::numeric::simplex::climbed;
use crate::numeric::top::climb;
use crate::spectrum::record_lines::LEAST_CYCLES;

/// Cycles at least: a choice. Fewer turns are a course of the level like any other.
pub const FEWEST: usize = 5;

/// Multiples by which the frequency is sought: a choice. The fifth is seldom the strongest to tell it.
const SOUGHT_BY: usize = 6;

/// Multiples at most: a choice. What switches and follows within a twentieth of its turn has a thousandth of its size there.
const MOST: usize = 128;

/// Nats that a multiple costs: two numbers fitted (H. Akaike, IEEE Trans. Autom. Control 19 (1974) 716). What a kink leaves to the high multiples
/// is seen in all of them together.
const PRICE: f64 = 2.0;

/// Nats by which multiples pay for themselves, all together, for a cycle to be more than one line: by chance those of 128 do once in some
/// thousand records.
const SURE: f64 = 9.0;

/// Cycles a record to which a frequency is sought: of a line a thousand deviations large half of one.
const CLOSE: f64 = 1e-5;

/// Highest frequency of a multiple, cycles a mean: a mean takes a fifth off it.
pub const HIGHEST: f64 = 0.25;

/// The strongest line may be the second or third multiple.
const STRONGEST: usize = 3;

/// A cycle among `means`, beside as many settlings as leave least, at most one.
pub fn best(means: &Means) -> Option<Fitted> {
    let found = strongest(means).into_iter();
    let found = found.filter_map(|turns| about(means, line(means, turns / means.factor as f64)?));
    let found = found.min_by(|a, b| costs(a, means).total_cmp(&costs(b, means)))?;
    let found = with_all(means, &found)?;
    let few = FEWEST as f64 / (means.len() * means.factor) as f64;
    found.course.cycle.filter(|cycle| cycle.cycles >= few)?;
    Some(found)
}

/// A cycle with a line at this frequency, cycles a sample: its first multiple or another.
fn about(means: &Means, cycles: f64) -> Option<Fitted> {
    let all = (1..=STRONGEST).filter_map(|number| {
        let found = at(means, cycles / number as f64)?;
        (number == 1 || has_others(means, &found, number)).then_some(found)
    });
    // Any line is the second of half its frequency.
    all.reduce(|one, slower| {
        if costs(&slower, means) + 2.0 * SURE < costs(&one, means) {
            slower
        } else {
            one
        }
    })
}

/// Whether a cycle has more than multiples of one `number`, in the noise about each: what a strong line leaves where samples are
/// missing is more than noise of one density, at a third of its frequency too.
fn has_others(means: &Means, found: &Fitted, number: usize) -> bool {
    let multiples = found.course.cycle.map_or(0, |cycle| cycle.multiples);
    let others = (1..=multiples).filter(|multiple| multiple % number != 0);
    let nats: f64 = others
        .map(|multiple| nats(means, found, multiple) - PRICE)
        .sum();
    nats > SURE
}

/// What a course costs: twice its nats, and its numbers at the logarithm of how many means there are (G. Schwarz, Ann. Stat. 6,
/// 1978).
pub fn costs(fitted: &Fitted, means: &Means) -> f64 {
    fitted.course.freedom() * means.known().ln() - 2.0 * fitted.nats(means)
}

/// Where the strongest lines may be, cycles a mean: of steps from mean to mean, in which a settling leaks less, and of the level that goes
/// by these steps. In steps the kinks of one that is switched stand out at any multiple.
fn strongest(means: &Means) -> Vec<f64> {
    let steps = means.values.windows(2).map(|two| two[1] - two[0]);
    let mut steps: Vec<f64> = steps.collect();
    let len = steps.len();
    let transform = fft::real_forward(len);
    let mut ordinates = vec![Complex64::ZERO; len / 2 + 1];
    if transform.process(&mut steps, &mut ordinates).is_err() {
        return Vec::new();
    }
    let last = (STRONGEST * LEAST_CYCLES as usize).min(len / 4);
    let top = |power: &dyn Fn(usize) -> f64| {
        (FEWEST..=last).max_by(|&a, &b| power(a).total_cmp(&power(b)))
    };
    let of_steps = top(&|k| ordinates[k].norm_sqr());
    let of_level = top(&|k| ordinates[k].norm_sqr() / (k * k) as f64);
    let mut tops: Vec<usize> = of_steps.into_iter().chain(of_level).collect();
    tops.dedup();
    tops.into_iter().map(|k| k as f64 / len as f64).collect()
}

/// The frequency of a line near one, where it has a good part of what the means have.
fn line(means: &Means, cycles: f64) -> Option<f64> {
    /// Part of the energy that it leaves, at most: a choice. Of a cycle most is in its strongest line.
    const LEFT: f64 = 0.75;
    let samples = (means.len() * means.factor) as f64;
    let of = |turns: f64| {
        let cycle = Some(Cycle {
            cycles: turns / samples,
            multiples: 1,
        });
        let course = Course {
            settlings: Vec::new(),
            cycle,
        };
        Fitted::new(means, course).map_or(f64::INFINITY, |one| one.energy)
    };
    let (turns, height) = climb(cycles * samples, 0.5, CLOSE, |turns| -of(turns));
    (-height < LEFT * dot(&means.values, &means.values)).then_some(turns / samples)
}

/// The likeliest cycle near a frequency, with or without a settling.
fn at(means: &Means, cycles: f64) -> Option<Fitted> {
    let samples = (means.len() * means.factor) as f64;
    if !(FEWEST as f64..=LEAST_CYCLES).contains(&(cycles * samples)) {
        return None;
    }
    let multiples = multiples(means, cycles, SOUGHT_BY);
    let of = |turns: f64, settlings: &[f64]| {
        let course = Course {
            settlings: settlings.to_vec(),
            cycle: Some(Cycle {
                cycles: turns / samples,
                multiples,
            }),
        };
        Fitted::new(means, course)
    };
    let nats = |fitted: Option<Fitted>| fitted.map_or(f64::NEG_INFINITY, |one| one.nats(means));
    let first = cycles * samples;
    let (alone, _) = climb(first, 0.25, CLOSE, |turns| nats(of(turns, &[])));
    let times = settlings::times(means).map(|time| (nats(of(alone, &[time])), time));
    let (_, time) = times.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let both = climbed(&[alone, time.ln()], &[0.1, 0.2], |at| {
        nats(of(at[0], &[at[1].exp()]))
    });
    let alone = of(alone, &[]);
    let both = of(both[0], &[both[1].exp()]).filter(|one| settlings::are_held(means, &one.course));
    let all = [alone, both].into_iter().flatten();
    all.min_by(|a, b| costs(a, means).total_cmp(&costs(b, means)))
}

/// A course of `values` with the multiples of its cycle that are too fast for the `means` in which it was found.
pub fn continued(values: &[f64], means: &Means, course: Course) -> Course {
    let Some(cycle) = course.cycle else {
        return course;
    };
    if multiples(means, cycle.cycles, MOST) == MOST {
        return course;
    }
    let finer = (HIGHEST / (cycle.cycles * MOST as f64)) as usize;
    let finer = Means::over(values, finer.clamp(1, means.factor));
    let all = Fitted::new(&finer, course.clone()).and_then(|one| with_all(&finer, &one));
    all.map_or(course, |one| one.course)
}

/// The same with all multiples that pay for themselves.
fn with_all(means: &Means, found: &Fitted) -> Option<Fitted> {
    let with = |course: &Course, multiples: usize| {
        let cycle = course.cycle.map(|cycle| Cycle { multiples, ..cycle });
        let course = Course {
            cycle,
            ..course.clone()
        };
        Fitted::new(means, course)
    };
    let most = multiples(means, found.course.cycle?.cycles, MOST);
    let all = with(&found.course, most)?.climbed(means);
    let mut sum = 0.0;
    let paid = (2..=most).map(|multiple| {
        sum += nats(means, &all, multiple) - PRICE;
        (sum, multiple)
    });
    let (paid, last) = paid.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, 1));
    with(&all.course, if paid > SURE { last } else { 1 })
}

/// What a multiple gains in the noise about it, nats; by chance it is one.
pub fn nats(means: &Means, fitted: &Fitted, multiple: usize) -> f64 {
    let place = fitted.course.place_of_multiple(multiple);
    let square = fitted.sizes[place].powi(2) + fitted.sizes[place + 1].powi(2);
    let base = fitted.course.cycle.map_or(0.0, |cycle| cycle.cycles);
    let noise = means.density(&fitted.left, multiple as f64 * base, base);
    0.25 * square * means.known() / noise
}

/// How many multiples the means show, at most so many.
fn multiples(means: &Means, cycles: f64, most: usize) -> usize {
    let shown = (HIGHEST / (cycles * means.factor as f64)) as usize;
    shown.clamp(1, most)
}

//! A plain course as explanations: each settling a warm-up, a cycle with its multiples lines of one cause.

use super::cycle;
use super::fit::{Course, Covariance, Cycle, Fitted, Part};
use super::means::Means;
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::diagnosis::explanation::{Candidate, Change};
use crate::diagnosis::held_out::SEEN_COST;
use crate::diagnosis::record::wave::Wave;
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::value::Value;
use crate::diagnosis::statistic::p_value;
use crate::model::{hum, sinusoid, warmup};
use crate::numeric::product::dot;

/// What is to be done about a course: its parts that are plain by themselves get a name.
pub fn proposals(look: &Look<'_>, means: &Means, fitted: &Fitted) -> Vec<Proposal> {
    let Some(covariance) = fitted.covariance(means) else {
        return Vec::new();
    };
    let told = Told {
        look,
        means,
        fitted,
        covariance,
    };
    let course = &fitted.course;
    let settlings = (0..course.settlings.len()).map(|number| told.settling(number));
    let cycle = course.cycle.map(|cycle| told.cycle(cycle));
    let candidates = settlings.chain(cycle).zip(course.parts());
    let candidates = candidates.filter(|(_, part)| super::is_plain_part(means, fitted, part));
    let candidates = candidates.map(|(candidate, Part { without, .. })| {
        let freedom = candidate.freedom;
        let nats = fitted.nats(means)
            - Fitted::new(means, without.clone()).map_or(0.0, |one| one.nats(means));
        Candidate {
            p_value: p_value::chi_squared(2.0 * nats, freedom),
            held_out_nats: held_out_nats(means, course, &without),
            ..candidate
        }
    });
    candidates
        .map(|one| Proposal::Explain(Box::new(one)))
        .collect()
}

/// What a course gains over that `without` a part on means that its sizes were not fitted to, nats.
fn held_out_nats(means: &Means, course: &Course, without: &Course) -> Option<f64> {
    let halves = [means.half(0), means.half(1)];
    let left = |course: &Course, train: &Means, held: &Means| {
        let sizes = Fitted::new(train, course.clone())?.sizes;
        let total = course.total(held, &sizes);
        let left = held
            .values
            .iter()
            .zip(total)
            .map(|(value, one)| value - one);
        let left: Vec<f64> = left.collect();
        Some(dot(&left, &left))
    };
    let gain = |train: &Means, held: &Means| {
        let both = left(without, train, held)? / left(course, train, held)?;
        Some(0.5 * held.known() * both.ln())
    };
    let shapes = course.settlings.len() - without.settlings.len();
    let shapes = if shapes == 0 { 1 } else { shapes };
    let [first, second] = [&halves[0], &halves[1]];
    Some(gain(first, second)? + gain(second, first)? - SEEN_COST * shapes as f64)
}

/// A course with what is known of its numbers.
struct Told<'a> {
    look: &'a Look<'a>,
    means: &'a Means,
    fitted: &'a Fitted,
    covariance: Covariance,
}

impl Told<'_> {
    /// Square of what is left, as if it were white, to a settling with this time constant, samples: at averaging times that leave
    /// enough of them, and from there on as it rises with them, at most as that of a walk.
    fn square(&self, samples: f64) -> f64 {
        /// Parts of the record that say what noise there is, at least: of fewer a course takes a good part out.
        const LEAST: usize = 32;
        /// How many times shorter the averaging time is beside which it rises.
        const SHORTER: usize = 4;
        let time = samples / self.means.factor as f64;
        let m = (time as usize).clamp(SHORTER, self.means.len() / LEAST);
        let [long, short] = [m, m / SHORTER].map(|m| self.means.white(&self.fitted.left, m));
        let slope = (long / short).ln() / (SHORTER as f64).ln();
        long * (time / m as f64).powf(slope.clamp(0.0, 2.0))
    }

    fn settling(&self, number: usize) -> Candidate {
        let course = &self.fitted.course;
        let samples = course.settlings[number];
        let place = Course::place_of(number);
        let square = self.square(samples);
        let sd = |variance: f64| (square * variance).sqrt();
        let amplitude = self.fitted.sizes[place];
        let time_s = samples / self.look.axis.rate_hz;
        let values = [
            Value::normal(amplitude, sd(self.covariance.of_size(place))),
            Value::log_normal(time_s, sd(self.covariance.of_shape(number))),
        ];
        let wave = Wave::WarmUp { amplitude, samples };
        let effect = Estimate::new(warmup::KIND, values);
        Candidate::new(effect, 0.0, 2.0, Change::Waves(vec![wave]))
    }

    fn cycle(&self, cycle: Cycle) -> Candidate {
        let rate_hz = self.look.axis.rate_hz;
        let variance = self.covariance.of_shape(self.fitted.course.settlings.len());
        let noise = self
            .means
            .density(&self.fitted.left, cycle.cycles, cycle.cycles);
        let sd = (noise * variance).sqrt();
        let base = Value::normal(cycle.cycles * rate_hz, sd * rate_hz);
        let lines = (1..=cycle.multiples).map(|multiple| self.line(cycle, multiple));
        let lines: Vec<Option<(Value, Wave)>> = lines.collect();
        let freedom =
            self.fitted.course.freedom() - 2.0 * self.fitted.course.settlings.len() as f64;
        let amplitudes = lines.iter().map(|line| Some(line.as_ref()?.0));
        let effect = if cycle.multiples == 1 {
            let values = [Some(base)].into_iter().chain(amplitudes);
            Estimate {
                kind: sinusoid::KIND,
                values: values.collect(),
            }
        } else {
            let values = [Some(base), None, None].into_iter().chain(amplitudes);
            Estimate {
                kind: hum::KIND,
                values: values.collect(),
            }
        };
        let waves = lines.into_iter().flatten().map(|(_, wave)| wave).collect();
        Candidate::new(effect, 0.0, freedom, Change::Waves(waves))
    }

    /// Amplitude of a multiple ahead of the declared chain, and the line as it is taken out: less by what noise adds to it on average, so
    /// that as much noise stays there as beside it. `None` where that is all.
    fn line(&self, cycle: Cycle, multiple: usize) -> Option<(Value, Wave)> {
        let axis = self.look.axis;
        let cycles = multiple as f64 * cycle.cycles;
        let place = self.fitted.course.place_of_multiple(multiple);
        let own = 1.0 - cycle::nats(self.means, self.fitted, multiple).recip();
        let [cosine, sine] = [place, place + 1].map(|place| own * self.fitted.sizes[place]);
        let amplitude = f64::hypot(cosine, sine);
        let variance = self
            .covariance
            .of_size(place)
            .max(self.covariance.of_size(place + 1));
        let noise = self.means.density(&self.fitted.left, cycles, cycle.cycles);
        let sd = (noise * variance).sqrt();
        let passed = axis.bins.chain_power(cycles * axis.rate_hz).sqrt();
        let wave = Wave::Line {
            cycles,
            cosine,
            sine,
            lost: None,
        };
        (own > 0.0).then(|| (Value::normal(amplitude / passed, sd / passed), wave))
    }
}

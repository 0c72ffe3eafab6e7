//! Records with gaps and with a mean far larger than the noise.

mod normal;

use allan::{Allan, Config, DataType, Style};
use inm_allan::edf::{Noise, edf};
use inm_allan::fixed_point::FixedPoint;
use inm_allan::{BlockEstimate, BlockMeans, Estimate, FloatBins, HostBins, Statistic};
use normal::Normal;

/// White noise of deviation 1 on a mean of 5 with 10 % of the samples missing, in runs of 100 at
/// random places.
struct Gappy {
    /// Runs of codes, each followed by 100 missing samples.
    runs: Vec<Vec<i32>>,
}

/// Codes to the unit.
const SCALE: f64 = 1e6;
const GAP: u64 = 100;
const SAMPLES: usize = 2_000_000;
const SEED: u64 = 20_260;

impl Gappy {
    fn new() -> Self {
        let mut normal = Normal { state: SEED };
        let mut left = SAMPLES;
        let mut runs = Vec::new();
        while left > 0 {
            // Runs of 400 to 1400, 900 on average.
            let len = ((400.0 + 1000.0 * normal.uniform()) as usize).min(left);
            left -= len;
            runs.push(
                (0..len)
                    .map(|_| ((5.0 + normal.next()) * SCALE) as i32)
                    .collect(),
            );
        }
        Self { runs }
    }
}

/// Three standard deviations of an estimate, as a fraction of it.
fn tolerance(statistic: Statistic, estimate: &Estimate) -> f64 {
    let Estimate {
        m, terms, stride, ..
    } = *estimate;
    // Spread over many runs the differences overlap less than in one: never fewer than this.
    3.0 * (2.0 / edf(statistic, Noise::White, m, stride, terms)).sqrt()
}

#[test]
#[cfg_attr(miri, ignore = "statistics over two million samples")]
fn a_mean_of_five_does_not_leak_through_gaps() {
    let record = Gappy::new();
    let mut bins = HostBins::new();
    let mut means = BlockMeans::<16>::starting_at(0);
    for run in &record.runs {
        bins.push_slice(run);
        bins.skip(GAP);
        means.push_slice(run);
        means.skip(GAP);
    }
    let white = |m: u64| SCALE * SCALE / m as f64;
    let mut longest = 0;
    for point in bins.points(Statistic::Allan) {
        let relative = point.variance / white(point.m) - 1.0;
        let limit = tolerance(Statistic::Allan, &point);
        assert!(
            relative.abs() < limit,
            "{point:?}: {relative}, limit {limit}, seed {SEED}"
        );
        longest = longest.max(point.m);
    }
    assert!((640..700).contains(&longest), "{longest}");
    // The Hadamard variance of white noise is the same.
    for point in bins.points(Statistic::Hadamard) {
        let relative = point.variance / white(point.m) - 1.0;
        assert!(
            relative.abs() < tolerance(Statistic::Hadamard, &point),
            "{point:?}"
        );
    }
    let mut beyond = 0;
    for BlockEstimate {
        estimate,
        white_bias,
    } in means.points().filter(|point| point.estimate.m > longest)
    {
        let relative = estimate.variance / (white(estimate.m) * white_bias) - 1.0;
        let limit = tolerance(Statistic::Allan, &estimate);
        assert!(
            relative.abs() < limit,
            "{estimate:?}: {relative}, limit {limit}, seed {SEED}"
        );
        assert!((1.0..1.112).contains(&white_bias));
        beyond += 1;
    }
    assert!(beyond >= 8, "{beyond}");
}

/// What there is to compare with: a phase that stands still in a gap sees the mean stop and go.
#[test]
#[cfg_attr(miri, ignore = "another crate, two million samples")]
fn the_other_crate_lets_it_leak() {
    let record = Gappy::new();
    let config = Config::new()
        .style(Style::DecadeDeci)
        .max_tau(10_000)
        .data_type(DataType::Frequency);
    let mut bins = Allan::with_config(config);
    for run in record.runs.iter().take(400) {
        run.iter()
            .for_each(|&code| bins.record(f64::from(code) / SCALE));
        (0..GAP).for_each(|_| bins.record(f64::NAN));
    }
    // As a multiple of the true deviation, at its averaging times 1 to 9 times powers of ten.
    let (times, m) = bins
        .iter()
        .map(|tau| {
            let deviation = tau.deviation().unwrap_or(0.0);
            (deviation * f64::from(tau.tau()).sqrt(), tau.tau())
        })
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .unwrap();
    println!("the other crate is {times:.1} times too large at m = {m}");
    assert!(times > 7.0, "{times} at m = {m}, seed {SEED}");
}

#[test]
#[cfg_attr(miri, ignore = "ten million samples")]
fn gravity_costs_no_digit_over_a_whole_capture() {
    const SAMPLES: usize = 10_800_000;
    // On a grid of 2^-49, the spacing of f64 at 9.8, noise of 1e-6 has a deviation of 5.6e8 steps.
    let step = 2.0_f64.powi(-49);
    let gravity = (9.80665 / step).round() * step;
    let mut normal = Normal { state: 9 };
    let mut noise = HostBins::new();
    // As codes, one billion and a half above zero.
    let mut codes = HostBins::new();
    let grid = FixedPoint::covering([gravity, gravity + 1e-5], 1.0);
    let mut floats = FloatBins::<25>::new(grid);
    for _ in 0..SAMPLES / 4000 {
        let chunk: Vec<i32> = (0..4000)
            .map(|_| (normal.next() * 1e-6 / step / 8.0).clamp(-5e8, 5e8) as i32)
            .collect();
        noise.push_slice(&chunk);
        codes.push_slice(
            &chunk
                .iter()
                .map(|code| code + 1_500_000_000)
                .collect::<Vec<_>>(),
        );
        let samples: Vec<f64> = chunk
            .iter()
            .map(|&code| gravity + f64::from(code) * 8.0 * step)
            .collect();
        floats.push_slice(&samples).unwrap();
    }
    for statistic in [Statistic::Allan, Statistic::Modified, Statistic::Hadamard] {
        let noise: Vec<Estimate> = noise.points(statistic).collect();
        assert_eq!(codes.points(statistic).collect::<Vec<_>>(), noise);
        let scaled = |estimate: &Estimate| Estimate {
            variance: estimate.variance * (8.0 * step) * (8.0 * step),
            ..*estimate
        };
        // The same integers to a power of two; reading them out rounds once a limb.
        for (float, expected) in floats.points(statistic).zip(noise.iter().map(scaled)) {
            assert_eq!((float.m, float.terms), (expected.m, expected.terms));
            let relative = float.variance / expected.variance - 1.0;
            assert!(
                relative.abs() < 4.0 * f64::EPSILON,
                "{float:?} {expected:?}"
            );
        }
        assert_eq!(floats.points(statistic).count(), noise.len());
        assert!(noise.len() > 80);
    }
}

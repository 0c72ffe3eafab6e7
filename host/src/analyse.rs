//! The analysis of a record: a source in, a plain result out. Reports only format it.
//!
//! The result is what `--json` writes (schema 1). Absent knowledge is `None`, `null` in JSON.

mod result;

use inm_allan::Statistic;
use rayon::iter::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};

use crate::bins::point::{self, Point};
use crate::bins::read::read;
pub use crate::bins::record::Overlap;
use crate::bins::record::{Account, AxisRecord, Record};
use crate::bins::taus::Taus;
use crate::fit::design::Design;
pub use crate::fit::likelihood::terms::{LikelihoodFit, LikelihoodValue};
pub use crate::fit::result::{Fits, PublishedValue, WeightedValue};
use crate::fit::{likelihood, published, weighted};
use crate::model::axis::ModelAxis;
use crate::model::kernel::Kernel;
use crate::model::{Coefficient, PerCoefficient};
use crate::navigate::{self, Growth, Integration, response::Integral};
use crate::signal::{Axis, Signal};
use crate::source::{Source, SourceError};
use crate::spectrum::{Bin, Estimate, Settings};

pub use result::{
    Analysis, AxisAnalysis, CurveModel, CurvePoint, GapSummary, SourceSummary, SpectrumPoint,
    UnusableSummary,
};

/// Version of the JSON schema.
pub const SCHEMA: u32 = 1;

/// How to evaluate the Allan family.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct AnalysisOptions {
    /// Averaging times.
    pub taus: Taus,
    /// Which overlap.
    pub overlap: Overlap,
    /// Averaging times of the published fit, samples; `None` for the 17 of
    /// [`published::factors`].
    pub published_taus: Option<Vec<u64>>,
}

/// Reads `source` to its end and analyses it. `progress` is called with the samples read so far.
///
/// # Errors
/// Whatever ends the source early; no sample that counts.
///
/// ```
/// use inm_host::{AnalysisOptions, Model, analyse, simulate};
///
/// let model = Model::open("published:X")?;
/// let mut record = simulate(&model, 8000, 1, None)?;
/// let analysis = analyse(&mut record, &AnalysisOptions::default(), |_| {})?;
/// assert_eq!(analysis.axes[0].name, "X");
/// // At the shortest averaging time there is quantisation noise and little else.
/// let shortest = analysis.axes[0].allan[0];
/// let quantisation = 3_f64.sqrt() * model.axes[0].coefficients.q / shortest.tau_s;
/// assert!((shortest.adev / quantisation - 1.0).abs() < 0.05);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn analyse(
    source: &mut dyn Source,
    options: &AnalysisOptions,
    progress: impl FnMut(u64),
) -> Result<Analysis, SourceError> {
    let signal = source.signal().clone();
    let record = read(source, options.overlap, progress)?;
    if record.axes().iter().all(|axis| axis.count() == 0) {
        return Err(SourceError {
            place: signal.name,
            message: format!(
                "none of the {} samples counts: all of them are missing (nan) or unusable",
                record.account().samples
            ),
            remedy: "check the file, and which columns are axes".into(),
        });
    }
    Ok(summarise(&signal, &record, options))
}

/// The result for what a record holds so far; a live view asks for it again and again.
pub fn summarise(signal: &Signal, record: &Record, options: &AnalysisOptions) -> Analysis {
    let account = record.account();
    // As many at once as there are processors: what a fit needs in between is some megabytes.
    let axes = signal.axes.par_iter().zip(record.axes());
    let axes = axes.map(|(axis, record)| analyse_axis(signal.rate_hz, axis, record, options));
    let axes = axes.collect();
    Analysis {
        schema: SCHEMA,
        source: summary(signal, account),
        axes,
    }
}

/// What was read, for the head of a result.
pub fn summary(signal: &Signal, account: &Account) -> SourceSummary {
    SourceSummary {
        file: signal.name.clone(),
        rate_hz: signal.rate_hz,
        measured_rate_hz: account.clocks.map(|clocks| clocks.rate_by_board_hz.value),
        clocks: account.clocks,
        unit: signal.axes.first().map(|axis| axis.unit),
        samples: account.samples,
        duration_s: (account.samples + account.lost) as f64 / signal.rate_hz,
        lost_samples: account.lost,
        gaps: account
            .gaps
            .iter()
            .map(|gap| {
                let samples = gap.to.map(|to| to.saturating_sub(gap.from));
                GapSummary {
                    from_s: gap.from as f64 / signal.rate_hz,
                    duration_s: samples.map(|samples| samples as f64 / signal.rate_hz),
                    samples,
                    cause: gap.cause.clone(),
                }
            })
            .collect(),
        unusable: unusable(signal, account),
        news: account.news.clone(),
        chain: signal
            .axes
            .first()
            .and_then(|axis| axis.chain.as_ref())
            .map(ToString::to_string),
    }
}

fn unusable(signal: &Signal, account: &Account) -> Vec<UnusableSummary> {
    let axes = signal.axes.iter().zip(&account.unusable);
    axes.filter(|(_, one)| one.samples > 0)
        .map(|(axis, one)| UnusableSummary {
            axis: axis.name.clone(),
            samples: one.samples,
            stretches: one.stretches,
            first_s: one.first as f64 / signal.rate_hz,
            longest_s: one.longest as f64 / signal.rate_hz,
        })
        .collect()
}

fn analyse_axis(
    rate_hz: f64,
    axis: &Axis,
    record: &AxisRecord,
    options: &AnalysisOptions,
) -> AxisAnalysis {
    let samples = record.count();
    let factors = options.taus.factors(samples / 2);
    let points = |statistic| {
        point::points(
            statistic,
            &record.estimates(statistic, &factors),
            rate_hz,
            axis.scale,
        )
    };
    let allan = point::allan_points(
        &record.estimates(Statistic::Allan, &factors),
        &record.bridged(factors.last().copied().unwrap_or(0)),
        rate_hz,
        axis.scale,
    );
    let modified = points(Statistic::Modified);
    let design = Design::new(rate_hz, axis.chain.as_ref());
    let estimate = Estimate::new(record.cascade(), rate_hz, &Settings::default());
    let weighted = weighted::fit(&modified, rate_hz, &design);
    let fits = Fits {
        published: published_fit(rate_hz, axis.scale, record, options),
        weighted: weighted.map(|fit| fit.coefficients),
        weighted_allowance_percent: weighted.map(|fit| 50.0 * fit.allowance),
        likelihood: likelihood::terms::fit(record.cascade(), &estimate, axis.scale, &design),
    };
    let velocity_error = fits
        .likelihood
        .as_ref()
        .map(|fit| velocity_error(rate_hz, axis, fit));
    AxisAnalysis {
        name: axis.name.clone(),
        unit: axis.unit,
        chain: axis.chain.as_ref().map(ToString::to_string),
        mean: record.mean().map(|mean| axis.scale * (mean - axis.zero)),
        samples,
        invalid_samples: record.invalid(),
        overlap: options.overlap,
        curves: curves(&allan, &fits, &design),
        fits,
        allan: curve(&allan),
        modified: curve(&modified),
        hadamard: curve(&points(Statistic::Hadamard)),
        spectrum: spectrum(&estimate, axis.scale),
        velocity_error,
    }
}

fn spectrum(estimate: &Estimate, units_per_count: f64) -> Vec<SpectrumPoint> {
    let squared = units_per_count * units_per_count;
    let point = |bin: &Bin| {
        let psd = squared * bin.psd;
        let (lo, hi) = point::interval(psd, bin.edf);
        SpectrumPoint {
            f_hz: bin.f_hz,
            psd,
            lo: lo * lo,
            hi: hi * hi,
            edf: bin.edf,
        }
    };
    estimate.bins.iter().map(point).collect()
}

/// The published fit of a record whose codes count `scale` each.
fn published_fit(
    rate_hz: f64,
    scale: f64,
    record: &AxisRecord,
    options: &AnalysisOptions,
) -> Option<PerCoefficient<PublishedValue>> {
    let taus = options.published_taus.clone();
    let taus = taus.unwrap_or_else(|| published::factors(record.count()));
    let points: Vec<(f64, f64)> = record
        .nearest(Statistic::Allan, &taus)
        .iter()
        .map(|one| (one.m as f64 / rate_hz, one.variance * scale * scale))
        .collect();
    let squares = published::fit(&points)?;
    Some(PerCoefficient::from_fn(|one| {
        PublishedValue::of_square(*squares.get(one))
    }))
}

/// Times of integration that a navigator asks about, seconds.
const NAVIGATOR_S: [f64; 5] = [1.0, 10.0, 60.0, 600.0, 3600.0];

/// Growth of the integral's error under the fitted terms, after [`navigate::ALIGNMENT_S`] at rest.
fn velocity_error(rate_hz: f64, axis: &Axis, fit: &LikelihoodFit) -> Vec<Growth> {
    let squares = fit.squares();
    let model = ModelAxis {
        name: axis.name.clone(),
        unit: axis.unit,
        mean: 0.0,
        chain: axis.chain.clone(),
        coefficients: PerCoefficient::from_fn(|one| squares.get(one).sqrt()),
        effects: Vec::new(),
    };
    let intervals = PerCoefficient::from_fn(|one| {
        let value = fit.coefficients.get(one);
        let best = squares.get(one).sqrt();
        let upper = value.hi.or(value.upper).unwrap_or(best);
        // A ramp that was not resolved from zero is left out, band included.
        if best == 0.0 && one == Coefficient::R {
            (0.0, 0.0)
        } else {
            (value.lo.min(best), upper.max(best))
        }
    });
    navigate::growth(
        &model,
        &intervals,
        Integration {
            integral: Integral::Velocity,
            rate_hz,
            alignment_s: navigate::ALIGNMENT_S,
        },
        &NAVIGATOR_S,
    )
}

fn curve(points: &[Point]) -> Vec<CurvePoint> {
    let point = |point: &Point| CurvePoint {
        tau_s: point.tau_s,
        m: point.m,
        adev: point.deviation(),
        lo: point.lo,
        hi: point.hi,
        edf: point.edf,
        bridged: point.bridged,
        white_bias: point.white_bias,
    };
    points.iter().map(point).collect()
}

fn curves(points: &[Point], fits: &Fits, design: &Design) -> Vec<CurveModel> {
    let sum = |part: &dyn Fn(Coefficient) -> f64| {
        let variance: f64 = Coefficient::ALL.into_iter().map(part).sum();
        (variance > 0.0).then(|| variance.sqrt())
    };
    let squares = fits.squares();
    let curve = |point: &Point| CurveModel {
        tau_s: point.tau_s,
        fitted: squares.and_then(|squares| {
            sum(&|one| match *squares.get(one) {
                0.0 => 0.0,
                squared => squared * design.unit_variance(Kernel::Allan, one, point.m),
            })
        }),
        published: fits.published.as_ref().and_then(|fit| {
            sum(&|one| fit.get(one).squared * one.term(1.0).allan_asymptote(point.tau_s))
        }),
    };
    points.iter().map(curve).collect()
}

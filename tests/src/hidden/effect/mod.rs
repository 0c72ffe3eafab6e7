//! The effects of the catalogue, one file each: how they are drawn, how they get into a record,
//! and what an ideal detector of that kind could do.

mod averaging;
mod burst;
mod clipping;
mod common_mode;
mod cyclic;
mod drift;
mod dropped;
mod highpass;
mod hum;
pub(crate) mod lorentzian;
mod markov;
mod outliers;
mod powerlaw;
mod quantisation;
mod resonance;
mod rolloff;
mod shock;
mod sinusoid;
mod slow;
mod stale;
mod steps;
mod telegraph;
mod thermal;
mod timebase;
pub mod tone;
mod wandering_line;
mod warmup;

use std::ops::Range;

use super::draw::Draw;
use super::ideal::detector::Evidence;
use super::ideal::grid::Feature;
use super::outside::Place;
use super::scene::Scene;
use super::truth::Truth;

/// Factor that the chain has on the amplitude of a tone, by its frequency in hertz.
pub type Gain<'a> = &'a dyn Fn(f64) -> f64;

/// Something hidden in a record, with its parameters. What it leaves out of these methods it
/// does not do.
pub trait Effect: Send + Sync {
    /// What a perfect report names. Several for an effect that shows only on another.
    fn truths(&self) -> Vec<Truth>;

    /// The same effect, `factor` times as strong.
    fn scaled(&self, factor: f64) -> Box<dyn Effect>;

    /// What an ideal detector of this kind achieves in `scene.target`.
    fn evidence(&self, scene: &Scene) -> Evidence;

    /// Two-sided density per hertz of an additive Gaussian part, ahead of the chain.
    fn density(&self, _f_hz: f64, _scene: &Scene) -> f64 {
        0.0
    }

    /// Features of that density that a grid must resolve.
    fn features(&self) -> Vec<Feature> {
        Vec::new()
    }

    /// Factor on the spectrum of everything else.
    fn power(&self, _f_hz: f64) -> f64 {
        1.0
    }

    /// Factor on the white and quantisation terms, sample by sample.
    fn envelope(&self, _scene: &Scene, _draw: &mut Draw) -> Option<Vec<f64>> {
        None
    }

    /// Mean square of that factor where it goes on all along the record: white and quantisation noise of the record are
    /// those of the scene times its root.
    fn swell(&self) -> f64 {
        1.0
    }

    /// What is added to an axis ahead of the chain, sample by sample. `draw` is the same for
    /// all axes.
    fn waveform(&self, _scene: &Scene, _axis: usize, _draw: &mut Draw) -> Option<Vec<f64>> {
        None
    }

    /// Tones that are added to an axis. They were there before the record and are there after it, so that the chain has
    /// no beginning of them to answer: it gives them the factor `gain` at their frequency. `draw` as above.
    fn tones(&self, _scene: &Scene, _draw: &mut Draw, _gain: Gain<'_>) -> Option<Vec<f64>> {
        None
    }

    /// Acts on the finished samples. Returns parameters that only the samples settle.
    fn distort(
        &self,
        _samples: &mut Vec<f64>,
        _scene: &Scene,
        _draw: &mut Draw,
    ) -> Vec<(String, f64)> {
        Vec::new()
    }

    /// What that does to the Allan variance.
    fn distorts(&self, _scene: &Scene) -> Distorts {
        Distorts::Alike
    }

    /// Whether it is in all axes and not only in the target.
    fn in_all_axes(&self) -> bool {
        false
    }

    /// True rate over the rate that the record says.
    fn clock(&self) -> f64 {
        1.0
    }

    /// The temperature that the record comes with, degrees Celsius.
    fn temperature(&self) -> Option<&[f64]> {
        None
    }

    /// What a reference record, made of the same noise, holds.
    fn in_reference(&self) -> Option<Box<dyn Effect>> {
        None
    }

    /// From when to when it happens, in seconds, where it is nowhere else: of that no more than half may go missing.
    fn happens_s(&self) -> Option<Range<f64>> {
        None
    }

    /// Where it shows, for what has no name in the catalogue.
    fn place(&self) -> Option<Place> {
        None
    }
}

/// What [`Effect::distort`] does to the Allan variance of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Distorts {
    /// Nothing, or the same to a course by itself as to the finished samples: some are lost.
    Alike,
    /// What it adds to the samples is not correlated with them, or to no effect: less than a thousandth
    /// of the deviation.
    Adds,
    /// More than these say.
    Beyond,
}

/// A kind of effect.
pub struct Kind {
    /// Its name in the report.
    pub name: &'static str,
    /// Axes of the records that it is hidden in.
    pub axes: usize,
    /// Draws one of any strength; the strength is settled afterwards.
    pub draw: fn(&Scene, &mut Draw) -> Box<dyn Effect>,
}

/// Every kind of the catalogue.
pub static KINDS: &[Kind] = &[
    Kind {
        name: "sinusoid",
        axes: 1,
        draw: sinusoid::draw,
    },
    Kind {
        name: "hum",
        axes: 1,
        draw: hum::draw,
    },
    Kind {
        name: "wandering_line",
        axes: 1,
        draw: wandering_line::draw,
    },
    Kind {
        name: "markov",
        axes: 1,
        draw: markov::draw,
    },
    Kind {
        name: "resonance",
        axes: 1,
        draw: resonance::draw,
    },
    Kind {
        name: "rolloff",
        axes: 1,
        draw: rolloff::draw,
    },
    Kind {
        name: "averaging",
        axes: 1,
        draw: averaging::draw,
    },
    Kind {
        name: "telegraph",
        axes: 1,
        draw: telegraph::draw,
    },
    Kind {
        name: "steps",
        axes: 1,
        draw: steps::draw,
    },
    Kind {
        name: "shock",
        axes: 1,
        draw: shock::draw,
    },
    Kind {
        name: "outliers",
        axes: 1,
        draw: outliers::draw,
    },
    Kind {
        name: "stale",
        axes: 1,
        draw: stale::draw,
    },
    Kind {
        name: "dropped",
        axes: 1,
        draw: dropped::draw,
    },
    Kind {
        name: "clipping",
        axes: 1,
        draw: clipping::draw,
    },
    Kind {
        name: "quantisation",
        axes: 1,
        draw: quantisation::draw,
    },
    Kind {
        name: "burst",
        axes: 1,
        draw: burst::draw,
    },
    Kind {
        name: "cyclic",
        axes: 1,
        draw: cyclic::draw,
    },
    Kind {
        name: "warmup",
        axes: 1,
        draw: warmup::draw,
    },
    Kind {
        name: "drift",
        axes: 1,
        draw: drift::draw,
    },
    Kind {
        name: "thermal",
        axes: 1,
        draw: thermal::draw,
    },
    Kind {
        name: "common_mode",
        axes: 3,
        draw: common_mode::draw,
    },
    Kind {
        name: "powerlaw",
        axes: 1,
        draw: powerlaw::draw,
    },
    Kind {
        name: "timebase",
        axes: 1,
        draw: timebase::draw,
    },
    Kind {
        name: "highpass",
        axes: 1,
        draw: highpass::draw,
    },
];

/// The kind of this name.
pub fn find(name: &str) -> Option<&'static Kind> {
    KINDS.iter().find(|kind| kind.name == name)
}

//! A signal chain ahead of the samples: one sensor pole and an ADS1281 with linear phase.

use std::f64::consts::PI;
use std::sync::OnceLock;

use realfft::RealFftPlanner;

use crate::hidden::draw::Draw;

/// What the quantity passes on its way into the record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Chain {
    /// Nothing: the samples are the process.
    None,
    /// The converter's digital filter, and a sensor pole ahead of it if there is one.
    Ads1281 {
        /// Corner of the sensor's pole, hertz.
        pole_hz: Option<u32>,
    },
}

impl Chain {
    /// None in three records of four.
    pub fn draw(draw: &mut Draw) -> Self {
        if draw.chance(0.75) {
            return Self::None;
        }
        Self::Ads1281 {
            pole_hz: draw.pick(&[None, Some(300), Some(400)]),
        }
    }

    /// As `--chain` takes it.
    pub fn declared(self) -> Option<String> {
        match self {
            Self::None => None,
            Self::Ads1281 { pole_hz: None } => Some("ads1281:linear".to_owned()),
            Self::Ads1281 {
                pole_hz: Some(pole_hz),
            } => Some(format!("ads1281:linear+{pole_hz}hz")),
        }
    }

    /// Whether the record is the process itself.
    pub fn is_none(self) -> bool {
        self == Self::None
    }

    /// Power let through at `f_hz`, from zero to half the rate.
    pub fn power(self, f_hz: f64, rate_hz: f64) -> f64 {
        match self {
            Self::None => 1.0,
            Self::Ads1281 { pole_hz } => {
                let pole = pole_hz.map_or(1.0, |pole| one_pole(f_hz, f64::from(pole)));
                pole * converter_table(f_hz / rate_hz).powi(2)
            }
        }
    }
}

/// Power behind one analog pole.
pub fn one_pole(f_hz: f64, corner_hz: f64) -> f64 {
    1.0 / (1.0 + (f_hz / corner_hz).powi(2))
}

/// Passes `samples` through a filter of this power and no delay. The record is mirrored at its
/// end, so that a level that differs between start and end makes no edge.
pub fn filter(samples: &mut [f64], rate_hz: f64, power: impl Fn(f64) -> f64) {
    let (n, length) = (samples.len(), 2 * samples.len());
    let mut planner = RealFftPlanner::<f64>::new();
    let mut mirrored: Vec<f64> = samples
        .iter()
        .chain(samples.iter().rev())
        .copied()
        .collect();
    let forward = planner.plan_fft_forward(length);
    let mut spectrum = forward.make_output_vec();
    forward
        .process(&mut mirrored, &mut spectrum)
        .expect("the buffers are the plan's");
    for (k, value) in spectrum.iter_mut().enumerate() {
        *value *= power(k as f64 * rate_hz / length as f64).sqrt() / length as f64;
    }
    // The mirrored record is even about its middle; its last coefficient is real but for rounding.
    spectrum[0].im = 0.0;
    spectrum[n].im = 0.0;
    planner
        .plan_fft_inverse(length)
        .process(&mut spectrum, &mut mirrored)
        .expect("the buffers are the plan's");
    samples.copy_from_slice(&mirrored[..n]);
}

/// Points of the table between zero and half the rate; the line between two is within 1e-4.
const POINTS: usize = 4096;

fn converter_table(cycles: f64) -> f64 {
    static TABLE: OnceLock<Vec<f64>> = OnceLock::new();
    let table = TABLE.get_or_init(|| {
        (0..=POINTS + 1)
            .map(|i| converter_gain(0.5 * i as f64 / POINTS as f64))
            .collect()
    });
    let at = cycles.clamp(0.0, 0.5) * 2.0 * POINTS as f64;
    let below = at as usize;
    table[below] + (at - below as f64) * (table[below + 1] - table[below])
}

/// Gain of the ADS1281's linear-phase filter at `cycles` a sample of its output at 2000/s
/// (sinc5 by 16, then FIR by 2, 2, 4, 2; SBAS378).
pub fn converter_gain(cycles: f64) -> f64 {
    const SINC: f64 = 16.0;
    // Cycles at the modulator's rate: 32 times 16 times the output's.
    let at_modulator = cycles / 512.0;
    let sinc = if at_modulator == 0.0 {
        1.0
    } else {
        ((PI * SINC * at_modulator).sin() / (SINC * (PI * at_modulator).sin())).powi(5)
    };
    sinc * symmetric(&FIR1, cycles / 32.0)
        * symmetric(&FIR2, cycles / 16.0)
        * symmetric(&FIR3, cycles / 8.0)
        * symmetric(&FIR4, cycles / 2.0)
}

/// Gain of a symmetric filter given by its first half and centre, one at zero frequency.
fn symmetric(half: &[f64], cycles: f64) -> f64 {
    let centre = half.len() - 1;
    let sum = |cycles: f64| -> f64 {
        half[centre]
            + half[..centre]
                .iter()
                .enumerate()
                .map(|(i, b)| 2.0 * b * (2.0 * PI * cycles * (centre - i) as f64).cos())
                .sum::<f64>()
    };
    sum(cycles) / sum(0.0)
}

const FIR1: [f64; 6] = [3.0, 0.0, -25.0, 0.0, 150.0, 256.0];
const FIR2: [f64; 8] = [
    -10944.0, 0.0, 103807.0, 0.0, -507903.0, 0.0, 2512192.0, 4194304.0,
];
const FIR3: [f64; 26] = [
    0.0, 0.0, -73.0, -874.0, -4648.0, -16147.0, -41280.0, -80934.0, -120064.0, -118690.0, -18203.0,
    224751.0, 580196.0, 893263.0, 891396.0, 293598.0, -987253.0, -2635779.0, -3860322.0,
    -3572512.0, -822573.0, 4669054.0, 12153698.0, 19911100.0, 25779390.0, 27966862.0,
];
const FIR4: [f64; 55] = [
    -132.0,
    -432.0,
    -75.0,
    2481.0,
    6692.0,
    7419.0,
    -266.0,
    -10663.0,
    -8280.0,
    10620.0,
    22008.0,
    348.0,
    -34123.0,
    -25549.0,
    33460.0,
    61387.0,
    -7546.0,
    -94192.0,
    -50629.0,
    101135.0,
    134826.0,
    -56626.0,
    -220104.0,
    -56082.0,
    263758.0,
    231231.0,
    -215231.0,
    -430178.0,
    34715.0,
    580424.0,
    283878.0,
    -588382.0,
    -693209.0,
    366118.0,
    1084786.0,
    132893.0,
    -1300087.0,
    -878642.0,
    1162189.0,
    1741565.0,
    -522533.0,
    -2490395.0,
    -688945.0,
    2811738.0,
    2425494.0,
    -2338095.0,
    -4511116.0,
    641555.0,
    6661730.0,
    2950811.0,
    -8538057.0,
    -10537298.0,
    9818477.0,
    41426374.0,
    56835776.0,
];

//! The numbers of an effect: what each is called, what it measures and which values it may have.

use std::borrow::Cow;

use crate::signal::Unit;

/// One number of an effect.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Parameter {
    /// Its name in model files, with the unit where that is fixed.
    pub name: Cow<'static, str>,
    /// What it measures, and thereby its unit and range.
    pub quantity: Quantity,
    /// What it means, in a few words.
    pub meaning: &'static str,
    /// Whether it may be left out of a model file, and is zero then.
    pub optional: bool,
    /// Of which row of a table, from 1, where an effect has as many rows as happened; its name ends with it.
    pub row: Option<usize>,
}

impl Parameter {
    /// A parameter called `name`.
    pub fn new(
        name: impl Into<Cow<'static, str>>,
        quantity: Quantity,
        meaning: &'static str,
    ) -> Self {
        Self {
            name: name.into(),
            quantity,
            meaning,
            optional: false,
            row: None,
        }
    }

    /// The same in this row of a table.
    #[must_use]
    pub fn in_row(self, number: usize) -> Self {
        Self {
            name: format!("{}_{number}", self.name).into(),
            row: Some(number),
            ..self
        }
    }

    /// Its name without the number of its row.
    pub fn stem(&self) -> &str {
        let ending = self.row.map_or(0, |row| format!("_{row}").len());
        &self.name[..self.name.len() - ending]
    }

    /// The same, which may be left out of a model file.
    #[must_use]
    pub fn or_zero(self) -> Self {
        Self {
            optional: true,
            ..self
        }
    }
}

/// What a parameter measures: its unit and its range.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// Frequency, above zero.
    Hertz,
    /// Middle of a band about zero or above, hertz.
    Centre,
    /// How far a frequency moves, zero or above.
    Wander,
    /// Frequency; zero where there is none.
    HertzOrNone,
    /// Events a second, zero or above.
    PerSecond,
    /// Length of time, above zero.
    Second,
    /// Length of time; zero where there is none.
    SecondOrNone,
    /// Time since the start of the record, zero or above.
    Instant,
    /// Time by which one thing lags another, zero or above.
    Delay,
    /// In the unit of the signal.
    Signal,
    /// In the unit of the signal per second.
    SignalPerSecond,
    /// In the unit of the signal per kelvin.
    SignalPerKelvin,
    /// Two-sided spectral density, zero or above.
    Density,
    /// A number without a unit.
    Ratio,
    /// Without a unit, above zero.
    Factor,
    /// Part of a whole, from 0 to 1.
    Share,
    /// A whole number, zero or above.
    Count,
    /// Which way: -1 or +1.
    Sign,
}

impl Quantity {
    /// Its unit for a signal in `signal`; empty where it has none.
    pub fn unit(self, signal: Unit) -> String {
        match self {
            Self::Hertz | Self::Centre | Self::Wander | Self::HertzOrNone => "Hz".to_owned(),
            Self::PerSecond => "1/s".to_owned(),
            Self::Second | Self::SecondOrNone | Self::Instant | Self::Delay => "s".to_owned(),
            Self::Signal => signal.to_string(),
            Self::SignalPerSecond => format!("{signal}/s"),
            Self::SignalPerKelvin => format!("{signal}/K"),
            Self::Density => format!("({signal})^2/Hz"),
            Self::Ratio | Self::Factor | Self::Share | Self::Count | Self::Sign => String::new(),
        }
    }

    /// Whether `value` is in its range.
    pub fn admits(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Signal | Self::SignalPerSecond | Self::SignalPerKelvin | Self::Ratio => true,
                Self::Hertz | Self::Second | Self::Factor => value > 0.0,
                Self::Centre
                | Self::Wander
                | Self::Instant
                | Self::Delay
                | Self::HertzOrNone
                | Self::SecondOrNone
                | Self::PerSecond
                | Self::Density => value >= 0.0,
                Self::Share => (0.0..=1.0).contains(&value),
                Self::Count => value >= 0.0 && value.fract() == 0.0,
                Self::Sign => value.abs() == 1.0,
            }
    }

    /// Its range in words, for messages.
    pub const fn range(self) -> &'static str {
        match self {
            Self::Signal | Self::SignalPerSecond | Self::SignalPerKelvin | Self::Ratio => {
                "a finite number"
            }
            Self::Hertz | Self::Second | Self::Factor => "a number above zero",
            Self::Centre
            | Self::Wander
            | Self::Instant
            | Self::Delay
            | Self::HertzOrNone
            | Self::SecondOrNone
            | Self::PerSecond
            | Self::Density => "zero or a number above it",
            Self::Share => "a number from 0 to 1",
            Self::Count => "a whole number, zero or above",
            Self::Sign => "1 or -1",
        }
    }
}

//! The signal chain between a quantity and its samples: sensor pole, converter filter.
//!
//! Written as in `--chain ads1281:linear+400hz`; captures carry it in their header.

use std::fmt;
use std::str::FromStr;

use inm_emulator::response::Response;
use inm_protocol::Phase;
use rustfft::num_complex::Complex;

/// What the quantity passes on its way to the samples.
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Chain {
    /// Digital filter of an ADS1281 (sinc5 and FIR), if there is one.
    pub converter: Option<Phase>,
    /// Corner frequencies of one-pole low-passes ahead of the converter, hertz.
    pub poles_hz: Vec<f64>,
}

impl Chain {
    /// Power that the chain lets through at `f_hz`, for samples at `rate_hz`.
    pub fn power(&self, f_hz: f64, rate_hz: f64) -> f64 {
        let poles: f64 = self
            .poles_hz
            .iter()
            .map(|pole| 1.0 / (1.0 + (f_hz / pole).powi(2)))
            .product();
        let Some(filter) = self.filter(rate_hz) else {
            return poles;
        };
        poles * filter.gain(f_hz / rate_hz).powi(2)
    }

    /// Response at `f_hz`, phase included; its square is [`Chain::power`].
    pub fn response(&self, f_hz: f64, rate_hz: f64) -> Complex<f64> {
        let poles: Complex<f64> = self
            .poles_hz
            .iter()
            .map(|pole| Complex::new(1.0, f_hz / pole).inv())
            .product();
        let Some(filter) = self.filter(rate_hz) else {
            return poles;
        };
        let (re, im) = filter.value(f_hz / rate_hz);
        poles * Complex::new(re, im)
    }

    /// The chain as a record shows it whose true rate is `ratio` times the one that it says: poles
    /// keep true time, the converter's filter keeps that of the samples.
    #[must_use]
    pub fn at_clock(&self, ratio: f64) -> Self {
        Self {
            converter: self.converter,
            poles_hz: self.poles_hz.iter().map(|pole| pole / ratio).collect(),
        }
    }

    /// The converter's filter for samples at `rate_hz`.
    fn filter(&self, rate_hz: f64) -> Option<Response> {
        let phase = match self.converter? {
            Phase::Linear => inm_emulator::Phase::Linear,
            Phase::Minimum => inm_emulator::Phase::Minimum,
        };
        // The rate itself matters to the converter's filter only beyond half of it.
        Some(Response::new(phase, rate_hz as u32))
    }
}

impl fmt::Display for Chain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let converter = self.converter.map(|phase| match phase {
            Phase::Linear => "ads1281:linear".to_owned(),
            Phase::Minimum => "ads1281:minimum".to_owned(),
        });
        let poles = self.poles_hz.iter().map(|pole| format!("{pole}hz"));
        let parts: Vec<String> = converter.into_iter().chain(poles).collect();
        f.write_str(&parts.join("+"))
    }
}

impl From<Chain> for String {
    fn from(chain: Chain) -> Self {
        chain.to_string()
    }
}

impl TryFrom<String> for Chain {
    type Error = ChainError;

    fn try_from(text: String) -> Result<Self, ChainError> {
        text.parse()
    }
}

impl FromStr for Chain {
    type Err = ChainError;

    fn from_str(text: &str) -> Result<Self, ChainError> {
        let mut chain = Self::default();
        for part in text.split('+') {
            let part = part.trim().to_ascii_lowercase();
            let converter = match part.as_str() {
                "ads1281" | "ads1281:linear" => Some(Phase::Linear),
                "ads1281:minimum" => Some(Phase::Minimum),
                _ => None,
            };
            if let Some(phase) = converter {
                if chain.converter.replace(phase).is_some() {
                    return Err(ChainError::TwoConverters);
                }
                continue;
            }
            let pole = part
                .strip_suffix("hz")
                .and_then(|number| number.trim().parse().ok());
            match pole {
                Some(pole_hz) if f64::is_normal(pole_hz) && pole_hz > 0.0 => {
                    chain.poles_hz.push(pole_hz);
                }
                _ => return Err(ChainError::UnknownPart(part)),
            }
        }
        Ok(chain)
    }
}

/// A chain that cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ChainError {
    /// A part that is neither a converter nor a pole.
    #[error(
        "`{0}` is no part of a signal chain; ads1281:linear, ads1281:minimum, or a pole such \
             as 400hz, joined by +"
    )]
    UnknownPart(String),
    /// Two converters.
    #[error("a signal chain has one converter")]
    TwoConverters,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_back_what_it_writes() {
        for text in ["ads1281:linear+400hz", "ads1281:minimum", "300hz+1507.5hz"] {
            assert_eq!(text.parse::<Chain>().expect(text).to_string(), text);
        }
        assert_eq!(
            "ADS1281".parse::<Chain>().expect("default phase").converter,
            Some(Phase::Linear)
        );
        for text in [
            "",
            "ads1282",
            "400",
            "-3hz",
            "0hz",
            "ads1281+ads1281",
            "400hz+",
        ] {
            assert!(text.parse::<Chain>().is_err(), "{text}");
        }
    }
}

//! The signal chain between a quantity and its samples: sensor pole, converter filter.
//!
//! Written as in `--chain ads1281:linear+400hz`; captures carry it in their header.

use std::fmt;
use std::str::FromStr;

use inm_protocol::Phase;

/// What the quantity passes on its way to the samples.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Chain {
    /// Digital filter of an ADS1281 (sinc5 and FIR), if there is one.
    pub converter: Option<Phase>,
    /// Corner frequencies of one-pole low-passes ahead of the converter, hertz.
    pub poles_hz: Vec<f64>,
}

/// Why a text does not describe a signal chain.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{part}` is no stage of a signal chain; stages are joined by `+`: `ads1281:linear`, \
     `ads1281:minimum`, or the corner of a one-pole low-pass such as `400hz`"
)]
pub struct ChainError {
    /// The stage that is not known.
    pub part: String,
}

impl FromStr for Chain {
    type Err = ChainError;

    fn from_str(text: &str) -> Result<Self, ChainError> {
        let mut chain = Self::default();
        for part in text
            .split('+')
            .map(str::trim)
            .filter(|part| !part.is_empty())
        {
            let unknown = || ChainError {
                part: part.to_owned(),
            };
            match part {
                "ads1281:linear" => chain.converter = Some(Phase::Linear),
                "ads1281:minimum" => chain.converter = Some(Phase::Minimum),
                _ => {
                    let corner = part.strip_suffix("hz").or_else(|| part.strip_suffix("Hz"));
                    let corner_hz: f64 = corner
                        .and_then(|hz| hz.trim().parse().ok())
                        .ok_or_else(unknown)?;
                    if !(corner_hz.is_finite() && corner_hz > 0.0) {
                        return Err(unknown());
                    }
                    chain.poles_hz.push(corner_hz);
                }
            }
        }
        Ok(chain)
    }
}

impl fmt::Display for Chain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let converter = self.converter.map(|phase| match phase {
            Phase::Linear => "ads1281:linear".to_owned(),
            Phase::Minimum => "ads1281:minimum".to_owned(),
        });
        let poles = self.poles_hz.iter().map(|hz| format!("{hz}hz"));
        let stages: Vec<String> = converter.into_iter().chain(poles).collect();
        f.write_str(&stages.join("+"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        for text in [
            "ads1281:linear+400hz",
            "ads1281:minimum",
            "400hz+1507.5hz",
            "",
        ] {
            let chain: Chain = text.parse().expect("a chain");
            assert_eq!(chain.to_string(), text);
        }
    }

    #[test]
    fn an_unknown_stage_is_named() {
        for (text, part) in [
            ("ads1282", "ads1282"),
            ("400hz+-3hz", "-3hz"),
            ("nanhz", "nanhz"),
        ] {
            assert_eq!(
                text.parse::<Chain>(),
                Err(ChainError {
                    part: part.to_owned()
                })
            );
        }
    }
}

//! The settings that a tab asks for, as its form sends them.

use inm_protocol::{Filter, Phase, Settings};
use serde::Deserialize;

use crate::source::board::{BadSetting, parse_rate, parse_word};

/// What the form holds: texts, as people write them.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Wanted {
    /// Samples a second.
    rate: String,
    phase: Response,
    /// HPF word; empty for no high-pass.
    high_pass: String,
}

/// Phase response of the converter's filter.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Response {
    Linear,
    Minimum,
}

/// Why there are no such settings.
#[derive(Debug, thiserror::Error)]
pub enum BadWish {
    /// It is no form of ours.
    #[error("settings are expected as JSON: {0}")]
    Form(#[from] serde_json::Error),
    /// The data rate.
    #[error("data rate: {0}")]
    Rate(BadSetting),
    /// The high-pass.
    #[error("high-pass word: {0}")]
    HighPass(BadSetting),
}

/// The settings that `body` asks for.
///
/// # Errors
/// [`BadWish`].
pub fn settings(body: &[u8]) -> Result<Settings, BadWish> {
    let wanted: Wanted = serde_json::from_slice(body)?;
    let high_pass = match wanted.high_pass.trim() {
        "" => None,
        word => Some(parse_word(word).map_err(BadWish::HighPass)?),
    };
    let phase = match wanted.phase {
        Response::Linear => Phase::Linear,
        Response::Minimum => Phase::Minimum,
    };
    Ok(Settings {
        rate: parse_rate(&wanted.rate).map_err(BadWish::Rate)?,
        filter: Filter::Fir { phase, high_pass },
    })
}

#[cfg(test)]
mod tests {
    use inm_protocol::Rate;

    use super::*;

    #[test]
    fn a_form_is_read() {
        let form = br#"{"rate":"500","phase":"minimum","high_pass":" 0x10 "}"#;
        let filter = Filter::Fir {
            phase: Phase::Minimum,
            high_pass: Some(16),
        };
        let rate = Rate::Sps500;
        assert_eq!(settings(form).ok(), Some(Settings { rate, filter }));
        let form = br#"{"rate":"2000","phase":"linear","high_pass":""}"#;
        assert_eq!(settings(form).ok(), Some(Settings::default()));
    }

    #[test]
    fn what_the_board_does_not_have_is_refused_by_its_name() {
        for (form, said) in [
            (
                r#"{"rate":"3000","phase":"linear","high_pass":""}"#,
                "data rate",
            ),
            (
                r#"{"rate":"500","phase":"linear","high_pass":"x"}"#,
                "high-pass word",
            ),
            (r#"{"rate":"500","phase":"steep","high_pass":""}"#, "JSON"),
            (r#"{"rate":"500","phase":"linear"}"#, "JSON"),
            ("", "JSON"),
        ] {
            let refused = settings(form.as_bytes()).expect_err(form).to_string();
            assert!(refused.contains(said), "{form}: {refused}");
        }
    }
}

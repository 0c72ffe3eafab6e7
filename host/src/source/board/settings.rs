//! Settings of the board as people write them.

use inm_protocol::Rate;

/// Why a setting cannot be had.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum BadSetting {
    /// Of the data rate.
    #[error("the converter has {} samples a second", Rate::ALL.map(|rate| rate.hz().to_string()).join(", "))]
    Rate,
    /// Of the high-pass word.
    #[error("a number from 0 to 65535 or 0x0 to 0xffff is expected")]
    Word,
}

/// A data rate, samples a second.
///
/// # Errors
/// [`BadSetting::Rate`] if the converter does not have it.
pub fn parse_rate(text: &str) -> Result<Rate, BadSetting> {
    let rate = text.parse().ok().and_then(Rate::from_hz);
    rate.ok_or(BadSetting::Rate)
}

/// The HPF word of the converter, decimal or hexadecimal behind `0x`.
///
/// # Errors
/// [`BadSetting::Word`] if it is no number of 16 bits.
pub fn parse_word(text: &str) -> Result<u16, BadSetting> {
    let parsed = match text.strip_prefix("0x") {
        Some(hex) => u16::from_str_radix(hex, 16),
        None => text.parse(),
    };
    parsed.map_err(|_| BadSetting::Word)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_read_as_people_write_them() {
        assert_eq!(parse_rate("4000"), Ok(Rate::Sps4000));
        assert_eq!(parse_word("0x1F4"), Ok(500));
        assert_eq!(parse_word("500"), Ok(500));
        for text in ["", "-1", "3000", "2k"] {
            assert_eq!(parse_rate(text), Err(BadSetting::Rate), "{text}");
        }
        for text in ["", "0x", "0x10000", "65536", "-1", "off"] {
            assert_eq!(parse_word(text), Err(BadSetting::Word), "{text}");
        }
        let said = BadSetting::Rate.to_string();
        assert!(said.contains("250, 500, 1000, 2000, 4000"), "{said}");
    }
}

//! The elements of a NumPy array: integers and floats of every size, in either byte order.

use super::super::Values;
use super::header::{Header, Kind};

/// The elements as codes if all of the file are, else as floats.
pub(super) fn decode<'a>(
    header: &Header,
    fits: bool,
    elements: impl Iterator<Item = &'a [u8]> + Clone,
) -> Values {
    let as_codes = if fits {
        codes(header, elements.clone())
    } else {
        None
    };
    as_codes.map_or_else(
        || Values::Floats(elements.map(|element| float(header, element)).collect()),
        Values::Codes,
    )
}

/// The elements as codes, `None` if one does not fit.
pub(super) fn codes<'a>(
    header: &Header,
    elements: impl Iterator<Item = &'a [u8]>,
) -> Option<Vec<i32>> {
    elements
        .map(|element| i32::try_from(integer(header, element)).ok())
        .collect()
}

/// An integer element, sign or zero extended.
fn integer(header: &Header, element: &[u8]) -> i128 {
    let word = word(header, element);
    let unused = 64 - 8 * header.size as u32;
    match header.kind {
        Kind::Signed => i128::from(((word << unused) as i64) >> unused),
        _ => i128::from(word),
    }
}

fn float(header: &Header, element: &[u8]) -> f64 {
    let bits = word(header, element);
    match (header.kind, header.size) {
        (Kind::Float, 2) => half(bits as u16),
        (Kind::Float, 4) => f64::from(f32::from_bits(bits as u32)),
        (Kind::Float, _) => f64::from_bits(bits),
        _ => integer(header, element) as f64,
    }
}

/// The bytes of an element as an unsigned word.
fn word(header: &Header, element: &[u8]) -> u64 {
    let fold = |word: u64, &byte: &u8| word << 8 | u64::from(byte);
    if header.big_endian {
        element.iter().fold(0, fold)
    } else {
        element.iter().rev().fold(0, fold)
    }
}

/// IEEE 754 half precision.
fn half(bits: u16) -> f64 {
    let sign = if bits >> 15 == 0 { 1.0 } else { -1.0 };
    let fraction = f64::from(bits & 0x3ff) / 1024.0;
    match bits >> 10 & 0x1f {
        0 => sign * fraction * 2_f64.powi(-14),
        0x1f if fraction == 0.0 => sign * f64::INFINITY,
        0x1f => f64::NAN,
        exponent => sign * (1.0 + fraction) * 2_f64.powi(i32::from(exponent) - 15),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(kind: Kind, size: usize, big_endian: bool) -> Header {
        Header {
            kind,
            size,
            big_endian,
            by_column: false,
            rows: 1,
            columns: 1,
            data_start: 0,
        }
    }

    #[test]
    fn elements_of_every_type_and_order() {
        for (kind, size, value) in [
            (Kind::Signed, 1, -5_i128),
            (Kind::Signed, 2, -300),
            (Kind::Signed, 4, i128::from(i32::MIN)),
            (Kind::Signed, 8, -1 << 40),
            (Kind::Unsigned, 1, 250),
            (Kind::Unsigned, 2, 65_000),
            (Kind::Unsigned, 4, 4_000_000_000),
            (Kind::Unsigned, 8, 1 << 63),
        ] {
            let little = &value.to_le_bytes()[..size];
            let big: Vec<u8> = little.iter().rev().copied().collect();
            assert_eq!(integer(&header(kind, size, false), little), value);
            assert_eq!(integer(&header(kind, size, true), &big), value);
        }
        assert_eq!(
            float(&header(Kind::Float, 4, true), &1.5_f32.to_be_bytes()),
            1.5
        );
        assert_eq!(
            float(&header(Kind::Float, 8, false), &(-0.1_f64).to_le_bytes()),
            -0.1
        );
    }

    #[test]
    fn half_precision() {
        assert_eq!(half(0x3c00), 1.0);
        assert_eq!(half(0xc000), -2.0);
        assert_eq!(half(0x7bff), 65504.0);
        assert_eq!(half(0x0001), 2_f64.powi(-24));
        assert_eq!(half(0xfc00), f64::NEG_INFINITY);
        assert!(half(0x7e00).is_nan());
    }
}

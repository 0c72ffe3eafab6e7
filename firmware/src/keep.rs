//! What the board keeps while it is off: the calibration of its accelerometers, one a range.
//!
//! ```text
//!   Request --> Kept::replace --> the older of two copies: erase, all words, checksum last
//!   two copies --> whole ones --> the newer --> Kept
//! ```
//!
//! Each copy has a sector of flash of its own, since a sector is erased as a whole. A copy counts
//! only with its checksum, which is written last, and the newer copy is never touched: power may
//! go at any word, and what is kept is the old or the new, never a mixture.

use inm_protocol::{AXES, SensorCalibration, SensorRange, TRIANGLE, crc32};

/// Copies, each in a sector of its own.
pub const COPIES: usize = 2;

/// Ranges of the accelerometers.
const RANGES: usize = 2;

/// Words of one calibration.
const RECORD: usize = 5 + 2 * (TRIANGLE + AXES);

/// Words ahead of the calibrations: magic, number, which ranges there are.
const HEAD: usize = 3;

/// Words of a copy; the last is the checksum.
pub const WORDS: usize = HEAD + RANGES * RECORD + 1;

/// Begins a copy: `INM` and the version of this layout.
const MAGIC: u32 = u32::from_be_bytes(*b"INM\x01");

/// A sector could not be erased, or a word not written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NotWritten;

/// Two sectors of flash: what is erased is all ones, and writing only clears bits.
pub trait Sectors {
    /// A word of a copy, by its number from the start of the sector.
    fn read(&self, copy: usize, word: usize) -> u32;

    /// Erases the sector of a copy.
    ///
    /// # Errors
    /// [`NotWritten`] if the flash says so.
    fn erase(&mut self, copy: usize) -> Result<(), NotWritten>;

    /// Writes a word of an erased sector.
    ///
    /// # Errors
    /// [`NotWritten`] if the flash says so.
    fn write(&mut self, copy: usize, word: usize, value: u32) -> Result<(), NotWritten>;
}

/// What is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Kept {
    calibrations: [Option<SensorCalibration>; RANGES],
}

impl Kept {
    /// What the newer of the whole copies holds; nothing where none is whole.
    pub fn load(sectors: &dyn Sectors) -> Self {
        newest(sectors).map_or_else(Self::default, |(_, _, words)| Self::of(&words))
    }

    /// The calibration of a range.
    pub fn calibration(&self, range: SensorRange) -> Option<SensorCalibration> {
        self.calibrations.get(place(range)).copied().flatten()
    }

    /// Keeps a calibration, or none, for a range in place of the old one; that of the other range
    /// stays.
    ///
    /// # Errors
    /// [`NotWritten`] if the flash does not hold it afterwards; what was kept before, is.
    pub fn replace(
        sectors: &mut dyn Sectors,
        range: SensorRange,
        calibration: Option<SensorCalibration>,
    ) -> Result<(), NotWritten> {
        let (copy, number, mut kept) = match newest(sectors) {
            Some((copy, number, words)) => {
                (COPIES - 1 - copy, number.wrapping_add(1), Self::of(&words))
            }
            None => (0, 1, Self::default()),
        };
        if let Some(old) = kept.calibrations.get_mut(place(range)) {
            *old = calibration;
        }
        let words = kept.words(number);
        sectors.erase(copy)?;
        for (at, &word) in words.iter().enumerate() {
            sectors.write(copy, at, word)?;
        }
        // A worn cell does not hold what was written.
        if copy_of(sectors, copy) == words {
            Ok(())
        } else {
            Err(NotWritten)
        }
    }

    /// As a copy with this number.
    fn words(&self, number: u32) -> [u32; WORDS] {
        let mut words = [0; WORDS];
        let (head, rest) = words.split_at_mut(HEAD);
        let mut there = 0;
        for (bit, (record, calibration)) in rest
            .chunks_exact_mut(RECORD)
            .zip(&self.calibrations)
            .enumerate()
        {
            if let Some(calibration) = calibration {
                there |= 1 << bit;
                record.copy_from_slice(&written(calibration));
            }
        }
        head.copy_from_slice(&[MAGIC, number, there]);
        words[WORDS - 1] = checksum(&words);
        words
    }

    /// What a whole copy holds.
    fn of(words: &[u32; WORDS]) -> Self {
        let mut kept = Self::default();
        let there = words[HEAD - 1];
        let records = words[HEAD..].chunks_exact(RECORD);
        for (bit, (record, place)) in records.zip(&mut kept.calibrations).enumerate() {
            if there & (1 << bit) != 0 {
                *place = read(record, bit);
            }
        }
        kept
    }
}

/// Where the calibration of a range stands.
const fn place(range: SensorRange) -> usize {
    match range {
        SensorRange::G4 => 0,
        SensorRange::G12 => 1,
    }
}

/// The words of a calibration; its range is told by its place.
fn written(calibration: &SensorCalibration) -> [u32; RECORD] {
    let mut words = [0; RECORD];
    let celsius = calibration.centi_celsius;
    let time = calibration.unix_s.cast_unsigned();
    let temperature = u32::from(celsius.unwrap_or(0).cast_unsigned());
    let head = [
        temperature << 16 | u32::from(celsius.is_some()),
        time as u32,
        (time >> 32) as u32,
        calibration.gravity_um_s2,
        u32::from(calibration.positions),
    ];
    let numbers = head
        .into_iter()
        .chain(calibration.rows.map(i32::cast_unsigned))
        .chain(calibration.row_deviations)
        .chain(calibration.zero.map(i32::cast_unsigned))
        .chain(calibration.zero_deviations);
    for (word, number) in words.iter_mut().zip(numbers) {
        *word = number;
    }
    words
}

/// The calibration at a place; `None` if there are too few words.
fn read(words: &[u32], place: usize) -> Option<SensorCalibration> {
    let (&[celsius, low, high, gravity_um_s2, positions], words) = words.split_first_chunk()?;
    let (rows, words) = words.split_first_chunk::<TRIANGLE>()?;
    let (row_deviations, words) = words.split_first_chunk()?;
    let (zero, words) = words.split_first_chunk::<AXES>()?;
    let (zero_deviations, _) = words.split_first_chunk()?;
    Some(SensorCalibration {
        range: if place == 0 {
            SensorRange::G4
        } else {
            SensorRange::G12
        },
        unix_s: (u64::from(high) << 32 | u64::from(low)).cast_signed(),
        centi_celsius: (celsius & 1 != 0).then_some(((celsius >> 16) as u16).cast_signed()),
        gravity_um_s2,
        positions: positions as u16,
        rows: rows.map(u32::cast_signed),
        row_deviations: *row_deviations,
        zero: zero.map(u32::cast_signed),
        zero_deviations: *zero_deviations,
    })
}

/// Checksum of all words but the last.
fn checksum(words: &[u32; WORDS]) -> u32 {
    let mut bytes = [0; 4 * (WORDS - 1)];
    for (place, word) in bytes.chunks_exact_mut(4).zip(words) {
        place.copy_from_slice(&word.to_le_bytes());
    }
    crc32(&bytes)
}

/// The words of a copy, whole or not.
fn copy_of(sectors: &dyn Sectors, copy: usize) -> [u32; WORDS] {
    core::array::from_fn(|word| sectors.read(copy, word))
}

/// The newer of the whole copies: which it is, its number, its words.
fn newest(sectors: &dyn Sectors) -> Option<(usize, u32, [u32; WORDS])> {
    let mut newest: Option<(usize, u32, [u32; WORDS])> = None;
    for copy in 0..COPIES {
        let words = copy_of(sectors, copy);
        let whole = words[0] == MAGIC && words[WORDS - 1] == checksum(&words);
        let number = words[1];
        // Two copies differ by one; a number may begin anew behind the largest.
        let newer = |other: u32| number.wrapping_sub(other).cast_signed() > 0;
        if whole && newest.is_none_or(|(_, other, _)| newer(other)) {
            newest = Some((copy, number, words));
        }
    }
    newest
}

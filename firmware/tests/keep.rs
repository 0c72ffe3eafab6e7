//! What the board keeps: the old or the new wherever power goes, never none and never a mixture.

use inm_firmware::emulated::VirtualFlash;
use inm_firmware::keep::{COPIES, Kept, NotWritten, Sectors, WORDS};
use inm_protocol::{SensorCalibration, SensorRange};

/// A calibration that differs from those of other numbers in every word.
fn calibration(range: SensorRange, number: i32) -> SensorCalibration {
    SensorCalibration {
        range,
        unix_s: 0x1_2345_6789 + i64::from(number),
        centi_celsius: Some(-1234 - number as i16),
        gravity_um_s2: 9_812_345 + number.unsigned_abs(),
        positions: 12 + number as u16,
        rows: [1, -2, 3, -4, 5, i32::MIN].map(|at| at ^ (number << 8)),
        row_deviations: [7, 8, 9, 10, 11, u32::MAX].map(|at| at ^ (number.unsigned_abs() << 8)),
        zero: [i32::MAX, -21, 22].map(|at| at ^ (number << 8)),
        zero_deviations: [30, 31, 32].map(|at| at ^ (number.unsigned_abs() << 8)),
    }
}

#[track_caller]
fn keep(flash: &mut VirtualFlash, calibration: SensorCalibration) {
    let kept = Kept::replace(flash, calibration.range, Some(calibration));
    kept.expect("the flash is sound");
}

#[test]
fn a_calibration_is_kept_for_each_range_and_forgotten_alone() {
    let mut flash = VirtualFlash::default();
    assert_eq!(Kept::load(&flash), Kept::default());
    let fine = calibration(SensorRange::G4, 1);
    let coarse = SensorCalibration {
        centi_celsius: None,
        ..calibration(SensorRange::G12, 2)
    };
    keep(&mut flash, fine);
    keep(&mut flash, coarse);
    let kept = Kept::load(&flash);
    assert_eq!(kept.calibration(SensorRange::G4), Some(fine));
    assert_eq!(kept.calibration(SensorRange::G12), Some(coarse));
    Kept::replace(&mut flash, SensorRange::G4, None).expect("the flash is sound");
    let kept = Kept::load(&flash);
    assert_eq!(kept.calibration(SensorRange::G4), None);
    assert_eq!(kept.calibration(SensorRange::G12), Some(coarse));
}

#[test]
fn power_that_goes_at_any_word_leaves_the_old_or_the_new() {
    // From one copy, and from two, into either sector.
    for writes in 1..=4 {
        let mut flash = VirtualFlash::default();
        for number in 0..writes {
            keep(&mut flash, calibration(SensorRange::G4, number));
        }
        let old = Kept::load(&flash);
        let next = calibration(SensorRange::G12, writes);
        let mut whole = flash.clone();
        keep(&mut whole, next);
        let new = Kept::load(&whole);
        assert_ne!(old, new);
        let all = 2 * WORDS as u32;
        for words in 0..=all {
            let mut cut = flash.clone().cut_after(Some(words));
            let result = Kept::replace(&mut cut, next.range, Some(next));
            let expected = if words < all { Err(NotWritten) } else { Ok(()) };
            assert_eq!(result, expected, "{words} words");
            let found = Kept::load(&cut);
            let expected = if words < all { old } else { new };
            assert_eq!(found, expected, "{words} words");
            // With power again, it is written as if nothing had been.
            let mut on = cut.cut_after(None);
            keep(&mut on, next);
            assert_eq!(Kept::load(&on), new, "{words} words");
        }
    }
}

#[test]
fn a_copy_that_lost_a_bit_counts_no_more_and_the_other_does() {
    let mut flash = VirtualFlash::default();
    let [old, new] = [1, 2].map(|number| calibration(SensorRange::G4, number));
    keep(&mut flash, old);
    keep(&mut flash, new);
    let blank = VirtualFlash::default();
    let newer = (0..COPIES)
        .find(|&copy| flash.read(copy, 1) == 2)
        .expect("the second was written");
    let mut damaged = 0;
    for word in 0..WORDS {
        for bit in 0..32 {
            let mut decayed = flash.clone();
            decayed.clear(newer, word, 1 << bit);
            let expected = if decayed == flash { new } else { old };
            damaged += u32::from(expected == old);
            let found = Kept::load(&decayed).calibration(SensorRange::G4);
            assert_eq!(found, Some(expected), "word {word}, bit {bit}");
        }
    }
    // Some two bits in five are ones, or nothing was tried.
    assert!(damaged > 100, "{damaged} bits");
    assert_eq!(Kept::load(&blank), Kept::default());
}

#[test]
fn a_sector_of_zeros_or_of_noise_holds_nothing_and_can_be_written() {
    let mut flash = VirtualFlash::default();
    for copy in 0..COPIES {
        for word in 0..WORDS {
            let noise = (word as u32).wrapping_mul(0x9E37_79B9) * copy as u32;
            flash.write(copy, word, noise).expect("sound");
        }
    }
    assert_eq!(Kept::load(&flash), Kept::default());
    let new = calibration(SensorRange::G12, 5);
    keep(&mut flash, new);
    let kept = Kept::load(&flash);
    assert_eq!(kept.calibration(SensorRange::G12), Some(new));
}

//! Words and levels as an axis sees them, one after another.

use ads1281::register::Output;
use ads1281::word::{Reading, Word};
use inm_protocol::{Code, Flags, Trouble};

use super::judge::STUCK;
use super::{Axis, Judgement, STALLED};

/// 0.5 g on the 4 g range, in 31-bit steps.
const LEVEL: i32 = 66_000_000;

fn judge(axis: &mut Axis, value: i32) -> Judgement {
    let word = Word((value << 1).cast_unsigned() | u32::from(value < 0));
    axis.judge(Ok(Some(Reading { word, torn: false })), Output::Fir)
}

/// Troubles of `count` equal values.
fn troubles(axis: &mut Axis, value: i32, count: u32) -> Vec<Trouble> {
    (0..count)
        .filter_map(|_| judge(axis, value).trouble)
        .collect()
}

#[test]
fn a_level_that_a_reset_does_not_change_is_the_signal() {
    let slipped = Trouble::Slipped { doubled: true };
    let mut axis = Axis::new();
    assert_eq!(troubles(&mut axis, LEVEL, 200), []);
    assert_eq!(troubles(&mut axis, 2 * LEVEL, 16), [slipped]);
    axis.rest(slipped, 0);
    axis.resume();
    assert_eq!(troubles(&mut axis, 2 * LEVEL, 200), []);
    // And is watched from then on.
    assert_eq!(troubles(&mut axis, 4 * LEVEL, 16), [slipped]);
}

#[test]
fn a_level_that_a_reset_brings_back_is_watched_as_before() {
    let slipped = Trouble::Slipped { doubled: false };
    let mut axis = Axis::new();
    assert_eq!(troubles(&mut axis, LEVEL, 200), []);
    for _ in 0..3 {
        assert_eq!(troubles(&mut axis, LEVEL / 2, 16), [slipped]);
        axis.rest(slipped, 0);
        axis.resume();
        assert_eq!(troubles(&mut axis, LEVEL, 1), []);
    }
    assert_eq!(axis.counters.slipped, 3);
}

#[test]
fn zero_words_around_zero_are_flagged_from_the_third_on() {
    let mut axis = Axis::new();
    judge(&mut axis, 1000);
    let flags: Vec<bool> = (0..STUCK)
        .map(|_| judge(&mut axis, 0).flags.has(Flags::STUCK))
        .collect();
    let expected = [false, false, true, true, true, true, true, true];
    assert_eq!(flags, expected);
}

#[test]
fn a_missing_word_repeats_the_last() {
    let mut axis = Axis::new();
    judge(&mut axis, LEVEL);
    let mut trouble = None;
    for _ in 0..STALLED {
        assert_eq!(trouble, None);
        let missed = axis.judge(Ok(None), Output::Fir);
        assert_eq!(
            (missed.code, missed.flags),
            (Code(2 * LEVEL), Flags::MISSED)
        );
        trouble = missed.trouble;
    }
    assert_eq!(trouble, Some(Trouble::Stalled));
}

#[test]
fn an_overload_that_flickers_is_one_event() {
    let mut axis = Axis::new();
    judge(&mut axis, LEVEL);
    let clipped = Ok(Some(Reading {
        word: Word(0x7FFF_FFFF),
        torn: false,
    }));
    let mut told = 0;
    for _ in 0..20 {
        told += u32::from(axis.judge(clipped, Output::Fir).trouble.is_some());
        judge(&mut axis, LEVEL);
    }
    assert_eq!((told, axis.counters.over_range), (1, 20));
}

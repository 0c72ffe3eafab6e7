//! Task: notice that a bit of the clock was lost. The part has no chip select, so that every later word
//! is shifted, too: the level doubles, and stays.
//!
//! `main` makes up the words of a steady signal with some noise.

use ads1281::slip::{CONFIRM, Slip, SlipDetector, Verdict};
use ads1281::word::Word;

/// The first word behind which a slip is certain, and which way the bits went.
fn first_slip(words: impl Iterator<Item = Word>) -> Option<(usize, Slip)> {
    let mut detector = SlipDetector::default();
    words
        .enumerate()
        .find_map(|(at, word)| match detector.push(word.value()) {
            Verdict::Slipped(slip) => Some((at, slip)),
            _ => None,
        })
}

fn main() {
    // 20 million steps, and a noise of up to 1000 from a congruential generator (Knuth).
    let mut state = 1_u64;
    let words = (0..2000).map(|at| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        let value = 20_000_000 + (state >> 54) as u32;
        // From word 1000 on the first bit is missing, and the first of the next word at the end.
        let word = value << 1;
        Word(if at < 1000 { word } else { word << 1 })
    });
    let found = first_slip(words);
    println!("{found:?}");
    assert_eq!(found, Some((1000 + CONFIRM as usize - 1, Slip::Doubled)));
}

#[test]
fn it_runs() {
    main();
}

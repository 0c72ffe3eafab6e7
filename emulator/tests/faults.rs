//! Each fault as it shows at the pins, and how it ends.

mod common;

use common::{RDATAC, RESET, SDATAC, bench, bench_of, configure, next_word, registers, send, word};
use embedded_hal::{delay::DelayNs, spi::SpiBus};
use inm_emulator::{
    Bench, BusError, Constant, Converter, Fault, Ramp, ReadMode, Signal, Slip, Tear, time,
};

const SECOND_PS: u64 = 1_000_000_000_000;

/// The last word that axis 0 made.
fn made<S: Signal>(bench: &Bench<S>) -> u32 {
    let made = bench.sent(0).words();
    bench.word(0, made - 1).expect("a word was made")
}

/// That the next words arrive as they were made.
fn assert_sound<S: Signal>(bench: &Bench<S>) {
    for _ in 0..3 {
        assert_eq!(next_word(bench, 0), made(bench));
    }
    assert_eq!(bench.violation(), None);
}

#[test]
fn drdy_stops_until_reset_while_conversions_go_on() {
    let bench = bench(Constant(5_000_000));
    next_word(&bench, 0);
    bench.inject_at(0, 3, Fault::DrdyStops);
    next_word(&bench, 0);
    next_word(&bench, 0);
    assert_eq!(bench.run_until_edge(0, bench.now_ps() + SECOND_PS), None);
    assert!(bench.sent(0).words() > 900, "conversions go on");
    assert!(
        bench.run_until_edge(1, u64::MAX).is_some(),
        "the others are sound"
    );
    send(&bench, 0, &[RESET, RDATAC]);
    assert_sound(&bench);
}

#[test]
fn a_stuck_bus_returns_one_level_for_words_and_registers() {
    for (high, level) in [(true, u32::MAX), (false, 0)] {
        let bench = bench(Constant(5_000_000));
        next_word(&bench, 0);
        bench.inject_at(
            0,
            2,
            Fault::BusStuck {
                high,
                conversions: Some(3),
            },
        );
        assert_eq!(next_word(&bench, 0), made(&bench));
        for _ in 0..3 {
            assert_eq!(next_word(&bench, 0), level);
        }
        assert_sound(&bench);

        bench.inject(
            0,
            Fault::BusStuck {
                high,
                conversions: None,
            },
        );
        for _ in 0..100 {
            assert_eq!(next_word(&bench, 0), level);
        }
        send(&bench, 0, &[SDATAC]);
        assert_eq!(registers::<_, 2>(&bench, 0, 0), [level as u8; 2]);
        send(&bench, 0, &[RESET, RDATAC]);
        assert_sound(&bench);
    }
}

#[test]
fn a_slip_doubles_or_halves_the_level_until_sclk_has_been_idle() {
    for code in [40_000_000, -40_000_000] {
        for slip in [Slip::Early, Slip::Late] {
            let bench = bench(Constant(code));
            assert_eq!(next_word(&bench, 0), made(&bench));
            bench.inject(0, Fault::Slip(slip));
            for _ in 0..100 {
                let (got, made) = (next_word(&bench, 0), made(&bench));
                let expected = match slip {
                    Slip::Early => made << 1 | made & 1,
                    Slip::Late => (made as i32 >> 1) as u32,
                };
                assert_eq!(got, expected, "{code} {slip:?}");
            }
            bench.advance_ps(65 * time::period_ps(1000));
            // The word under way was loaded slipped; those after it are not.
            word(&bench, 0);
            assert_sound(&bench);
        }
    }
}

/// DIN slips with DOUT: nothing that a controller sends is what the part receives.
#[test]
fn a_slipped_part_understands_no_command() {
    for slip in [Slip::Early, Slip::Late] {
        let bench = bench(Constant(40_000_000));
        configure(&bench, 0, 0x5A);
        next_word(&bench, 0);
        bench.inject(0, Fault::Slip(slip));
        send(&bench, 0, &[RESET]);
        assert_eq!(
            bench.registers(0).data_rate_hz(),
            2000,
            "{slip:?}: no RESET"
        );
        send(&bench, 0, &[SDATAC]);
        assert_ne!(registers::<_, 1>(&bench, 0, 1), [0x5A], "{slip:?}: no RREG");
        // Whatever the bytes were taken for is no fault of the controller's.
        assert_eq!(bench.violation(), None);

        bench.advance_ps(65 * time::period_ps(1000));
        send(&bench, 0, &[RESET, SDATAC]);
        assert_eq!(registers::<_, 1>(&bench, 0, 1), [0x52], "{slip:?}");
        send(&bench, 0, &[RDATAC]);
        next_word(&bench, 0);
        assert_sound(&bench);
    }
}

#[test]
fn an_overload_clips_and_leaves_62_conversions_of_settling() {
    let bench = bench(Constant(5_000_000));
    let clean = next_word(&bench, 0);
    bench.inject_at(
        0,
        10,
        Fault::Overload {
            input: 2_000_000_000,
            conversions: 20,
        },
    );
    let words: Vec<u32> = (0..200).map(|_| next_word(&bench, 0)).collect();
    let clipped = words.iter().filter(|&&word| word == 0x7FFF_FFFF).count();
    // 20 conversions above full scale, rounded at both ends by the filter's step response.
    assert!((19..=21).contains(&clipped), "{clipped}");
    let last = words
        .iter()
        .rposition(|&word| word.abs_diff(clean) > 2)
        .expect("disturbed");
    // The first disturbed conversion is number 10, words[9]; input ends 20 later.
    let settled = last + 1 - (9 + 20);
    assert!((60..=62).contains(&settled), "{settled}");

    let within = Fault::Overload {
        input: -1_000_000_000,
        conversions: 200,
    };
    bench.inject(0, within);
    let driven = (0..100).map(|_| next_word(&bench, 0)).last();
    assert_eq!(
        driven.map(|word| (word as i32 >> 1) / 100_000),
        Some(-10_000)
    );
}

#[test]
fn a_brown_out_puts_the_defaults_back_and_is_silent_for_63_ms() {
    let bench = bench(Constant(5_000_000));
    configure(&bench, 0, 0x5A);
    send(&bench, 0, &[SDATAC, 0x45, 0x00, 0x11, RDATAC]);
    next_word(&bench, 0);
    bench.inject_at(0, 4, Fault::BrownOut);
    for _ in 0..3 {
        next_word(&bench, 0);
    }
    let before = bench.now_ps();
    let edge = bench.run_until_edge(0, u64::MAX).expect("it restarts");
    assert_eq!((edge - before) / 1_000_000_000, 63);
    assert_eq!(bench.registers(0).data_rate_hz(), 1000);
    assert_sound(&bench);

    // A driver that had stopped the part and finds it converting broke no rule.
    send(&bench, 0, &[SDATAC]);
    bench.inject(0, Fault::BrownOut);
    send(&bench, 0, &[0x20, 0x00, 0x00]);
    assert_eq!(bench.violation(), None);
    send(&bench, 0, &[SDATAC]);
    assert_eq!(registers::<_, 6>(&bench, 0, 0)[5], 0);
}

#[test]
fn a_wrong_identity_stays() {
    let bench = bench(Constant(0));
    bench.inject(0, Fault::WrongId(0x05));
    send(&bench, 0, &[RESET, SDATAC]);
    assert_eq!(registers::<_, 1>(&bench, 0, 0), [0x05]);
}

#[test]
fn a_late_read_is_torn_in_either_way() {
    for (tear, bits) in [
        (Tear::Splice, 9),
        (Tear::Reload, 9),
        (Tear::Splice, 31),
        (Tear::Reload, 1),
    ] {
        // A slope with which every word differs from the next in many bits.
        let signal = Ramp::new(-400_000_000, 123_456_789);
        let bench = bench_of([0, 1, 2].map(|_| Converter::new(signal).tearing(tear)));
        next_word(&bench, 0);
        bench.run_until_edge(0, u64::MAX);
        bench.drdy(0).take_edge();
        let old = made(&bench);
        bench.inject(0, Fault::LateRead { bits });
        let got = word(&bench, 0);
        let new = made(&bench);
        let high = u32::MAX << (32 - bits);
        let expected = match tear {
            Tear::Splice => old & high | new & !high,
            Tear::Reload => old & high | new >> bits,
        };
        assert_eq!(
            got, expected,
            "{tear:?} after {bits} bits: {old:08X} {new:08X}"
        );
        // Its sure sign: DRDY fell between the first clock and the last.
        bench.delay().delay_us(1);
        assert!(bench.drdy(0).take_edge());
        assert_sound(&bench);
    }
}

#[test]
fn an_overrun_is_reported_once() {
    let bench = bench(Constant(0));
    bench.inject(0, Fault::BusError);
    assert_eq!(bench.spi(0).write(&[SDATAC]), Err(BusError::Overrun));
    assert_eq!(bench.spi(0).write(&[SDATAC]), Ok(()));
}

#[test]
fn the_schedule_is_bounded() {
    let bench = bench(Constant(0));
    for word in 0..8 {
        assert!(bench.inject_at(0, 1000 + word, Fault::BrownOut));
    }
    assert!(!bench.inject_at(0, 1000, Fault::BrownOut));
}

#[test]
fn either_mode_after_reset_can_be_had() {
    let bench = bench_of(
        [0, 1, 2].map(|_| Converter::new(Constant(777)).mode_after_reset(ReadMode::Stopped)),
    );
    assert_eq!(next_word(&bench, 0), 0, "stopped: no data");
    send(&bench, 0, &[RDATAC]);
    assert_eq!(next_word(&bench, 0), 777 << 1);
    send(&bench, 0, &[RESET]);
    assert_eq!(registers::<_, 1>(&bench, 0, 1), [0x52]);
    assert_eq!(bench.violation(), None);
}

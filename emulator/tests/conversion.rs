//! What the words say: level, calibration, filters, pins, and that they are the same everywhere.

mod common;

use common::{RDATAC, SDATAC, SYNC, bench, bench_of, configure, next_word, registers, send, word};
use embedded_hal::{
    delay::DelayNs,
    digital::{InputPin, OutputPin},
};
use inm_emulator::{
    Bench, Constant, Conversion, Converter, Phase, Ramp, Recorded, Registers, Sent, Signal, Sine,
    channel::published, response::Response, time,
};
use proptest::prelude::*;

fn code(word: u32) -> i32 {
    word as i32 >> 1
}

#[test]
fn drdy_follows_the_data_sheet_from_conversion_to_conversion() {
    let bench = bench(Constant(0));
    let mut drdy = bench.drdy(0);
    let edge = bench.run_until_edge(0, u64::MAX).expect("converting");
    assert_eq!(
        edge,
        time::POWER_ON_PS + time::settling_ps(time::period_ps(1000))
    );
    assert!(drdy.take_edge() && !drdy.take_edge());
    assert_eq!(drdy.is_low(), Ok(true));
    // Not read: low until 4 clocks ahead of the next conversion.
    bench.advance_ps(time::period_ps(1000) - time::UPDATE_LEAD_PS - 1);
    assert_eq!(drdy.is_low(), Ok(true));
    bench.advance_ps(1);
    assert_eq!(drdy.is_high(), Ok(true));
    assert_eq!(
        bench.run_until_edge(0, u64::MAX),
        Some(edge + time::period_ps(1000))
    );
    assert_eq!(drdy.is_low(), Ok(true));
    // Read: high from the first clock on.
    word(&bench, 0);
    assert_eq!(drdy.is_high(), Ok(true));
    assert!(drdy.take_edge());
    assert_eq!(
        bench.run_until_edge(0, u64::MAX),
        Some(edge + 2 * time::period_ps(1000))
    );
    assert!(drdy.take_edge());
}

#[test]
fn what_comes_next_is_known_without_letting_time_pass() {
    let bench = bench(Constant(0));
    let edge = bench.run_until_edge(0, u64::MAX).expect("converting");
    // The word is made 4 clocks ahead of the fall that shows it.
    let fall = edge + time::period_ps(1000);
    assert_eq!(bench.next_change_ps(0), Some(fall - time::UPDATE_LEAD_PS));
    assert_eq!(bench.now_ps(), edge);
    bench.advance_ps(fall - time::UPDATE_LEAD_PS - edge);
    assert_eq!(bench.next_change_ps(0), Some(fall));
    send(&bench, 0, &[0x02]);
    assert_eq!(bench.next_change_ps(0), None, "in standby");
}

#[test]
fn every_rate_has_its_period() {
    for setting in 0..5 {
        let bench = bench(Constant(12_345));
        configure(&bench, 0, 0x42 + 8 * setting);
        let first = bench.run_until_edge(0, u64::MAX).expect("converting");
        for n in 1..=100 {
            // 0.25 mdB of gain on a small level: the code itself.
            assert_eq!(code(word(&bench, 0)), 12_345);
            let edge = bench.run_until_edge(0, u64::MAX);
            assert_eq!(edge, Some(first + n * time::period_ps(250 << setting)));
        }
    }
}

#[test]
fn sinc_words_come_32_times_as_fast_and_without_the_redundant_bit() {
    let bench = bench(Constant(-12_345));
    configure(&bench, 0, 0x41);
    let first = bench.run_until_edge(0, u64::MAX).expect("converting");
    assert_eq!(word(&bench, 0) as i32, -12_345);
    assert_eq!(
        bench.run_until_edge(0, u64::MAX),
        Some(first + time::period_ps(8000))
    );
}

#[test]
fn offset_and_gain_calibration_set_their_registers() {
    let bench = bench(Constant(300_000_000));
    let calibrate = |command| {
        send(&bench, 0, &[SDATAC, SYNC, RDATAC]);
        next_word(&bench, 0);
        send(&bench, 0, &[SDATAC, command, RDATAC]);
        let before = bench.now_ps();
        let edge = bench.run_until_edge(0, u64::MAX).expect("it ends");
        assert_eq!(
            (edge - before).div_ceil(1_000_000_000),
            17,
            "16 readings without DRDY"
        );
        code(word(&bench, 0))
    };
    let full = calibrate(0x61);
    assert!(full.abs_diff((1 << 30) - 1) < 1000, "{full}");
    let zero = calibrate(0x60);
    // OFC counts 128 codes, and FSC of 3.58 scales what is left.
    assert!(zero.unsigned_abs() <= 64 * 4, "{zero}");
    send(&bench, 0, &[SDATAC]);
    let [ofc @ .., _, _, fsc2] = registers::<_, 6>(&bench, 0, 5);
    assert_eq!(
        i32::from(ofc[2]) << 16 | i32::from(ofc[1]) << 8 | i32::from(ofc[0]),
        {
            // 300 000 000 by the filter's DC gain of 0.25 mdB, over 128.
            (300_000_000.0 * Response::new(Phase::Linear, 1000).gain(0.0) / 128.0_f64).round()
                as i32
        }
    );
    assert_eq!(fsc2, 0xE5);
}

#[test]
fn the_high_pass_removes_the_level() {
    let bench = bench(Constant(300_000_000));
    configure(&bench, 0, 0x53);
    assert!(code(next_word(&bench, 0)) > 290_000_000);
    for _ in 0..2000 {
        next_word(&bench, 0);
    }
    assert!(code(next_word(&bench, 0)).abs() < 10);
}

#[test]
fn sync_starts_all_three_together() {
    let bench = bench(Constant(0));
    configure(&bench, 1, 0x52);
    bench.sync().set_low().expect("infallible");
    bench.delay().delay_us(1);
    bench.sync().set_high().expect("infallible");
    let mut pins = [0, 1, 2].map(|axis| bench.drdy(axis));
    let edge = bench.run_until_edge(0, u64::MAX).expect("converting");
    assert!(pins.iter_mut().all(|pin| pin.take_edge()));
    bench.advance_ps(time::period_ps(1000) - 1);
    assert!(!pins.iter_mut().any(|pin| pin.take_edge()));
    bench.advance_ps(1);
    assert!(pins.iter_mut().all(|pin| pin.take_edge()));
    assert_eq!(bench.now_ps() - edge, time::period_ps(1000));
}

/// The integer chain against the response computed from the tables in floating point.
#[test]
fn a_sine_passes_with_the_gain_of_the_response() {
    for (config0, phase) in [(0x52, Phase::Linear), (0x56, Phase::Minimum)] {
        let mut registers = Registers::default();
        registers.set(1, config0);
        for frequency_mhz in [10_000, 100_000, 375_000, 413_000, 450_000, 600_000] {
            let amplitude = 500_000_000;
            let mut conversion = Conversion::new(Sine::new(100_000, amplitude, frequency_mhz));
            // One second: a whole number of periods of every frequency, and no alias among them
            // but its own.
            let f = f64::from(frequency_mhz) / 1e6;
            let (mut re, mut im) = (0.0, 0.0);
            for n in 0..1000 {
                let x = f64::from(conversion.next_code(&registers));
                let (sin, cos) = (2.0 * std::f64::consts::PI * f * f64::from(n)).sin_cos();
                re += x * cos;
                im += x * sin;
            }
            let gain = (re * re + im * im).sqrt() / 500.0 / f64::from(amplitude);
            // The input comes as impulses, the part's in 32 modulator cycles each: sinc5's limit.
            let cycle = std::f64::consts::PI * f / 32.0 / 32.0;
            let impulses = (cycle.sin() / cycle).powi(5);
            let expected = Response::new(phase, 1000).gain(f) * impulses;
            // The oscillator is good to 1e-7; rounding adds nothing to speak of.
            assert!(
                (gain - expected).abs() < 3e-7,
                "{phase:?} {f}: {gain} {expected}"
            );
        }
    }
}

/// A step is settled after 62 conversions, and both halves of the response are there.
#[test]
fn a_step_settles_in_62_conversions() {
    let registers = Registers::default();
    let mut inputs = vec![0; 32 * 100];
    inputs.extend([800_000_000; 32 * 100]);
    let mut conversion = Conversion::new(Recorded::new(&inputs));
    let codes: Vec<i32> = (0..137).map(|_| conversion.next_code(&registers)).collect();
    // The first word ends with the 63rd block of inputs; the step comes with the 101st.
    let (before, after) = codes.split_at(100 - 63 + 1);
    assert!(before[..before.len() - 1].iter().all(|&code| code == 0));
    let settled = codes[136];
    assert!((settled - 800_023_000).abs() < 30_000, "{settled}");
    let last = after
        .iter()
        .rposition(|&code| code != settled)
        .expect("a step");
    assert!((58..62).contains(&last), "{last}");
}

#[test]
fn the_channel_goes_on_where_it_was_across_restarts() {
    // Configured late or early: the same words, because a restart draws nothing.
    let run = |pause_ms: u32| {
        let bench = bench_of([0, 1, 2].map(|axis| Converter::new(published(axis, 9))));
        configure(&bench, 0, 0x5A);
        bench.delay().delay_ms(pause_ms);
        send(&bench, 0, &[SYNC]);
        (0..20).map(|_| next_word(&bench, 0)).collect::<Vec<_>>()
    };
    assert_eq!(run(1), run(20));
}

/// The same digest on every machine: the image under QEMU is held to these figures, too.
#[test]
fn golden_digests() {
    let expected = [
        0x07CE_17E2_E492_9ADD,
        0xDAAA_78FA_ADA8_2B4B,
        0x7A07_CDE9_EC42_454F,
    ];
    let digests = [0, 1, 2].map(|axis| {
        let mut registers = Registers::default();
        registers.set(1, 0x5A);
        let mut conversion = Conversion::new(published(axis, 1));
        let mut sent = Sent::default();
        for _ in 0..10_000 {
            sent.push(conversion.next_word(&registers));
        }
        sent.digest()
    });
    assert_eq!(digests, expected, "{digests:#018X?}");
}

#[test]
fn the_bus_carries_what_a_bare_conversion_makes() {
    let bench: Bench<_> = bench_of([0, 1, 2].map(|axis| Converter::new(published(axis, 4))));
    for axis in 0..3 {
        configure(&bench, axis, 0x62);
    }
    send(&bench, 0, &[SYNC]);
    let mut twin = Conversion::new(published(0, 4));
    let mut received = Sent::default();
    for _ in 0..5000 {
        let got = next_word(&bench, 0);
        received.push(got);
        assert_eq!(got, twin.next_word(&bench.registers(0)));
    }
    assert_eq!(received, bench.sent(0));
}

proptest! {
    /// Any input, any calibration, any signal: no overflow (tests run with checks), the right
    /// clip.
    #[test]
    fn no_input_upsets_the_arithmetic(
        inputs in proptest::collection::vec(any::<i32>(), 1..200),
        ofc in any::<i32>(), fsc in any::<u32>(), config0 in 0_u8..255,
    ) {
        let mut registers = Registers::default();
        registers.set(1, config0 | 1);
        registers.set_ofc(ofc);
        registers.set_fsc(fsc);
        let mut conversion = Conversion::new(Recorded::new(&inputs));
        for _ in 0..5 {
            conversion.next_word(&registers);
        }
    }

    /// Any bytes at any pace leave the converter able to reset and convert.
    #[test]
    fn no_bytes_upset_the_converter(
        bytes in proptest::collection::vec((any::<u8>(), 0_u64..200_000_000_000), 1..60),
    ) {
        let bench = bench(Ramp::new(0, 1000));
        bench.set_strict(false);
        for (byte, pause_ps) in bytes {
            send(&bench, 0, &[byte]);
            bench.advance_ps(pause_ps);
        }
        bench.advance_ps(20_000_000_000_000);
        send(&bench, 0, &[common::RESET, RDATAC]);
        let made = |bench: &Bench<Ramp>| bench.word(0, bench.sent(0).words() - 1);
        let got = next_word(&bench, 0);
        prop_assert_eq!(Some(got), made(&bench));
    }
}

#[test]
fn simple_signals_keep_their_promises() {
    let mut ramp = Ramp::new(-10, 64_000);
    ramp.set_rate(32_000);
    assert_eq!([(); 4].map(|()| ramp.next()), [-10, -8, -6, -4]);
    let mut sine = Sine::new(7, 1_000_000_000, 1_000_000);
    sine.set_rate(12_000);
    for n in 0..100 {
        let expected = 7.0 + 1e9 * (std::f64::consts::PI / 6.0 * f64::from(n)).sin();
        let got = f64::from(sine.next());
        assert!((got - expected).abs() < 100.0, "{n}: {got} {expected}");
    }
    assert_eq!(Recorded::new(&[]).next(), 0);
    let mut recorded = Recorded::new(&[1, 2]);
    assert_eq!([(); 3].map(|()| recorded.next()), [1, 2, 1]);
}

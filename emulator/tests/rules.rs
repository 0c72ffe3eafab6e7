//! Each rule of the part broken once, and each kept at its limit.

mod common;

use common::{RDATA, RDATAC, SDATAC, SYNC, bench, configure, next_word, registers, send, word};
use embedded_hal::{delay::DelayNs, digital::OutputPin, spi::SpiBus};
use inm_emulator::{Bench, Constant, Converter, Rule, time};

type Lenient = Bench<Constant>;

fn lenient() -> Lenient {
    let bench = bench(Constant(1_000_000));
    bench.set_strict(false);
    bench
}

/// The rule that this sequence breaks first.
fn broken(bench: &Lenient, sequence: impl FnOnce(&Lenient)) -> Option<Rule> {
    sequence(bench);
    bench.violation().map(|violation| violation.rule)
}

fn raw(bench: &Lenient, bytes: &[u8]) {
    bench.spi(0).write(bytes).expect("no bus error injected");
}

#[test]
fn clocking_needs_16_ms_from_power_on() {
    let bench = Bench::new([0, 1, 2].map(|_| Converter::new(Constant(0))));
    bench.set_strict(false);
    bench.advance_ps(time::POWER_ON_PS - 1);
    assert_eq!(broken(&bench, |b| raw(b, &[0])), Some(Rule::PowerOn));
}

#[test]
fn sclk_may_be_half_the_clock_and_no_faster() {
    let bench = lenient();
    bench.set_sclk_hz(0, 2_048_000);
    assert_eq!(broken(&bench, |b| raw(b, &[0])), None);
    bench.set_sclk_hz(0, 2_100_000);
    assert_eq!(broken(&bench, |b| raw(b, &[0])), Some(Rule::SclkTooFast));
}

#[test]
fn bytes_of_a_command_need_24_clocks_between_them() {
    // From the last rising edge to the first: the pause and one SCLK period.
    let pause = |bench: &Lenient, short_ps| {
        raw(bench, &[SDATAC]);
        bench.advance_ps(time::COMMAND_GAP_PS - 1_000_000_000_000 / 1_312_500 - short_ps);
        raw(bench, &[0x20]);
    };
    assert_eq!(broken(&lenient(), |b| pause(b, 0)), None);
    assert_eq!(broken(&lenient(), |b| pause(b, 1)), Some(Rule::CommandGap));
    let within = |b: &Lenient| {
        send(b, 0, &[SDATAC]);
        raw(b, &[0x41, 0x00]);
    };
    assert_eq!(broken(&lenient(), within), Some(Rule::CommandGap));
    let data = |b: &Lenient| {
        send(b, 0, &[SDATAC, 0x23, 0x01]);
        raw(b, &[0, 0]);
    };
    assert_eq!(broken(&lenient(), data), Some(Rule::CommandGap));
    // Data words need none.
    assert_eq!(broken(&lenient(), |b| raw(b, &[0; 8])), None);
}

#[test]
fn registers_rdata_and_calibration_need_sdatac() {
    for command in [0x20, 0x45, RDATA, 0x60, 0x61] {
        let bench = lenient();
        assert_eq!(
            broken(&bench, |b| raw(b, &[command])),
            Some(Rule::NotStopped),
            "{command:02X}h"
        );
    }
    // And the refused write changes nothing.
    let bench = lenient();
    send(&bench, 0, &[0x45, 0x00, 0x77]);
    assert_eq!(bench.registers(0).get(5), Some(0));
}

#[test]
fn din_is_decoded_while_data_are_read() {
    let high = |b: &Lenient| b.spi(0).read(&mut [0; 4]).expect("no bus error injected");
    assert_eq!(broken(&lenient(), high), Some(Rule::UnknownCommand(0xFF)));
    let register = |b: &Lenient| send(b, 0, &[SDATAC, 0x20, 0x00, 0x80]);
    assert_eq!(
        broken(&lenient(), register),
        Some(Rule::DinDuringRead(0x80))
    );
    // NOP keeps the part awake, STANDBY among data puts it to sleep.
    let bench = lenient();
    bench.run_until_edge(0, u64::MAX);
    raw(&bench, &[0x00, 0x02]);
    assert_eq!(
        bench.run_until_edge(0, bench.now_ps() + 1_000_000_000_000),
        None
    );
    assert_eq!(bench.violation(), None);
}

#[test]
fn registers_that_must_not_be_written() {
    let write = |address: u8, value: u8| {
        broken(&lenient(), |b| {
            send(b, 0, &[SDATAC, 0x40 + address, 0x00, value]);
        })
    };
    assert_eq!(write(0x00, 0x10), Some(Rule::ReadOnlyRegister));
    assert_eq!(write(0x02, 0x08), Some(Rule::ReservedRegister));
    assert_eq!(write(0x01, 0x12), Some(Rule::FixedBit));
    assert_eq!(write(0x01, 0x6A), Some(Rule::UndefinedRate));
    assert_eq!(write(0x01, 0x62), None);
    assert_eq!(write(0x0A, 0x41), None);
    // A block write across the reserved register breaks the rule, a block read does not.
    let block = |b: &Lenient| send(b, 0, &[SDATAC, 0x41, 0x02, 0x52, 0x08, 0x32]);
    assert_eq!(broken(&lenient(), block), Some(Rule::ReservedRegister));
    let bench = lenient();
    send(&bench, 0, &[SDATAC]);
    let all = registers::<_, 11>(&bench, 0, 0);
    assert_eq!(all, [0x10, 0x52, 0x08, 0x32, 0x03, 0, 0, 0, 0, 0, 0x40]);
    assert_eq!(bench.violation(), None);
    let beyond = |b: &Lenient| send(b, 0, &[SDATAC, 0x2A, 0x01]);
    let rule = Rule::RegisterRange {
        address: 0x0A,
        count: 2,
    };
    assert_eq!(broken(&lenient(), beyond), Some(rule));
}

#[test]
fn rdata_waits_for_drdy() {
    let hasty = |b: &Lenient| {
        send(b, 0, &[SDATAC, SYNC, RDATA]);
        word(b, 0);
    };
    assert_eq!(broken(&lenient(), hasty), Some(Rule::RdataBeforeReady));
    let bench = lenient();
    send(&bench, 0, &[SDATAC, SYNC, RDATA]);
    assert_eq!(
        next_word(&bench, 0),
        bench.word(0, 0).expect("the first word")
    );
    // The word stays whole across the next conversion.
    send(&bench, 0, &[RDATA]);
    let edge = bench.run_until_edge(0, u64::MAX).expect("converting");
    bench.advance_ps(edge + 990_000_000 - bench.now_ps());
    assert_eq!(Some(word(&bench, 0)), bench.word(0, 1));
    assert_eq!(bench.violation(), None);
}

#[test]
fn calibration_needs_the_high_pass_off() {
    let calibrate = |b: &Lenient| {
        configure(b, 0, 0x53);
        send(b, 0, &[SDATAC, 0x60]);
    };
    assert_eq!(
        broken(&lenient(), calibrate),
        Some(Rule::HighPassDuringCalibration)
    );
}

#[test]
fn sync_pulses_last_two_clocks() {
    let pulse = |low_ps| {
        broken(&lenient(), |b| {
            b.sync().set_low().expect("infallible");
            b.advance_ps(low_ps);
            b.sync().set_high().expect("infallible");
        })
    };
    assert_eq!(pulse(time::SYNC_PULSE_PS), None);
    assert_eq!(pulse(time::SYNC_PULSE_PS - 1), Some(Rule::SyncPulse));
}

#[test]
#[should_panic(expected = "ADS1281 0 at 17000 us: no command: 80h on DIN")]
fn a_strict_bench_panics_at_the_breach() {
    raw(&bench(Constant(0)), &[0x80]);
}

#[test]
fn sixty_three_readings_are_lost_after_every_restart() {
    let restarts: [&[u8]; 3] = [&[SYNC], &[0x06], &[SDATAC, 0x45, 0x00, 0x00, RDATAC]];
    for bytes in restarts {
        let bench = lenient();
        next_word(&bench, 0);
        send(&bench, 0, bytes);
        let start = bench.now_ps();
        let edge = bench.run_until_edge(0, u64::MAX).expect("converting");
        let lost = (edge - start) / time::period_ps(1000);
        assert!((62..=63).contains(&lost), "{bytes:02X?}: {lost}");
        let shift = edge - start - lost * time::period_ps(1000);
        assert!(
            lost == 63 || shift > time::period_ps(1000) / 2,
            "{bytes:02X?}"
        );
    }
}

#[test]
fn continuous_sync_gives_zeros_until_settled_and_ignores_whole_periods() {
    let bench = lenient();
    configure(&bench, 0, 0xD2);
    send(&bench, 0, &[SYNC]);
    let mut zeros = 0;
    while next_word(&bench, 0) == 0 {
        zeros += 1;
    }
    assert_eq!(zeros, 63);
    let pulse = |at_ps: u64| {
        bench.advance_ps(at_ps - bench.now_ps());
        bench.sync().set_low().expect("infallible");
        bench.delay().delay_us(1);
        bench.sync().set_high().expect("infallible");
        bench.now_ps()
    };
    let first = pulse(bench.now_ps());
    for _ in 0..64 {
        next_word(&bench, 0);
    }
    pulse(first + 70 * time::period_ps(1000) - 1_000_000);
    assert_ne!(
        next_word(&bench, 0),
        0,
        "70 periods after the last: no restart"
    );
    pulse(first + 75 * time::period_ps(1000) - 500_000);
    assert_eq!(next_word(&bench, 0), 0, "half a microsecond off: restart");
}

#[test]
fn sclk_idle_for_64_conversions_discards_a_partial_command() {
    let after = |conversions: u64| {
        let bench = lenient();
        send(&bench, 0, &[SDATAC, 0x45]);
        bench.advance_ps(conversions * time::period_ps(1000));
        // Either the count of the command before, or a command that is none.
        broken(&bench, |b| send(b, 0, &[0x80]))
    };
    assert_eq!(after(63), None);
    assert_eq!(after(64), Some(Rule::UnknownCommand(0x80)));
}

//! Every request of the host: what it does, when it is refused, and that it is answered once.

mod rig;

use std::rc::Rc;

use inm_emulator::{Bench, Converter};
use inm_protocol::{
    Answer, Filter, Phase, Rate, Refusal, Request, Restart, SensorRange, Settings, ToHost, Trouble,
};
use rig::{Noisy, OFFSETS, Rig, bench, inputs, settings};

/// Inputs without noise.
fn quiet(offsets: [i32; 3]) -> [Noisy; 3] {
    inputs(offsets).map(|input| Noisy {
        amplitude: 0,
        ..input
    })
}

#[test]
fn the_board_says_who_it_is_in_any_state() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::new(&bench);
    for streaming in [false, true] {
        if streaming {
            rig.start();
        }
        let Ok(Answer::Identity(identity)) = rig.ask(Request::Identify) else {
            panic!("no identity");
        };
        assert_eq!(identity.firmware, env!("CARGO_PKG_VERSION"));
        assert_eq!(identity.platform, "virtual");
        assert_eq!(identity.timer_hz, 1_000_000);
        assert_eq!(identity.converter_clock_hz, 4_096_000);
        assert_eq!(identity.range, SensorRange::G4);
        assert_eq!(identity.converters, [Some(0x10); 3]);
        assert_eq!(identity.settings, Settings::default());
        assert_eq!(identity.restart, Restart::Power);
    }
}

#[test]
fn what_the_link_cannot_carry_is_refused_with_the_reason() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::new(&bench);
    for filter in [Filter::Modulator, Filter::Sinc] {
        let rate = Rate::Sps4000;
        let refusal = rig.ask(Request::Configure(Settings { rate, filter }));
        let Err(Refusal::LinkTooSlow { needed, available }) = refusal else {
            panic!("{filter:?}: {refusal:?}");
        };
        assert_eq!(available, 92_160);
        assert!(needed > available);
    }
    // What was refused is not in force.
    let answer = rig.ask(Request::Start);
    assert_eq!(answer, Ok(Answer::Settings(Settings::default())));
}

#[test]
fn requests_that_need_the_converters_are_refused_while_streaming() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::new(&bench);
    rig.start();
    for request in [
        Request::Start,
        Request::Configure(Settings::default()),
        Request::CalibrateOffset,
        Request::CalibrateGain,
        Request::SelfTest,
    ] {
        assert_eq!(rig.ask(request), Err(Refusal::Streaming), "{request:?}");
    }
    rig.run_ms(100);
    assert_eq!(rig.ask(Request::Stop), Ok(Answer::Done));
    assert_eq!(
        rig.ask(Request::Stop),
        Ok(Answer::Done),
        "twice is no fault"
    );
    rig.proven();
}

#[test]
fn a_command_that_comes_again_is_answered_as_before_and_not_carried_out() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::new(&bench);
    let id = rig.send(Request::Start);
    rig.run_until(5000, "reply", |rig| rig.replies.len() == 1);
    rig.run_ms(100);
    rig.send_as(id, Request::Start);
    rig.run_until(5000, "the reply again", |rig| rig.replies.len() == 2);
    let settings = Ok(Answer::Settings(Settings::default()));
    assert_eq!(rig.replies, [(id, settings.clone()), (id, settings)]);
    // With another request, or with another number, it is another command.
    rig.send_as(id, Request::RestartBins);
    rig.run_until(5000, "its reply", |rig| rig.replies.len() == 3);
    let (_, answer) = &rig.replies[2];
    assert!(matches!(answer, Ok(Answer::BinsEpoch { .. })), "{answer:?}");
    assert_eq!(rig.ask(Request::Start), Err(Refusal::Streaming));
    rig.proven();
}

#[test]
fn registers_are_those_of_the_converters() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::new(&bench);
    rig.configure(settings(Rate::Sps500, Phase::Minimum, Some(0x1234)));
    rig.start();
    let streaming = rig.ask(Request::ReadRegisters);
    rig.run_ms(1000);
    rig.proven();
    rig.ask(Request::Stop).expect("stop");
    let registers = rig.ask(Request::ReadRegisters);
    let expected = [0x10, 0x4F, 0x08, 0x34, 0x12, 0, 0, 0, 0, 0, 0x40];
    assert_eq!(registers, Ok(Answer::Registers([expected; 3])));
    assert_eq!(
        streaming, registers,
        "the same without asking the converters"
    );
}

#[test]
fn offset_and_gain_are_found_kept_and_applied() {
    let full = [1_000_000_000, 900_000_000, 1_073_000_000];
    let inputs = quiet(OFFSETS);
    let bench = Bench::new(inputs.map(Converter::new));
    let mut rig = Rig::new(&bench);
    // With the high-pass on, which the calibration has to keep off.
    rig.configure(settings(Rate::Sps2000, Phase::Linear, Some(0x0332)));
    let Ok(Answer::Calibration(found)) = rig.ask(Request::CalibrateOffset) else {
        panic!("no offsets");
    };
    for (found, offset) in found.into_iter().zip(OFFSETS) {
        // OFC counts 128 steps of the 31-bit value; the filter's own gain at DC is 1.00003.
        let expected = f64::from(offset) / 128.0;
        let tolerance = 1.0 + 4e-5 * expected.abs();
        assert!((f64::from(found) - expected).abs() < tolerance, "{found}");
    }
    rig.configure(settings(Rate::Sps2000, Phase::Linear, None));
    for _ in 0..2 {
        rig.start();
        rig.run_ms(100);
        rig.ask(Request::Stop).expect("stop");
        let last = *rig.proven().last().expect("conversions");
        for code in last.codes {
            assert!((code.0 >> 1).abs() <= 64, "{code:?}");
        }
        rig.batches.clear();
    }

    let bench = Bench::new(quiet(full).map(Converter::new));
    let mut rig = Rig::new(&bench);
    let Ok(Answer::Calibration(gains)) = rig.ask(Request::CalibrateGain) else {
        panic!("no gains");
    };
    for (gain, full) in gains.into_iter().zip(full) {
        // The filter's own gain at DC is 1.00003.
        let expected = 4_194_304.0 * 1_073_741_823.0 / f64::from(full);
        assert!((f64::from(gain) / expected - 1.0).abs() < 1e-4, "{gain}");
    }
    rig.start();
    rig.run_ms(100);
    let last = *rig.proven().last().expect("conversions");
    for code in last.codes {
        let of_full = f64::from(code.0 >> 1) / 1_073_741_823.0;
        assert!((of_full - 1.0).abs() < 1e-6, "{code:?}");
    }
}

#[test]
fn the_self_test_measures_its_step() {
    let steps = [-13_000_000, -12_000_000, 132_000_000];
    let mut inputs = quiet(OFFSETS);
    let pin: Rc<_> = Rc::default();
    for (input, step) in inputs.iter_mut().zip(steps) {
        input.step = step;
        input.self_test = Rc::clone(&pin);
    }
    let bench = Bench::new(inputs.map(Converter::new));
    let mut rig = Rig::new(&bench);
    rig.self_test = pin;
    let Ok(Answer::SelfTest(found)) = rig.ask(Request::SelfTest) else {
        panic!("no self-test");
    };
    for axis in 0..3 {
        let close = |code: i32, value: i32| (code - 2 * value).abs() < 2 * value.abs() / 10_000;
        assert!(close(found[axis].rest, OFFSETS[axis]), "{found:?}");
        let driven = OFFSETS[axis] + steps[axis];
        assert!(close(found[axis].driven, driven), "{found:?}");
    }
    assert!(!rig.link().self_test_is_on());
}

#[test]
fn a_reset_answers_first_and_then_restarts() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::with_baud(&bench, Some(921_600));
    rig.start();
    rig.run_ms(20);
    assert_eq!(rig.ask(Request::Reset), Ok(Answer::Done));
    // A halted board lets no time pass.
    for _ in 0..100 {
        rig.step();
    }
    assert_eq!(rig.link().restarts(), 1);
    let (batches, health) = (rig.batches.len(), rig.health.len());
    // The watchdog is fed no more; if restarting failed, it bites.
    for _ in 0..1000 {
        assert!(!rig.instrument.step());
    }
    assert_eq!((rig.batches.len(), rig.health.len()), (batches, health));
}

#[test]
fn requests_in_a_row_are_answered_in_order_once_each() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::new(&bench);
    let ids = [
        Request::Identify,
        Request::Start,
        Request::Stop,
        Request::CalibrateOffset,
        Request::Start,
        Request::Identify,
    ]
    .map(|request| rig.send(request));
    rig.run_ms(1000);
    let answered: Vec<u16> = rig.replies.iter().map(|&(id, _)| id).collect();
    assert_eq!(answered, ids);
    assert!(rig.replies.iter().all(|(_, result)| result.is_ok()));
}

#[test]
fn damaged_requests_are_counted_and_the_next_is_understood() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::new(&bench);
    rig.run_ms(50);
    // A broken frame, and a line full of noise longer than any command.
    rig.link().send(&[3, 1, 2, 0]);
    rig.link().send(&[0xAA; 100]);
    rig.link().send(&[0]);
    rig.ask(Request::Identify).expect("identity");
    let link = rig.fresh_health().link;
    assert_eq!((link.frames_bad, link.bytes_lost), (2, 105));
}

#[test]
fn a_host_that_does_not_listen_loses_batches_and_is_told() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::with_baud(&bench, Some(921_600));
    rig.start();
    rig.run_ms(100);
    rig.listening = false;
    rig.run_ms(1000);
    // The reply has to wait for room, and still comes once.
    let id = rig.send(Request::Identify);
    rig.run_ms(100);
    rig.listening = true;
    rig.run_ms(500);
    assert_eq!(
        rig.replies
            .iter()
            .filter(|&&(reply, _)| reply == id)
            .count(),
        1
    );
    let missing: u32 = rig
        .batches
        .windows(2)
        .map(|pair| pair[1].seq - pair[0].seq - 1)
        .sum();
    assert!(missing > 30, "{missing} batches");
    // The short batch ahead of a health record may find room where a full one does not.
    let told = rig.events.iter().map(|event| match event.trouble {
        Trouble::LinkFull { batches } => batches,
        other => panic!("{other:?}"),
    });
    assert_eq!(told.sum::<u32>(), missing);
    let health = rig.fresh_health();
    // At most one health record fell into the silence, too.
    assert!((missing..=missing + 1).contains(&health.link.frames_dropped));
    assert_eq!(health.lost_conversions, 0, "no conversion was lost");
    let pairs = rig.batches.windows(2);
    let gaps: Vec<_> = pairs
        .filter(|pair| pair[1].seq != pair[0].seq + 1)
        .collect();
    let lost: u64 = gaps.iter().map(|gap| gap[1].first - gap[0].end()).sum();
    // All full but for one ahead of each health record.
    let full = 32 * u64::from(missing);
    assert!((full - 63..=full).contains(&lost), "{lost} of {full}");
    let told = rig.events.iter().map(|event| event.index);
    assert!(told.eq(gaps.iter().map(|gap| gap[0].end())));
}

#[test]
fn health_comes_once_a_second_streaming_or_not() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::new(&bench);
    rig.run_ms(5000);
    rig.start();
    rig.run_ms(5000);
    // One more, ahead of the first conversion.
    let begins = |health: &inm_protocol::Health| health.streaming && health.index == 0;
    assert_eq!(rig.health.iter().filter(|health| begins(health)).count(), 1);
    rig.health.retain(|health| !begins(health));
    assert!((10..=11).contains(&rig.health.len()));
    for pair in rig.health.windows(2) {
        let ticks = pair[1].stamp - pair[0].stamp;
        // While streaming, the record waits for the first conversion of a batch, 32 of 0.5 ms.
        assert!((980_000..1_020_000).contains(&ticks), "{ticks}");
    }
    assert!(rig.health[9].streaming && !rig.health[2].streaming);
    assert!(rig.health[9].index > 7000);
}

/// The largest message of each kind fits the frame that both ends have room for.
#[test]
fn every_frame_fits() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::new(&bench);
    let Ok(Answer::Identity(mut identity)) = rig.ask(Request::Identify) else {
        panic!("no identity");
    };
    identity.restart = Restart::Panic {
        line: u32::MAX,
        file: [b'x'; 32].into_iter().collect(),
    };
    let reply = ToHost::Reply(inm_protocol::Reply {
        id: u16::MAX,
        result: Ok(Answer::Identity(identity)),
    });
    let mut frame = [0; inm_protocol::MAX_FRAME];
    assert!(inm_protocol::encode(&reply, &mut frame).is_ok());
}

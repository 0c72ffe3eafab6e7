//! The instrument against the emulator under its strict rules: what arrives at the host is what
//! the converters made, bit for bit.

mod rig;

use inm_emulator::channel::published;
use inm_emulator::{Bench, Converter, Fault, ReadMode, Tear};
use inm_protocol::{Phase, Rate, Request, samples_load};
use rig::{OFFSETS, Rig, bench, inputs, settings};

#[test]
fn every_rate_and_filter_arrives_bit_for_bit() {
    for rate in Rate::ALL {
        for (phase, high_pass) in [
            (Phase::Linear, None),
            (Phase::Minimum, None),
            (Phase::Linear, Some(0x019B)),
        ] {
            let bench = bench(OFFSETS);
            let mut rig = Rig::new(&bench);
            rig.configure(settings(rate, phase, high_pass));
            rig.start();
            rig.run_until(10_000, "conversions", |rig| rig.batches.len() >= 40);
            let indices = rig.proven().into_iter().map(|conversion| conversion.index);
            // One batch in a second is cut short by the health record.
            let (expected, cut) = (40 * 32_usize, 32 * rig.health.len());
            assert!(indices.len() + cut > expected, "{}", indices.len());
            assert!(
                indices
                    .enumerate()
                    .all(|(place, index)| place as u64 == index)
            );
            assert!(rig.batches.iter().all(|batch| batch.flags.is_empty()));
            assert_eq!(rig.events, []);
            assert_eq!(bench.violation(), None);
        }
    }
}

#[test]
fn either_mode_after_reset_and_either_tearing_will_do() {
    for mode in [ReadMode::Continuous, ReadMode::Stopped] {
        for tear in [Tear::Splice, Tear::Reload] {
            let bench = Bench::new(
                inputs(OFFSETS)
                    .map(|input| Converter::new(input).mode_after_reset(mode).tearing(tear)),
            );
            let mut rig = Rig::new(&bench);
            rig.start();
            rig.run_ms(500);
            assert!(rig.proven().len() > 700);
            assert_eq!(rig.events, []);
        }
    }
}

#[test]
fn registers_are_read_back_while_streaming_without_a_word_lost() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::new(&bench);
    rig.configure(settings(Rate::Sps4000, Phase::Linear, None));
    rig.start();
    rig.run_ms(1500);
    let health = rig.fresh_health();
    for axis in 0..3 {
        let registers = bench.registers(axis);
        let expected = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10].map(|k| registers.get(k).unwrap_or(0));
        assert_eq!(health.registers[axis], expected);
    }
    assert!(health.streaming);
    assert_eq!(health.lost_conversions, 0);
    assert_eq!(health.axes.map(|axis| axis.torn + axis.missed), [0; 3]);
    rig.proven();
}

#[test]
fn a_second_stream_starts_again_from_zero() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::new(&bench);
    for _ in 0..2 {
        rig.start();
        rig.run_ms(200);
        rig.ask(Request::Stop).expect("stop");
        let received = rig.proven();
        assert_eq!(received[0].index, 0);
        assert_eq!(rig.batches[0].seq, 0);
        // The last batch is sent as far as it is filled.
        assert!(received.len() > 350 && !received.len().is_multiple_of(32));
        rig.batches.clear();
        rig.run_ms(100);
        assert_eq!(rig.batches, []);
    }
}

/// Two minutes of the published sensors: nothing about their noise looks like trouble.
#[test]
fn noise_is_not_trouble() {
    for seed in [1, 2] {
        let bench = Bench::new([0, 1, 2].map(|axis| Converter::new(published(axis, seed))));
        let mut rig = Rig::new(&bench);
        rig.start();
        rig.run_ms(120_000);
        assert!(rig.proven().len() > 239_000);
        assert_eq!(rig.events, [], "seed {seed}");
        let flagged: usize = rig.batches.iter().map(|batch| batch.flags.len()).sum();
        assert_eq!(flagged, 0, "seed {seed}");
    }
}

/// The budget that the host is told, against a line that takes its time.
#[test]
fn the_line_carries_every_rate_at_its_speed() {
    for rate in Rate::ALL {
        let bench = bench(OFFSETS);
        let mut rig = Rig::with_baud(&bench, Some(921_600));
        let chosen = settings(rate, Phase::Linear, None);
        rig.configure(chosen);
        rig.start();
        rig.run_ms(500);
        let (bytes, begin_ps) = (rig.bytes, bench.now_ps());
        rig.run_ms(4000);
        let seconds = (bench.now_ps() - begin_ps) as f64 * 1e-12;
        let measured = (rig.bytes - bytes) as f64 / seconds;
        let load = samples_load(chosen, 921_600);
        assert!(
            measured <= f64::from(load.needed),
            "{measured} byte/s, said {load:?}"
        );
        assert!(load.fits());
        // Never more than two batches and a health record wait for the line.
        let waiting = rig.link().most_waiting();
        assert!(waiting < 1400, "{waiting} bytes at {rate:?}");
        rig.proven();
        assert_eq!(rig.fresh_health().link.frames_dropped, 0);
    }
}

/// A host that heard neither the stop nor the start has to know one stream from the other.
#[test]
fn batches_notices_and_health_say_which_start_they_belong_to() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::new(&bench);
    rig.run_ms(1500);
    assert!(
        rig.health.iter().all(|health| health.stream == 0),
        "at rest"
    );
    for stream in [700, 3] {
        rig.batches.clear();
        rig.events.clear();
        rig.health.clear();
        rig.send_as(stream, Request::Start);
        rig.run_ms(300);
        rig.inject(1, Fault::DrdyStops);
        rig.run_ms(1500);
        assert!(rig.batches.iter().all(|batch| batch.stream == stream));
        assert!(rig.events.iter().all(|event| event.stream == stream));
        let of =
            |health: &inm_protocol::Health| health.stream == stream * u16::from(health.streaming);
        assert!(rig.health.iter().all(of));
        assert!(rig.batches.len() > 60 && rig.events.len() > 1 && rig.health.len() > 1);
        rig.send_as(stream + 1, Request::Stop);
        rig.run_ms(100);
    }
}

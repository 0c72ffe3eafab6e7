//! A minute of three axes, bit for bit, and what it costs.

use std::time::Instant;

use inm_image_test::chip::Spent;
use inm_image_test::machine::{Machine, PS_PER_MS, PS_PER_S, Talk};
use inm_image_test::record::Expected;
use inm_protocol::{Answer, AxisCounters, Filter, Health, Rate, Request, Settings, ToHost};

/// Board time of a stream, seconds.
const DURATION_S: u64 = 60;

/// Cycles of the core in a second.
const CORE_HZ: f64 = 168e6;

/// What came of a stream.
struct Stream {
    expected: Expected,
    received: u64,
    health: Option<Health>,
}

impl Stream {
    fn take(&mut self, message: ToHost) {
        match message {
            ToHost::Samples(batch) => {
                assert_eq!(batch.first, self.received, "no gap in the index");
                assert_eq!(batch.flags, [], "no word is flagged");
                for codes in &batch.codes {
                    let words = codes.map(|code| code.0);
                    let index = self.received;
                    assert_eq!(words, self.expected.next_words(), "conversion {index}");
                    self.received += 1;
                }
            }
            ToHost::Health(health) => self.health = Some(health),
            other => panic!("on a sound board: {other:?}"),
        }
    }
}

/// Streams at `rate`, whose `config0` is register 01h, and compares every word.
fn stream(rate: Rate, config0: u8) {
    let begin = Instant::now();
    let mut machine = Machine::started(true);
    let mut talk = Talk::default();
    let settings = Settings {
        rate,
        filter: Filter::default(),
    };
    for request in [Request::Configure(settings), Request::Start] {
        let answer = talk.ask(&mut machine, request);
        assert_eq!(answer, Ok(Answer::Settings(settings)), "{request:?}");
    }
    talk.heard.clear();
    let mut stream = Stream {
        expected: Expected::new(config0),
        received: 0,
        health: None,
    };
    machine.chip_mut().spent = Spent::default();
    let mut late_ps = 0;
    for _ in 0..DURATION_S * 10 {
        machine.run(100 * PS_PER_MS);
        let period_ps = PS_PER_S / u64::from(rate.hz());
        late_ps = late_ps.max(latest_ps(&mut machine, period_ps));
        talk.listen(&mut machine);
        talk.heard
            .drain(..)
            .for_each(|message| stream.take(message));
    }
    // What has not been sent yet is a batch, and what the start took of the first second.
    let most = DURATION_S * u64::from(rate.hz());
    assert!(
        (most - 64..=most).contains(&stream.received),
        "{}",
        stream.received
    );
    assert_eq!(talk.damaged, 0);
    let health = stream.health.expect("a health record each second");
    assert_sound(&health);
    assert_eq!(machine.chip().board.bench.violation(), None);
    assert!(machine.chip().misuse.is_empty());
    tell(rate, stream.received, machine.chip().spent);
    println!(
        "X is read {} us behind its edge at most; in {:.1} s",
        late_ps / 1_000_000,
        begin.elapsed().as_secs_f64()
    );
}

/// Longest from an edge of X to the reading of its word, picoseconds: four bytes on end, which those of a
/// command never are. The bytes are used up.
fn latest_ps(machine: &mut Machine, period_ps: u64) -> u64 {
    let board = &mut machine.chip_mut().board;
    let edge_ps = board.bench.last_edge_ps(0).expect("it streams");
    let bytes = board.bytes.replace(Vec::new()).unwrap_or_default();
    let of_x: Vec<_> = bytes.iter().filter(|byte| byte.axis == 0).collect();
    let words = of_x.windows(4).filter(|word| {
        word.windows(2)
            .all(|pair| pair[0].gap_ps(pair[1]) < 4 * pair[0].bit_ps)
    });
    let late = words.map(|word| (word[0].begin_ps + period_ps - edge_ps % period_ps) % period_ps);
    late.max().unwrap_or(0)
}

/// Nothing went wrong on the board.
fn assert_sound(health: &Health) {
    for axis in health.axes {
        // Each start resets the converters on purpose.
        let resets = axis.resets;
        let sound = AxisCounters {
            resets,
            ..AxisCounters::default()
        };
        assert_eq!(axis, sound);
    }
    assert_eq!(health.lost_conversions, 0);
    assert_eq!(health.link.frames_dropped, 0);
    assert!(health.stack_used > 0, "the stack is measured");
    assert!(health.stack_used < health.stack_size / 2, "{health:?}");
}

/// The load, and that some of the core's time is left.
fn tell(rate: Rate, conversions: u64, spent: Spent) {
    let all_ps = (DURATION_S * PS_PER_S) as f64;
    let share = |ps: u64| ps as f64 / all_ps;
    let (asleep, waiting) = (share(spent.asleep_ps), share(spent.waiting_ps));
    let each = |instructions: u64| instructions as f64 / conversions as f64;
    let per_second = spent.instructions as f64 / DURATION_S as f64;
    // As many cycles an instruction as would leave no sleep at all.
    let bearable = (1.0 - waiting) * CORE_HZ / per_second;
    println!(
        "{}/s: {conversions} conversions equal bit for bit; {:.0} instructions each, {:.0} of them in \
         handlers; {:.1} % asleep, {:.1} % waiting for a bus; all of it fits up to {bearable:.1} cycles \
         an instruction",
        rate.hz(),
        each(spent.instructions),
        each(spent.in_handlers),
        100.0 * asleep,
        100.0 * waiting,
    );
    assert!(asleep > 0.1, "a tenth of the time is in reserve: {asleep}");
}

#[test]
fn a_minute_at_2000_a_second_arrives_bit_for_bit() {
    stream(Rate::Sps2000, 0x5a);
}

#[test]
fn a_minute_at_4000_a_second_arrives_bit_for_bit() {
    stream(Rate::Sps4000, 0x62);
}

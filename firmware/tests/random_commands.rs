//! Any command at any moment, garbage between them, and faults: each command is answered once, the
//! converter's rules are kept, and what streams is right.

mod rig;

use inm_emulator::{Fault, Slip};
use inm_protocol::{Answer, Filter, Phase, Rate, Refusal, Request, Settings};
use rig::{Noisy, OFFSETS, Rig, bench, settings};

/// Commands of a run.
const COMMANDS: u32 = 40;

/// Longest time that a command takes: three attempts of a start at 250/s, each with a rest of 66
/// periods and two settlings, and calibrations or a self-test of as many words.
const LONGEST_MS: u64 = 5000;

/// Linear congruential generator of Knuth, upper half.
struct Dice(u64);

impl Dice {
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % n
    }
}

fn any_settings(dice: &mut Dice) -> Settings {
    let rate = Rate::ALL[dice.below(5) as usize];
    let phase = [Phase::Linear, Phase::Minimum][dice.below(2) as usize];
    match dice.below(6) {
        0 => Settings {
            rate,
            filter: Filter::Sinc,
        },
        1 => Settings {
            rate,
            filter: Filter::Modulator,
        },
        2 => settings(rate, phase, Some(0x19A)),
        _ => settings(rate, phase, None),
    }
}

fn any_request(dice: &mut Dice) -> Request {
    match dice.below(12) {
        0 => Request::Identify,
        1..=3 => Request::Start,
        4 | 5 => Request::Stop,
        6 => Request::Configure(any_settings(dice)),
        7 => Request::CalibrateOffset,
        8 => Request::CalibrateGain,
        9 => Request::SelfTest,
        10 => Request::ReadRegisters,
        _ => Request::RestartBins,
    }
}

fn any_fault(dice: &mut Dice) -> Fault {
    let conversions = None;
    match dice.below(6) {
        0 => Fault::DrdyStops,
        1 => Fault::Slip(Slip::Early),
        2 => Fault::Slip(Slip::Late),
        3 => Fault::BrownOut,
        4 => Fault::BusError,
        _ => Fault::BusStuck {
            high: dice.below(2) == 0,
            conversions,
        },
    }
}

/// Whether the answer is of the kind that the request has.
fn fits(request: Request, result: &Result<Answer, Refusal>) -> bool {
    match (request, result) {
        (Request::Identify, Ok(Answer::Identity(_)))
        | (Request::Start, Ok(Answer::Settings(_)))
        | (Request::Stop, Ok(Answer::Done))
        | (Request::CalibrateOffset | Request::CalibrateGain, Ok(Answer::Calibration(_)))
        | (Request::SelfTest, Ok(Answer::SelfTest(_)))
        | (Request::ReadRegisters, Ok(Answer::Registers(_)))
        | (Request::RestartBins, Ok(Answer::BinsEpoch { .. })) => true,
        (Request::Configure(asked), Ok(Answer::Settings(got))) => asked == *got,
        (Request::Configure(_), Err(refusal)) => !matches!(refusal, Refusal::Converter { .. }),
        (Request::Identify | Request::Stop | Request::RestartBins, Err(_)) => false,
        (_, Err(refusal)) => matches!(refusal, Refusal::Streaming | Refusal::Converter { .. }),
        _ => false,
    }
}

/// Sends commands at random moments; those that were sent, with their numbers.
fn talk(rig: &mut Rig<'_, Noisy>, dice: &mut Dice, faults: bool) -> Vec<(u16, Request)> {
    let mut sent = Vec::new();
    for _ in 0..COMMANDS {
        for _ in 0..dice.below(400) {
            rig.step();
        }
        if dice.below(4) == 0 {
            // Damaged frames, an end of one among them.
            let garbage: Vec<u8> = (0..dice.below(60)).map(|_| dice.below(256) as u8).collect();
            rig.link().send(&garbage);
            rig.link().send(&[0]);
        }
        if faults && dice.below(3) == 0 {
            rig.inject(dice.below(3) as usize, any_fault(dice));
        }
        let request = any_request(dice);
        sent.push((rig.send(request), request));
        // Often the next comes before the answer; the receive queue holds some.
        while sent.len() > rig.replies.len() + 3 {
            rig.step();
        }
    }
    rig.run_until(4 * LONGEST_MS, "replies", |rig| {
        rig.replies.len() >= sent.len()
    });
    rig.run_ms(50);
    sent
}

fn runs(seeds: std::ops::Range<u64>, faults: bool) {
    let mut streamed = 0;
    for seed in seeds {
        let bench = bench(OFFSETS);
        let mut rig = Rig::new(&bench);
        let mut dice = Dice(seed);
        let sent = talk(&mut rig, &mut dice, faults);
        let answered: Vec<u16> = rig.replies.iter().map(|&(id, _)| id).collect();
        let asked: Vec<u16> = sent.iter().map(|&(id, _)| id).collect();
        assert_eq!(answered, asked, "seed {seed}: each once, in order");
        for ((_, request), (_, result)) in sent.iter().zip(&rig.replies) {
            assert!(
                fits(*request, result),
                "seed {seed}: {request:?}, {result:?}"
            );
        }
        assert_eq!(rig.bench.violation(), None, "seed {seed}");
        streamed += rig.batches.len();

        // Whatever was before, it can be stopped, set and started, and is right.
        rig.ask(Request::Stop).expect("it stops");
        rig.configure(Settings::default());
        rig.start();
        rig.batches.clear();
        rig.events.clear();
        rig.run_ms(400);
        let received = rig.proven();
        let good = received.iter().all(|c| c.flags.iter().all(|f| f.is_none()));
        assert!(
            good && rig.events.is_empty(),
            "seed {seed}: {:?}",
            rig.events
        );
        assert!(received.len() > 200, "seed {seed}: {}", received.len());
    }
    assert!(
        streamed > 100,
        "{streamed} batches: it did stream in between"
    );
}

#[test]
fn any_command_at_any_moment_is_answered_once() {
    runs(0..60, false);
}

#[test]
fn any_command_at_any_moment_is_answered_once_among_faults() {
    runs(1000..1060, true);
}

//! An instrument on the emulator's bench, the host's end of its link, and the proof that what
//! arrives there is what the converters made.

#![allow(dead_code)] // each test file uses its part

use std::cell::Cell;
use std::collections::HashMap;
use std::rc::Rc;

use inm_allan::BoardBins;
use inm_emulator::{Bench, Converter, Fault, Signal};
use inm_firmware::Instrument;
use inm_firmware::emulated::{VirtualBoard, VirtualLink, describe};
use inm_protocol::{
    Answer, Batch, BinsMark, Code, Command, Decoder, Event, Flags, Health, Hello, MAX_FRAME, Phase,
    Pulse, Rate, Refusal, Request, Settings, ToBoard, ToHost, Trouble, UNPROVEN_PERIODS, encode,
};

/// An input with an offset and uniform noise, in steps of the 31-bit value.
#[derive(Debug, Clone)]
pub struct Noisy {
    pub offset: i32,
    /// Added while the self-test pin is high.
    pub step: i32,
    pub self_test: Rc<Cell<bool>>,
    /// Half the width of the noise.
    pub amplitude: i32,
    pub state: u64,
}

impl Signal for Noisy {
    fn set_rate(&mut self, _input_hz: u32) {}

    fn next(&mut self) -> i32 {
        // Linear congruential generator of Knuth, upper half.
        self.state = self
            .state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let span = 2 * i64::from(self.amplitude) + 1;
        let uniform = ((self.state >> 32) as i64 * span) >> 32;
        let noise = (uniform - i64::from(self.amplitude)) as i32;
        let step = if self.self_test.get() { self.step } else { 0 };
        self.offset + step + noise
    }
}

/// 1 g on Z, zero-g errors on X and Y, on the 4 g range (1 g is 1.32e8 steps): no axis around
/// zero.
pub const OFFSETS: [i32; 3] = [21_000_000, -34_000_000, 132_000_000];

/// Inputs with these offsets; behind the filter the noise is 6 mg or so.
pub fn inputs(offsets: [i32; 3]) -> [Noisy; 3] {
    let mut state = 0;
    offsets.map(|offset| {
        state += 0x5EED;
        Noisy {
            offset,
            step: 0,
            self_test: Rc::default(),
            amplitude: 9_000_000,
            state,
        }
    })
}

pub fn bench(offsets: [i32; 3]) -> Bench<Noisy> {
    Bench::new(inputs(offsets).map(Converter::new))
}

pub const QUEUE: usize = 8192;
pub type Link = VirtualLink<QUEUE>;
pub type Virtual<'b, S> = VirtualBoard<'b, S, Link>;

/// One conversion as it arrived.
#[derive(Debug, Clone, Copy)]
pub struct Received {
    pub index: u64,
    pub stamp: u64,
    pub codes: [Code; 3],
    pub flags: [Flags; 3],
}

pub struct Rig<'b, S: Signal> {
    pub bench: &'b Bench<S>,
    pub instrument: Instrument<Virtual<'b, S>>,
    decoder: Decoder,
    /// What the host takes from the link.
    pub listening: bool,
    pub batches: Vec<Batch>,
    pub events: Vec<Event>,
    pub health: Vec<Health>,
    pub pulses: Vec<Pulse>,
    pub replies: Vec<(u16, Result<Answer, Refusal>)>,
    pub bytes: u64,
    /// Words of the converters by axis and the stamp of its edge.
    made: HashMap<(usize, u64), u32>,
    noted_ps: [Option<u64>; 3],
    next_id: u16,
    period_ticks: u64,
    /// The board's self-test pin, as the inputs see it.
    pub self_test: Rc<Cell<bool>>,
}

impl<'b, S: Signal> Rig<'b, S> {
    /// A board whose link is as fast as it needs to be.
    pub fn new(bench: &'b Bench<S>) -> Self {
        Self::with_baud(bench, None)
    }

    pub fn with_baud(bench: &'b Bench<S>, baud: Option<u32>) -> Self {
        Self {
            bench,
            instrument: VirtualBoard::instrument(bench, Link::new(baud), describe("virtual")),
            decoder: Decoder::new(),
            listening: true,
            batches: Vec::new(),
            events: Vec::new(),
            health: Vec::new(),
            pulses: Vec::new(),
            replies: Vec::new(),
            bytes: 0,
            made: HashMap::new(),
            noted_ps: [None; 3],
            next_id: 100,
            period_ticks: 500,
            self_test: Rc::default(),
        }
    }

    pub fn link(&mut self) -> &mut Link {
        self.instrument.platform_mut().environment_mut()
    }

    /// One step of the board, and what the host sees of it.
    pub fn step(&mut self) {
        self.instrument.step();
        for axis in 0..3 {
            self.note_words(axis);
        }
        let self_test = self.link().self_test_is_on();
        self.self_test.set(self_test);
        if !self.listening {
            return;
        }
        let now_ps = self.bench.now_ps();
        let mut arrived = Vec::new();
        self.link().take(now_ps, |byte| arrived.push(byte));
        self.bytes += arrived.len() as u64;
        let mut input = &arrived[..];
        while let Some(message) = self.decoder.next(&mut input) {
            match message.expect("the link is clean") {
                ToHost::Samples(batch) => self.batches.push(batch),
                ToHost::Event(event) => self.events.push(event),
                ToHost::Health(health) => self.health.push(health),
                ToHost::Reply(reply) => self.replies.push((reply.id, reply.result)),
                ToHost::Pulse(pulse) => self.pulses.push(pulse),
                ToHost::Note(note) => panic!("a board sends no notes: {note:?}"),
            }
        }
    }

    /// The words behind the latest edge of an axis, as its converter made them.
    fn note_words(&mut self, axis: usize) {
        let edge_ps = self.bench.last_edge_ps(axis);
        if edge_ps == self.noted_ps[axis] {
            return;
        }
        let noted_ps = std::mem::replace(&mut self.noted_ps[axis], edge_ps);
        let word = |age: u64| {
            let made = self.bench.sent(axis).words();
            made.checked_sub(age)
                .and_then(|index| self.bench.word(axis, index))
                .unwrap_or(0)
        };
        let Some(edge_ps) = edge_ps else {
            // SYNC at the end of a step in which a conversion was read.
            if let Some(noted_ps) = noted_ps {
                let stamp = noted_ps / 1_000_000 + self.period_ticks;
                self.made.insert((axis, stamp), word(1));
            }
            return;
        };
        let stamp = edge_ps / 1_000_000;
        // More edges may have fallen in one step.
        let periods = noted_ps.map_or(1, |noted_ps| {
            (edge_ps - noted_ps) / 1_000_000 / self.period_ticks
        });
        for before in 1..periods.min(8) {
            let stamp = stamp - before * self.period_ticks;
            self.made.insert((axis, stamp), word(1 + before));
        }
        self.made.insert((axis, stamp), word(1));
    }

    /// The word that an axis made at a conversion.
    #[track_caller]
    fn made_at(&self, axis: usize, conversion: &Received) -> u32 {
        *self
            .made
            .get(&(axis, conversion.stamp))
            .unwrap_or_else(|| panic!("axis {axis}: no edge at the stamp of {conversion:?}"))
    }

    pub fn run_ms(&mut self, ms: u64) {
        let end_ps = self.bench.now_ps() + ms * 1_000_000_000;
        while self.bench.now_ps() < end_ps {
            self.step();
        }
    }

    /// Steps until `done`, for at most `ms` of board time.
    #[track_caller]
    pub fn run_until(&mut self, ms: u64, what: &str, done: impl Fn(&Self) -> bool) {
        let end_ps = self.bench.now_ps() + ms * 1_000_000_000;
        while !done(self) {
            assert!(
                self.bench.now_ps() < end_ps,
                "{what}: not within {ms} ms; events {:?}",
                self.events
            );
            self.step();
        }
    }

    /// Sends a request and waits for its one answer.
    #[track_caller]
    pub fn ask(&mut self, request: Request) -> Result<Answer, Refusal> {
        let id = self.send(request);
        self.run_until(5000, "reply", |rig| {
            rig.replies.iter().any(|&(reply, _)| reply == id)
        });
        let mut answers = self.replies.iter().filter(|&&(reply, _)| reply == id);
        let (_, result) = answers.next().expect("awaited above").clone();
        assert_eq!(answers.next(), None, "one answer to each request");
        result
    }

    pub fn send(&mut self, request: Request) -> u16 {
        self.next_id += 1;
        let id = self.next_id;
        self.send_as(id, request);
        id
    }

    /// Sends a request as the command of this number.
    pub fn send_as(&mut self, id: u16, request: Request) {
        let mut frame = [0; MAX_FRAME];
        let command = ToBoard::Command(Command { id, request });
        let len = encode(&command, &mut frame).expect("a command fits");
        self.link().send(&frame[..len]);
    }

    /// The last hello of the board.
    pub fn hello(&self) -> Option<&Hello> {
        self.decoder.hello()
    }

    #[track_caller]
    pub fn configure(&mut self, settings: Settings) {
        let answer = self.ask(Request::Configure(settings));
        assert_eq!(answer, Ok(Answer::Settings(settings)));
        self.period_ticks = 1_000_000 / u64::from(settings.rate.hz());
    }

    #[track_caller]
    pub fn start(&mut self) {
        let answer = self.ask(Request::Start);
        assert!(matches!(answer, Ok(Answer::Settings(_))), "{answer:?}");
    }

    /// Conversions received so far, in order.
    pub fn received(&self) -> Vec<Received> {
        let mut all = Vec::new();
        for batch in &self.batches {
            for (k, &codes) in (0_u64..).zip(&batch.codes) {
                let mut flags = [Flags::NONE; 3];
                for flag in batch
                    .flags
                    .iter()
                    .filter(|flag| u64::from(flag.conversion) == k)
                {
                    flags[usize::from(flag.axis)] = flag.flags;
                }
                all.push(Received {
                    index: batch.first + k,
                    stamp: batch.stamp + k * self.period_ticks,
                    codes,
                    flags,
                });
            }
        }
        all
    }

    /// Asserts that every word that is not flagged is the one that its converter made at that
    /// moment, and that batches and indices are in order. Returns the conversions.
    #[track_caller]
    pub fn proven(&self) -> Vec<Received> {
        self.proven_but(|_, _| false)
    }

    /// As [`Self::proven`], but for the conversions and axes that are `excused`.
    #[track_caller]
    pub fn proven_but(&self, excused: impl Fn(u64, usize) -> bool) -> Vec<Received> {
        for pair in self.batches.windows(2) {
            let [before, after] = pair else { continue };
            assert_eq!(after.seq, before.seq + 1);
            assert!(after.first >= before.end());
        }
        let received = self.received();
        for conversion in &received {
            for axis in 0..3 {
                let flags = conversion.flags[axis];
                let told = flags.is_none() || flags == Flags::OVER_RANGE;
                if told && !excused(conversion.index, axis) {
                    let made = self.made_at(axis, conversion);
                    assert_eq!(
                        conversion.codes[axis].0 as u32, made,
                        "axis {axis} of {conversion:x?}, made {made:x}"
                    );
                }
            }
        }
        received
    }

    /// The words without flags that are not their converter's, and that no notice of a reset of
    /// their axis excludes either: index and axis.
    pub fn wrong_and_not_told(&self) -> Vec<(u64, usize)> {
        let told = |index: u64, axis: usize| {
            self.events.iter().any(|event| {
                event.axis == Some(axis as u8)
                    && event.trouble.is_reset_for()
                    && (event.index.saturating_sub(UNPROVEN_PERIODS)..event.index).contains(&index)
            })
        };
        let mut wrong = Vec::new();
        for conversion in &self.received() {
            for axis in 0..3 {
                let flags = conversion.flags[axis];
                let good = flags.is_none() || flags == Flags::OVER_RANGE;
                if good && !told(conversion.index, axis) {
                    let made = self.made.get(&(axis, conversion.stamp)).copied();
                    if made != Some(conversion.codes[axis].0 as u32) {
                        wrong.push((conversion.index, axis));
                    }
                }
            }
        }
        wrong
    }

    /// Asserts that every mark of the bins in the health records is what the converters' own
    /// words make, with a gap for each flag and each missing conversion. Returns the marks.
    #[track_caller]
    pub fn marks_proven(&self) -> Vec<BinsMark> {
        let received = self.received();
        let marks: Vec<BinsMark> = self
            .health
            .iter()
            .filter_map(|health| health.bins)
            .collect();
        for mark in &marks {
            let within = received
                .iter()
                .filter(|conversion| (mark.epoch..mark.index).contains(&conversion.index));
            let mut bins = [0, 1, 2].map(|_| BoardBins::starting_at(mark.epoch));
            for conversion in within {
                for axis in 0..3 {
                    let bins = &mut bins[axis];
                    bins.skip(conversion.index - bins.next_index());
                    if conversion.flags[axis].is_none() {
                        bins.push(self.made_at(axis, conversion) as i32);
                    } else {
                        bins.skip(1);
                    }
                }
            }
            let digests = bins.each_ref().map(BoardBins::digest);
            assert_eq!(digests, mark.digests, "to conversion {}", mark.index);
            assert!(bins.iter().all(|bins| bins.next_index() == mark.index));
        }
        marks
    }

    /// Troubles told about `axis`, in order.
    pub fn troubles(&self, axis: u8) -> Vec<Trouble> {
        self.events
            .iter()
            .filter(|event| event.axis == Some(axis))
            .map(|event| event.trouble)
            .collect()
    }

    pub fn recoveries(&self) -> usize {
        self.events
            .iter()
            .filter(|event| matches!(event.trouble, Trouble::Recovered { .. }))
            .count()
    }

    /// A fresh health record.
    pub fn fresh_health(&mut self) -> Health {
        let seen = self.health.len();
        self.run_until(2100, "health", |rig| rig.health.len() > seen);
        self.health[seen]
    }

    pub fn inject(&self, axis: usize, fault: Fault) {
        self.bench.inject(axis, fault);
    }
}

pub fn settings(rate: Rate, phase: Phase, high_pass: Option<u16>) -> Settings {
    Settings {
        rate,
        filter: inm_protocol::Filter::Fir { phase, high_pass },
    }
}

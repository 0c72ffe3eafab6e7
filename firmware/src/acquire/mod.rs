//! The instrument: three converters to batches, health and events; commands to replies.
//!
//! ```text
//!   DRDY stamp --> stream --> axis (flags, trouble) --> batch --> outbox --> link
//!                    |          |                                   ^
//!                    |          +--> recover: rest, RESET, SYNC     | events, replies, health
//!   link --> host (commands) --> job (start, calibrate, self-test) -+
//! ```
//!
//! All of it runs in one loop, by [`Instrument::step`]; nothing waits. What takes time is a
//! stage with a deadline on the board's timer. X's DRDY, or while X is away that of the next
//! axis, drives the reading of all three, which convert together after a common SYNC. Conversions are numbered by the time
//! between the stamps: whatever makes the board late shows as a gap in the index.

mod axis;
mod batch;
mod clock;
mod health;
mod host;
mod job;
mod outbox;
mod prove;
mod pulse;
mod read_back;
mod recover;
mod self_test;
mod settle;
mod stream;

use ads1281::calibrate::Calibration;
use ads1281::config::Config;
use ads1281::register::Address;
use ads1281::{Ads1281, POWER_UP_US};
use inm_protocol::{AXES, BinsMark, Decoder, REGISTERS, Settings};

use crate::log::Logged;
use crate::{Board, Platform};

use axis::Axis;
use batch::Batcher;
use clock::Clock;
use job::Job;
use outbox::Outbox;
use pulse::Pulses;
use read_back::Rounds;
use self_test::SelfTest;
use stream::Position;

/// Driver of one converter on platform `P`.
pub type Converter<P> =
    Ads1281<<P as Platform>::Spi, <P as Platform>::Drdy, <P as Platform>::Delay>;

/// Longest frame that the host sends: the longest command, a calibration to be kept, takes up to 125
/// bytes.
const COMMAND_FRAME: usize = 128;

/// What the instrument is doing. `until` and the like are ticks of the board's timer.
#[derive(Debug, Clone, Copy)]
enum Stage {
    /// The converters are coming up.
    PowerUp { until: u64 },
    /// RESET was sent at the start of the board; the IDs come next.
    Identify { until: u64 },
    /// Nothing; commands are welcome.
    Idle,
    /// A converter did not do as told: no clocks until the next attempt.
    Rest { until: u64, job: Job },
    /// RESET was sent to all converters.
    Reset { until: u64, job: Job },
    /// The filters fill after a common SYNC; for a job, or to go on streaming. In time before they
    /// are full the converters are `looked` at.
    Settle {
        since: u64,
        job: Option<Job>,
        looked: bool,
    },
    /// Streaming.
    Stream,
    /// OFSCAL or GANCAL was sent.
    Calibrate {
        until: u64,
        job: Job,
        done: [bool; AXES],
    },
    /// Averaging the self-test.
    SelfTest(SelfTest),
    /// The reply to [`Request::Reset`](inm_protocol::Request::Reset) is leaving, or what is left of a stream
    /// that ended because the `loader` was asked for.
    Restart { until: u64, loader: bool },
    /// The board should have restarted.
    Halted,
}

/// The whole board above its [`Platform`].
pub struct Instrument<P: Platform> {
    platform: P,
    converters: [Converter<P>; AXES],
    sync: P::Sync,
    board: Board,
    clock: Clock,
    settings: Settings,
    calibration: [Calibration; AXES],
    /// What is written to the converters, by axis.
    configs: [Config; AXES],
    /// ID registers as found at power-on or, since then, when a configuration was verified.
    ids: [Option<u8>; AXES],
    /// CONFIG1, which is reserved and never written, as found with the identity.
    reserved: [u8; AXES],
    /// All registers as last read back.
    registers: [[u8; REGISTERS]; AXES],
    stage: Stage,
    axes: [Axis; AXES],
    position: Position,
    rounds: Rounds,
    /// The axis whose DRDY drives the reading: the first that runs.
    trigger: usize,
    /// Timer when it was chosen, ticks.
    trigger_since: u64,
    /// The next conversion is the first after SYNC: all axes have to be there.
    fresh: bool,
    /// The axes whose recovery brought the common SYNC on.
    recovering: [bool; AXES],
    lost_conversions: u64,
    batcher: Batcher,
    outbox: Outbox,
    decoder: Decoder<COMMAND_FRAME>,
    /// A host has been understood.
    proved: bool,
    /// Timer of the next health record, ticks.
    next_health: u64,
    /// The bins as the record on its way will tell of them. Nothing of the stream is sent
    /// between the two.
    mark: Option<BinsMark>,
    pulses: Pulses,
    logged: Logged,
}

impl<P: Platform> Instrument<P> {
    /// Takes the machine, the converters X, Y, Z and the SYNC pin. Nothing is sent yet.
    pub fn new(platform: P, converters: [Converter<P>; AXES], sync: P::Sync) -> Self {
        let board = platform.board();
        let settings = Settings::default();
        let clock = Clock::new(&board, settings);
        let now = platform.now();
        let power_up = now + clock.micros(POWER_UP_US);
        Self {
            platform,
            converters,
            sync,
            board,
            clock,
            settings,
            calibration: [Calibration::default(); AXES],
            configs: [Config::default(); AXES],
            ids: [None; AXES],
            reserved: [0; AXES],
            registers: [[0; REGISTERS]; AXES],
            stage: Stage::PowerUp { until: power_up },
            axes: core::array::from_fn(|_| Axis::new()),
            position: Position::default(),
            rounds: Rounds::default(),
            trigger: 0,
            trigger_since: power_up,
            fresh: false,
            recovering: [false; AXES],
            lost_conversions: 0,
            batcher: Batcher::default(),
            outbox: Outbox::new(),
            decoder: Decoder::with_capacity(),
            proved: false,
            next_health: power_up,
            mark: None,
            pulses: Pulses::default(),
            logged: Logged::default(),
        }
    }

    /// Does what there is to do and returns: `true` when something was done, `false` when the
    /// caller may sleep until the next interrupt.
    ///
    /// Takes about 100 us when a conversion is read and 2 ms when the converters are
    /// configured; never waits for anything.
    pub fn step(&mut self) -> bool {
        if matches!(self.stage, Stage::Halted) {
            return false;
        }
        self.platform.feed_watchdog();
        let edge = self.platform.take_edge_stamp();
        let now = self.platform.now();
        let mut busy = edge.is_some();
        busy |= self.advance(edge, now);
        busy |= self.serve_host(now);
        busy |= self.outbox.flush(&mut self.platform);
        busy |= self.serve_pulse(edge.is_some());
        if now >= self.next_health {
            busy |= self.report_health(edge.is_some(), now);
        }
        busy
    }

    /// The machine.
    pub fn platform(&self) -> &P {
        &self.platform
    }

    /// The machine, to drive it from outside.
    pub fn platform_mut(&mut self) -> &mut P {
        &mut self.platform
    }

    /// Whether samples are being sent, or will be again after a recovery.
    pub fn is_streaming(&self) -> bool {
        matches!(self.stage, Stage::Stream | Stage::Settle { job: None, .. })
    }

    /// Gives everything back.
    pub fn release(self) -> (P, [Converter<P>; AXES], P::Sync) {
        (self.platform, self.converters, self.sync)
    }

    /// Takes the stage as far as the time allows; `true` if it moved.
    fn advance(&mut self, edge: Option<u64>, now: u64) -> bool {
        match self.stage {
            Stage::Stream => {
                if let Some(stamp) = edge {
                    self.conversion(stamp);
                }
                self.watch_trigger(now) | self.recover(now)
            }
            Stage::Settle { since, job, looked } => self.settle(edge, now, since, job, looked),
            Stage::Idle | Stage::Halted => false,
            Stage::SelfTest(test) => self.self_test(test, edge, now),
            Stage::Calibrate { until, job, done } => self.await_calibration(now, until, job, done),
            Stage::PowerUp { until }
            | Stage::Identify { until }
            | Stage::Rest { until, .. }
            | Stage::Reset { until, .. }
                if now < until =>
            {
                false
            }
            Stage::PowerUp { .. } => self.reset_for_identity(now),
            Stage::Identify { .. } => self.identify_converters(),
            Stage::Rest { job, .. } => self.reset_all(job, now),
            Stage::Reset { job, .. } => self.configure_all(job, now),
            Stage::Restart { until, loader } => self.restart(now, until, loader),
        }
    }

    /// Commands other than those that are answered at once have to wait.
    fn is_occupied(&self) -> bool {
        !(matches!(self.stage, Stage::Idle) || self.is_streaming())
    }

    fn reset_for_identity(&mut self, now: u64) -> bool {
        self.send_reset_to_all();
        self.stage = Stage::Identify {
            until: now + self.clock.micros(ads1281::RESET_US),
        };
        true
    }

    fn identify_converters(&mut self) -> bool {
        for axis in 0..AXES {
            let found = self.identify(axis);
            self.ids[axis] = found
                .is_ok()
                .then_some(self.registers[axis][Address::Id.index()]);
        }
        self.stage = Stage::Idle;
        true
    }

    fn restart(&mut self, now: u64, until: u64, loader: bool) -> bool {
        let gone = !self.outbox.reply_waits() && self.platform.transmit_idle();
        if gone || now >= until {
            self.stage = Stage::Halted;
            match loader {
                true => self.platform.enter_loader(),
                false => self.platform.restart(),
            }
        }
        gone
    }
}

/// How long a restart waits for what has to be told before it, microseconds.
const RESTART_US: u32 = 200_000;

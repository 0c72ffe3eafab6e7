//! Commands of the host, each carried out once and answered, one after the other. One that comes
//! again, because its reply was lost, is answered again.

use ads1281::CLOCK_HZ;
use heapless::String;
use inm_protocol::{
    AXES, Answer, Command, Fault, Hello, Identity, REGISTERS, Refusal, Reply, Request,
    SensorCalibration, SensorRange, Settings, ToBoard, VERSION, samples_load,
};

use super::clock::{Clock, readable_hz};
use super::job::{Kind, Task};
use super::{Instrument, RESTART_US, Stage};
use crate::Platform;
use crate::converters::{conversions_hz, trouble};
use crate::keep::Kept;

/// Bytes taken from the link in one step.
const BYTES_A_STEP: u32 = 64;

impl<P: Platform> Instrument<P> {
    /// Takes bytes from the link up to the end of one command; `true` if there were any.
    ///
    /// While a command is carried out or its reply waits for room, the next one waits in the
    /// receive queue.
    pub(super) fn serve_host(&mut self, now: u64) -> bool {
        let mut busy = false;
        for _ in 0..BYTES_A_STEP {
            if self.is_occupied() || self.outbox.reply_waits() {
                break;
            }
            let Some(byte) = self.platform.receive() else {
                break;
            };
            busy = true;
            // Faults are counted by the decoder and shown in the health record.
            let met = self.decoder.next(&mut &[byte][..]);
            if matches!(met, Some(Ok(_) | Err(Fault::Version { .. }))) {
                self.understand();
            }
            match met {
                Some(Ok(ToBoard::Command(command))) => self.carry_out(command, now),
                Some(Err(_)) if self.decoder.asks_for_loader() => self.leave(now, true),
                // Whoever asks: what it asked is not understood.
                Some(Err(Fault::Version { .. })) => self.outbox.greet(self.hello()),
                Some(Err(_)) | None => {}
            }
        }
        busy
    }

    /// Ends a stream and restarts, into the loader or the program.
    fn leave(&mut self, now: u64, loader: bool) {
        self.end_stream(now);
        let until = now + self.clock.micros(RESTART_US);
        self.stage = Stage::Restart { until, loader };
    }

    /// An intact frame has come, of whatever version: there is a host, and the line from it is sound.
    fn understand(&mut self) {
        if !self.proved {
            self.proved = true;
            self.platform.prove();
        }
    }

    fn carry_out(&mut self, command: Command, now: u64) {
        if command.request == Request::Identify {
            self.outbox.greet(self.hello());
        }
        if self.outbox.repeats(command) {
            return;
        }
        let Command { id, request } = command;
        let streaming = self.is_streaming();
        let result = match request {
            Request::Identify => Ok(Answer::Identity(self.identity())),
            Request::Stop => {
                self.end_stream(now);
                Ok(Answer::Done)
            }
            Request::Reset => {
                self.leave(now, false);
                Ok(Answer::Done)
            }
            Request::RestartBins => Ok(Answer::BinsEpoch {
                index: if streaming { self.restart_bins() } else { 0 },
            }),
            Request::Start
            | Request::Configure(_)
            | Request::CalibrateOffset
            | Request::CalibrateGain
            | Request::SelfTest
            | Request::SelectRange(_)
            | Request::WriteSensorCalibration(_)
            | Request::EraseSensorCalibration(_)
                if streaming =>
            {
                Err(Refusal::Streaming)
            }
            Request::Start => return self.begin_job(id, Task::Start, now),
            Request::CalibrateOffset => {
                return self.begin_job(id, Task::Calibrate(Kind::Offset), now);
            }
            Request::CalibrateGain => return self.begin_job(id, Task::Calibrate(Kind::Gain), now),
            Request::SelfTest => return self.begin_job(id, Task::SelfTest, now),
            Request::Configure(settings) => self.configure(settings),
            // What the start wrote, and what has been read back since: a question to the converters
            // would cost their words.
            Request::ReadRegisters if streaming => Ok(Answer::Registers(self.registers)),
            Request::ReadRegisters => self.read_registers().map(Answer::Registers),
            Request::SelectRange(range) => Ok(self.select(range)),
            Request::ReadSensorCalibration(range) => Ok(self.kept(range)),
            Request::WriteSensorCalibration(found) if !found.is_sound() => Err(Refusal::Unsound),
            Request::WriteSensorCalibration(found) => self.keep(found.range, Some(found)),
            Request::EraseSensorCalibration(range) => self.keep(range, None),
        };
        self.outbox.reply(Reply { id, result });
    }

    fn select(&mut self, range: SensorRange) -> Answer {
        self.platform.select_range(range);
        self.board.range = range;
        Answer::Done
    }

    #[inline(never)]
    fn kept(&mut self, range: SensorRange) -> Answer {
        let kept = Kept::load(self.platform.sectors());
        Answer::SensorCalibration(kept.calibration(range))
    }

    /// Keeps a calibration, or none any more. The only thing that stops the board while it is
    /// done, up to seconds for an erase of its flash: nothing streams, and nobody else waits.
    #[inline(never)]
    fn keep(
        &mut self,
        range: SensorRange,
        calibration: Option<SensorCalibration>,
    ) -> Result<Answer, Refusal> {
        Kept::replace(self.platform.sectors(), range, calibration)
            .map(|()| Answer::Done)
            .map_err(|_| Refusal::NotKept)
    }

    /// Begins the bins anew about a second ahead. A reply that a full link holds up for longer
    /// comes too late, which its reader sees.
    fn restart_bins(&mut self) -> u64 {
        let ahead = u64::from(conversions_hz(self.settings));
        let epoch = self.position.next_index() + ahead;
        self.platform.bins().begin(epoch);
        self.mark = None;
        epoch
    }

    /// What a host of any version understands.
    fn hello(&self) -> Hello {
        Hello {
            version: VERSION,
            serial: self.board.serial,
            firmware: text(env!("CARGO_PKG_VERSION")),
            platform: text(self.board.platform),
        }
    }

    fn identity(&self) -> Identity {
        Identity {
            serial: self.board.serial,
            firmware: text(env!("CARGO_PKG_VERSION")),
            platform: text(self.board.platform),
            timer_hz: self.board.timer_hz,
            converter_clock_hz: CLOCK_HZ,
            baud: self.board.baud,
            range: self.board.range,
            reference_uv: self.board.reference_uv,
            sensor_supply_uv: self.board.sensor_supply_uv,
            converters: self.ids,
            settings: self.settings,
            restart: self.board.restart.clone(),
        }
    }

    /// Checks settings and keeps them. They are written at the next start, which resets the
    /// converters anyway.
    fn configure(&mut self, settings: Settings) -> Result<Answer, Refusal> {
        let load = samples_load(settings, self.board.baud);
        if !load.fits() {
            return Err(Refusal::LinkTooSlow {
                needed: load.needed,
                available: load.available,
            });
        }
        let asked = conversions_hz(settings);
        let readable = readable_hz(self.board.spi_hz);
        if asked > readable {
            return Err(Refusal::BusTooSlow { asked, readable });
        }
        self.settings = settings;
        self.clock = Clock::new(&self.board, settings);
        Ok(Answer::Settings(settings))
    }

    fn read_registers(&mut self) -> Result<[[u8; REGISTERS]; AXES], Refusal> {
        for axis in 0..AXES {
            match self.converters[axis].read_all_registers() {
                Ok(registers) => self.registers[axis] = registers,
                Err(error) => {
                    return Err(Refusal::Converter {
                        axis: axis as u8,
                        trouble: trouble(error),
                    });
                }
            }
        }
        Ok(self.registers)
    }
}

/// As much of `text` as fits.
fn text<const N: usize>(text: &str) -> String<N> {
    let mut short = String::new();
    for character in text.chars() {
        if short.push(character).is_err() {
            break;
        }
    }
    short
}

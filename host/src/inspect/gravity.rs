//! What the sensors of a board read at rest, one stretch after the other, and the calibration that a board
//! keeps.
//!
//! One port, opened once: a board that is opened anew may begin anew, and with it what its zeros have
//! wandered.

use std::time::Duration;

use inm_firmware::mma7331l::Scaling;
use inm_protocol::{AXES, Batch, Identity, REGISTERS, Request, SensorRange, Settings, ToHost};

use super::{Heard, Session};
use crate::calibrate::{BLOCK_S, Stretch};
use crate::capture::corrects;
use crate::link::{LinkError, Patience};

/// A board whose sensors are read at rest.
pub struct Readings<'s> {
    session: &'s mut Session,
    port: String,
    scaling: Scaling,
    timer_hz: f64,
    /// Conversions of a block.
    block: usize,
    /// Timer at the first conversion of the session, ticks.
    began: Option<u64>,
    /// Timer at the last one, ticks.
    ended: u64,
}

impl<'s> Readings<'s> {
    /// Brings the board to rest and to this range, with the default settings. What it says of its
    /// converters' own correction comes with it: `true` if there is one.
    ///
    /// # Errors
    /// What the link says, or the board.
    pub fn begin(
        session: &'s mut Session,
        port: String,
        identity: &Identity,
        range: SensorRange,
    ) -> Result<(Self, bool), LinkError> {
        let () = session.ask(Request::Stop)?;
        let () = session.ask(Request::SelectRange(range))?;
        let settings: Settings = session.ask(Request::Configure(Settings::default()))?;
        let registers: [[u8; REGISTERS]; AXES] = session.ask(Request::ReadRegisters)?;
        let readings = Self {
            session,
            port,
            scaling: Scaling::new(identity.reference_uv, range, identity.sensor_supply_uv),
            timer_hz: f64::from(identity.timer_hz.max(1)),
            block: (BLOCK_S * f64::from(settings.rate.hz())) as usize,
            began: None,
            ended: 0,
        };
        Ok((readings, corrects(&registers)))
    }

    /// Volts and codes in terms of accelerations by the sheets.
    pub fn scaling(&self) -> Scaling {
        self.scaling
    }

    /// Seconds from the first reading to the last.
    pub fn end_s(&self) -> f64 {
        (self.ended - self.began.unwrap_or(self.ended)) as f64 / self.timer_hz
    }

    /// Reads for so many seconds.
    ///
    /// # Errors
    /// What the link says; [`LinkError::Silent`] if the stream breaks off.
    pub fn stretch(&mut self, seconds: f64) -> Result<Stretch, LinkError> {
        let _: Settings = self.session.ask(Request::Start)?;
        let wanted = (seconds / BLOCK_S).round() as usize;
        let mut blocks = Blocks::new(self.block);
        let read = self.fill(&mut blocks, wanted);
        // Whatever happened, it is not left streaming.
        let stopped: Result<(), LinkError> = self.session.ask(Request::Stop);
        while self.session.heard().is_some() {}
        read?;
        stopped?;
        let began = *self.began.get_or_insert(blocks.began);
        self.ended = blocks.ended;
        let middle = 0.5 * ((blocks.began - began) as f64 + (blocks.ended - began) as f64);
        let value = |sum: i64| {
            let code = sum as f64 / self.block as f64;
            self.scaling.scale() * (code - self.scaling.zero())
        };
        Ok(Stretch {
            blocks: blocks.sums.iter().map(|sums| sums.map(value)).collect(),
            time_s: middle / self.timer_hz,
        })
    }

    /// Gathers so many blocks.
    fn fill(&mut self, blocks: &mut Blocks, wanted: usize) -> Result<(), LinkError> {
        let Patience { silence, .. } = Patience::default();
        let mut last = self.session.now();
        while blocks.sums.len() < wanted {
            self.session.listen()?;
            while let Some(Heard { at, message }) = self.session.heard() {
                if let ToHost::Samples(batch) = message {
                    last = at;
                    blocks.take(&batch, wanted);
                }
            }
            let since: Duration = self.session.now().duration_since(last);
            if since > silence {
                return Err(LinkError::Silent {
                    port: self.port.clone(),
                    since,
                });
            }
        }
        Ok(())
    }
}

/// Sums of the codes of whole blocks.
struct Blocks {
    /// Conversions of one.
    length: usize,
    sums: Vec<[i64; AXES]>,
    under_way: [i64; AXES],
    have: usize,
    /// The conversion that comes next.
    next: Option<u64>,
    /// Timer at the first batch and at the last, ticks.
    began: u64,
    ended: u64,
}

impl Blocks {
    fn new(length: usize) -> Self {
        Self {
            length: length.max(1),
            sums: Vec::new(),
            under_way: [0; AXES],
            have: 0,
            next: None,
            began: 0,
            ended: 0,
        }
    }

    /// Adds a batch, up to so many blocks. A block with a gap or a flagged word begins anew.
    fn take(&mut self, batch: &Batch, wanted: usize) {
        if self.next.is_none() {
            self.began = batch.stamp;
        }
        self.ended = batch.stamp;
        if self.next != Some(batch.first) {
            self.begin_block();
        }
        self.next = Some(batch.first + batch.codes.len() as u64);
        for (conversion, codes) in batch.codes.iter().enumerate() {
            let flagged = batch
                .flags
                .iter()
                .any(|flag| usize::from(flag.conversion) == conversion);
            if flagged {
                self.begin_block();
                continue;
            }
            for (sum, code) in self.under_way.iter_mut().zip(codes) {
                *sum += i64::from(code.0);
            }
            self.have += 1;
            if self.have == self.length && self.sums.len() < wanted {
                self.sums.push(self.under_way);
                self.begin_block();
            }
        }
    }

    fn begin_block(&mut self) {
        self.under_way = [0; AXES];
        self.have = 0;
    }
}

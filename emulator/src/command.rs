//! The command decoder behind DIN (SBAS378D page 30): bytes in, actions and breaches out.

use crate::{
    registers::{CONFIG0, COUNT, ID, RESERVED},
    rule::Rule,
    time::COMMAND_GAP_PS,
};

/// What a byte on DIN makes the converter do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Action {
    Nothing,
    Wakeup,
    Standby,
    Sync,
    Reset,
    ReadContinuous,
    StopContinuous,
    ReadOnce,
    CalibrateOffset,
    CalibrateGain,
    /// A register gets this value; `last` ends the command.
    Write {
        address: u8,
        value: u8,
        last: bool,
    },
}

/// A byte on DIN.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Byte {
    pub(crate) din: u8,
    /// First rising edge of SCLK, picoseconds.
    pub(crate) first_ps: u64,
    /// Last rising edge of SCLK, picoseconds.
    pub(crate) last_ps: u64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum State {
    #[default]
    Idle,
    /// The second byte of RREG or WREG comes next.
    Count { write: bool, address: u8 },
    /// Registers go out on DOUT.
    Reading { address: u8, left: u8 },
    /// Registers come in on DIN.
    Writing { address: u8, left: u8 },
}

/// The decoder's state.
#[derive(Debug, Clone, Default)]
pub(crate) struct Decoder {
    state: State,
    /// Last rising edge of a byte that a gap must follow.
    gap_from_ps: Option<u64>,
    /// The command under way was refused: its bytes are swallowed.
    refused: bool,
}

impl Decoder {
    /// Back to waiting for a command: RESET, or the interface's time-out.
    pub(crate) fn reset(&mut self) {
        *self = Self::default();
    }

    /// The register that the next byte on DOUT shows, while RREG is under way.
    pub(crate) fn register(&self) -> Option<u8> {
        match self.state {
            State::Reading { address, .. } if !self.refused => Some(address),
            _ => None,
        }
    }

    /// Takes a byte; `stopped` tells whether SDATAC is in force.
    pub(crate) fn take(&mut self, byte: Byte, stopped: bool) -> (Action, Option<Rule>) {
        let early = self
            .gap_from_ps
            .is_some_and(|from| byte.first_ps - from < COMMAND_GAP_PS);
        let idle_nop = self.state == State::Idle && byte.din < 2;
        self.gap_from_ps = if idle_nop { None } else { Some(byte.last_ps) };
        let (action, breach) = match self.state {
            State::Idle => self.command(byte.din, stopped),
            State::Count { write, address } => self.count(byte.din, write, address),
            State::Reading { address, left } => {
                self.state = next(
                    left,
                    State::Reading {
                        address: address + 1,
                        left: left - 1,
                    },
                );
                let breach = (byte.din != 0).then_some(Rule::DinDuringRead(byte.din));
                (Action::Nothing, breach)
            }
            State::Writing { address, left } => {
                self.state = next(
                    left,
                    State::Writing {
                        address: address + 1,
                        left: left - 1,
                    },
                );
                self.write(address, byte.din, left == 1)
            }
        };
        (
            action,
            if early {
                Some(Rule::CommandGap)
            } else {
                breach
            },
        )
    }

    fn command(&mut self, din: u8, stopped: bool) -> (Action, Option<Rule>) {
        self.refused = false;
        let action = match din {
            0x00 | 0x01 => Action::Wakeup,
            0x02 | 0x03 => Action::Standby,
            0x04 | 0x05 => Action::Sync,
            0x06 | 0x07 => Action::Reset,
            0x10 => Action::ReadContinuous,
            0x11 => Action::StopContinuous,
            0x12 if stopped => Action::ReadOnce,
            0x60 if stopped => Action::CalibrateOffset,
            0x61 if stopped => Action::CalibrateGain,
            0x12 | 0x60 | 0x61 => return (Action::Nothing, Some(Rule::NotStopped)),
            0x20..=0x5F => {
                self.state = State::Count {
                    write: din & 0x40 != 0,
                    address: din & 0x1F,
                };
                self.refused = !stopped;
                return (Action::Nothing, self.refused.then_some(Rule::NotStopped));
            }
            _ => return (Action::Nothing, Some(Rule::UnknownCommand(din))),
        };
        (action, None)
    }

    /// The second byte of RREG and WREG: number of registers less one, 5 bits.
    fn count(&mut self, din: u8, write: bool, address: u8) -> (Action, Option<Rule>) {
        let count = (din & 0x1F) + 1;
        self.state = if write {
            State::Writing {
                address,
                left: count,
            }
        } else {
            State::Reading {
                address,
                left: count,
            }
        };
        let beyond = usize::from(address) + usize::from(count) > COUNT;
        let breach = beyond.then_some(Rule::RegisterRange { address, count });
        (Action::Nothing, breach)
    }

    fn write(&self, address: u8, value: u8, last: bool) -> (Action, Option<Rule>) {
        if self.refused {
            return (Action::Nothing, None);
        }
        let breach = match address {
            ID => Some(Rule::ReadOnlyRegister),
            RESERVED => Some(Rule::ReservedRegister),
            CONFIG0 if value & 0x40 == 0 => Some(Rule::FixedBit),
            CONFIG0 if (value >> 3) & 7 > 4 => Some(Rule::UndefinedRate),
            _ => None,
        };
        (
            Action::Write {
                address,
                value,
                last,
            },
            breach,
        )
    }
}

/// `state`, or waiting for a command if that was the last byte.
fn next(left: u8, state: State) -> State {
    if left == 1 { State::Idle } else { state }
}

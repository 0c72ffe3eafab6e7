//! USART1 in bytes of ten bits (RM0090, section 30), and the line to the host.

use std::collections::VecDeque;

use super::Registers;

const SR: u32 = 0x00;
const DR: u32 = 0x04;
const BRR: u32 = 0x08;
const CR1: u32 = 0x0c;

/// Bits of SR (30.6.1); those of CR1 that let them ask for the interrupt lie at the same places
/// (30.6.4).
const FE: u32 = 1 << 1;
const ORE: u32 = 1 << 3;
const RXNE: u32 = 1 << 5;
const TC: u32 = 1 << 6;
const TXE: u32 = 1 << 7;

/// UE of CR1.
const ENABLED: u32 = 1 << 13;

/// Start, eight data, stop.
const BITS: u64 = 10;

/// The far end's speed, bit/s: that of the protocol (WIRE.md).
pub const HOST_BAUD: u64 = 921_600;

/// A receiver that samples in the middle of bits bears an error of half a bit in ten, less the half of
/// it that the other side may have: 2 %.
const BORNE_PERCENT: u64 = 2;

/// How often an open input that nothing holds picks up something, picoseconds: a guess, any will do.
const NOISE_PS: u64 = 1_000_000_000;

/// The line to the host and back; resets of the chip do not touch it.
#[derive(Default)]
pub struct Line {
    /// Bytes that the host has received.
    pub to_host: Vec<u8>,
    /// Bytes that arrived at a speed which the host cannot read.
    pub garbled: u64,
    /// Bytes on their way to the board, and when they are whole.
    to_board: VecDeque<(u64, u8)>,
    /// Nobody is connected.
    pub open: bool,
    noise_ps: u64,
}

impl Line {
    /// Sends bytes to the board, one after the other.
    pub fn send(&mut self, now_ps: u64, bytes: &[u8]) {
        let mut end_ps = self.to_board.back().map_or(now_ps, |&(end, _)| end);
        for &byte in bytes {
            end_ps = end_ps.max(now_ps) + BITS * 1_000_000_000_000 / HOST_BAUD;
            self.to_board.push_back((end_ps, byte));
        }
    }
}

/// The peripheral.
pub struct Usart {
    registers: Registers,
    /// Byte under way and its end.
    shifting: Option<(u64, u8)>,
    waiting: Option<u8>,
    received: Option<u8>,
    status: u32,
    /// What the pins are connected to.
    pub line: Line,
}

impl Usart {
    pub(super) fn new(line: Line) -> Self {
        Self {
            registers: Registers::default(),
            shifting: None,
            waiting: None,
            received: None,
            // 30.6.1: nothing was sent, so all was sent.
            status: TC,
            line,
        }
    }

    /// Speed, bit/s, by BRR where the bus clock is `pclk2`: 16 times oversampled (30.3.4).
    #[must_use]
    pub fn baud(&self, pclk2: u64) -> u64 {
        pclk2 / u64::from(self.registers.get(BRR).max(1))
    }

    fn suits_host(&self, pclk2: u64) -> bool {
        self.baud(pclk2).abs_diff(HOST_BAUD) * 100 <= HOST_BAUD * BORNE_PERCENT
    }

    /// Whether it asks for its interrupt.
    pub(super) fn asks(&self) -> bool {
        let overrun = if self.status & ORE != 0 { RXNE } else { 0 };
        (self.flags() | overrun) & self.registers.get(CR1) & (RXNE | TC | TXE) != 0
    }

    fn flags(&self) -> u32 {
        let flag = |set, bit| if set { bit } else { 0 };
        self.status | flag(self.waiting.is_none(), TXE) | flag(self.received.is_some(), RXNE)
    }

    /// `held` says whether its input is held high when nobody is connected.
    pub(super) fn next_ps(&self, held: bool) -> Option<u64> {
        let sent = self.shifting.map(|(end, _)| end);
        let arrives = self.line.to_board.front().map(|&(end, _)| end);
        let noise = (self.line.open && !held && self.enabled()).then_some(self.line.noise_ps);
        [sent, arrives, noise].into_iter().flatten().min()
    }

    fn enabled(&self) -> bool {
        self.registers.get(CR1) & ENABLED != 0
    }

    pub(super) fn catch_up(&mut self, now_ps: u64, pclk2: u64, held: bool) {
        if let Some((end_ps, byte)) = self.shifting.take_if(|(end, _)| *end <= now_ps) {
            if self.suits_host(pclk2) {
                self.line.to_host.push(byte);
            } else {
                self.line.garbled += 1;
            }
            match self.waiting.take() {
                Some(next) => self.shift(end_ps, next, pclk2),
                None => self.status |= TC,
            }
        }
        while let Some(&(end_ps, byte)) = self.line.to_board.front()
            && end_ps <= now_ps
        {
            self.line.to_board.pop_front();
            let fits = self.suits_host(pclk2);
            self.arrive(if fits { byte } else { !byte }, !fits);
        }
        if self.line.open && !held && self.line.noise_ps <= now_ps {
            self.line.noise_ps = now_ps + NOISE_PS;
            self.arrive(0, true);
        }
    }

    fn arrive(&mut self, byte: u8, damaged: bool) {
        if !self.enabled() || self.line.open && !damaged {
            return;
        }
        if self.received.is_some() {
            self.status |= ORE;
        } else {
            self.received = Some(byte);
        }
        if damaged {
            self.status |= FE;
        }
    }

    fn shift(&mut self, begin_ps: u64, byte: u8, pclk2: u64) {
        // A bit is BRR cycles of the bus clock.
        let cycles = BITS * u64::from(self.registers.get(BRR));
        let end_ps = begin_ps + cycles * 1_000_000_000_000 / pclk2.max(1);
        self.shifting = Some((end_ps, byte));
    }

    pub(super) fn read(&mut self, offset: u32) -> u32 {
        match offset {
            SR => self.flags(),
            DR => {
                // Behind a look at SR this clears the errors, too (30.6.1); the image always looks.
                self.status &= !(ORE | FE);
                u32::from(self.received.take().unwrap_or(0))
            }
            _ => self.registers.get(offset),
        }
    }

    pub(super) fn write(&mut self, offset: u32, value: u32, now_ps: u64, pclk2: u64) {
        match offset {
            SR => self.status &= value,
            DR => {
                self.status &= !TC;
                if self.shifting.is_none() {
                    self.shift(now_ps, value as u8, pclk2);
                } else {
                    self.waiting = Some(value as u8);
                }
            }
            _ => self.registers.set(offset, value),
        }
    }
}

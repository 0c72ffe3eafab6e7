//! A serial line in virtual time: ten bits a byte, a bounded transmit queue, seeded trouble.
//!
//! Tells when each byte arrives, so that what a link can carry is tested without one.

use crate::{random::Random, time::PS_PER_S};

/// Bits on the line for each byte: start, eight data, stop.
const BITS_PER_BYTE: u64 = 10;

/// A byte that has come out of the line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Arrival {
    /// End of its stop bit, picoseconds.
    pub at_ps: u64,
    /// The byte.
    pub byte: u8,
}

/// What happens to a byte on its way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Trouble {
    /// It is lost.
    Drop,
    /// One bit (0 to 7) is inverted.
    Flip(u8),
}

/// One direction of a serial line with a queue of `N` bytes.
///
/// A byte leaves the queue when the far end fetches it: one that does not keep up fills it, and
/// the sender finds no room.
///
/// ```
/// use inm_emulator::link::Link;
/// let mut link = Link::<4>::new(1_000_000);
/// assert_eq!(link.send(0, b"hello"), 4); // the queue is full
/// assert_eq!(link.receive(9_999_999), None);
/// let first = link.receive(10_000_000).expect("10 bits at 1 Mbit/s are 10 us");
/// assert_eq!((first.at_ps, first.byte), (10_000_000, b'h'));
/// ```
#[derive(Debug, Clone)]
pub struct Link<const N: usize> {
    baud: u64,
    /// Queued and arrived bytes with their arrival times, a ring.
    ring: [Arrival; N],
    first: usize,
    len: usize,
    /// End of the last byte on the line, and what its rounding left, in 1/baud picoseconds.
    busy_until_ps: u64,
    rest: u64,
}

impl<const N: usize> Link<N> {
    /// An idle line of `baud` bit/s (at least 1).
    pub const fn new(baud: u32) -> Self {
        Self {
            baud: if baud == 0 { 1 } else { baud as u64 },
            ring: [Arrival { at_ps: 0, byte: 0 }; N],
            first: 0,
            len: 0,
            busy_until_ps: 0,
            rest: 0,
        }
    }

    /// Bytes that [`Link::send`] would take now.
    pub fn room(&self) -> usize {
        N - self.len
    }

    /// Queues bytes at `now_ps`; returns how many found room. Times must not go backwards.
    pub fn send(&mut self, now_ps: u64, bytes: &[u8]) -> usize {
        let taken = bytes.len().min(self.room());
        for &byte in &bytes[..taken] {
            let at_ps = self.next_arrival(now_ps);
            self.ring[(self.first + self.len) % N] = Arrival { at_ps, byte };
            self.len += 1;
        }
        taken
    }

    /// The next byte that has arrived by `now_ps`.
    pub fn receive(&mut self, now_ps: u64) -> Option<Arrival> {
        let arrival = self.ring.get(self.first).copied()?;
        if self.len == 0 || arrival.at_ps > now_ps {
            return None;
        }
        self.first = (self.first + 1) % N;
        self.len -= 1;
        Some(arrival)
    }

    /// Puts one more byte on the line. Remainders are carried, so that a busy line keeps its rate.
    fn next_arrival(&mut self, now_ps: u64) -> u64 {
        if self.busy_until_ps < now_ps {
            self.busy_until_ps = now_ps;
            self.rest = 0;
        }
        let span = BITS_PER_BYTE * PS_PER_S + self.rest;
        self.rest = span % self.baud;
        self.busy_until_ps += span / self.baud;
        self.busy_until_ps
    }
}

/// A line that loses and damages bytes: at random with a seed, and on request.
#[derive(Debug, Clone)]
pub struct Noisy<const N: usize> {
    /// The line itself.
    pub link: Link<N>,
    random: Random,
    drop_ppm: u32,
    flip_ppm: u32,
    received: u64,
    planned: Option<(u64, Trouble)>,
    dropped: u64,
    flipped: u64,
}

impl<const N: usize> Noisy<N> {
    /// Loses and damages bytes of `link` with these probabilities, in millionths.
    pub fn new(link: Link<N>, seed: u64, drop_ppm: u32, flip_ppm: u32) -> Self {
        let random = Random::new(seed, u64::MAX);
        let (received, dropped, flipped) = (0, 0, 0);
        Self {
            link,
            random,
            drop_ppm,
            flip_ppm,
            received,
            planned: None,
            dropped,
            flipped,
        }
    }

    /// Plans trouble for byte number `index` of the line, counted from zero; replaces an earlier
    /// plan.
    pub fn plan(&mut self, index: u64, trouble: Trouble) {
        self.planned = Some((index, trouble));
    }

    /// Bytes lost and bytes damaged so far.
    pub fn harm(&self) -> (u64, u64) {
        (self.dropped, self.flipped)
    }

    /// The next byte that has arrived by `now_ps`, lost ones passed over.
    pub fn receive(&mut self, now_ps: u64) -> Option<Arrival> {
        loop {
            let mut arrival = self.link.receive(now_ps)?;
            let index = self.received;
            self.received += 1;
            let planned = self.planned.take_if(|&mut (at, _)| at <= index);
            match planned
                .map(|(_, trouble)| trouble)
                .or_else(|| self.chance())
            {
                None => return Some(arrival),
                Some(Trouble::Drop) => self.dropped += 1,
                Some(Trouble::Flip(bit)) => {
                    self.flipped += 1;
                    arrival.byte ^= 1 << (bit & 7);
                    return Some(arrival);
                }
            }
        }
    }

    fn chance(&mut self) -> Option<Trouble> {
        let million = ((u64::from(self.random.next()) * 1_000_000) >> 32) as u32;
        let bit = (self.random.next() >> 29) as u8;
        if million < self.drop_ppm {
            Some(Trouble::Drop)
        } else if million < self.drop_ppm.saturating_add(self.flip_ppm) {
            Some(Trouble::Flip(bit))
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_busy_line_carries_exactly_its_rate() {
        // 921600 bit/s: 10850694.44 ps a byte, 92160 bytes in a second to the picosecond.
        let mut link = Link::<1024>::new(921_600);
        let mut now_ps = 0;
        let (mut sent, mut received, mut last_ps) = (0, 0, 0);
        while received < 92_160 {
            let want = (92_160 - sent).min(64);
            sent += link.send(now_ps, &[0x55; 64][..want]);
            while let Some(arrival) = link.receive(now_ps) {
                received += 1;
                last_ps = arrival.at_ps;
            }
            now_ps += 100_000_000;
            assert!(now_ps < 2 * PS_PER_S, "{received} of {sent} bytes arrived");
        }
        assert_eq!(last_ps, PS_PER_S);
    }

    #[test]
    fn an_idle_line_starts_at_once_and_order_is_kept() {
        let mut link = Link::<8>::new(1_000_000);
        link.send(5_000_000, &[1, 2]);
        link.send(100_000_000, &[3]);
        let arrivals = [(); 3].map(|()| link.receive(u64::MAX).map(|a| (a.at_ps, a.byte)));
        assert_eq!(
            arrivals,
            [
                Some((15_000_000, 1)),
                Some((25_000_000, 2)),
                Some((110_000_000, 3))
            ]
        );
    }

    #[test]
    fn a_receiver_that_does_not_fetch_fills_the_queue() {
        let mut link = Link::<4>::new(1_000_000);
        assert_eq!(link.send(0, &[1, 2, 3, 4]), 4);
        assert_eq!(link.send(20_000_000, &[5, 6, 7]), 0);
        assert_eq!(link.receive(20_000_000).map(|a| a.byte), Some(1));
        assert_eq!(link.send(20_000_000, &[5, 6, 7]), 1);
    }

    #[test]
    fn harm_is_counted_and_as_likely_as_asked() {
        let seed = 11;
        let mut noisy = Noisy::<64>::new(Link::new(1_000_000_000), seed, 10_000, 20_000);
        noisy.plan(0, Trouble::Flip(3));
        let n = 100_000;
        let (mut received, mut damaged) = (0, 0);
        for i in 0..n {
            noisy.link.send(i * 1_000_000, &[0xA5]);
            while let Some(arrival) = noisy.receive(u64::MAX) {
                received += 1;
                damaged += u64::from(arrival.byte != 0xA5);
                assert!(i > 0 || arrival.byte == 0xA5 ^ 8, "planned");
            }
        }
        let (dropped, flipped) = noisy.harm();
        assert_eq!((received + dropped, damaged), (n, flipped));
        // Five sigma of binomial counts: sqrt(1000), sqrt(2000).
        assert!(dropped.abs_diff(1000) < 160, "seed {seed}: {dropped}");
        assert!(flipped.abs_diff(2000) < 225, "seed {seed}: {flipped}");
    }
}

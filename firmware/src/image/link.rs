//! The link: USART1, a queue in each direction and the interrupt that empties and fills them.
//!
//! The loop asks for the interrupt in software when it has queued something; from there on
//! the transmitter's own interrupts carry on until the queue is empty. QEMU's USART sends at
//! once and has no transmit interrupts, and this works there unchanged.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use cortex_m::peripheral::NVIC;
use heapless::spsc::{Consumer, Producer, Queue};
use stm32f4xx_hal::pac::{Interrupt, USART1, interrupt};

use super::handover::Handover;

/// Bytes to the host that may wait: 89 ms at 921600 baud, 19 batches.
const OUTGOING: usize = 8192;

/// Bytes from the host that may wait. The longest command takes 17; a step of the loop takes
/// 2 ms at most, 184 bytes.
const INCOMING: usize = 256;

static INTERRUPT_SIDE: Handover<InterruptSide> = Handover::new();

/// Bytes received and thrown away: queue full, or damaged on the line.
static LOST: AtomicU32 = AtomicU32::new(0);

/// The last byte has left the shift register.
static IDLE: AtomicBool = AtomicBool::new(true);

/// The loop's side of the link.
pub struct Link {
    outgoing: Producer<'static, u8>,
    incoming: Consumer<'static, u8>,
}

/// The interrupt's side.
struct InterruptSide {
    usart: USART1,
    outgoing: Consumer<'static, u8>,
    incoming: Producer<'static, u8>,
}

/// Takes a USART whose speed and frame are set; `None` if the link has been started before.
pub fn start(usart: USART1) -> Option<Link> {
    let outgoing = cortex_m::singleton!(: Queue<u8, OUTGOING> = Queue::new())?;
    let incoming = cortex_m::singleton!(: Queue<u8, INCOMING> = Queue::new())?;
    let (outgoing_in, outgoing_out) = outgoing.split();
    let (incoming_in, incoming_out) = incoming.split();

    usart.cr1().modify(|_, w| w.rxneie().set_bit());
    INTERRUPT_SIDE.give(InterruptSide {
        usart,
        outgoing: outgoing_out,
        incoming: incoming_in,
    });
    // SAFETY: the handler is defined below, what it needs is in place, and no critical section
    // is built on the interrupt's mask.
    #[allow(unsafe_code)]
    unsafe {
        NVIC::unmask(Interrupt::USART1);
    }
    Some(Link {
        outgoing: outgoing_in,
        incoming: incoming_out,
    })
}

impl Link {
    /// Queues all of `frame`, or nothing when there is no room for all of it.
    pub fn transmit(&mut self, frame: &[u8]) -> bool {
        if self.outgoing.capacity() - self.outgoing.len() < frame.len() {
            return false;
        }
        for &byte in frame {
            // There is room: only the interrupt touches the queue meanwhile, and it makes more.
            let _ = self.outgoing.enqueue(byte);
        }
        NVIC::pend(Interrupt::USART1);
        true
    }

    /// Whether all that was queued is on the line.
    pub fn is_idle(&self) -> bool {
        self.outgoing.is_empty() && IDLE.load(Ordering::Acquire)
    }

    /// Next byte from the host.
    pub fn receive(&mut self) -> Option<u8> {
        self.incoming.dequeue()
    }

    /// Whether no byte from the host waits.
    pub fn is_quiet(&self) -> bool {
        !self.incoming.ready()
    }

    /// Bytes from the host that were lost since the start.
    pub fn lost(&self) -> u32 {
        LOST.load(Ordering::Relaxed)
    }
}

impl InterruptSide {
    fn receive(&mut self) {
        let status = self.usart.sr().read();
        let damaged = status.ore().bit() || status.fe().bit() || status.nf().bit();
        if damaged || status.rxne().bit() {
            // Reading the data after the status also clears the error flags.
            let byte = self.usart.dr().read().dr().bits() as u8;
            if damaged || self.incoming.enqueue(byte).is_err() {
                LOST.fetch_add(1, Ordering::Relaxed);
            }
        }
    }

    fn transmit(&mut self) {
        while self.usart.sr().read().txe().bit() {
            let Some(byte) = self.outgoing.dequeue() else {
                break;
            };
            IDLE.store(false, Ordering::Release);
            self.usart.dr().write(|w| w.dr().set(byte.into()));
        }
        let empty = !self.outgoing.ready();
        let sent = empty && self.usart.sr().read().tc().bit();
        if sent {
            IDLE.store(true, Ordering::Release);
        }
        // More to send: when the data register is free. All given out: when the last bit left.
        self.usart
            .cr1()
            .modify(|_, w| w.txeie().bit(!empty).tcie().bit(empty && !sent));
    }
}

#[interrupt]
fn USART1() {
    static mut SIDE: Option<InterruptSide> = None;
    if let Some(side) = INTERRUPT_SIDE.receive(SIDE) {
        side.receive();
        side.transmit();
    }
}

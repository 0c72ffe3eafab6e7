//! What the board and QEMU's model of it share.
//!
//! ```text
//!   clock     64-bit time from a 32-bit timer; the heartbeat that wakes the loop
//!   stamps    DRDY edges of X: interrupt to loop
//!   link      USART: two queues and their interrupt
//!   restart   why the board started; the panic and fault handlers
//!   stack     how deep it went
//!   machine   all of it as the instrument's platform
//!   handover  what the loop gives to an interrupt, once
//! ```

pub mod clock;
mod handover;
pub mod link;
pub mod machine;
pub mod restart;
mod stack;
pub mod stamps;

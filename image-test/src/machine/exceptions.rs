//! Exceptions, which the engine does not take by itself (PM0214, 2.3.7; ARMv7-M, B1.5).
//!
//! Thread mode stays the engine's mode throughout: which stack is in use is switched by CONTROL, and who
//! runs is known to [`Core`](crate::chip::core::Core) alone.

use unicorn_engine::{RegisterARM, Unicorn};

use crate::chip::Chip;
use crate::chip::core::HARD_FAULT;

/// Bit of CONTROL: the process stack is in use.
const ON_PSP: u64 = 0b10;
/// Bit of CONTROL: floating-point registers are in use, which the frame would have to hold.
const FLOATING: u64 = 0b100;

/// Where a handler returns to: the upper bits of EXC_RETURN.
const RETURN: u64 = 0xffff_ffe0;
/// EXC_RETURN into another handler, the program on the main stack, the program on its own.
const TO_HANDLER: u64 = 0xffff_fff1;
const TO_MSP: u64 = 0xffff_fff9;
const TO_PSP: u64 = 0xffff_fffd;

/// Bits of xPSR within an IT block, where a handler cannot be let in between.
const IT: u64 = 0x0600_fc00;
/// Bit of the stacked xPSR: four bytes were left out for alignment.
const PADDED: u64 = 1 << 9;
/// Flags of the xPSR.
const FLAGS: u64 = 0xf80f_0000;

/// What the hardware stacks, from the lowest address up; PC and xPSR follow.
const FRAME: [RegisterARM; 6] = [
    RegisterARM::R0,
    RegisterARM::R1,
    RegisterARM::R2,
    RegisterARM::R3,
    RegisterARM::R12,
    RegisterARM::LR,
];
const FRAME_LEN: u64 = 32;

/// Reads a register.
pub fn get(uc: &Unicorn<'_, Chip>, register: RegisterARM) -> u64 {
    uc.reg_read(register).expect("the core has it")
}

/// Writes a register.
pub fn set(uc: &mut Unicorn<'_, Chip>, register: RegisterARM, value: u64) {
    uc.reg_write(register, value).expect("the core has it");
}

/// Has the engine call where it cannot go on: at EXC_RETURN, since nothing may be executed so high up
/// in memory (PM0214, 2.2.3), and at faults.
pub fn handle(uc: &mut Unicorn<'static, Chip>) {
    uc.add_intr_hook(|uc, _| {
        let address = get(uc, RegisterARM::PC);
        if address >= RETURN {
            leave(uc, address);
        } else {
            enter(uc, HARD_FAULT, address);
        }
    })
    .expect("the engine has interrupts");
}

/// Enters the handler of the most urgent exception that waits and is not masked; whether there was one.
pub fn take(uc: &mut Unicorn<'_, Chip>, address: u64) -> bool {
    if get(uc, RegisterARM::PRIMASK) & 1 != 0 || get(uc, RegisterARM::XPSR) & IT != 0 {
        return false;
    }
    let base = get(uc, RegisterARM::BASEPRI) as u8;
    match uc.get_data().core.due(base) {
        Some(number) => {
            enter(uc, number, address);
            true
        }
        None => false,
    }
}

/// Enters a handler; the program goes on at `address` afterwards.
pub fn enter(uc: &mut Unicorn<'_, Chip>, number: usize, address: u64) {
    let control = get(uc, RegisterARM::CONTROL);
    assert_eq!(control & FLOATING, 0, "the image uses no floating point");
    let running = uc.get_data().core.running() as u64;
    let sp = get(uc, RegisterARM::SP);
    let padding = sp & 4;
    let frame_at = sp - padding - FRAME_LEN;
    let flags = get(uc, RegisterARM::XPSR) & FLAGS;
    let xpsr = flags | 1 << 24 | running | if padding == 0 { 0 } else { PADDED };
    let words = FRAME.map(|register| get(uc, register));
    let words = words.into_iter().chain([address, xpsr]);
    let bytes: Vec<u8> = words.flat_map(|word| (word as u32).to_le_bytes()).collect();
    // A full stack has no room for it: the handler of that fault runs all the same.
    let _ = uc.mem_write(frame_at, &bytes);
    let back = match (running, control & ON_PSP) {
        (0, 0) => TO_MSP,
        (0, _) => TO_PSP,
        _ => TO_HANDLER,
    };
    set(uc, RegisterARM::SP, frame_at);
    set(uc, RegisterARM::CONTROL, control & !ON_PSP);
    set(uc, RegisterARM::LR, back);
    let vector = uc.get_data_mut().core.enter(number);
    let handler = read_word(uc, u64::from(vector));
    set(uc, RegisterARM::PC, handler);
    uc.get_data_mut().settle();
}

/// Leaves a handler: the core has been sent to EXC_RETURN, whose lowest bit is no part of an address.
pub fn leave(uc: &mut Unicorn<'_, Chip>, address: u64) {
    let control = get(uc, RegisterARM::CONTROL);
    if address | 1 == TO_PSP {
        set(uc, RegisterARM::CONTROL, control | ON_PSP);
    }
    let sp = get(uc, RegisterARM::SP);
    for (place, register) in (0..).zip(FRAME) {
        let word = read_word(uc, sp + 4 * place);
        set(uc, register, word);
    }
    let pc = read_word(uc, sp + 24);
    let xpsr = read_word(uc, sp + 28);
    let padding = if xpsr & PADDED == 0 { 0 } else { 4 };
    set(uc, RegisterARM::SP, sp + FRAME_LEN + padding);
    set(uc, RegisterARM::APSR_NZCVQG, xpsr & FLAGS);
    let chip = uc.get_data_mut();
    chip.core.leave();
    chip.settle();
    set(uc, RegisterARM::PC, pc | 1);
}

/// A word of memory.
pub fn read_word(uc: &Unicorn<'_, Chip>, address: u64) -> u64 {
    let mut bytes = [0; 4];
    uc.mem_read(address, &mut bytes).expect("memory is there");
    u64::from(u32::from_le_bytes(bytes))
}

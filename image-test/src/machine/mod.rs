//! The machine: the engine that executes instructions, and everything that it leaves to others.

mod blocks;
mod exceptions;
mod flash;
mod talk;

use unicorn_engine::{Arch, ArmCpuModel, Mode, Prot, RegisterARM, Unicorn};

use crate::board::Board;
use crate::chip::core::HARD_FAULT;
use crate::chip::map::{BIT_BAND, PERIPHERALS};
use crate::chip::rcc::Cause;
use crate::chip::{COLD_CODE, Chip, HOT_CODE, REFERENCE_CODE, Stop};
use crate::image::{FLASH, FLASH_LEN, Image};
use blocks::Blocks;
pub use talk::Talk;

/// SRAM1 and SRAM2 (RM0090, 2.3.1).
const RAM: u64 = 0x2000_0000;
const RAM_LEN: u64 = 128 << 10;

/// The page of the system memory with the unique number and the factory's codes (RM0090, 39.1, and the
/// data sheet's tables of calibration values).
const FACTORY: u64 = 0x1fff_7000;
const UNIQUE: u64 = 0x1fff_7a10;
const CALIBRATION: u64 = 0x1fff_7a2a;
/// Unique number: place on the wafer, wafer, lot.
pub const SERIAL: [u8; 12] = *b"\x11\x00\x22\x00\x07LOT1234";

/// The core's private peripherals, of which the system control space is one page (PM0214, 2.2).
const PRIVATE: u64 = 0xe000_0000;
const PRIVATE_LEN: u64 = 0x10_0000;
const SYSTEM_CONTROL: u64 = 0xe000_e000;

/// Which peripherals of APB1 a halted core stops: DBGMCU_APB1_FZ (RM0090, 38.16.4).
const HALTED: u64 = 0xe004_2008;

/// Of the peripherals on APB1, APB2 and AHB1 as far as the image uses them.
const PERIPHERALS_LEN: u64 = 0x4_0000;

/// Memory is mapped in pages of this.
const PAGE: u64 = 0x1000;

/// Picoseconds of a millisecond.
pub const PS_PER_MS: u64 = 1_000_000_000;
/// Picoseconds of a second.
pub const PS_PER_S: u64 = 1_000_000_000_000;

/// A start takes 12 ms with the crystal and 0.2 s without.
const START_MS: u64 = 300;

/// A board with its chip and the image in its flash.
pub struct Machine {
    uc: Unicorn<'static, Chip>,
    /// Where it goes on.
    pc: u64,
    asleep: bool,
    /// Restarts so far, and what each was by.
    pub resets: Vec<Cause>,
}

impl Machine {
    /// Power comes on.
    #[must_use]
    pub fn new(image: &Image, board: Board) -> Self {
        let mut uc =
            Unicorn::new_with_data(Arch::ARM, Mode::THUMB | Mode::MCLASS, Chip::new(board))
                .expect("the engine has the architecture");
        uc.ctl_set_cpu_model(ArmCpuModel::CORTEX_M4 as i32)
            .expect("the engine has the core");
        map_memory(&mut uc, image);
        map_registers(&mut uc);
        flash::program(&mut uc);
        flash::read(&mut uc);
        let blocks = Blocks::new(image);
        blocks::count(&mut uc, blocks);
        exceptions::handle(&mut uc);
        let mut machine = Self {
            uc,
            pc: 0,
            asleep: false,
            resets: Vec::new(),
        };
        machine.begin();
        machine
    }

    /// The image that was built, on a board whose crystal swings or does not, once it listens to the host.
    #[must_use]
    pub fn started(crystal: bool) -> Self {
        let mut machine = Self::new(&Image::built(), Board::new(crystal));
        machine.run(START_MS * PS_PER_MS);
        machine
    }

    /// The chip and what is around it.
    #[must_use]
    pub fn chip(&self) -> &Chip {
        self.uc.get_data()
    }

    /// To make something happen there.
    pub fn chip_mut(&mut self) -> &mut Chip {
        self.uc.get_data_mut()
    }

    /// Changes memory behind the program's back.
    pub fn poke(&mut self, address: u32, bytes: &[u8]) {
        self.uc
            .mem_write(u64::from(address), bytes)
            .expect("memory is there");
    }

    /// Runs for `ps` picoseconds of the board's time.
    pub fn run(&mut self, ps: u64) {
        let deadline_ps = self.chip().now_ps + ps;
        self.chip_mut().deadline_ps = deadline_ps;
        self.chip_mut().settle();
        while self.chip().now_ps < deadline_ps {
            self.go_on();
        }
    }

    /// Runs until the core is about to execute the instruction at `address`.
    pub fn run_to(&mut self, address: u32) {
        let chip = self.uc.get_data_mut();
        chip.deadline_ps = chip.now_ps + PS_PER_S;
        chip.settle();
        let end = self.uc.emu_start(self.pc | 1, u64::from(address), 0, 0);
        end.expect("it runs");
        self.pc = self.program_counter();
        assert_eq!(self.pc, u64::from(address), "it came there");
    }

    /// Sends the core to an address, as a damaged pointer would.
    pub fn jump(&mut self, address: u32) {
        self.pc = u64::from(address);
        self.asleep = false;
    }

    /// Until something stops it.
    fn go_on(&mut self) {
        if self.asleep {
            self.sleep();
        } else {
            self.execute();
        }
        match self.chip_mut().stop.take() {
            Some(Stop::Reset(cause)) => self.reset(cause),
            Some(Stop::NoClock) => {
                // What runs on oscillators of its own goes on; only the watchdog can end this.
                self.chip_mut().skip();
                if let Some(Stop::Reset(cause)) = self.chip_mut().stop.take() {
                    self.reset(cause);
                }
                self.chip_mut().settle();
            }
            Some(Stop::Deadline) | None => {}
        }
    }

    /// Executes until something stops it, a fault or a sleep.
    fn execute(&mut self) {
        if self.chip().stop.is_some() {
            return;
        }
        let end = self.uc.emu_start(self.pc | 1, 0, 0, 0);
        self.pc = self.program_counter();
        if end.is_err() {
            exceptions::enter(&mut self.uc, HARD_FAULT, self.pc);
            self.pc = self.program_counter();
        } else {
            // Nothing but WFI ends it without a reason.
            self.asleep = self.chip().stop.is_none();
        }
    }

    fn program_counter(&self) -> u64 {
        exceptions::get(&self.uc, RegisterARM::PC)
    }

    fn sleep(&mut self) {
        let chip = self.uc.get_data_mut();
        while chip.stop.is_none() {
            if chip.core.wakes() {
                self.asleep = false;
                return;
            }
            chip.spent.asleep_ps += chip.skip();
        }
    }

    fn reset(&mut self, cause: Cause) {
        self.chip_mut().reset(cause);
        self.resets.push(cause);
        self.begin();
    }

    /// What the core does out of reset (PM0214, 2.3.4).
    fn begin(&mut self) {
        self.asleep = false;
        let stack = exceptions::read_word(&self.uc, u64::from(FLASH));
        let start = exceptions::read_word(&self.uc, u64::from(FLASH) + 4);
        for (register, value) in [
            (RegisterARM::CONTROL, 0),
            (RegisterARM::PRIMASK, 0),
            (RegisterARM::BASEPRI, 0),
            (RegisterARM::MSP, stack),
            (RegisterARM::LR, 0xffff_ffff),
        ] {
            exceptions::set(&mut self.uc, register, value);
        }
        self.pc = start & !1;
    }
}

fn map_memory(uc: &mut Unicorn<'static, Chip>, image: &Image) {
    let factory: Vec<u8> = [REFERENCE_CODE, COLD_CODE, HOT_CODE]
        .into_iter()
        .flat_map(u16::to_le_bytes)
        .collect();
    for (at, len, protection) in [
        (u64::from(FLASH), FLASH_LEN as u64, Prot::READ | Prot::EXEC),
        (RAM, RAM_LEN, Prot::READ | Prot::WRITE),
        (FACTORY, PAGE, Prot::READ),
    ] {
        uc.mem_map(at, len, protection).expect("it is free");
    }
    for (at, bytes) in [
        (u64::from(FLASH), &image.flash[..]),
        (UNIQUE, &SERIAL),
        (CALIBRATION, &factory),
    ] {
        uc.mem_write(at, bytes).expect("it is mapped");
    }
}

fn map_registers(uc: &mut Unicorn<'static, Chip>) {
    map(
        uc,
        (u64::from(PERIPHERALS), PERIPHERALS_LEN),
        |chip, offset| chip.read(PERIPHERALS + offset),
        |chip, offset, _, value| chip.write(PERIPHERALS + offset, value),
    );
    map(
        uc,
        (u64::from(BIT_BAND), 32 * PERIPHERALS_LEN),
        Chip::read_bit,
        |chip, offset, _, value| chip.write_bit(offset, value),
    );
    map(
        uc,
        (SYSTEM_CONTROL, PAGE),
        |chip, offset| chip.core.read(offset),
        Chip::control,
    );
    // Trace and debug: nobody is connected, and nothing answers but what a debugger would find set.
    let ahead = (PRIVATE, SYSTEM_CONTROL - PRIVATE);
    map(uc, ahead, |_, _| 0, |_, _, _, _| ());
    let behind = SYSTEM_CONTROL + PAGE;
    let halted = (HALTED - behind) as u32;
    map(
        uc,
        (behind, PRIVATE + PRIVATE_LEN - behind),
        move |chip, offset| if offset == halted { chip.halted } else { 0 },
        move |chip, offset, _, value| {
            if offset == halted {
                chip.halted = value;
            }
        },
    );
}

/// Has reads (of an offset) and writes (offset, bytes, value) of a span of addresses go to the chip.
fn map(
    uc: &mut Unicorn<'static, Chip>,
    (at, len): (u64, u64),
    read: impl Fn(&mut Chip, u32) -> u32 + 'static,
    write: impl Fn(&mut Chip, u32, u32, u32) + 'static,
) {
    let read = move |uc: &mut Unicorn<'_, Chip>, offset: u64, _| {
        u64::from(read(uc.get_data_mut(), offset as u32))
    };
    let write = move |uc: &mut Unicorn<'_, Chip>, offset: u64, size: usize, value: u64| {
        write(uc.get_data_mut(), offset as u32, size as u32, value as u32);
        flash::erase(uc);
    };
    uc.mmio_map(at, len, Some(read), Some(write))
        .expect("it is free");
}

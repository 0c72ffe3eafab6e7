//! What the image has set up by the time that it listens: pins, clocks, speeds, readings.

use inm_image_test::chip::gpio::{Mode, Pin, Pull};
use inm_image_test::chip::map::ADC_LIMIT_HZ;
use inm_image_test::chip::rcc::Clocks;
use inm_image_test::chip::usart::HOST_BAUD;
use inm_image_test::machine::{Machine, PS_PER_MS, SERIAL, Talk};
use inm_protocol::{Answer, Request, Restart, Settings, ToHost};

/// A pin by its port (0 for A), use and pull.
type Row = (usize, u32, Mode, Pull);

/// The table at the top of firmware/src/board.rs, with functions from table 9 of the data sheet: 5 is SPI1
/// and SPI2, 6 is SPI3, 7 is USART1, 1 is TIM2.
const TABLE: [Row; 19] = [
    (0, 5, Mode::Alternate(5), Pull::None),
    (0, 6, Mode::Alternate(5), Pull::None),
    (0, 7, Mode::Alternate(5), Pull::None),
    (1, 13, Mode::Alternate(5), Pull::None),
    (1, 14, Mode::Alternate(5), Pull::None),
    (1, 15, Mode::Alternate(5), Pull::None),
    (2, 10, Mode::Alternate(6), Pull::None),
    (2, 11, Mode::Alternate(6), Pull::None),
    (2, 12, Mode::Alternate(6), Pull::None),
    (2, 4, Mode::Input, Pull::None),
    (2, 5, Mode::Input, Pull::None),
    (2, 6, Mode::Input, Pull::None),
    (1, 0, Mode::Output, Pull::None),
    (1, 1, Mode::Output, Pull::None),
    (1, 10, Mode::Output, Pull::None),
    (2, 0, Mode::Analog, Pull::None),
    (0, 9, Mode::Alternate(7), Pull::None),
    (0, 10, Mode::Alternate(7), Pull::Up),
    (0, 0, Mode::Alternate(1), Pull::Down),
];

/// As a reset leaves them (RM0090, 8.4.1 and 8.4.4): the debug probe's pins of ports A and B.
const AT_RESET: [Row; 5] = [
    (0, 13, Mode::Alternate(0), Pull::Up),
    (0, 14, Mode::Alternate(0), Pull::Down),
    (0, 15, Mode::Alternate(0), Pull::Up),
    (1, 3, Mode::Alternate(0), Pull::None),
    (1, 4, Mode::Alternate(0), Pull::Up),
];

/// PCLK1 is 42 MHz at most, PCLK2 84 MHz (RM0090, 7.2).
const CLOCKS: Clocks = Clocks {
    hclk: 168_000_000,
    pclk1: 42_000_000,
    pclk2: 84_000_000,
    timclk1: 84_000_000,
};

/// SCLK: 84 MHz / 64 and 42 MHz / 32; the converter's limit is 2.048 MHz.
const SCLK_HZ: u64 = 1_312_500;

/// Nothing that the manual or the converters' sheet forbids.
fn assert_lawful(machine: &Machine) {
    let chip = machine.chip();
    assert!(chip.misuse.is_empty(), "{:?}", chip.misuse);
    assert_eq!(chip.board.bench.violation(), None);
}

#[test]
fn pins_are_those_of_the_table() {
    let machine = Machine::started(true);
    let expected = |port: usize, pin: u32| {
        let mut rows = TABLE.iter().chain(&AT_RESET);
        let row = rows.find(|row| (row.0, row.1) == (port, pin));
        row.map_or((Mode::Input, Pull::None), |row| (row.2, row.3))
    };
    for (port, gpio) in machine.chip().gpio.iter().enumerate() {
        for number in 0..16 {
            let Pin {
                mode,
                pull,
                push_pull,
                ..
            } = gpio.pin(number);
            let name = format!("P{}{number}", ["A", "B", "C"][port]);
            assert_eq!((mode, pull), expected(port, number), "{name}");
            assert!(push_pull, "{name}");
        }
    }
    // SYNC rests high, the sensors are on their 4 g range, self-test is off.
    let levels = [0, 1, 10].map(|pin| machine.chip().gpio[1].driven(pin));
    assert_eq!(levels, [Some(true), Some(false), Some(false)]);
    assert_lawful(&machine);
}

#[test]
fn speeds_follow_from_the_crystal() {
    let mut machine = Machine::started(true);
    assert_speeds(&machine);
    let identity = Talk::default().identify(&mut machine);
    assert_eq!(identity.restart, Restart::Power);
    assert_eq!(identity.platform, "stm32f405");
    assert_eq!(u64::from(identity.timer_hz), CLOCKS.timclk1);
    let place = [SERIAL[2], SERIAL[3], SERIAL[0], SERIAL[1]];
    let place = u32::from_le_bytes(place);
    assert_eq!(identity.serial[0], place, "x, then y on the wafer");
    assert_lawful(&machine);
}

/// Without a crystal the internal oscillator makes the same clocks, and the board says that it does.
#[test]
fn a_board_without_its_crystal_runs_and_says_so() {
    let mut machine = Machine::started(false);
    assert_speeds(&machine);
    let mut talk = Talk::default();
    let identity = talk.identify(&mut machine);
    assert_eq!(identity.restart, Restart::ClockFallback);
    assert_eq!(
        talk.ask(&mut machine, Request::Start),
        Ok(Answer::Settings(Settings::default()))
    );
    machine.run(100 * PS_PER_MS);
    talk.listen(&mut machine);
    let batch = |message: &ToHost| matches!(message, ToHost::Samples(_));
    assert!(talk.heard.iter().any(batch), "it streams");
    assert_eq!(machine.resets, []);
    assert_lawful(&machine);
}

fn assert_speeds(machine: &Machine) {
    let chip = machine.chip();
    assert_eq!(chip.rcc.clocks, CLOCKS);
    // One for each 30 MHz begun, less one (RM0090, table 10).
    assert_eq!(chip.wait_states(), 5);
    assert_eq!([0, 1, 2].map(|axis| chip.sclk_hz(axis)), [SCLK_HZ; 3]);
    assert!(chip.spi.iter().all(|spi| spi.suits()), "mode 0, eight bits");
    let adc_hz = chip.adc.clock_hz(CLOCKS.pclk2);
    assert!(adc_hz <= ADC_LIMIT_HZ, "ADC at {adc_hz} Hz");
    // 84 MHz / 91; receivers bear 2 %, which leaves the internal oscillator its 1 %.
    let baud = chip.usart.baud(CLOCKS.pclk2);
    let off_ppm = baud.abs_diff(HOST_BAUD) * 1_000_000 / HOST_BAUD;
    assert!(off_ppm < 2000, "{baud} bit/s, {off_ppm} ppm off");
}

/// Codes of the chip's converter come out as what they stand for.
#[test]
fn temperature_and_supply_are_read() {
    let mut machine = Machine::started(true);
    let health = Talk::default().health(&mut machine);
    // 30 degC and 33 codes of 80 K / 260: 10.15 K.
    assert_eq!(health.mcu_centi_celsius, Some(3000 + 1015));
    let supply_mv = health.supply_mv.expect("it is measured");
    // Two codes of 3.3 V / 4095, doubled by the divider.
    assert!(supply_mv.abs_diff(2800) <= 4, "{supply_mv} mV");
    assert_lawful(&machine);
}

/// A program that a probe has halted is not to be restarted for it.
#[test]
fn the_watchdog_stands_still_under_a_debugger() {
    /// DBG_IWDG_STOP (RM0090, 38.16.4).
    const WATCHDOG: u32 = 1 << 12;
    let machine = Machine::started(true);
    assert_eq!(machine.chip().halted, WATCHDOG);
    assert_lawful(&machine);
}

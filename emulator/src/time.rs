//! Virtual time in picoseconds, and the converter's clock in it.
//!
//! At fCLK = 4.096 MHz every conversion period is a whole number of picoseconds, so time never
//! drifts against the conversions. Single clocks are not (244140.625 ps); spans of clocks round
//! up.

/// Picoseconds a second.
pub const PS_PER_S: u64 = 1_000_000_000_000;

/// Master clock of the converters, hertz (nominal value, SBAS378D page 11).
pub const CLOCK_HZ: u64 = 4_096_000;

/// Span of `clocks` cycles of fCLK, picoseconds, rounded up.
pub const fn clocks_ps(clocks: u64) -> u64 {
    // PS_PER_S / CLOCK_HZ = 1953125 / 8, exactly.
    (clocks * 1_953_125).div_ceil(8)
}

/// Period of a rate that divides a second into whole picoseconds, as all of the converter's do.
pub const fn period_ps(rate_hz: u32) -> u64 {
    PS_PER_S / rate_hz as u64
}

/// Gap after every command byte and between the bytes of a command: 24/fCLK (SBAS378D page 30).
pub const COMMAND_GAP_PS: u64 = clocks_ps(24);

/// The output register is overwritten this long before DRDY falls: 4/fCLK (SBAS378D page 24).
pub const UPDATE_LEAD_PS: u64 = clocks_ps(4);

/// From power-on to valid operation: 2^16 clocks, 16 ms (family value).
pub const POWER_ON_PS: u64 = clocks_ps(1 << 16);

/// Shortest SCLK period: 2/fCLK (ADS1287 data sheet), rounded down so that 2.048 MHz passes.
pub const SHORTEST_SCLK_PS: u64 = clocks_ps(2) - 1;

/// Shortest low and high time of the SYNC pin: 2/fCLK (ADS1287, ADS1288 data sheets).
pub const SYNC_PULSE_PS: u64 = clocks_ps(2);

/// SCLK low for so many conversions resets the serial interface.
pub const INTERFACE_TIMEOUT_CONVERSIONS: u64 = 64;

/// Conversions lost after SYNC, RESET or a register write (SBAS378D page 21).
pub const SETTLING_CONVERSIONS: u32 = 63;

/// From a restart to the first settled FIR word: 62.98 periods and 468 clocks.
pub const fn settling_ps(period_ps: u64) -> u64 {
    period_ps * 6298 / 100 + clocks_ps(468)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_are_those_of_the_data_sheet() {
        assert_eq!(COMMAND_GAP_PS, 5_859_375);
        assert_eq!(POWER_ON_PS, 16_000_000_000);
        assert_eq!(UPDATE_LEAD_PS, 976_563);
        assert_eq!(SHORTEST_SCLK_PS, 488_281);
        for rate in [250, 500, 1000, 2000, 4000] {
            assert_eq!(period_ps(rate) * u64::from(rate), PS_PER_S);
            assert_eq!(period_ps(32 * rate) * 32, period_ps(rate));
            // 63 readings never come: the first edge lies in the 64th period at every rate.
            assert!(
                settling_ps(period_ps(rate)).div_ceil(period_ps(rate)) == 64,
                "{rate}/s"
            );
        }
    }
}

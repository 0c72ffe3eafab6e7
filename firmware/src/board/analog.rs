//! The chip's own converter: its temperature, and the accelerometers' supply.

use embedded_hal::delay::DelayNs;
use stm32f4xx_hal::adc::config::{AdcConfig, Clock, SampleTime};
use stm32f4xx_hal::adc::{Adc, Temperature};
use stm32f4xx_hal::gpio::{self, PC0};
use stm32f4xx_hal::pac::ADC1;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::signature::{VDDA_CALIB, VtempCal30, VtempCal110};

/// The accelerometers' supply comes through a divider by this.
const SUPPLY_DIVIDER: u16 = 2;

/// Start of temperature sensor and reference, microseconds: 10 at most (STM32F405 data sheet).
const WAKE_UP_US: u32 = 20;

/// PCLK2 of 84 MHz by 4 is 21 MHz. The converter is allowed 36 MHz at most (STM32F405 data sheet,
/// ADC characteristics, fADC at VDDA of 2.4 V and more), which by 2, the default, would exceed.
const CLOCK: Clock = Clock::Pclk2_div_4;

/// ADC1 with its channels.
pub struct Analog {
    adc: Adc<ADC1>,
    supply: PC0<gpio::Analog>,
}

impl Analog {
    /// Powers the converter up and measures VDDA by the chip's reference.
    pub fn start(
        adc: ADC1,
        supply: PC0<gpio::Analog>,
        mut delay: impl DelayNs,
        rcc: &mut Rcc,
    ) -> Self {
        let config = AdcConfig::default()
            .clock(CLOCK)
            .default_sample_time(SampleTime::Cycles_480);
        let mut adc = Adc::new(adc, true, config, rcc);
        adc.enable_temperature_and_vref();
        delay.delay_us(WAKE_UP_US);
        // Again, now that the reference is awake.
        adc.calibrate();
        Self { adc, supply }
    }

    /// Temperature of the chip by its two factory calibration points, 0.01 degC; `None` on a
    /// chip without them.
    pub fn temperature_centi_celsius(&mut self) -> Option<i16> {
        let sample = u32::from(self.adc.convert(&Temperature, SampleTime::Cycles_480));
        // The calibration was made at 3.3 V.
        let sample = (sample * self.adc.reference_voltage() / VDDA_CALIB) as i32;
        let cold = i32::from(VtempCal30::get().read());
        let hot = i32::from(VtempCal110::get().read());
        let centi = (8000 * (sample - cold)).checked_div(hot - cold)?;
        i16::try_from(3000 + centi).ok()
    }

    /// Supply of the accelerometers, millivolts.
    pub fn supply_mv(&mut self) -> u16 {
        let sample = self.adc.convert(&self.supply, SampleTime::Cycles_480);
        SUPPLY_DIVIDER.saturating_mul(self.adc.sample_to_millivolts(sample))
    }
}

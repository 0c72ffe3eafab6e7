//! What the board keeps in its flash is read as it was written: the cache in between is emptied.

use inm_image_test::machine::{Machine, Talk};
use inm_protocol::{Answer, Request, SensorCalibration, SensorRange};

fn calibration(gravity_um_s2: u32) -> SensorCalibration {
    SensorCalibration {
        range: SensorRange::G4,
        unix_s: 1_795_435_200,
        centi_celsius: None,
        gravity_um_s2,
        positions: 12,
        rows: [1_366_000_000, 0, 1_380_000_000, 0, 0, 1_350_000_000],
        row_deviations: [2000; 6],
        zero: [-1_234_567, 890_123, 45],
        zero_deviations: [110, 120, 130],
    }
}

/// Asked before and after: each sector is read, erased, written and read again. Without the emptied cache the model notes
/// each word that is read.
#[test]
fn a_calibration_is_read_back_past_the_data_cache() {
    let mut machine = Machine::started(true);
    let mut talk = Talk::default();
    let mut kept = None;
    for gravity_um_s2 in [9_815_000, 9_780_000, 9_832_000] {
        let read = Request::ReadSensorCalibration(SensorRange::G4);
        let found = talk.ask(&mut machine, read);
        assert_eq!(found, Ok(Answer::SensorCalibration(kept)));
        let new = calibration(gravity_um_s2);
        let done = talk.ask(&mut machine, Request::WriteSensorCalibration(new));
        assert_eq!(done, Ok(Answer::Done));
        kept = Some(new);
    }
    assert_eq!(machine.resets, []);
    assert_eq!(machine.chip().misuse, Default::default());
}

//! The calibration of the accelerometers by command: kept, told, forgotten, refused; and their range.

mod rig;

use inm_firmware::emulated::VirtualFlash;
use inm_firmware::keep::WORDS;
use inm_protocol::{
    Answer, Command, MAX_FRAME, Refusal, Request, SensorCalibration, SensorRange, ToBoard, encode,
};
use rig::{OFFSETS, Rig, bench};

/// Every number as long as it gets on the wire.
fn longest(range: SensorRange) -> SensorCalibration {
    SensorCalibration {
        range,
        unix_s: i64::MIN,
        centi_celsius: Some(i16::MIN),
        gravity_um_s2: u32::MAX,
        positions: u16::MAX,
        rows: [i32::MAX; 6],
        row_deviations: [u32::MAX; 6],
        zero: [i32::MIN; 3],
        zero_deviations: [u32::MAX; 3],
    }
}

#[test]
fn a_calibration_is_told_as_it_was_given_in_any_state() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::new(&bench);
    let read = Request::ReadSensorCalibration(SensorRange::G12);
    assert_eq!(rig.ask(read), Ok(Answer::SensorCalibration(None)));
    let given = longest(SensorRange::G12);
    let write = Request::WriteSensorCalibration(given);
    let mut frame = [0; MAX_FRAME];
    let command = Command {
        id: u16::MAX,
        request: write,
    };
    let len = encode(&ToBoard::Command(command), &mut frame).expect("fits");
    rig.send_as(u16::MAX, write);
    rig.run_until(1000, "a reply to the longest command", |rig| {
        rig.replies.last().is_some_and(|(id, _)| *id == u16::MAX)
    });
    assert_eq!(
        rig.replies.last(),
        Some(&(u16::MAX, Ok(Answer::Done))),
        "{len} bytes"
    );
    rig.start();
    assert_eq!(rig.ask(read), Ok(Answer::SensorCalibration(Some(given))));
    let other = Request::ReadSensorCalibration(SensorRange::G4);
    assert_eq!(rig.ask(other), Ok(Answer::SensorCalibration(None)));
    rig.proven();
}

#[test]
fn what_is_kept_changes_at_rest_only_and_is_sound() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::new(&bench);
    let range = SensorRange::G4;
    let given = longest(range);
    let write = Request::WriteSensorCalibration(given);
    assert_eq!(rig.ask(write), Ok(Answer::Done));
    let changes = [
        write,
        Request::EraseSensorCalibration(range),
        Request::SelectRange(SensorRange::G12),
    ];
    rig.start();
    for request in changes {
        assert_eq!(rig.ask(request), Err(Refusal::Streaming), "{request:?}");
    }
    rig.ask(Request::Stop).expect("stop");
    for unsound in [
        SensorCalibration {
            gravity_um_s2: 0,
            ..given
        },
        SensorCalibration {
            rows: [1, 0, 0, 0, 0, 1],
            ..given
        },
        SensorCalibration {
            rows: [1, 0, 1, 0, 0, -1],
            ..given
        },
    ] {
        let write = Request::WriteSensorCalibration(unsound);
        assert_eq!(rig.ask(write), Err(Refusal::Unsound), "{unsound:?}");
    }
    let read = Request::ReadSensorCalibration(range);
    assert_eq!(rig.ask(read), Ok(Answer::SensorCalibration(Some(given))));
    assert_eq!(
        rig.ask(Request::EraseSensorCalibration(range)),
        Ok(Answer::Done)
    );
    assert_eq!(rig.ask(read), Ok(Answer::SensorCalibration(None)));
}

#[test]
fn flash_that_cannot_be_written_is_told_and_the_old_is_kept() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::new(&bench);
    let old = longest(SensorRange::G4);
    let new = SensorCalibration {
        positions: 12,
        ..old
    };
    assert_eq!(
        rig.ask(Request::WriteSensorCalibration(old)),
        Ok(Answer::Done)
    );
    let flash: &mut VirtualFlash = rig.instrument.platform_mut().flash_mut();
    // It dies in the middle of the words, behind the erase.
    *flash = flash.clone().cut_after(Some(WORDS as u32 + 20));
    let refused = rig.ask(Request::WriteSensorCalibration(new));
    assert_eq!(refused, Err(Refusal::NotKept));
    let read = rig.ask(Request::ReadSensorCalibration(SensorRange::G4));
    assert_eq!(read, Ok(Answer::SensorCalibration(Some(old))));
}

#[test]
fn a_range_is_selected_and_told() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::new(&bench);
    for range in [SensorRange::G12, SensorRange::G4, SensorRange::G12] {
        assert_eq!(rig.ask(Request::SelectRange(range)), Ok(Answer::Done));
        assert_eq!(rig.link().range(), range);
        let Ok(Answer::Identity(identity)) = rig.ask(Request::Identify) else {
            panic!("no identity");
        };
        assert_eq!(identity.range, range);
    }
}

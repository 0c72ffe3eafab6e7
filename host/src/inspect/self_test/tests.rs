use inm_protocol::{Restart, SensorRange, Settings, Trouble};

use super::*;

fn identity() -> Identity {
    Identity {
        serial: [1, 2, 3],
        firmware: heapless_text("1.0.0"),
        platform: heapless_text("virtual"),
        timer_hz: 1_000_000,
        converter_clock_hz: 4_096_000,
        baud: 921_600,
        range: SensorRange::G4,
        reference_uv: 5_000_000,
        sensor_supply_uv: 2_800_000,
        converters: [Some(0); AXES],
        settings: Settings::default(),
        restart: Restart::Power,
    }
}

fn heapless_text<T: for<'a> TryFrom<&'a str>>(text: &str) -> T {
    T::try_from(text).ok().expect("short")
}

fn failed(checks: &[Check]) -> Vec<(&'static str, Option<&'static str>)> {
    let failed = checks
        .iter()
        .filter(|check| check.verdict == Verdict::Failed);
    failed.map(|check| (check.name, check.axis)).collect()
}

/// A g of the 4 g range is 2.646e8 of the word (`firmware/src/mma7331l.rs`).
const CODE_PER_G: f64 = 2.646e8;

fn steps(rest_g: [f64; AXES], driven_g: [f64; AXES]) -> [SelfTestStep; AXES] {
    std::array::from_fn(|axis| SelfTestStep {
        rest: (rest_g[axis] * CODE_PER_G) as i32,
        driven: (driven_g[axis] * CODE_PER_G) as i32,
    })
}

#[test]
fn a_step_is_judged_by_its_axis_and_only_that_of_z_by_its_sign() {
    let board = identity();
    let sound = measured(&board, &steps([0.1, -0.1, 1.0], [0.0, 0.0, 2.0]));
    assert!(failed(&sound).is_empty(), "{sound:?}");
    let wrong = measured(&board, &steps([0.0; 3], [0.04, 0.9, -1.0]));
    let axes = [
        ("step", Some("X")),
        ("step", Some("Y")),
        ("step", Some("Z")),
    ];
    assert_eq!(failed(&wrong), axes);
}

#[test]
fn an_output_at_rest_that_no_position_gives_fails() {
    let board = identity();
    // 1 g and the zero-g error of 84 mV at 308 mV/g are 1.273 g in plane, 1.455 g across.
    let sound = measured(&board, &steps([1.26, -1.26, 1.44], [1.36, -1.36, 2.44]));
    assert!(failed(&sound).is_empty(), "{sound:?}");
    let wrong = measured(&board, &steps([1.29, -1.29, 1.47], [1.39, -1.39, 2.47]));
    let axes = [
        ("rest", Some("X")),
        ("rest", Some("Y")),
        ("rest", Some("Z")),
    ];
    assert_eq!(failed(&wrong), axes);
}

#[test]
fn a_converter_that_does_not_answer_fails_and_leaves_the_others_open() {
    let refusal = Refusal::Converter {
        axis: 1,
        trouble: Trouble::Stalled,
    };
    let error = LinkError::Refused {
        port: "port".to_owned(),
        request: Box::new(Request::SelfTest),
        refusal,
    };
    let checks = not_measured(&identity(), refusal, &error);
    assert_eq!(failed(&checks), [("step", Some("Y")), ("rest", Some("Y"))]);
    assert!(checks[1].remark.contains("DRDY stopped"), "{checks:?}");
    let open = checks
        .iter()
        .filter(|check| check.verdict == Verdict::Open && check.value.is_none());
    assert_eq!(open.count(), 4, "{checks:?}");
}

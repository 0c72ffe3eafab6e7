//! Logs that say their unit, or do not, and columns that are no axes.

use super::log::{Log, rows};

fn named(names: &str) -> String {
    format!("{names}\n{}", rows(|_, x, y| format!("{x:.6},{y:.6}\n")))
}

pub fn logs() -> Vec<Log> {
    let mut all = said_or_not();
    all.extend(no_axes());
    all
}

fn said_or_not() -> Vec<Log> {
    let unsaid = |what, unit, say| Log {
        unit,
        refused: Some(("nothing says which unit column ax is in; give --unit", say)),
        ..Log::new(what, "--rate 100", named("ax,ay"))
    };
    let said = |what, unit, names| Log {
        unit,
        news: "as its name says",
        ..Log::new(what, "--rate 100", named(names))
    };
    vec![
        unsaid("no unit", "g", "--rate 100 --unit g"),
        unsaid(
            "a gyroscope without a unit",
            "deg/s",
            "--rate 100 --unit deg/s",
        ),
        said("degrees a second", "deg/s", "gx_dps,gy_dps"),
        said("brackets", "m/s^2", "accel_x (m/s^2),accel_y (m/s²)"),
        Log {
            worth: 1e-3,
            ..said("thousandths", "g", "ax_mg,ay [mg]")
        },
        Log {
            unit: "deg/s",
            refused: Some(("column gx_dps says deg/s, --unit says g", "--rate 100")),
            ..Log::new(
                "another unit",
                "--rate 100 --unit g",
                named("gx_dps,gy_dps"),
            )
        },
        Log {
            unit: "m/s^2",
            worth: 9.80665,
            refused: Some((
                "give --unit of the scaled data",
                "--rate 100 --scale 9.80665 --unit m/s^2",
            )),
            ..Log::new("scaled", "--rate 100 --scale 9.80665", named("ax_g,ay_g"))
        },
    ]
}

fn no_axes() -> Vec<Log> {
    let counted = || {
        format!(
            ",ax_g,ay_g\n{}",
            rows(|n, x, y| format!("{n},{x:.6},{y:.6}\n"))
        )
    };
    let timed = |header: &str| {
        let rows = rows(|n, x, y| format!("{:.2},{x:.6},{y:.6}\n", 0.01 * n as f64));
        format!("{header}{rows}")
    };
    vec![
        Log {
            refused: Some((
                "rises as a time or a counter does",
                "--rate 100 --columns 1,2",
            )),
            ..Log::new("the index of a data frame", "--rate 100", counted())
        },
        Log {
            refused: Some((
                "column time is named as a time, and nothing says what it is; give --time 0",
                "--time 0",
            )),
            ..Log::new(
                "a time that was not declared",
                "--rate 100",
                timed("time,ax_g,ay_g\n"),
            )
        },
        Log {
            refused: Some((
                "column 0 rises as a time or a counter does",
                "--time 0 --unit g",
            )),
            ..Log::new("a time without a name", "--rate 100 --unit g", timed(""))
        },
    ]
}

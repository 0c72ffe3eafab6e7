//! Logs whose time is in any unit, jitters, or comes in bursts.

use super::log::{Log, ROWS, stamped};

fn all(_: usize) -> bool {
    true
}

fn whole(header: &str, step: u64, from: u64) -> String {
    stamped(header, all, |index| {
        (from + step * index as u64).to_string()
    })
}

fn seconds(header: &str) -> String {
    stamped(header, all, |index| format!("{:.3}", 0.01 * index as f64))
}

/// Stamps that are right, in units that are said or not.
pub fn units() -> Vec<Log> {
    let mut all = small();
    all.extend(large());
    all
}

fn small() -> Vec<Log> {
    vec![
        Log {
            news: "column time is the time in s, as nothing says otherwise",
            ..Log::new("seconds", "--time time", seconds("time,ax_g,ay_g"))
        },
        Log {
            news: "column millis is the time in ms, as its name says",
            ..Log::new(
                "Arduino millis",
                "--time millis",
                whole("millis,ax_g,ay_g", 10, 4711),
            )
        },
        Log::new(
            "a unit in brackets",
            "--time 0",
            whole("t [ms],ax_g,ay_g", 10, 0),
        ),
        Log {
            refused: Some((
                "say the unit: --time t:ms (100/s), or --time t:s (0.1/s)",
                "--time t:ms",
            )),
            ..Log::new(
                "milliseconds without a word",
                "--time t",
                whole("t,ax_g,ay_g", 10, 0),
            )
        },
        Log {
            refused: Some(("--time t:us (100/s)", "--time t:us")),
            ..Log::new(
                "microseconds without a word",
                "--time t",
                whole("t,ax_g,ay_g", 10_000, 0),
            )
        },
    ]
}

fn large() -> Vec<Log> {
    vec![
        Log {
            rate_within: 1e-6,
            unit: "m/s^2",
            ..Log::new(
                "rostopic echo -p",
                "--time %time --columns 1,2 --unit m/s^2",
                whole(
                    "%time,field.linear_acceleration.x,field.linear_acceleration.y",
                    10_000_000,
                    1_700_000_000_123_456_789,
                ),
            )
        },
        Log {
            rate_within: 1e-6,
            ..Log::new(
                "nanoseconds",
                "--time stamp_ns",
                whole("stamp_ns,ax_g,ay_g", 10_000_000, 0),
            )
        },
        Log {
            rate_within: 1e-6,
            ..Log::new(
                "seconds since 1970",
                "--time timestamp",
                stamped("timestamp,ax_g,ay_g", all, |index| {
                    format!("{:.6}", 1_700_000_000.0 + 0.01 * index as f64)
                }),
            )
        },
        Log {
            news: "began again",
            ..Log::new(
                "Arduino micros over its end",
                "--time micros",
                stamped("micros,ax_g,ay_g", all, |index| {
                    ((4_294_967_296 - 7_000_000 + 10_000 * index as u64) % 4_294_967_296)
                        .to_string()
                }),
            )
        },
        Log {
            refused: Some((
                "contradicts the time stamps, which give 100/s",
                "--time time",
            )),
            ..Log::new(
                "another rate",
                "--time time --rate 2000",
                seconds("time,ax_g,ay_g"),
            )
        },
        Log {
            rate_hz: 101.0,
            news: "the time stamps give 100/s; taken is --rate 101",
            ..Log::new(
                "a rate that is nearly so",
                "--time time --rate 101",
                seconds("time,ax_g,ay_g"),
            )
        },
    ]
}

/// Between 0 and 1, by multiplication: the same on every machine.
fn chance(index: usize) -> f64 {
    let mixed = (index as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mixed = (mixed ^ (mixed >> 31)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (mixed >> 11) as f64 / (1_u64 << 53) as f64
}

fn even(index: usize) -> f64 {
    0.01 * index as f64
}

fn jittered(index: usize) -> f64 {
    0.01 * (index as f64 + 0.8 * chance(index))
}

/// Read ten at a time, and stamped then.
fn fifo(index: usize) -> f64 {
    0.01 * (index / 10 * 10 + 10) as f64
}

/// Read 32 at a time, when the computer comes to it.
fn late(index: usize) -> f64 {
    0.01 * (index / 32 * 32 + 32) as f64 + 0.01 * chance(index / 32)
}

/// All but `count` samples from index `from` on.
fn lacks(from: usize, count: usize) -> impl Fn(usize) -> bool {
    move |index| !(from..from + count).contains(&index)
}

fn log(what: &'static str, kept: &dyn Fn(usize) -> bool, stamp: &dyn Fn(usize) -> f64) -> Log {
    let text = stamped("time,ax_g,ay_g", kept, |index| {
        format!("{:.6}", stamp(index))
    });
    let samples = (0..ROWS).filter(|&index| kept(index)).count();
    Log {
        rate_within: 2e-5,
        samples,
        ..Log::new(what, "--time time", text)
    }
}

/// Stamps that are late, and samples that are not there.
pub fn jitter() -> Vec<Log> {
    let mut all = delays();
    all.extend(counts());
    all
}

fn delays() -> Vec<Log> {
    // A driver that counts on by a tenth of a millisecond within a burst.
    let counted = |index: usize| fifo(index) + 1e-4 * (index % 10) as f64;
    // Busy for a fifth of a second now and then.
    let stalls = |index: usize| {
        even(if index % 700 < 20 {
            index / 700 * 700 + 20
        } else {
            index
        })
    };
    vec![
        log("jitter", &all, &jittered),
        Log {
            lost: 1,
            gaps: 1,
            ..log("jitter and one lost", &lacks(1234, 1), &jittered)
        },
        log("a FIFO of ten", &all, &fifo),
        log("a FIFO of ten, counted on", &all, &counted),
        Log {
            lost: 20,
            gaps: 1,
            ..log("a FIFO that ran over", &lacks(2000, 20), &fifo)
        },
        Log {
            rate_within: 2e-4,
            ..log("a FIFO of 32, read late", &all, &late)
        },
        Log {
            rate_within: 2e-4,
            lost: 64,
            gaps: 1,
            ..log(
                "a FIFO of 32, read late, that ran over",
                &lacks(1600, 64),
                &late,
            )
        },
        Log {
            rate_within: 1e-4,
            ..log("stalls", &all, &stalls)
        },
        Log {
            lost: 300,
            gaps: 1,
            ..log("a real gap", &lacks(1000, 300), &even)
        },
        Log {
            lost: ROWS / 100,
            gaps: ROWS / 100,
            ..log("every hundredth lost", &|index| index % 100 != 50, &even)
        },
    ]
}

fn counts() -> Vec<Log> {
    vec![
        Log {
            rate_hz: 999.3,
            rate_within: 1.5 / ROWS as f64,
            say: "--time millis",
            text: stamped("millis,ax_g,ay_g", all, |index| {
                ((index as f64 / 0.9993).floor() as u64).to_string()
            }),
            ..log("milliseconds at a thousand a second", &all, &even)
        },
        {
            let text = log("", &all, &even).text;
            let twice = text.lines().nth(2000).expect("a row").to_owned() + "\n";
            Log {
                text: text.replacen(&twice, &twice.repeat(2), 1),
                samples: ROWS + 1,
                refused: Some((
                    "there are more rows than their time stamps have room for",
                    "--columns 1,2 --rate 100",
                )),
                ..log("a row that is there twice", &all, &even)
            }
        },
    ]
}

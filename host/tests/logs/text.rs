//! Logs in the many ways to write a table as text.

use super::log::{Log, ROWS, rows};

/// `0,012` for 0.012.
fn comma(value: f64) -> String {
    format!("{value:.6}").replace('.', ",")
}

fn seconds(index: usize) -> String {
    format!("{:.2}", 0.01 * index as f64)
}

pub fn logs() -> Vec<Log> {
    let mut all = shapes();
    all.extend(headers());
    all.extend(damaged());
    all
}

fn shapes() -> Vec<Log> {
    let pair = |x: f64, y: f64| format!("{x:.6},{y:.6}\n");
    let single = |what, say, text| Log {
        axes: 1,
        ..Log::new(what, say, text)
    };
    let near_one = || rows(|_, x, _| format!("{:.3}\n", 0.5 + x).replace('.', ","));
    vec![
        Log::new(
            "decimal commas and semicolons",
            "--time t",
            format!(
                "t;ax_g;ay_g\n{}",
                rows(|n, x, y| {
                    format!("{};{};{}\n", comma(0.01 * n as f64), comma(x), comma(y))
                })
            ),
        ),
        single(
            "one column of decimal commas",
            "--rate 100 --unit g",
            rows(|_, x, _| comma(x) + "\n"),
        ),
        Log {
            // Three digits.
            refused: Some((
                "give --decimal comma, or --decimal point",
                "--rate 100 --unit g --decimal comma",
            )),
            ..single(
                "decimal commas or two columns",
                "--rate 100 --unit g",
                near_one(),
            )
        },
        Log::new(
            "a byte order mark, and lines as Windows ends them",
            "--rate 100",
            format!(
                "\u{feff}ax_g,ay_g\r\n{}",
                rows(|_, x, y| pair(x, y).replace('\n', "\r\n"))
            ),
        ),
        Log::new(
            "numpy.savetxt",
            "--time 0 --unit g",
            rows(|n, x, y| format!("{:.18e} {x:.18e} {y:.18e}\n", 0.01 * n as f64)),
        ),
        Log::new(
            "tabs",
            "--time t",
            format!(
                "t\tax_g\tay_g\n{}",
                rows(|n, x, y| format!("{}\t{x:.6}\t{y:.6}\n", seconds(n)))
            ),
        ),
        Log::new(
            "a separator behind every row",
            "--rate 100",
            format!(
                "ax_g,ay_g,\n{}",
                rows(|_, x, y| format!("{x:.6},{y:.6},\n"))
            ),
        ),
    ]
}

fn headers() -> Vec<Log> {
    let timed = |header: &str| {
        format!(
            "{header}\n{}",
            rows(|n, x, y| format!("{},{x:.6},{y:.6}\n", seconds(n)))
        )
    };
    vec![
        Log::new(
            "numpy.savetxt with a header",
            "--time t",
            format!(
                "# t ax_g ay_g\n{}",
                rows(|n, x, y| format!("{} {x:e} {y:e}\n", seconds(n)))
            ),
        ),
        Log::new(
            "savetxt with commas",
            "--time t",
            timed("# bench 3\n# t,ax_g,ay_g"),
        ),
        Log::new(
            "quoted names",
            "--time t",
            timed("\"t\",\"a, x (g)\",\"ay_g\""),
        ),
        Log::new("units below the names", "--time t", timed("t,ax,ay\ns,g,g")),
        Log::new(
            "lines ahead",
            "--time t",
            timed("Logger 3\nSerial: 17\n\nt,ax_g,ay_g"),
        ),
        Log::new(
            "a comment of MATLAB",
            "--time t",
            timed("% made today\nt,ax_g,ay_g"),
        ),
        Log::new(
            "a column of words",
            "--time t --columns ax_g,ay_g",
            format!(
                "t,sensor,ax_g,ay_g\n{}",
                rows(|n, x, y| { format!("{},\"left, IMU\",{x:.6},{y:.6}\n", seconds(n)) })
            ),
        ),
    ]
}

fn damaged() -> Vec<Log> {
    let timed = |line: &dyn Fn(usize, String) -> String| {
        let rows = rows(|n, x, y| line(n, format!("{},{x:.6},{y:.6}\n", seconds(n))));
        format!("t,ax_g,ay_g\n{rows}")
    };
    let cut = timed(&|_, row| row);
    vec![
        Log {
            samples: ROWS - 1,
            news: "line 9001 is cut off by the end of the file and left out",
            text: cut[..cut.len() - 12].to_owned(),
            ..Log::new("a last line that is cut off", "--time t", String::new())
        },
        Log {
            samples: ROWS - 1,
            news: "line 9001 is cut off",
            text: cut[..cut.len() - 4].to_owned(),
            ..Log::new("a last number that is cut off", "--time t", String::new())
        },
        Log {
            text: cut.trim_end().to_owned(),
            ..Log::new(
                "no line end behind the last line",
                "--time t",
                String::new(),
            )
        },
        Log::new(
            "empty lines",
            "--time t",
            timed(&|n, row| if n % 50 == 0 { row + "\n" } else { row }),
        ),
        Log {
            invalid: 4,
            ..Log::new(
                "words for no number",
                "--time t",
                timed(&|n, row| match n {
                    100 => format!("{},NaN,nan\n", seconds(n)),
                    200 => format!("{},,-nan\n", seconds(n)),
                    300 => format!("{},1.#QNAN,NULL\n", seconds(n)),
                    400 => format!("{},inf,#N/A\n", seconds(n)),
                    _ => row,
                }),
            )
        },
    ]
}

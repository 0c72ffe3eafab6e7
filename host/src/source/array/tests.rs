//! Columns, stamps and cuts of small files.

use super::super::options::Selector;
use super::super::text::TextTable;
use super::*;
use crate::signal::Unit;

fn open(text: &str, options: &ArrayOptions) -> Result<ArraySource, SourceError> {
    let open = || {
        let table = TextTable::open(
            "t.csv",
            Box::new(std::io::Cursor::new(text.to_owned())),
            options.decimal,
        )?;
        Ok(Box::new(table) as Box<dyn Table>)
    };
    ArraySource::new(&open, options)
}

fn drain(mut source: ArraySource) -> Result<Vec<Chunk>, SourceError> {
    let mut chunks = Vec::new();
    while let Some(chunk) = source.next_chunk()? {
        chunks.push(chunk);
    }
    Ok(chunks)
}

/// What a file without a word about itself needs.
fn said() -> ArrayOptions {
    ArrayOptions {
        rate_hz: Some(10.0),
        unit: Some(Unit::Gravity),
        ..Default::default()
    }
}

#[test]
fn stamps_give_rate_and_gaps() {
    let options = ArrayOptions {
        time: Some("t:s".parse().expect("a column")),
        ..Default::default()
    };
    let rows = |stamps: &[f64]| {
        let rows = stamps
            .iter()
            .map(|stamp| format!("{stamp},{}\n", stamp.sin()));
        format!("t,x_g\n{}", rows.collect::<String>())
    };
    let mut stamps: Vec<f64> = (0..40).map(|row| 0.5 * f64::from(row)).collect();
    let source = open(&rows(&stamps), &options).expect("good file");
    assert_eq!(source.signal().rate_hz, 2.0);
    assert_eq!(source.signal().axes[0].name, "x_g");
    assert_eq!(source.signal().axes[0].unit, Unit::Gravity);
    stamps.drain(30..32);
    let source = open(&rows(&stamps), &options).expect("good file");
    assert_eq!(source.expected_len(), Some(40));
    let chunks = drain(source).expect("good stamps");
    let [
        Chunk::News(unit),
        Chunk::Samples(one),
        Chunk::Gap(gap),
        Chunk::Samples(two),
    ] = &chunks[..]
    else {
        panic!("{chunks:?}");
    };
    assert_eq!(unit, "column x_g is in g, as its name says");
    assert_eq!((one.first, one.len(), two.first, two.len()), (0, 30, 32, 8));
    assert_eq!((gap.from, gap.to), (30, Some(32)));

    let error = open("t,x_g\n0,1\n0.5,2\n1,3\n0.9,4\n", &options).map(|_| ());
    let error = error.expect_err("time runs backwards").to_string();
    assert!(
        error.starts_with("t.csv:5: time 0.9 lies before 1 in the row before"),
        "{error}"
    );
}

#[test]
fn what_nobody_called_an_axis_and_rises_is_none() {
    let mut text = String::from("n,x,y\n");
    for row in 0..50 {
        text += &format!("{row},{},{}\n", row * 7 % 5, row * 3 % 7);
    }
    let error = open(&text, &said()).map(|_| ()).expect_err("a counter");
    let message = "t.csv: column n rises as a time or a counter does, and nothing says what it is; \
                   give --time 0, or choose the axes with --columns 1,2";
    assert_eq!(error.to_string(), message);
    let columns = ["1", "2"]
        .map(|one| one.parse().expect("a column"))
        .to_vec();
    let options = ArrayOptions { columns, ..said() };
    assert_eq!(
        open(&text, &options)
            .expect("as it said")
            .signal()
            .axes
            .len(),
        2
    );
    let named = open("time,x\n1,2\n1,3\n", &said()).map(|_| ());
    let named = named.expect_err("named as a time").to_string();
    assert!(named.contains("column time is named as a time"), "{named}");
}

#[test]
fn a_unit_is_known_or_asked_for() {
    let read = |text: &str, options: &ArrayOptions| {
        let source = open(text, options)?;
        let axes = source.signal().axes.iter();
        Ok::<_, SourceError>(axes.map(|axis| (axis.unit, axis.scale)).collect::<Vec<_>>())
    };
    let silent = ArrayOptions {
        unit: None,
        ..said()
    };
    let both = read("ax_g,gx (deg/s)\n1,2\n2,1\n", &silent).expect("the names say it");
    assert_eq!(both, [(Unit::Gravity, 1.0), (Unit::DegreePerSecond, 1.0)]);
    let scaled = ArrayOptions {
        scales: vec![2.0],
        ..silent.clone()
    };
    let remedied = ArrayOptions {
        unit: Some(Unit::Volt),
        ..scaled.clone()
    };
    for (text, options, message) in [
        (
            "1 2\n2 1\n",
            &silent,
            "nothing says which unit column 0 is in; give --unit",
        ),
        (
            "a_dps\n1\n2\n",
            &said(),
            "column a_dps says deg/s, --unit says g",
        ),
        ("a_dps\n1\n2\n", &scaled, "give --unit of the scaled data"),
    ] {
        let error = read(text, options).expect_err(message).to_string();
        assert!(error.contains(message), "{error}");
        let all = read(text, &remedied).expect("both said");
        assert!(all.iter().all(|one| *one == (Unit::Volt, 2.0)), "{all:?}");
    }
}

#[test]
fn cuts_and_marks() {
    let options = ArrayOptions {
        from_s: Some(0.1),
        to_s: Some(0.5),
        ..said()
    };
    let source = open("0\n1\nnan\nnan\n4\n5\n", &options).expect("good file");
    let chunks = drain(source).expect("good rows");
    let [Chunk::Samples(block)] = &chunks[..] else {
        panic!("{chunks:?}")
    };
    assert_eq!((block.first, block.len()), (1, 4));
    assert_eq!(block.columns[0].invalid, [1..3]);
}

#[test]
fn refuses_what_it_cannot_know() {
    let rate = said();
    let check = |options: &ArrayOptions, message: &str| {
        let error = open("1 2\n3 4\n", options).map(|_| ()).expect_err(message);
        assert!(error.to_string().contains(message), "{error}");
    };
    let no_rate = ArrayOptions {
        rate_hz: None,
        ..said()
    };
    check(&no_rate, "give --rate HZ");
    check(
        &ArrayOptions {
            columns: vec![Selector::Number(2)],
            ..rate.clone()
        },
        "there is no column `2`; the columns are 0 to 1",
    );
    check(
        &ArrayOptions {
            scales: vec![1.0; 3],
            ..rate.clone()
        },
        "3 scales for 2 columns",
    );
    check(
        &ArrayOptions {
            scales: vec![0.0],
            ..rate.clone()
        },
        "a scale of 0",
    );
    check(
        &ArrayOptions {
            from_s: Some(3.0),
            to_s: Some(2.0),
            ..rate
        },
        "--from and --to",
    );
}

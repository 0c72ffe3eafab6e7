//! Text as programs write it, row by row.

use super::*;

fn table(text: &'static str) -> Result<TextTable, SourceError> {
    TextTable::open("t.csv", Box::new(text.as_bytes()), None)
}

fn values(columns: Vec<Values>) -> Vec<Vec<f64>> {
    columns
        .into_iter()
        .map(|column| match column {
            Values::Floats(floats) => floats,
            Values::Codes(codes) => codes.into_iter().map(f64::from).collect(),
        })
        .collect()
}

#[test]
fn header_comments_and_separators() {
    for text in [
        "# made by hand\n\"t\", x ,y\n0,1,2 # first\n\n1,3,-4e1\n",
        "t;x;y\r\n0;1;2\r\n1;3;-40\r\n",
        "\u{feff}t x\ty\n 0 1   2\n1 3 -40",
    ] {
        let mut table = table(text).expect("good text");
        assert_eq!(
            table.header(),
            Some(&["t".to_owned(), "x".into(), "y".into()][..])
        );
        table.select(&[2, 1]).expect("columns exist");
        assert_eq!(values(table.read(1).expect("row")), [[2.0], [1.0]]);
        assert_eq!(values(table.read(9).expect("row")), [[-40.0], [3.0]]);
        assert_eq!(values(table.read(9).expect("end")), [[0.0; 0], []]);
    }
}

#[test]
fn missing_values_and_no_header() {
    let mut table = table("1,2\n,nan\n").expect("good text");
    assert_eq!(table.header(), None);
    let columns = values(table.read(9).expect("rows"));
    assert_eq!(columns[0][0], 1.0);
    assert!(columns[0][1].is_nan() && columns[1][1].is_nan());
}

#[test]
fn errors_name_line_and_column() {
    let read = |text| {
        let mut table = table(text)?;
        table.read(100)
    };
    for (text, message) in [
        ("", "t.csv: the file holds no row of numbers"),
        ("a,b\n", "no row of numbers"),
        (
            "1.0,2\n3,x4\n",
            "t.csv:2: `x4` in column 1 where a number was expected",
        ),
        ("1.5,oops\n", "t.csv:1: `oops` in column 1"),
        (
            "1 2\n3\n",
            "t.csv:2: 1 columns, where the lines before have 2",
        ),
    ] {
        let error = read(text).expect_err(text);
        assert!(error.to_string().contains(message), "{error}");
    }
}

type NamesAndColumns = (Option<Vec<String>>, Vec<Vec<f64>>);

/// Names and columns of a text.
fn read(text: &'static str) -> Result<NamesAndColumns, SourceError> {
    let mut table = table(text)?;
    let columns = values(table.read(1000)?);
    Ok((table.header().map(<[String]>::to_vec), columns))
}

#[test]
fn decimal_commas_are_read_with_any_other_separator() {
    for text in [
        "a;b\n0,5;-1,25\n1;2,5e-1\n",
        "a\tb\n0,5\t-1,25\n1\t2,5e-1\n",
        "a b\n0,5  -1,25\n1,0 2,5e-1\n",
    ] {
        let (names, columns) = read(text).expect("decimal commas");
        assert_eq!(names, Some(vec!["a".to_owned(), "b".into()]));
        assert_eq!(columns, [[0.5, 1.0], [-1.25, 0.25]], "{text}");
    }
}

#[test]
fn one_column_of_decimal_commas_is_no_pair_of_columns() {
    for text in ["0,123\n0,045\n", "-0,1\n0,2\n", "ax_g\n0,1\n0,2\n"] {
        assert_eq!(read(text).expect("one column").1.len(), 1, "{text}");
    }
    for text in ["12,7\n3,104\n", "1,-2\n3,4\n", "a,b\n1,2\n3,4\n"] {
        assert_eq!(read(text).expect("two columns").1.len(), 2, "{text}");
    }
    let error = read("9,81\n9,80\n").expect_err("either").to_string();
    assert!(
        error.contains("give --decimal comma, or --decimal point"),
        "{error}"
    );
    let forced = TextTable::open(
        "t.csv",
        Box::new("9,81\n9,80\n".as_bytes()),
        Some(Decimal::Comma),
    );
    let columns = values(forced.expect("told").read(9).expect("rows"));
    assert_eq!(columns, [[9.81, 9.8]]);
    let error = read("a,b\n0,00,9,81\n0,01,9,80\n").expect_err("commas everywhere");
    assert!(error.to_string().contains("another separator"), "{error}");
}

#[test]
fn names_are_found_in_comments_quotes_and_above_units() {
    for (text, names) in [
        ("# t,ax\n0,1\n1,2\n", ["t", "ax"]),
        ("# made by hand\n# t ax\n0 1\n1 2\n", ["t", "ax"]),
        ("\"t, s\",\"ax\"\n0,1\n1,2\n", ["t, s", "ax"]),
        ("t,ax\ns,m/s^2\n0,1\n1,2\n", ["t [s]", "ax [m/s^2]"]),
        ("Logger 3\nSerial: 17\n\nt,ax\n0,1\n1,2\n", ["t", "ax"]),
        ("t,ax,\n0,1,\n1,2,\n", ["t", "ax"]),
        ("t,ax\n0,1,\n1,2,\n", ["t", "ax"]),
    ] {
        let (found, columns) = read(text).expect(text);
        assert_eq!(
            found.as_deref(),
            Some(&names.map(str::to_owned)[..]),
            "{text}"
        );
        assert_eq!(columns, [[0.0, 1.0], [1.0, 2.0]], "{text}");
    }
}

#[test]
fn a_last_line_that_is_cut_off_is_left_out_and_said() {
    for (text, rows) in [
        ("0.11,0.12\n0.21,0.22\n0.31", 2),
        ("0.11,0.12\n0.21,0.22\n0.31,0.3", 2),
        ("0.11,0.12\n0.21,0.22\n0.31,-", 2),
        ("0.11,0.12\n0.21,0.22\n0.31,0.32", 3),
    ] {
        let mut table = table(text).expect("text");
        assert_eq!(table.read(99).expect("rows")[0].len(), rows, "{text}");
        let said = "line 3 is cut off by the end of the file and left out";
        let notes = table.notes();
        assert_eq!(
            notes,
            if rows == 2 {
                vec![said.to_owned()]
            } else {
                vec![]
            }
        );
    }
}

#[test]
fn words_for_nothing_are_missing_values() {
    let (_, columns) = read("1,2\nNaN,nan\n,#N/A\n1.#QNAN,-nan\nNULL,None\n").expect("words");
    for column in columns {
        assert!(column[1..].iter().all(|value| value.is_nan()), "{column:?}");
    }
}

/// Found by `cargo xtask fuzz text`: it was a row of no cells.
#[test]
fn a_comment_behind_blanks_is_no_row() {
    let (_, columns) = read("1.5,2\n\t# why\n3,4\n").expect("two rows");
    assert_eq!(columns[0], [1.5, 3.0]);
    assert!(table("\n10ad1UU.2\n)\n\t#0\n").is_err());
}

#[test]
fn a_carriage_return_within_a_line_hides_no_row() {
    // Line ends of old computers, and one that went astray: each row but the first was lost.
    for (text, line) in [
        ("1.5,2\r3.5,4\r5.5,6\r", 1),
        ("1.5,2\n3.5,4\r5.5,6\n7.5,8\n", 2),
    ] {
        let error = table(text).map(|_| ()).expect_err("refused").to_string();
        let place = format!("t.csv:{line}: a carriage return within a line");
        assert!(error.starts_with(&place), "{error}");
    }
    let mut table = table("1.5,2\r\r\n3.5,4\r\r\n").expect("two of them at an end hide nothing");
    assert_eq!(
        values(table.read(9).expect("rows")),
        [[1.5, 3.5], [2.0, 4.0]]
    );
}

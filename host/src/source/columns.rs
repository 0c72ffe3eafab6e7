//! Which columns of a table are axes, which is the time, and in which unit they are.

use super::npy::MOST_COLUMNS;
use super::options::{ArrayOptions, Selector};
use super::table::Table;
use super::{SourceError, Values, header};
use crate::signal::{Axis, SCALE, Unit};

/// Steps upwards from which a column that does not fall is no noise: one that rises at every other
/// step by chance would do so in one record of 256.
const RISES: usize = 8;

/// Rises for each fall that a counter has at least: one of eight bits starts again after 256.
const RISES_A_FALL: usize = 64;

/// The number of the column that `selector` means.
///
/// # Errors
/// If there is none.
pub fn find(table: &dyn Table, selector: &Selector) -> Result<usize, SourceError> {
    let wanted = selector.to_string();
    let by_name = table.header().and_then(|names| {
        let mut same = names.iter();
        same.position(|name| *name == wanted)
            .or_else(|| names.iter().position(|name| header::bare(name) == wanted))
    });
    let by_number = match selector {
        Selector::Number(number) if *number < table.width() => Some(*number),
        _ => None,
    };
    by_name.or(by_number).ok_or_else(|| SourceError {
        place: table.name().to_owned(),
        message: format!("there is no column `{selector}`"),
        remedy: match table.header() {
            Some(names) => format!("the columns are {}", names.join(", ")),
            None if table.width() == 1 => "the only column is 0".into(),
            None => format!("the columns are 0 to {}", table.width() - 1),
        },
    })
}

/// The columns that are axes.
///
/// # Errors
/// If there is none, or what could be one is named as a time.
pub fn choose(
    table: &dyn Table,
    time: Option<usize>,
    options: &ArrayOptions,
) -> Result<Vec<usize>, SourceError> {
    if !options.columns.is_empty() {
        let columns = options.columns.iter();
        return columns.map(|column| find(table, column)).collect();
    }
    let columns: Vec<usize> = (0..table.width())
        .filter(|&one| Some(one) != time)
        .collect();
    let is_time = |&&column: &&usize| {
        let name = table.header().map(|names| names[column].as_str());
        name.is_some_and(header::is_time)
    };
    if let Some(&undeclared) = columns.iter().find(is_time) {
        let others = columns.iter().copied().filter(|column| !is_time(&column));
        return Err(undeclared_time(
            table,
            undeclared,
            &others.collect::<Vec<_>>(),
            "is named as a time",
        ));
    }
    if columns.is_empty() {
        return Err(SourceError {
            place: table.name().to_owned(),
            message: "no column is left for an axis".into(),
            remedy: "choose one with --columns".into(),
        });
    }
    if columns.len() > MOST_COLUMNS {
        return Err(SourceError {
            place: table.name().to_owned(),
            message: format!(
                "{} columns; expected one column per axis, {MOST_COLUMNS} at most",
                columns.len()
            ),
            remedy: "choose the axes with --columns, or transpose the table".into(),
        });
    }
    Ok(columns)
}

/// Looks at the first rows of `columns`, of which nobody said that they are axes.
///
/// # Errors
/// If one rises as a time or a counter does.
pub fn check(table: &dyn Table, columns: &[usize], first: &[Values]) -> Result<(), SourceError> {
    let rises = |at: usize| first.get(at).is_some_and(rises);
    match (0..columns.len()).find(|&at| rises(at)) {
        Some(at) if table.width() > 1 => {
            let others = (0..columns.len()).filter(|&one| !rises(one));
            let others: Vec<usize> = others.map(|one| columns[one]).collect();
            Err(undeclared_time(
                table,
                columns[at],
                &others,
                "rises as a time or a counter does",
            ))
        }
        _ => Ok(()),
    }
}

/// Whether values do little but rise.
fn rises(values: &Values) -> bool {
    let count = |rising: &dyn Fn(usize) -> bool| (1..values.len()).filter(|&at| rising(at)).count();
    let (up, down) = match values {
        Values::Codes(codes) => (
            count(&|at| codes[at] > codes[at - 1]),
            count(&|at| codes[at] < codes[at - 1]),
        ),
        Values::Floats(floats) => (
            count(&|at| floats[at] > floats[at - 1]),
            count(&|at| floats[at] < floats[at - 1]),
        ),
    };
    up >= RISES && down * RISES_A_FALL <= up
}

fn undeclared_time(table: &dyn Table, column: usize, others: &[usize], why: &str) -> SourceError {
    let name = |column: usize| {
        let named = table.header().map(|names| names[column].clone());
        named
            .filter(|name| !name.is_empty())
            .unwrap_or_else(|| column.to_string())
    };
    let others: Vec<String> = others.iter().map(ToString::to_string).collect();
    let others = if others.is_empty() {
        "C,...".to_owned()
    } else {
        others.join(",")
    };
    SourceError {
        place: table.name().to_owned(),
        message: format!("column {} {why}, and nothing says what it is", name(column)),
        remedy: format!("give --time {column}, or choose the axes with --columns {others}"),
    }
}

/// The axes in `columns`, and what their names said of them, in words.
///
/// # Errors
/// If the unit of one is not known, or the scales do not fit.
pub fn axes(
    table: &dyn Table,
    columns: &[usize],
    options: &ArrayOptions,
) -> Result<(Vec<Axis>, Vec<String>), SourceError> {
    check_scales(table, columns.len(), options)?;
    let names: Vec<String> = columns
        .iter()
        .map(|&column| match table.header() {
            Some(names) if !names[column].is_empty() => names[column].clone(),
            _ => column.to_string(),
        })
        .collect();
    let mut notes = Vec::new();
    let mut axes = Vec::new();
    for (axis, name) in names.iter().enumerate() {
        let scale = options.scales.get(axis).or(options.scales.first()).copied();
        let (unit, scale) = unit(table, name, scale, options.unit)?;
        if options.unit.is_none() {
            let worth = if scale == 1.0 {
                String::new()
            } else {
                format!("{scale} ")
            };
            notes.push(format!(
                "column {name} is in {worth}{unit}, as its name says"
            ));
        }
        axes.push(Axis {
            name: header::bare(name).to_owned(),
            unit,
            scale,
            zero: 0.0,
            chain: options.chain.clone(),
        });
    }
    Ok((axes, notes))
}

/// Unit and scale of the column `name`.
fn unit(
    table: &dyn Table,
    name: &str,
    scale: Option<f64>,
    given: Option<Unit>,
) -> Result<(Unit, f64), SourceError> {
    let bad = |message: String, remedy: &str| SourceError {
        place: table.name().to_owned(),
        message,
        remedy: remedy.to_owned(),
    };
    match (given, scale, header::unit(name)) {
        (Some(unit), Some(scale), _) => Ok((unit, scale)),
        (Some(unit), None, None) => Ok((unit, 1.0)),
        (Some(unit), None, Some((said, worth))) if said == unit => Ok((unit, worth)),
        (Some(unit), None, Some((said, _))) => Err(bad(
            format!("column {name} says {said}, --unit says {unit}"),
            "leave --unit out, or give --scale UNIT_PER_NUMBER too if the numbers are in another unit",
        )),
        (None, None, Some(said)) => Ok(said),
        (None, Some(_), Some((said, _))) => Err(bad(
            format!("column {name} says {said}, and --scale makes something else of it"),
            "give --unit of the scaled data too",
        )),
        (None, _, None) if table.is_integer() => Err(bad(
            "the data are integers and nothing says what a count is worth".into(),
            "give --scale UNIT_PER_COUNT and --unit, or --unit counts",
        )),
        (None, _, None) => Err(bad(
            format!("nothing says which unit column {name} is in"),
            "give --unit m/s^2, g, rad/s, deg/s, V or counts, or choose other columns with --columns",
        )),
    }
}

fn check_scales(
    table: &dyn Table,
    columns: usize,
    options: &ArrayOptions,
) -> Result<(), SourceError> {
    let bad = |message: String, remedy: &str| SourceError {
        place: table.name().to_owned(),
        message,
        remedy: remedy.to_owned(),
    };
    if options.scales.len() > 1 && options.scales.len() != columns {
        return Err(bad(
            format!("{} scales for {columns} columns", options.scales.len()),
            "give --scale once, or once for each column",
        ));
    }
    let is_one = |scale: &&f64| SCALE.contains(&scale.abs());
    match options.scales.iter().find(|scale| !is_one(scale)) {
        Some(scale) => Err(bad(
            format!("a scale of {scale:?}"),
            "a scale is a number of size 1e-30 to 1e30",
        )),
        None => Ok(()),
    }
}

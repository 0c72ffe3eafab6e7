//! The numbers of a finding as they are listed: one by one, and as rows where the same happened several times.

use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::value::Value;
use crate::model::effect::Parameter;

/// Numbers of rows that are listed one by one, with their intervals; more are a table without them, which JSON has.
const FEW: usize = 8;

/// Rows of a table, at most: a choice, a third of a screen.
const MOST_ROWS: usize = 8;

/// Values of a column that stands by itself, at most: a choice, some lines.
const MOST_IN_LINES: usize = 48;

/// The numbers of a finding.
pub struct Numbers {
    /// Those that stand for themselves.
    pub alone: Vec<(Parameter, Value)>,
    /// Those of what happened several times, where they are more than [`FEW`].
    pub rows: Option<Rows>,
}

/// What happened several times.
pub struct Rows {
    /// A parameter of each column.
    pub columns: Vec<Parameter>,
    /// Values by row and column, the first rows of all; `None` where one is not known, as of a multiple that was not found.
    pub values: Vec<Vec<Option<Value>>>,
    /// How many rows are not among them.
    pub more: usize,
}

impl Numbers {
    /// What is known of an effect, in the catalogue's order.
    pub fn of(estimate: &Estimate) -> Self {
        let of_rows = estimate.known().filter(|(one, _)| one.row.is_some());
        if of_rows.count() <= FEW {
            let alone = estimate.known().collect();
            return Self { alone, rows: None };
        }
        let (rows, alone) = estimate.known().partition(|(one, _)| one.row.is_some());
        let rows = Some(Rows::of(rows));
        Self { alone, rows }
    }
}

impl Rows {
    fn of(numbers: Vec<(Parameter, Value)>) -> Self {
        let mut columns: Vec<Parameter> = Vec::new();
        let mut values: Vec<Vec<Option<Value>>> = Vec::new();
        for (parameter, value) in numbers {
            let is_own = |column: &Parameter| column.stem() == parameter.stem();
            let column = columns.iter().position(is_own).unwrap_or(columns.len());
            let number = parameter.row.unwrap_or(1);
            values.resize(values.len().max(number), Vec::new());
            let row = &mut values[number - 1];
            row.resize(row.len().max(column + 1), None);
            row[column] = Some(value);
            if column == columns.len() {
                columns.push(parameter);
            }
        }
        // One column takes a line or two.
        let most = if columns.len() > 1 {
            MOST_ROWS
        } else {
            MOST_IN_LINES
        };
        let more = values.len().saturating_sub(most);
        values.truncate(most);
        values
            .iter_mut()
            .for_each(|row| row.resize(columns.len(), None));
        Self {
            columns,
            values,
            more,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::kind::Kind;
    use crate::model::{drift, hum, motion, steps};

    fn of(kind: Kind, values: &[f64]) -> Numbers {
        let known = |value: &f64| Value::told(*value);
        Numbers::of(&Estimate::new(kind, values.iter().map(known)))
    }

    #[test]
    fn what_happened_a_few_times_is_listed_number_by_number() {
        let numbers = of(steps::KIND, &[1.0, 2.0, 30.0, 4.0]);
        let names: Vec<&str> = numbers.alone.iter().map(|one| &*one.0.name).collect();
        assert_eq!(names, ["time_s_1", "height_1", "time_s_2", "height_2"]);
        assert!(numbers.rows.is_none());
    }

    #[test]
    fn what_happened_more_often_is_a_table_by_number() {
        // Eleven rows: by name the tenth comes before the second.
        let values: Vec<f64> = (0..22).map(f64::from).collect();
        let rows = of(steps::KIND, &values).rows.expect("rows");
        assert_eq!(rows.columns[1].stem(), "height");
        let plain = |row: &Vec<Option<Value>>| row[0].map(|one| one.value);
        let times: Vec<Option<f64>> = rows.values.iter().map(plain).collect();
        let expected: Vec<Option<f64>> = (0..MOST_ROWS).map(|row| Some(2.0 * row as f64)).collect();
        assert_eq!(times, expected);
        assert_eq!(rows.more, 11 - MOST_ROWS);
    }

    #[test]
    fn a_column_by_itself_is_listed_as_far_as_it_is_long() {
        let values: Vec<f64> = (0..34).map(f64::from).collect();
        let numbers = of(drift::KIND, &values);
        assert_eq!(numbers.alone[0].0.name, "duration_s");
        let rows = numbers.rows.expect("rows");
        assert_eq!(
            (rows.columns.len(), rows.values.len(), rows.more),
            (1, 33, 0)
        );
    }

    #[test]
    fn a_multiple_that_was_not_found_keeps_its_place() {
        let mut values = vec![Some(Value::told(1.0)); hum::KIND.parameters(&[1.0; 15]).len()];
        let frequency = hum::KIND.parameters(&[1.0; 15]);
        let second = frequency.iter().position(|one| one.row == Some(2));
        values[second.expect("a second multiple")] = None;
        let kind = hum::KIND;
        let rows = Numbers::of(&Estimate { kind, values }).rows.expect("rows");
        let known: Vec<bool> = rows.values.iter().map(|row| row[0].is_some()).collect();
        assert_eq!(known[..3], [true, false, true]);
    }

    #[test]
    fn what_is_not_known_leaves_its_place_empty() {
        let one = motion::KIND.parameters(&[]).len();
        let mut values = vec![Some(Value::told(1.0)); 3 * one];
        values[one + 2] = None;
        let kind = motion::KIND;
        let rows = Numbers::of(&Estimate { kind, values }).rows.expect("rows");
        assert_eq!(rows.columns.len(), one);
        let empty = |row: &Vec<Option<Value>>| row.iter().filter(|one| one.is_none()).count();
        let empty: Vec<usize> = rows.values.iter().map(empty).collect();
        assert_eq!(empty, [0, 1, 0]);
    }
}

//! The sealed truth about a record: kept in memory, never written beside it unless asked.

/// One effect that is in the record.
#[derive(Debug, Clone, PartialEq)]
pub struct Truth {
    /// Its name in the report; for what lies outside the catalogue a name of its own.
    pub effect: &'static str,
    /// Its parameters by the names of the report. Hertz and seconds where the name says so, the
    /// rest in m/s^2 or dimensionless.
    pub parameters: Vec<(String, f64)>,
}

impl Truth {
    /// An effect with these parameters.
    pub fn new(effect: &'static str, parameters: &[(&str, f64)]) -> Self {
        let parameters = parameters
            .iter()
            .map(|&(name, value)| (name.to_owned(), value))
            .collect();
        Self { effect, parameters }
    }

    /// The parameter of this name.
    pub fn parameter(&self, name: &str) -> Option<f64> {
        let found = self.parameters.iter().find(|(known, _)| known == name)?;
        Some(found.1)
    }
}

//! Text that stays in one place of the terminal.

use std::io;

use console::Term;

use crate::plain::shown;

/// A block of lines that is drawn over itself; where the output is not a terminal, one line
/// now and then.
#[derive(Debug)]
pub struct Lines {
    term: Term,
    drawn: usize,
}

impl Lines {
    /// Lines on standard error, so that results can be piped.
    pub fn stderr() -> Self {
        Self {
            term: Term::stderr(),
            drawn: 0,
        }
    }

    /// Whether it is a terminal; else it is a log.
    pub fn is_term(&self) -> bool {
        self.term.is_term()
    }

    /// Shows `text` in the place of what was shown before. In a log only its second line
    /// (the progress) appears.
    ///
    /// # Errors
    /// What the terminal says.
    pub fn show(&mut self, text: &str) -> io::Result<()> {
        let text = &*shown(text);
        if !self.term.is_term() {
            return self.term.write_line(text.lines().nth(1).unwrap_or(text));
        }
        let (rows, columns) = self.term.size();
        // A block taller than the terminal cannot be drawn over; its end matters least.
        let lines: Vec<String> = text
            .lines()
            .take(usize::from(rows).saturating_sub(1))
            .map(|line| line.chars().take(usize::from(columns)).collect())
            .collect();
        self.term.clear_last_lines(self.drawn)?;
        self.drawn = lines.len();
        self.term.write_line(&lines.join("\n"))
    }
}

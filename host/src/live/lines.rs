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
    /// What a log was told last: where it is recorded, and how far.
    told: [String; 2],
}

impl Lines {
    /// Lines on standard error, so that results can be piped.
    pub fn stderr() -> Self {
        Self {
            term: Term::stderr(),
            drawn: 0,
            told: Default::default(),
        }
    }

    /// Whether it is a terminal; else it is a log.
    pub fn is_term(&self) -> bool {
        self.term.is_term()
    }

    /// Shows `text` in the place of what was shown before. In a log only its first two lines appear, each as
    /// it changes: where it is recorded, and how far.
    ///
    /// # Errors
    /// What the terminal says.
    pub fn show(&mut self, text: &str) -> io::Result<()> {
        let text = &*shown(text);
        if !self.term.is_term() {
            for (told, line) in self.told.iter_mut().zip(text.lines()) {
                if told != line {
                    line.clone_into(told);
                    self.term.write_line(line)?;
                }
            }
            return Ok(());
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

//! Who turns the block, and what they are told.

use std::io::{BufRead, stdin};

use anyhow::bail;

use super::tell;
use crate::virtual_board::VirtualConnect;
use crate::virtual_board::cube::Cube;
use crate::virtual_board::hand::Hand;
use crate::virtual_board::turned::Truth;
use inm_emulator::sensor::Coefficients;

/// Which axes point up (1) or down (-1): faces, then edges, then corners. Opposite ones follow each other.
const PLACES: [[i8; 3]; 26] = [
    [0, 0, 1],
    [0, 0, -1],
    [1, 0, 0],
    [-1, 0, 0],
    [0, 1, 0],
    [0, -1, 0],
    [1, 1, 0],
    [-1, -1, 0],
    [0, 1, 1],
    [0, -1, -1],
    [1, 0, 1],
    [-1, 0, -1],
    [1, -1, 0],
    [-1, 1, 0],
    [0, 1, -1],
    [0, -1, 1],
    [1, 0, -1],
    [-1, 0, 1],
    [1, 1, 1],
    [-1, -1, -1],
    [1, 1, -1],
    [-1, -1, 1],
    [1, -1, 1],
    [-1, 1, -1],
    [-1, 1, 1],
    [1, -1, -1],
];

/// What a virtual board lies on.
#[derive(Debug, Clone, Copy)]
pub enum Lies {
    /// A block that is neither level nor square.
    Anyhow,
    /// A cube whose faces are off level by so much, a standard deviation in two directions, rad.
    OnCube {
        /// The standard deviation.
        tilt_rad: f64,
    },
}

/// Leads through a session.
pub struct Guide {
    hand: Option<Hand>,
    positions: usize,
}

impl Guide {
    /// A person turns the block, and says by a line when it lies still.
    pub fn of_a_person(positions: usize) -> Self {
        Self {
            hand: None,
            positions,
        }
    }

    /// A board without hardware with sensors drawn from the seed, and a hand that turns it.
    ///
    /// # Errors
    /// If the sensors cannot be made.
    pub fn on_virtual(
        positions: usize,
        lies: Lies,
        gravity_m_s2: f64,
        seed: u64,
    ) -> anyhow::Result<(Self, VirtualConnect)> {
        let truth = Truth::draw(Coefficients::PUBLISHED, seed);
        let board = VirtualConnect::published(seed, 0.0);
        let (connect, block) = board.turning(&truth, seed)?;
        let hand = match lies {
            Lies::Anyhow => block.hand(positions, gravity_m_s2, seed),
            Lies::OnCube { tilt_rad } => Cube::draw(tilt_rad, seed).hand(&block, gravity_m_s2),
        };
        let hand = Some(hand);
        Ok((Self { hand, positions }, connect))
    }

    /// Has the block put into the next position, of which so many are done.
    ///
    /// # Errors
    /// If nobody is there any more.
    pub fn next(&mut self, done: usize) -> anyhow::Result<()> {
        let wanted = PLACES.get(done).map_or_else(
            || "in any way that is new".to_owned(),
            |place| format!("for instance with {}", words(*place)),
        );
        self.put(done, &format!("lay the block down {wanted}"))
    }

    /// Has a face of the cube put up, of which so many are done; any other new one will do.
    ///
    /// # Errors
    /// If nobody is there any more.
    pub fn next_face(&mut self, done: usize, wanted: &str) -> anyhow::Result<()> {
        self.put(done, &format!("lay the cube down with {wanted}"))
    }

    /// Says which face was up, where it is another than was asked for.
    pub fn taken(&self, face: &str, wanted: &str) {
        if self.hand.is_none() && face != wanted {
            tell(&format!(
                "{face}, and not {wanted} as asked: it counts as {face}"
            ));
        }
    }

    fn put(&mut self, done: usize, how: &str) -> anyhow::Result<()> {
        let number = done + 1;
        if let Some(hand) = &mut self.hand {
            if !hand.turn() {
                bail!("the virtual board's block has no further position");
            }
            return Ok(());
        }
        tell(&format!(
            "position {number} of {}: {how}, let go, press Enter",
            self.positions
        ));
        let mut line = String::new();
        if stdin().lock().read_line(&mut line)? == 0 {
            bail!(
                "the input ended ahead of position {number} of {}; the board keeps what it kept before",
                self.positions
            );
        }
        Ok(())
    }

    /// Says why a position does not count.
    ///
    /// # Errors
    /// If nobody can put the block otherwise.
    pub fn again(&self, why: &str) -> anyhow::Result<()> {
        if self.hand.is_some() {
            bail!("{why}");
        }
        tell(&format!("{why}: it does not count"));
        Ok(())
    }
}

/// A place in words.
fn words(place: [i8; 3]) -> String {
    let named = ['X', 'Y', 'Z'].into_iter().zip(place);
    let parts = named.filter(|(_, way)| *way != 0).map(|(axis, way)| {
        let way = if way > 0 { "up" } else { "down" };
        format!("{axis} {way}")
    });
    parts.collect::<Vec<_>>().join(", ")
}

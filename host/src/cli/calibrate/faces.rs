//! The six faces of a cube, read one after the other in whatever order they come.

use crate::calibrate::{FACES, Face, Position};
use crate::inspect::gravity::Readings;
use crate::source::SourceError;

use super::guide::Guide;

/// Reads a position on each face; one on none, or on a face that was there, is asked for again.
///
/// # Errors
/// What the board says, or nobody is there any more.
pub(super) fn read(
    seconds: f64,
    readings: &mut Readings<'_>,
    guide: &mut Guide,
) -> anyhow::Result<Vec<(Face, Position)>> {
    let mut read: Vec<(Face, Position)> = Vec::new();
    let mut quiet = None;
    while read.len() < FACES {
        let there = |face: &Face| read.iter().position(|(other, _)| other == face);
        let wanted = Face::ALL.into_iter().find(|face| there(face).is_none());
        let wanted = wanted.map_or_else(String::new, |face| face.to_string());
        guide.next_face(read.len(), &wanted)?;
        let stretch = readings.stretch(seconds).map_err(SourceError::from)?;
        let position = match stretch.position(quiet) {
            Ok(position) => position,
            Err(unsteady) => {
                guide.again(&unsteady.to_string())?;
                continue;
            }
        };
        let face = match Face::of(&position) {
            Ok(face) => face,
            Err(none) => {
                guide.again(&none.to_string())?;
                continue;
            }
        };
        if let Some(before) = there(&face) {
            guide.again(&format!(
                "this is {face} once more, as in position {}",
                before + 1
            ))?;
            continue;
        }
        guide.taken(&face.to_string(), &wanted);
        quiet.get_or_insert(stretch.scatter());
        read.push((face, position));
    }
    Ok(read)
}

//! Names at places along the horizontal axis, in rows so that none lies on another.

use super::legend::text_width;

/// Size of the text.
pub const FONT: f64 = 10.5;

/// Rows at most; what does not fit in them stays without a name.
const ROWS: usize = 4;

/// Space between two names.
const APART: f64 = 8.0;

/// A name at a place.
#[derive(Debug, Clone, PartialEq)]
pub struct Tag {
    /// Where the name belongs, pixels.
    pub at: f64,
    /// The name.
    pub text: String,
}

/// Where a name goes.
#[derive(Debug, Clone, PartialEq)]
pub struct Placed {
    /// The name.
    pub tag: Tag,
    /// Left end of its text, pixels.
    pub left: f64,
    /// Its row, from 0.
    pub row: usize,
}

/// Places names between the pixels `from` and `to`, those that come first in the list first.
pub fn place(tags: &[Tag], from: f64, to: f64) -> Vec<Placed> {
    let mut rows: Vec<Vec<(f64, f64)>> = vec![Vec::new(); ROWS];
    let mut placed = Vec::new();
    for tag in tags {
        let width = text_width(&tag.text, FONT);
        // Beside its place, on the side where there is room.
        let right = tag.at + 4.0;
        let left = if right + width < to {
            right
        } else {
            tag.at - 4.0 - width
        };
        if left < from {
            continue;
        }
        let (begin, end) = (left - APART, left + width + APART);
        let free = |row: &Vec<(f64, f64)>| row.iter().all(|&(a, b)| end < a || begin > b);
        if let Some(row) = rows.iter().position(free) {
            rows[row].push((left, left + width));
            placed.push(Placed {
                tag: tag.clone(),
                left,
                row,
            });
        }
    }
    placed
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_do_not_lie_on_one_another() {
        let tag = |at: f64| Tag {
            at,
            text: "sinusoid 50 Hz".into(),
        };
        let tags: Vec<Tag> = [100.0, 110.0, 640.0, 120.0, 130.0, 140.0].map(tag).to_vec();
        let placed = place(&tags, 64.0, 742.0);
        // Four rows, so one of the five that lie together finds no place.
        assert_eq!(placed.len(), 5);
        for (one, other) in placed.iter().zip(&placed[1..]) {
            let width = text_width(&one.tag.text, FONT);
            let apart = one.left + width <= other.left || other.left + width <= one.left;
            assert!(one.row != other.row || apart, "{one:?} lies on {other:?}");
        }
        assert!(place(&[tag(740.0)], 64.0, 742.0)[0].left < 740.0);
    }
}

//! Bridges over gaps for the line searches.
//!
//! A line is as narrow as the record is long, so its searches cannot stop at every lost sample.
//! They bridge a gap by a straight line between its ends, which leaves no step to leak; the
//! samples are counted, and the noise level is taken from the bridged record itself.

/// Longest bridge handed on at once, samples.
const PIECE: u64 = 4096;

/// Turns blocks with gaps into one sequence without.
#[derive(Debug, Clone, Default)]
pub(super) struct Filler {
    /// Index that is due and the value before it, once there is one.
    last: Option<(u64, f64)>,
    piece: Vec<f64>,
}

/// A piece of the sequence.
pub(super) enum Piece<'a> {
    /// Measured values.
    Measured(&'a [f64]),
    /// Values put in their place.
    Bridge(&'a [f64]),
    /// A gap too long to bridge: what follows starts anew at this index.
    Break(u64),
}

impl Filler {
    /// Hands `values` on, from absolute index `first`, with bridges over what is missing before
    /// and within them if that is at most `longest` samples. Indices that went back are ignored.
    pub(super) fn push(
        &mut self,
        first: u64,
        values: &[f64],
        longest: u64,
        emit: &mut impl FnMut(Piece<'_>),
    ) {
        let mut at = first;
        let mut rest = values;
        while !rest.is_empty() {
            let bad = rest.iter().take_while(|x| !x.is_finite()).count();
            at += bad as u64;
            rest = &rest[bad..];
            let good = rest.iter().take_while(|x| x.is_finite()).count();
            if good == 0 {
                continue;
            }
            let (run, tail) = rest.split_at(good);
            self.run(at, run, longest, emit);
            at += good as u64;
            rest = tail;
        }
    }

    fn run(&mut self, first: u64, run: &[f64], longest: u64, emit: &mut impl FnMut(Piece<'_>)) {
        match self.last {
            Some((due, _)) if first < due => return,
            Some((due, before)) if first > due && first - due <= longest => {
                self.bridge(before, run[0], first - due, emit);
            }
            Some((due, _)) if first == due => {}
            _ => emit(Piece::Break(first)),
        }
        emit(Piece::Measured(run));
        self.last = Some((first + run.len() as u64, run[run.len() - 1]));
    }

    fn bridge(&mut self, from: f64, to: f64, missing: u64, emit: &mut impl FnMut(Piece<'_>)) {
        let step = (to - from) / (missing + 1) as f64;
        let mut done = 0;
        while done < missing {
            let end = (done + PIECE).min(missing);
            self.piece.clear();
            self.piece
                .extend((done..end).map(|n| from + step * (n + 1) as f64));
            emit(Piece::Bridge(&self.piece));
            done = end;
        }
    }
}

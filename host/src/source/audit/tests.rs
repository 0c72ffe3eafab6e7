use inm_protocol::{BATCH_LEN, BinsMark, Code, Flag, Flags};

use super::*;

/// A board that fills batches, and its bins.
struct Board {
    bins: ProofBins,
    seq: u32,
    next: u64,
}

impl Board {
    fn new() -> Self {
        Self {
            bins: ProofBins::new(),
            seq: 0,
            next: 0,
        }
    }

    fn batch(&mut self, flagged: Option<u8>) -> Batch {
        let mut batch = Batch {
            seq: self.seq,
            first: self.next,
            ..Batch::default()
        };
        for conversion in 0..BATCH_LEN as u8 {
            let codes = [3, 5, 7].map(|k| Code((self.next as i32 + 1).wrapping_mul(k << 20)));
            let mut flags = [Flags::NONE; AXES];
            if flagged == Some(conversion) {
                flags[1] = Flags::TORN;
                let flags = flags[1];
                let flag = Flag {
                    conversion,
                    axis: 1,
                    flags,
                };
                batch.flags.push(flag).expect("room");
            }
            self.bins.conversion(self.next, &codes, &flags);
            batch.codes.push(codes).expect("room");
            self.next += 1;
        }
        self.seq += 1;
        batch
    }

    fn health(&mut self) -> Health {
        Health {
            bins: self.bins.mark(self.next),
            ..Health::default()
        }
    }
}

/// Batches from the board to the audit; what was reported.
fn pass(board: &mut Board, audit: &mut Audit, count: usize) -> Vec<State> {
    let told = (0..count).filter_map(|_| audit.batch(&board.batch(None), 0));
    told.collect()
}

#[test]
fn a_sound_stream_is_proven_and_nothing_is_told() {
    let (mut board, mut audit) = (Board::new(), Audit::default());
    assert_eq!(
        audit.health(&board.health()),
        None,
        "nothing to compare yet"
    );
    for second in 1..40 {
        assert_eq!(pass(&mut board, &mut audit, 10), []);
        // A flagged word, and a gap that both sides see.
        assert_eq!(audit.batch(&board.batch(Some(9)), 0), None);
        board.next += 63;
        assert_eq!(pass(&mut board, &mut audit, 1), []);
        assert_eq!(audit.health(&board.health()), None);
        let index = second * (12 * 32 + 63);
        let state = State::Proven { epoch: 0, index };
        let proven = index;
        let proof = Proof {
            state,
            proven,
            ..Proof::default()
        };
        assert_eq!(audit.proof(), proof);
        assert!(!audit.wants_new_beginning());
    }
}

#[test]
fn a_lost_batch_breaks_the_proof_until_the_board_begins_anew() {
    let (mut board, mut audit) = (Board::new(), Audit::default());
    pass(&mut board, &mut audit, 5);
    audit.health(&board.health());
    board.batch(None);
    let lost = State::Lost { index: 160 };
    assert_eq!(pass(&mut board, &mut audit, 3), [lost]);
    assert!(audit.wants_new_beginning());
    assert_eq!(audit.health(&board.health()), None);
    assert_eq!(audit.proof().state, lost);

    // In the middle of a batch.
    let epoch = board.next + 70;
    board.bins.begin(epoch);
    let waiting = State::Waiting { epoch };
    assert_eq!(audit.begins_anew(epoch), Some(waiting));
    assert!(!audit.wants_new_beginning());
    // A loss ahead of it does not matter.
    board.batch(None);
    assert_eq!(pass(&mut board, &mut audit, 4), []);
    let proven = State::Proven {
        epoch,
        index: board.next,
    };
    assert_eq!(audit.health(&board.health()), Some(proven));
    let proof = Proof {
        state: proven,
        breaks: 1,
        disagreements: 0,
        proven: 160 + board.next - epoch,
    };
    assert_eq!(audit.proof(), proof);
}

#[test]
fn a_lost_batch_ahead_of_a_health_record_shows_in_it() {
    let (mut board, mut audit) = (Board::new(), Audit::default());
    pass(&mut board, &mut audit, 5);
    board.batch(None);
    let lost = State::Lost { index: 160 };
    assert_eq!(audit.health(&board.health()), Some(lost));
    assert_eq!(pass(&mut board, &mut audit, 5), [], "told once");
    assert_eq!(audit.proof().breaks, 1);
}

#[test]
fn a_beginning_that_was_missed_is_asked_for_again() {
    for late in [false, true] {
        let (mut board, mut audit) = (Board::new(), Audit::default());
        pass(&mut board, &mut audit, 5);
        board.batch(None);
        pass(&mut board, &mut audit, 1);
        let epoch = board.next + 10;
        board.bins.begin(epoch);
        if late {
            pass(&mut board, &mut audit, 1);
            audit.begins_anew(epoch);
        } else {
            audit.begins_anew(epoch);
            board.batch(None);
            pass(&mut board, &mut audit, 1);
        }
        assert_eq!(audit.health(&board.health()), None);
        assert!(audit.wants_new_beginning(), "late: {late}");
        assert_eq!(audit.proof().state, State::Lost { index: 160 });
    }
}

#[test]
fn a_new_stream_begins_with_zero_and_counts_on() {
    let (mut board, mut audit) = (Board::new(), Audit::default());
    pass(&mut board, &mut audit, 5);
    audit.health(&board.health());
    let mut board = Board::new();
    for _ in 0..3 {
        assert_eq!(audit.batch(&board.batch(None), 161), None);
    }
    assert_eq!(audit.health(&board.health()), None);
    let (epoch, index) = (161, 161 + 96);
    assert_eq!(audit.proof().state, State::Proven { epoch, index });
    assert_eq!(audit.proof().proven, 160 + 96);
}

#[test]
fn a_wrong_code_is_told_and_never_forgotten() {
    for axis in 0..AXES {
        let (mut board, mut audit) = (Board::new(), Audit::default());
        pass(&mut board, &mut audit, 5);
        let mut wrong = board.batch(None);
        wrong.codes[7][axis].0 ^= 1 << 9;
        audit.batch(&wrong, 0);
        let index = board.next;
        let disagrees = State::Disagrees { index };
        assert_eq!(audit.health(&board.health()), Some(disagrees));
        assert!(audit.wants_new_beginning());
        let epoch = index + 3;
        board.bins.begin(epoch);
        audit.begins_anew(epoch);
        pass(&mut board, &mut audit, 5);
        assert!(matches!(
            audit.health(&board.health()),
            Some(State::Proven { .. })
        ));
        assert!(audit.proof().to_string().contains("1 DISAGREEMENTS"));
    }
}

#[test]
fn numbers_from_the_wire_may_be_anything() {
    let mut board = Board::new();
    let batch = board.batch(Some(3));
    for (seq, first) in [(0, u64::MAX), (9, u64::MAX - 3), (10, 0), (0, 1 << 63)] {
        let mut audit = Audit::default();
        let wild = Batch {
            seq,
            first,
            ..batch.clone()
        };
        let digests = [0; AXES];
        for epoch in [0, u64::MAX, 1 << 63] {
            audit.batch(&wild, u64::MAX);
            audit.begins_anew(epoch);
            audit.batch(&batch, 5);
            audit.batch(&wild, 7);
            let bins = Some(BinsMark {
                epoch,
                index: wild.end(),
                digests,
            });
            audit.health(&Health {
                bins,
                ..Health::default()
            });
        }
    }
}

/// Another stream may go on where the last one was left, by its counts.
#[test]
fn what_is_of_another_stream_is_not_compared() {
    let (mut board, mut audit) = (Board::new(), Audit::default());
    pass(&mut board, &mut audit, 10);
    let other = |health: Health| Health {
        stream: 8,
        ..health
    };
    assert_eq!(audit.health(&other(board.health())), None);
    assert_eq!(audit.proof().proven, 0);
    audit.health(&board.health());
    assert_eq!(audit.proof().proven, 320);
    let first_heard = Batch {
        stream: 8,
        ..board.batch(None)
    };
    assert_eq!(
        audit.batch(&first_heard, 0),
        Some(State::Lost { index: 320 })
    );
    assert_eq!(audit.health(&other(board.health())), None);
    assert_eq!(
        (audit.proof().proven, audit.proof().disagreements),
        (320, 0)
    );
}

//! What must hold for any bytes read as a state; shared with the fuzz target.

use inm_allan::{Bins, Statistic};

/// Octaves of the states tried.
pub const LEVELS: usize = 4;

/// Reads `bytes` as a state: it is refused, or it can be written back, continued, merged and read
/// out without a panic. True if it was accepted.
pub fn try_state(bytes: &[u8]) -> bool {
    let Ok(state) = postcard::from_bytes::<Bins<LEVELS>>(bytes) else {
        return false;
    };
    let written = postcard::to_stdvec(&state).expect("a state can be written");
    let again: Bins<LEVELS> = postcard::from_bytes(&written).expect("what was written can be read");
    assert!(again == state, "reading back gives another state");

    let [used, same] = [state, again].map(continued);
    assert!(used == same, "what was read back goes on in another way");
    for statistic in [Statistic::Allan, Statistic::Modified, Statistic::Hadamard] {
        assert!(
            used.points(statistic)
                .all(|point| point.variance.is_finite())
        );
    }
    true
}

/// The state after more samples, a gap and a merge.
fn continued(mut used: Bins<LEVELS>) -> Bins<LEVELS> {
    used.push_slice(&[i32::MIN, i32::MAX, 0, 1]);
    used.push_slice(&[i32::MAX; 300]);
    used.skip(3);
    used.push(7);
    let mut right = Bins::starting_at(used.next_index());
    right.push_slice(&[5; 100]);
    used.merge(&right).expect("the parts are adjacent");
    used
}

//! The self-test: the words at rest, and those with the accelerometers' self-test pin driven.

use ads1281::SETTLING_READINGS;
use inm_protocol::{AXES, Answer, SelfTestStep, Trouble};

use super::job::Job;
use super::{Instrument, Stage};
use crate::Platform;

/// Words averaged for each half of the self-test.
const SELF_TEST_WORDS: u32 = 64;

/// The accelerometer answers its self-test pin within 5 ms; twice that, microseconds.
const SELF_TEST_RESPONSE_US: u32 = 10_000;

/// State of the self-test.
#[derive(Debug, Clone, Copy)]
pub(super) struct SelfTest {
    job: Job,
    /// Self-test pin high.
    driven: bool,
    /// Edges before this are not measured, ticks.
    from: u64,
    /// The measurement has failed by then, ticks.
    until: u64,
    sums: [i64; AXES],
    counts: [u32; AXES],
    steps: [SelfTestStep; AXES],
}

impl<P: Platform> Instrument<P> {
    pub(super) fn begin_self_test(&mut self, job: Job, now: u64) {
        self.measure(
            SelfTest {
                job,
                driven: false,
                from: now,
                until: now,
                sums: [0; AXES],
                counts: [0; AXES],
                steps: [SelfTestStep::default(); AXES],
            },
            now,
        );
    }

    /// Begins one half of the measurement at `from`.
    fn measure(&mut self, test: SelfTest, from: u64) {
        self.stage = Stage::SelfTest(SelfTest {
            from,
            until: from + self.clock.periods(2 * SELF_TEST_WORDS),
            sums: [0; AXES],
            counts: [0; AXES],
            ..test
        });
    }

    pub(super) fn self_test(&mut self, mut test: SelfTest, edge: Option<u64>, now: u64) -> bool {
        let Some(stamp) = edge else {
            if now > test.until {
                let axis = test
                    .counts
                    .iter()
                    .position(|&count| count < SELF_TEST_WORDS)
                    .unwrap_or(0);
                self.platform.self_test(false);
                self.refuse_job(test.job, axis, Trouble::Stalled);
                return true;
            }
            return false;
        };
        if stamp < test.from {
            for converter in &mut self.converters {
                converter.forget_edge();
            }
            return true;
        }
        for (axis, converter) in self.converters.iter_mut().enumerate() {
            match converter.take_new() {
                Ok(Some(reading)) if !reading.torn && test.counts[axis] < SELF_TEST_WORDS => {
                    test.sums[axis] += i64::from(reading.word.signed());
                    test.counts[axis] += 1;
                }
                // Too few words end the test at its deadline.
                Ok(_) | Err(_) => {}
            }
        }
        self.stage = Stage::SelfTest(test);
        if test.counts == [SELF_TEST_WORDS; AXES] {
            self.end_half(test, now);
        }
        true
    }

    fn end_half(&mut self, mut test: SelfTest, now: u64) {
        for (step, sum) in test.steps.iter_mut().zip(test.sums) {
            // A mean of 32-bit words fits 32 bits.
            let mean = (sum / i64::from(SELF_TEST_WORDS)) as i32;
            if test.driven {
                step.driven = mean;
            } else {
                step.rest = mean;
            }
        }
        self.platform.self_test(!test.driven);
        if test.driven {
            self.finish(test.job, Ok(Answer::SelfTest(test.steps)));
        } else {
            let response =
                self.clock.micros(SELF_TEST_RESPONSE_US) + self.clock.periods(SETTLING_READINGS);
            test.driven = true;
            self.measure(test, now + response);
        }
    }
}

//! The board of one run: firmware, converters and the link, step by step.

use std::collections::HashMap;

use inm_emulator::time::UPDATE_LEAD_PS;
use inm_emulator::{Bench, Converter, Fault, Signal};
use inm_firmware::Instrument;
use inm_firmware::emulated::{VirtualBoard, VirtualLink, describe};
use inm_protocol::{
    Command, Decoder, Filter, MAX_FRAME, Request, Settings, ToBoard, ToHost, encode,
};

use super::judge::{Judge, Outcome};
use super::{Act, Dice, Ending, Plan};

const QUEUE: usize = 8192;

/// Longest wait for a reply, milliseconds of board time: a start with its attempts, at 250/s.
const PATIENCE_MS: u64 = 3000;

const PS_PER_MS: u64 = 1_000_000_000;

/// Uniform noise around a level.
struct Noisy {
    offset: i32,
    dice: Dice,
}

impl Signal for Noisy {
    fn set_rate(&mut self, _input_hz: u32) {}

    fn next(&mut self) -> i32 {
        self.offset + self.dice.below(18_000_001) as i32 - 9_000_000
    }
}

type Board<'b> = Instrument<VirtualBoard<'b, Noisy, VirtualLink<QUEUE>>>;

struct Rig<'b> {
    bench: &'b Bench<Noisy>,
    board: Board<'b>,
    /// What the board has sent of the frame on its way.
    frame: Vec<u8>,
    decoder: Decoder,
    /// Whether the last stream has been answered for; the number of the last reply.
    replied: Option<u16>,
    next_id: u16,
    period_ps: u64,
    noted_ps: [Option<u64>; 3],
    /// By axis: words up to the one whose edge was noted.
    counted: [u64; 3],
    /// Words of the converters by axis and stamp.
    made: HashMap<(usize, u64), u32>,
    judge: Judge,
    /// The host hears.
    listening: bool,
    outage_until_ps: u64,
    dead: [u64; 3],
}

/// Does what the plan says.
///
/// # Panics
/// The firmware breaks a rule of the converter, or does not answer.
#[must_use]
pub fn run(plan: &Plan) -> Outcome {
    let mut dice = Dice::new(plan.seed ^ 0x5EED);
    let bench = Bench::new(plan.offsets.map(|offset| {
        let dice = Dice::new(dice.word());
        Converter::new(Noisy { offset, dice })
    }));
    let mut rig = Rig {
        bench: &bench,
        board: VirtualBoard::instrument(&bench, VirtualLink::new(None), describe("virtual")),
        frame: Vec::new(),
        decoder: Decoder::new(),
        replied: None,
        next_id: 0,
        period_ps: 1000 * PS_PER_MS / u64::from(plan.rate.hz()),
        noted_ps: [None; 3],
        counted: [0; 3],
        made: HashMap::new(),
        judge: Judge::new(plan, dice),
        listening: true,
        outage_until_ps: 0,
        dead: [0; 3],
    };
    let filter = Filter::default();
    rig.ask(Request::Configure(Settings {
        rate: plan.rate,
        filter,
    }));
    rig.judge.sound(true);
    rig.ask(Request::Start);
    rig.judge.sound(false);
    rig.stream(plan);
    match plan.ending {
        Ending::Cut => rig.listening = false,
        Ending::Stopped => rig.ask(Request::Stop),
        Ending::Again => {
            rig.ask(Request::Stop);
            rig.end_of_deaths();
            rig.ask(Request::Start);
            rig.run_periods(400);
            rig.ask(Request::Stop);
        }
    }
    let Rig { judge, made, .. } = rig;
    judge.verdict(&made)
}

impl Rig<'_> {
    fn stream(&mut self, plan: &Plan) {
        let began_ps = self.bench.now_ps();
        for misfortune in &plan.misfortunes {
            let at_ps = began_ps + misfortune.at * self.period_ps;
            while self.bench.now_ps() < at_ps {
                self.step();
            }
            self.suffer(misfortune.act);
        }
        let end_ps = began_ps + plan.length * self.period_ps;
        while self.bench.now_ps() < end_ps {
            self.step();
        }
    }

    fn suffer(&mut self, act: Act) {
        let now_ps = self.bench.now_ps();
        match act {
            Act::Fault(axis, fault) => self.bench.inject(axis, fault),
            Act::Dead(axis, periods) => self.dead[axis] = now_ps + periods * self.period_ps,
            Act::HeldUp(periods) => self.bench.advance_ps(periods * self.period_ps),
            Act::Outage(periods) => self.outage_until_ps = now_ps + periods * self.period_ps,
        }
    }

    fn end_of_deaths(&mut self) {
        self.dead = [0; 3];
        for axis in 0..3 {
            self.bench.inject(axis, Fault::WrongId(0x10));
        }
    }

    fn run_periods(&mut self, periods: u64) {
        let end_ps = self.bench.now_ps() + periods * self.period_ps;
        while self.bench.now_ps() < end_ps {
            self.step();
        }
    }

    /// Sends a request and waits until the board has answered, whether or not the host hears it.
    fn ask(&mut self, request: Request) {
        self.next_id += 1;
        let id = self.next_id;
        let command = ToBoard::Command(Command { id, request });
        let mut frame = [0; MAX_FRAME];
        let len = encode(&command, &mut frame).expect("a command fits");
        self.link().send(&frame[..len]);
        let until_ps = self.bench.now_ps() + PATIENCE_MS * PS_PER_MS;
        while self.replied != Some(id) {
            assert!(self.bench.now_ps() < until_ps, "no reply to {request:?}");
            self.step();
        }
    }

    fn link(&mut self) -> &mut VirtualLink<QUEUE> {
        self.board.platform_mut().environment_mut()
    }

    fn step(&mut self) {
        for axis in 0..3 {
            if self.bench.now_ps() < self.dead[axis] {
                self.bench.inject(axis, Fault::DrdyStops);
            }
        }
        self.board.step();
        for axis in 0..3 {
            self.note_word(axis);
        }
        let now_ps = self.bench.now_ps();
        let mut bytes = Vec::new();
        self.link().take(now_ps, |byte| bytes.push(byte));
        for byte in bytes {
            self.frame.push(byte);
            if byte == 0 {
                let frame = std::mem::take(&mut self.frame);
                self.sent(&frame);
            }
        }
    }

    /// A whole frame has left the board.
    fn sent(&mut self, frame: &[u8]) {
        let message = self.decoder.next(&mut &frame[..]);
        let message = message.expect("a frame").expect("sound when it leaves");
        if let ToHost::Reply(reply) = &message {
            self.replied = Some(reply.id);
        }
        let outage = self.bench.now_ps() < self.outage_until_ps;
        let heard = self.listening && !outage;
        self.judge
            .frame(frame, &message, self.period_ps / 1_000_000, heard);
    }

    /// Notes down what an axis has made since the last time, by the stamps of its edges.
    fn note_word(&mut self, axis: usize) {
        let now_ps = self.bench.now_ps();
        let edge_ps = self.bench.last_edge_ps(axis);
        let noted_ps = std::mem::replace(&mut self.noted_ps[axis], edge_ps);
        if edge_ps == noted_ps {
            return;
        }
        let made = self.bench.sent(axis).words();
        let before = self.counted[axis];
        // The edge that was last, and the number of its word.
        let (last_ps, last) = match (edge_ps, noted_ps) {
            (Some(edge_ps), _) => {
                // The next word is made shortly ahead of its edge.
                let ahead = now_ps - edge_ps + UPDATE_LEAD_PS >= self.period_ps;
                (edge_ps, made.saturating_sub(1 + u64::from(ahead)))
            }
            // A SYNC at the end of a step leaves no edge, but what came before it was read.
            (None, Some(noted_ps)) => {
                let more = made.saturating_sub(before);
                (noted_ps + more * self.period_ps, made.saturating_sub(1))
            }
            (None, None) => return,
        };
        self.counted[axis] = last + 1;
        // More edges may have fallen in one step.
        let first = before.max(last.saturating_sub(8));
        for index in first..=last {
            let stamp_ps = last_ps - (last - index) * self.period_ps;
            if let Some(word) = self.bench.word(axis, index) {
                self.made.insert((axis, stamp_ps / 1_000_000), word);
            }
        }
    }
}

//! A new program, message by message.

use inm_protocol::image::BOARD;
use inm_protocol::slot::{HEADER, Header, ROOM, SLOT_STARTS, crc32_of_words};
use inm_protocol::update::{FromLoader, LoaderRefusal, LoaderStatus, NewProgram, ToLoader};

use super::{PROGRAM_AT, Slots, WORD, first_to_start, newest, other, program, whole};

/// The RAM that a program's stack may lie in, with the address just behind it, from which a stack grows down.
const RAM: core::ops::RangeInclusive<u32> = 0x2000_0004..=0x2002_0000;

/// The lowest bit of an address of code: the processor knows Thumb only.
const THUMB: u32 = 1;

/// What a loader does while nothing runs: takes a program, a message at a time.
pub struct Updater<S> {
    slots: S,
    /// The slot that a restart starts.
    starts: Option<usize>,
    /// The slot that the next program goes to.
    free: usize,
    under_way: Option<UnderWay>,
    /// The last program that was begun is in its slot, verified.
    done: bool,
}

/// A program that is coming in.
struct UnderWay {
    new: NewProgram,
    /// Bytes written.
    written: u32,
}

impl<S: Slots> Updater<S> {
    /// Looks at what is in the slots; changes nothing.
    pub fn new(slots: S) -> Self {
        let mut updater = Self {
            slots,
            starts: None,
            free: 0,
            under_way: None,
            done: false,
        };
        updater.look();
        updater
    }

    /// Does what is asked, and says how far it is or why not. The slot of the program that starts is never
    /// touched.
    pub fn answer(&mut self, message: &ToLoader) -> FromLoader {
        let result = match message {
            ToLoader::Enter | ToLoader::Status => Ok(()),
            ToLoader::Begin(new) => self.begin(new),
            ToLoader::Data { offset, bytes } => self.data(*offset, bytes),
            ToLoader::Commit => self.commit(),
            ToLoader::Start if self.starts.is_none() => Err(LoaderRefusal::NothingToStart),
            ToLoader::Start => Ok(()),
        };
        match result {
            Ok(()) => FromLoader::Status(self.status()),
            Err(refusal) => FromLoader::Refused(refusal),
        }
    }

    /// Whether there is a program that a restart starts.
    pub fn has_program(&self) -> bool {
        self.starts.is_some()
    }

    /// The slots.
    pub fn slots(&self) -> &S {
        &self.slots
    }

    /// Gives the slots back.
    pub fn release(self) -> S {
        self.slots
    }

    fn status(&self) -> LoaderStatus {
        LoaderStatus {
            starts: self.starts.map(|slot| slot as u8),
            free: self.free as u8,
            address: SLOT_STARTS[self.free] + HEADER,
            room: ROOM,
            written: self.under_way.as_ref().map_or(0, |one| one.written),
        }
    }

    /// Which program starts, and where the next one goes: never where that one is, nor, where none may
    /// start, where the newest is.
    fn look(&mut self) {
        self.starts = first_to_start(&self.slots);
        let keep = self.starts.or_else(|| newest(&self.slots));
        self.free = keep.map_or(0, other);
    }

    fn begin(&mut self, new: &NewProgram) -> Result<(), LoaderRefusal> {
        if self.under_way.as_ref().is_some_and(|one| one.new == *new) {
            return Ok(());
        }
        let NewProgram {
            address,
            length,
            ref platform,
            ..
        } = *new;
        if platform != BOARD {
            return Err(LoaderRefusal::WrongBoard);
        }
        let expected = SLOT_STARTS[self.free] + HEADER;
        if address != expected {
            return Err(LoaderRefusal::WrongAddress { expected });
        }
        if length == 0 || !length.is_multiple_of(4) || length > ROOM {
            return Err(LoaderRefusal::WrongLength { room: ROOM });
        }
        self.under_way = None;
        self.done = false;
        let words = PROGRAM_AT + length as usize / WORD;
        let erased = self.slots.erase(self.free, words);
        erased.map_err(|_| LoaderRefusal::NotWritten)?;
        self.under_way = Some(UnderWay {
            new: new.clone(),
            written: 0,
        });
        Ok(())
    }

    fn data(&mut self, offset: u32, bytes: &[u8]) -> Result<(), LoaderRefusal> {
        let Some(UnderWay { new, written }) = &mut self.under_way else {
            return Err(LoaderRefusal::NotBegun);
        };
        let (words, rest) = bytes.as_chunks::<WORD>();
        let end = u64::from(offset) + bytes.len() as u64;
        if rest.is_empty() && end <= u64::from(*written) {
            // Its answer was lost.
            return Ok(());
        }
        if offset != *written || !rest.is_empty() || end > u64::from(new.length) {
            return Err(LoaderRefusal::WrongPlace { expected: *written });
        }
        let first = PROGRAM_AT + offset as usize / WORD;
        for (word, &bytes) in (first..).zip(words) {
            let value = u32::from_le_bytes(bytes);
            let done = self.slots.write(self.free, word, value);
            if done.is_err() || self.slots.read(self.free, word) != value {
                self.under_way = None;
                return Err(LoaderRefusal::NotWritten);
            }
        }
        *written = end as u32;
        Ok(())
    }

    fn commit(&mut self) -> Result<(), LoaderRefusal> {
        let Some(UnderWay { new, written }) = &self.under_way else {
            return match self.done {
                // Its answer was lost.
                true => Ok(()),
                false => Err(LoaderRefusal::NotBegun),
            };
        };
        if *written < new.length {
            return Err(LoaderRefusal::WrongPlace { expected: *written });
        }
        let (length, crc) = (new.length, new.crc);
        self.under_way = None;
        let found = crc32_of_words(program(&self.slots, self.free, length));
        if found != crc {
            return Err(LoaderRefusal::WrongCrc { found });
        }
        if !self.starts_something(length) {
            return Err(LoaderRefusal::NoProgram);
        }
        // This slot holds no program yet.
        let other = whole(&self.slots, other(self.free));
        let header = Header {
            number: other.map_or(1, |one| one.number.wrapping_add(1)),
            length,
            crc,
        };
        for (word, value) in header.words().into_iter().enumerate() {
            let done = self.slots.write(self.free, word, value);
            done.map_err(|_| LoaderRefusal::NotWritten)?;
        }
        if whole(&self.slots, self.free) != Some(header) {
            return Err(LoaderRefusal::NotWritten);
        }
        self.done = true;
        self.look();
        Ok(())
    }

    /// Whether the vectors of what was written are a stack in RAM and code of the program itself.
    fn starts_something(&self, length: u32) -> bool {
        let [stack, reset] = [0, 1].map(|word| self.slots.read(self.free, PROGRAM_AT + word));
        let start = SLOT_STARTS[self.free] + HEADER;
        let code = reset & !THUMB;
        RAM.contains(&stack)
            && stack.is_multiple_of(4)
            && reset & THUMB != 0
            && (start..start + length).contains(&code)
    }
}

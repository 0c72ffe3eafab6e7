#!/usr/bin/env python3
"""Reference client of the inm board, after protocol/WIRE.md: reads captures and talks to a board.

    inm_client.py samples CAPTURE            the samples of a capture as CSV, on standard output
    inm_client.py messages CAPTURE           every message of a capture, a line each, as JSON
    inm_client.py proof CAPTURE              up to which conversion the board's own bins agree with what came
    inm_client.py identify PORT              who the board is, as JSON
    inm_client.py record PORT CAPTURE --samples N [--rate HZ]
                                             N samples an axis into a new capture; the samples, as they
                                             came over the port, as CSV on standard output

A line of the CSV is `index,x,y,z`: the number of the conversion and the codes of the axes; an empty
cell is a word that must not be used, a number that is left out is a conversion that is missing.

One file, and nothing beside Python 3.8 but pyserial, which is needed where the system has no termios.
"""

import argparse
import binascii
import datetime
import json
import os
import random
import struct
import sys
import time

# --- made of the types: INM_WRITE_TABLES=1 cargo test -p inm-protocol --test wire_tables
VERSION = 2
AXES = 3
REGISTERS = 11
BATCH_LEN = 32
MAX_PAYLOAD = 708
MAX_FRAME = 712
UNPROVEN_PERIODS = 128
MAX_MARK = 120
LOADER = 240
CHUNK = 512
FLAGS = {"NONE": 0, "OVER_RANGE": 1, "TORN": 2, "MISSED": 4, "SLIPPED": 8, "STUCK": 16}
TYPES = {
    "ToBoard": ("enum", [
        ("Command", "Command"),
    ]),
    "Command": ("struct", [("id", "u16"), ("request", "Request")]),
    "Request": ("enum", [
        ("Identify", None),
        ("Start", None),
        ("Stop", None),
        ("Configure", "Settings"),
        ("CalibrateOffset", None),
        ("CalibrateGain", None),
        ("SelfTest", None),
        ("ReadRegisters", None),
        ("Reset", None),
        ("RestartBins", None),
        ("SelectRange", "SensorRange"),
        ("ReadSensorCalibration", "SensorRange"),
        ("WriteSensorCalibration", "SensorCalibration"),
        ("EraseSensorCalibration", "SensorRange"),
    ]),
    "Settings": ("struct", [("rate", "Rate"), ("filter", "Filter")]),
    "Rate": ("enum", [
        ("Sps250", None),
        ("Sps500", None),
        ("Sps1000", None),
        ("Sps2000", None),
        ("Sps4000", None),
    ]),
    "Filter": ("enum", [
        ("Modulator", None),
        ("Sinc", None),
        ("Fir", [("phase", "Phase"), ("high_pass", ("option", "u16"))]),
    ]),
    "Phase": ("enum", [
        ("Linear", None),
        ("Minimum", None),
    ]),
    "SensorRange": ("enum", [
        ("G4", None),
        ("G12", None),
    ]),
    "SensorCalibration": ("struct", [("range", "SensorRange"), ("unix_s", "i64"), ("centi_celsius", ("option", "i16")), ("gravity_um_s2", "u32"), ("positions", "u16"), ("rows", ("array", 6, "i32")), ("row_deviations", ("array", 6, "u32")), ("zero", ("array", 3, "i32")), ("zero_deviations", ("array", 3, "u32"))]),
    "ToHost": ("enum", [
        ("Samples", "Batch"),
        ("Health", "Health"),
        ("Reply", "Reply"),
        ("Event", "Event"),
        ("Note", "Note"),
        ("Pulse", "Pulse"),
    ]),
    "Batch": ("struct", [("seq", "u32"), ("first", "u64"), ("stamp", "u64"), ("codes", ("list", ("array", 3, "Code"))), ("flags", ("list", "Flag")), ("stream", "u16")]),
    "Code": ("newtype", ("array", 4, "u8")),
    "Flag": ("struct", [("conversion", "u8"), ("axis", "u8"), ("flags", "Flags")]),
    "Flags": ("newtype", "u8"),
    "Health": ("struct", [("stamp", "u64"), ("index", "u64"), ("streaming", "bool"), ("mcu_centi_celsius", ("option", "i16")), ("supply_mv", ("option", "u16")), ("registers", ("array", 3, ("array", 11, "u8"))), ("axes", ("array", 3, "AxisCounters")), ("link", "LinkCounters"), ("lost_conversions", "u64"), ("stack_used", "u32"), ("stack_size", "u32"), ("bins", ("option", "BinsMark")), ("stream", "u16")]),
    "AxisCounters": ("struct", [("over_range", "u32"), ("torn", "u32"), ("missed", "u32"), ("slipped", "u32"), ("stuck", "u32"), ("stalled", "u32"), ("registers_lost", "u32"), ("resets", "u32")]),
    "LinkCounters": ("struct", [("frames_sent", "u32"), ("frames_dropped", "u32"), ("frames_bad", "u32"), ("bytes_lost", "u32")]),
    "BinsMark": ("struct", [("epoch", "u64"), ("index", "u64"), ("digests", ("array", 3, "u64"))]),
    "Reply": ("struct", [("id", "u16"), ("result", "Result")]),
    "Result": ("enum", [
        ("Ok", "Answer"),
        ("Err", "Refusal"),
    ]),
    "Answer": ("enum", [
        ("Done", None),
        ("Identity", "Identity"),
        ("Settings", "Settings"),
        ("Registers", ("array", 3, ("array", 11, "u8"))),
        ("Calibration", ("array", 3, "i32")),
        ("SelfTest", ("array", 3, "SelfTestStep")),
        ("BinsEpoch", [("index", "u64")]),
        ("SensorCalibration", ("option", "SensorCalibration")),
    ]),
    "Identity": ("struct", [("serial", ("array", 3, "u32")), ("firmware", "text"), ("platform", "text"), ("timer_hz", "u32"), ("converter_clock_hz", "u32"), ("baud", "u32"), ("range", "SensorRange"), ("reference_uv", "u32"), ("sensor_supply_uv", "u32"), ("converters", ("array", 3, ("option", "u8"))), ("settings", "Settings"), ("restart", "Restart")]),
    "Restart": ("enum", [
        ("Power", None),
        ("Command", None),
        ("Watchdog", None),
        ("Panic", [("line", "u32"), ("file", ("list", "u8"))]),
        ("ClockFallback", None),
        ("CommandClockFallback", None),
        ("WatchdogClockFallback", None),
        ("PanicClockFallback", [("line", "u32"), ("file", ("list", "u8"))]),
    ]),
    "SelfTestStep": ("struct", [("rest", "i32"), ("driven", "i32")]),
    "Refusal": ("enum", [
        ("Streaming", None),
        ("LinkTooSlow", [("needed", "u32"), ("available", "u32")]),
        ("BusTooSlow", [("asked", "u32"), ("readable", "u32")]),
        ("Converter", [("axis", "u8"), ("trouble", "Trouble")]),
        ("Unsound", None),
        ("NotKept", None),
    ]),
    "Trouble": ("enum", [
        ("Stalled", None),
        ("Stuck", [("ones", "bool")]),
        ("Slipped", [("doubled", "bool")]),
        ("OverRange", None),
        ("WrongId", [("found", "u8")]),
        ("RegisterLost", [("address", "u8"), ("wrote", "u8"), ("found", "u8")]),
        ("Bus", None),
        ("LinkFull", [("batches", "u32")]),
        ("Recovered", [("lost", "u32")]),
        ("Misaligned", None),
    ]),
    "Event": ("struct", [("index", "u64"), ("axis", ("option", "u8")), ("trouble", "Trouble"), ("stream", "u16")]),
    "Note": ("enum", [
        ("PortLost", [("unix_ms", "i64")]),
        ("PortBack", [("unix_ms", "i64")]),
        ("End", [("unix_ms", "i64")]),
        ("BoardSilent", [("unix_ms", "i64")]),
        ("BoardStopped", [("unix_ms", "i64")]),
        ("Overrun", [("unix_ms", "i64"), ("until_ms", "i64"), ("bytes", "u64")]),
        ("StreamBack", [("unix_ms", "i64")]),
        ("Mark", [("unix_ms", "i64"), ("text", "text")]),
        ("Clock", [("unix_ms", "i64"), ("stamp", "u64"), ("host_us", "u64")]),
    ]),
    "Pulse": ("struct", [("stamp", "u64"), ("number", "u32"), ("doubled", "bool"), ("counters", "PulseCounters")]),
    "PulseCounters": ("struct", [("early", "u32"), ("doubled", "u32"), ("missing", "u32"), ("odd", "u32")]),
    "ToLoader": ("enum", [
        ("Enter", None),
        ("Status", None),
        ("Begin", "NewProgram"),
        ("Data", [("offset", "u32"), ("bytes", ("list", "u8"))]),
        ("Commit", None),
        ("Start", None),
    ]),
    "NewProgram": ("struct", [("address", "u32"), ("length", "u32"), ("crc", "u32"), ("platform", "text")]),
    "FromLoader": ("enum", [
        ("Status", "LoaderStatus"),
        ("Refused", "LoaderRefusal"),
    ]),
    "LoaderStatus": ("struct", [("starts", ("option", "u8")), ("free", "u8"), ("address", "u32"), ("room", "u32"), ("written", "u32")]),
    "LoaderRefusal": ("enum", [
        ("WrongBoard", None),
        ("WrongAddress", [("expected", "u32")]),
        ("WrongLength", [("room", "u32")]),
        ("NotBegun", None),
        ("WrongPlace", [("expected", "u32")]),
        ("WrongCrc", [("found", "u32")]),
        ("NoProgram", None),
        ("NotWritten", None),
        ("NothingToStart", None),
    ]),
}
CODES = ("list", ("array", 3, "Code"))
# --- end of what is made of the types

# What is said of the session in WIRE.md.
WAIT_S, TRIES = 1.5, 3
# Of the samples: words ahead of a notice and near a clipped one that must not be used.
SLIP_NOTICE = 540
GUARD_BEFORE, GUARD_AFTER = 31, 62
# Begins a hello, behind the version; never changes.
HELLO = b"inmhello"
MAGIC = b"#inm-capture 1\n"


class WireError(Exception):
    """What is wrong with bytes, a board or a port, in words."""


# --- postcard: forms to values and back; values as serde_json has them -----------------------------


def read(form, data, at):
    """The value of `form` at `at`, and the place behind it."""
    if isinstance(form, tuple):
        return read_compound(form, data, at)
    if form in TYPES:
        return read_type(form, data, at)
    if form in ("u8", "bool"):
        return (data[at] if form == "u8" else data[at] != 0), at + 1
    number, at = read_varint(data, at)
    if form == "text":
        return data[at : at + number].decode(), at + number
    if form.startswith("i"):
        number = number >> 1 ^ -(number & 1)
    return number, at


def read_compound(form, data, at):
    if form == CODES:
        # The bulk of a record: as `read` would, but at once.
        count, at = read_varint(data, at)
        end = at + count * AXES * 4
        flat = struct.unpack("<%di" % (count * AXES), data[at:end])
        return [flat[i : i + AXES] for i in range(0, len(flat), AXES)], end
    kind, inner = form[0], form[-1]
    if kind == "option":
        return read(inner, data, at + 1) if data[at] else (None, at + 1)
    count, at = (form[1], at) if kind == "array" else read_varint(data, at)
    values = []
    for _ in range(count):
        value, at = read(inner, data, at)
        values.append(value)
    return values, at


def read_type(name, data, at):
    kind, content = TYPES[name]
    if kind == "newtype":
        return read(content, data, at)
    if kind == "struct":
        return read_fields(content, data, at)
    number, at = read_varint(data, at)
    variant, inner = content[number]
    if inner is None:
        return variant, at
    value, at = read_fields(inner, data, at) if isinstance(inner, list) else read(inner, data, at)
    return {variant: value}, at


def read_fields(fields, data, at):
    values = {}
    for name, form in fields:
        values[name], at = read(form, data, at)
    return values, at


def read_varint(data, at):
    number = shift = 0
    while True:
        byte = data[at]
        number |= (byte & 0x7F) << shift
        shift, at = shift + 7, at + 1
        if byte < 0x80:
            return number, at


def write(form, value):
    """The bytes of a value: what a host sends and notes down needs numbers, options and types."""
    if isinstance(form, tuple):
        if form[0] != "option":
            raise WireError("no host sends a %s" % form[0])
        return b"\0" if value is None else b"\1" + write(form[1], value)
    if form not in TYPES:
        return write_varint((value << 1 ^ value >> 63) if form.startswith("i") else value)
    kind, content = TYPES[form]
    if kind == "newtype":
        return write(content, value)
    if kind == "struct":
        return b"".join(write(inner, value[name]) for name, inner in content)
    variant, value = (value, None) if isinstance(value, str) else next(iter(value.items()))
    number = [name for name, _ in content].index(variant)
    inner = content[number][1]
    if isinstance(inner, list):
        return write_varint(number) + b"".join(write(f, value[name]) for name, f in inner)
    return write_varint(number) + (b"" if inner is None else write(inner, value))


def write_varint(number):
    out = bytearray()
    while number >= 0x80:
        out.append(number & 0x7F | 0x80)
        number >>= 7
    out.append(number)
    return bytes(out)


# --- frames ---------------------------------------------------------------------------------------


def cobs_encode(data):
    out, block = bytearray(), bytearray()
    for byte in data + b"\0":
        if byte:
            block.append(byte)
        if not byte or len(block) == 254:
            out += bytes([len(block) + 1]) + block
            block = bytearray()
    return bytes(out)


def cobs_decode(frame):
    out, at = bytearray(), 0
    while at < len(frame):
        code = frame[at]
        if at + code > len(frame):
            raise WireError("not a frame")
        out += frame[at + 1 : at + code]
        at += code
        if code < 255 and at < len(frame):
            out.append(0)
    return bytes(out)


def frame_of(root, message):
    """The frame of a message, with a zero ahead that ends whatever the receiver believes to be in."""
    payload = bytes([VERSION]) + write(root, message)
    payload += struct.pack("<I", binascii.crc32(payload))
    return b"\0" + cobs_encode(payload) + b"\0"


def message_of(frame):
    """`(version, message)` of a frame without its zero; the message is `{"Hello": ...}` for a hello.

    Raises WireError, which says what is wrong with it.
    """
    payload = cobs_decode(frame)
    body = payload[:-4]
    if len(payload) < 5 or binascii.crc32(body) != struct.unpack("<I", payload[-4:])[0]:
        raise WireError("check sum does not match")
    version, message = body[0], body[1:]
    if message.startswith(HELLO):
        return version, {"Hello": hello_of(message[len(HELLO) :])}
    if version not in (1, VERSION):
        raise WireError(foreign(version))
    # A message of version 1 may lack the stream at its end, where version 2 would have a zero.
    for data in [message] + [message + b"\0"] * (version == 1):
        try:
            value, end = read("ToHost", data, 0)
        except (IndexError, struct.error, UnicodeDecodeError):
            continue
        if end == len(data):
            return version, value
    raise WireError("unknown message")


def hello_of(data):
    """What a board of any version says of itself."""
    try:
        data = data[1 : 1 + data[0]]
        texts, at = [], 12
        for _ in range(2):
            texts.append(data[at + 1 : at + 1 + data[at]].decode())
            at += 1 + data[at]
        serial = list(struct.unpack("<3I", data[:12]))
    except (IndexError, struct.error, UnicodeDecodeError):
        raise WireError("a hello that is cut short") from None
    return {"serial": serial, "firmware": texts[0], "platform": texts[1]}


def foreign(version, hello=None):
    who = "" if hello is None else " (firmware %(firmware)s on %(platform)s)" % hello
    return (
        "the board%s speaks protocol version %d, this client versions 1 and %d: take the client of "
        "that release, or flash the firmware of this one (inm flash)" % (who, version, VERSION)
    )


class Frames:
    """Bytes in any split to frames."""

    def __init__(self):
        self.rest = b""

    def push(self, data):
        *whole, self.rest = (self.rest + data).split(b"\0")
        return [frame for frame in whole if frame]


# --- samples --------------------------------------------------------------------------------------


class Samples:
    """Messages to samples: which conversion, and which words must not be used (WIRE.md, Samples)."""

    def __init__(self):
        self.stretches = []  # [first index, codes], without a gap within
        self.bad = [[] for _ in range(AXES)]  # ranges of indices
        self.offset = 0
        self.next = self.stream = self.confirmed = None
        self.former = None
        self.ahead = (None, [])
        self.arrived, self.counted = [0] * AXES, None
        self.health = None
        self.ended = False

    def push(self, message):
        kind, value = next(iter(message.items()))
        if self.ended:
            return
        if kind == "Samples":
            self.batch(value)
        elif kind == "Event":
            self.event(value)
        elif kind == "Health":
            self.take_health(value)
        elif kind == "Reply":
            self.reply(value)
        elif kind == "Note":
            self.ended = "End" in value

    def finish(self):
        """Nothing more will come: what the board has not confirmed must not be used."""
        if self.confirmed is not None and self.next is not None:
            for axis in range(AXES):
                self.spoil(axis, self.confirmed, self.next)
        self.confirmed = None

    def spoil(self, axis, begin, end):
        self.bad[axis].append((max(begin, 0), end))

    def batch(self, batch):
        first = batch["first"] + self.offset
        other = self.stream is not None and batch["stream"] != self.stream
        if other and batch["stream"] == self.former:
            return  # too late
        if self.next is not None and first < self.next and not other and batch["stream"]:
            return  # twice, or too late
        if self.next is not None and (other or first < self.next):
            # The board has counted from 0 again; how much time passed is not known.
            self.finish()
            first, self.former = self.next + 1, self.stream
            self.offset = first - batch["first"]
            self.stream = None
        if self.stream is None:
            self.stream = batch["stream"]
            self.begin(batch, first)
        if self.next != first:
            self.stretches.append((first, []))
        begin, codes = self.stretches[-1]
        codes += batch["codes"]
        self.next = first + len(batch["codes"])
        self.flags(batch, first, begin)

    def begin(self, batch, first):
        if batch["stream"] and self.confirmed is None:
            self.confirmed = first
        stream, told = self.ahead
        for axis, begin, end in told if stream == batch["stream"] else []:
            self.spoil(axis, max(begin, batch["first"]) + self.offset, end + self.offset)
        self.ahead = (None, [])

    def flags(self, batch, first, stretch):
        for flag in batch["flags"]:
            at = first + flag["conversion"]
            if flag["axis"] >= AXES or at >= self.next:
                continue
            if flag["flags"] & FLAGS["OVER_RANGE"]:
                begin = max(at - GUARD_BEFORE, stretch)
                self.spoil(flag["axis"], begin, at + 1 + GUARD_AFTER)
            else:
                self.spoil(flag["axis"], at, at + 1)

    def event(self, event):
        trouble, axis = event["trouble"], event["axis"]
        kind = trouble if isinstance(trouble, str) else next(iter(trouble))
        if kind in ("OverRange", "LinkFull", "Recovered") or axis is None or axis >= AXES:
            return
        self.arrived[axis] += 1
        begin = max(event["index"] - (SLIP_NOTICE if kind == "Slipped" else UNPROVEN_PERIODS), 0)
        if self.stream is not None and event["stream"] != self.stream:
            stream, told = self.ahead
            told = told if stream == event["stream"] else []
            self.ahead = (event["stream"], told + [(axis, begin, event["index"])])
        else:
            self.spoil(axis, begin + self.offset, event["index"] + self.offset)

    def take_health(self, health):
        kinds = ("slipped", "stuck", "stalled", "registers_lost")
        counted = [sum(axis[kind] for kind in kinds) for axis in health["axes"]]
        for axis in range(AXES):
            if self.counted and counted[axis] > self.counted[axis] + self.arrived[axis]:
                self.spoil(axis, self.confirmed or 0, self.next or 0)
        self.counted, self.arrived = counted, [0] * AXES
        self.health = health
        if health["streaming"]:
            self.confirm(SLIP_NOTICE)

    def confirm(self, late):
        """Every notice has arrived, or is known to be missing, up to the last health record."""
        if self.stream is None or self.health["stream"] == self.stream:
            index = min(self.health["index"] + self.offset, self.next or 0)
            self.confirmed = max(index - late, 0)

    def reply(self, reply):
        if reply["result"] == {"Ok": "Done"} and self.health and self.health["streaming"]:
            if self.health["index"] + self.offset == (self.next or 0):
                self.confirm(0)

    def csv(self):
        """The lines of the CSV, without line ends."""
        bad = [merged(ranges) for ranges in self.bad]
        place = [0] * AXES
        yield "index,x,y,z"
        for first, codes in self.stretches:
            for index, words in enumerate(codes, first):
                cells = [str(index)]
                for axis, word in enumerate(words):
                    ranges = bad[axis]
                    while place[axis] < len(ranges) and ranges[place[axis]][1] <= index:
                        place[axis] += 1
                    inside = place[axis] < len(ranges) and ranges[place[axis]][0] <= index
                    cells.append("" if inside else str(word))
                yield ",".join(cells)


def merged(ranges):
    """Ascending disjoint ranges."""
    out = []
    for begin, end in sorted(r for r in ranges if r[0] < r[1]):
        if out and begin <= out[-1][1]:
            out[-1][1] = max(out[-1][1], end)
        else:
            out.append([begin, end])
    return out


# --- proof ----------------------------------------------------------------------------------------


class Bins:
    """The Allan bins of one axis, as far as their digest needs them (WIRE.md, Proof)."""

    GROUND = (1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 20, 24, 28, 32, 40)
    LEVEL, LEVELS = (24, 28, 32, 40), 22

    def __init__(self, first):
        self.next = self.start = first
        self.samples = self.total = 0
        self.sums = [0]  # of the words of this run, before each of its indices
        self.terms = [[0, 0] for _ in range(len(self.GROUND) + self.LEVELS * len(self.LEVEL))]

    def push(self, code):
        self.next, self.samples, self.total = self.next + 1, self.samples + 1, self.total + code
        self.sums.append(self.sums[-1] + code)
        for place, lag in enumerate(self.GROUND):
            self.add(place, lag, self.next)
        half = self.next & -self.next
        self.level(half.bit_length(), self.next - half)

    def level(self, level, index):
        """The differences of a level that end at an index whose turn has come."""
        if 1 <= level <= self.LEVELS:
            place = len(self.GROUND) + (level - 1) * len(self.LEVEL)
            for lag in self.LEVEL:
                self.add(place, lag << level, index)
                place += 1

    def add(self, place, lag, index):
        at = index - self.start
        if at >= 2 * lag:
            difference = self.sums[at] - 2 * self.sums[at - lag] + self.sums[at - 2 * lag]
            self.terms[place][0] += 1
            self.terms[place][1] += difference * difference

    def skip_to(self, index):
        """What lies before `index` and has not come is missing."""
        if index <= self.next:
            return
        for level in range(1, self.LEVELS + 1):
            newest = self.next >> level << level
            if self.next - newest < 1 << level - 1:
                self.level(level, newest)
        self.next = self.start = index
        self.sums = [0]

    def digest(self):
        words = [self.next, self.start, self.samples, self.total]
        for count, squares in self.terms:
            words += [count, squares, squares >> 64, squares >> 128]
        mask, digest = (1 << 64) - 1, 0
        for word in words:
            turned = digest << 29 & mask | digest >> 35
            digest = (turned ^ word & mask) * 0x9E3779B97F4A7C15 & mask
        return digest ^ digest >> 32


class Proof:
    """What came, against the digests that the board keeps of what it sent."""

    def __init__(self):
        self.stream, self.words, self.seq, self.begin = None, [], -1, 0
        self.epoch, self.bins, self.fed = None, [], 0
        self.proven = self.disagreements = 0

    def push(self, message):
        if "Samples" in message:
            batch = message["Samples"]
            if batch["stream"] != self.stream:
                self.stream, self.words, self.epoch = batch["stream"], [], None
                self.seq, self.begin = -1, 0
            if batch["seq"] != self.seq + 1:
                # A batch was lost: only bins that begin behind it can be compared.
                self.begin = batch["first"]
            self.seq = batch["seq"]
            flagged = {(f["conversion"], f["axis"]) for f in batch["flags"] if f["flags"]}
            for at, codes in enumerate(batch["codes"]):
                good = [(at, axis) not in flagged for axis in range(AXES)]
                self.words.append((batch["first"] + at, codes, good))
        elif "Health" in message and message["Health"]["bins"]:
            if message["Health"]["stream"] == self.stream:
                self.mark(message["Health"]["bins"])

    def mark(self, mark):
        if mark["epoch"] < self.begin:
            return
        if mark["epoch"] != self.epoch:
            self.epoch, self.fed = mark["epoch"], 0
            self.bins = [Bins(self.epoch) for _ in range(AXES)]
        for index, codes, good in self.words[self.fed :]:
            for axis in range(AXES):
                if good[axis] and index >= self.epoch:
                    self.bins[axis].skip_to(index)
                    self.bins[axis].push(codes[axis])
        self.fed = len(self.words)
        for bins in self.bins:
            bins.skip_to(mark["index"])
        if [bins.digest() for bins in self.bins] == mark["digests"]:
            self.proven = mark["index"]
        else:
            self.disagreements += 1


# --- captures -------------------------------------------------------------------------------------


def capture(path):
    """`(header, messages)` of a capture; frames that are damaged are left out."""
    with open(path, "rb") as file:
        if file.read(len(MAGIC)) != MAGIC:
            raise WireError("%s: not a capture: it does not begin with %r" % (path, MAGIC.decode()))
        header, rest = json.loads(file.readline()), file.read()
    if header["protocol"] not in (1, VERSION):
        raise WireError("%s: %s" % (path, foreign(header["protocol"])))
    messages = []
    for frame in Frames().push(rest):
        try:
            messages.append(message_of(frame)[1])
        except WireError as fault:
            print("%s: a damaged frame is left out: %s" % (path, fault), file=sys.stderr)
    return header, messages


def header_of(identity, registers, created):
    """The header of a capture by this board (WIRE.md, Capture)."""
    settings = identity["settings"]
    g_v = {"G4": 0.308, "G12": 0.0836}[identity["range"]] * identity["sensor_supply_uv"] * 1e-6 / 2.8
    volts_per_value = identity["reference_uv"] * 1e-6 / 2.0 / ((1 << 30) - 1)
    scale = volts_per_value / 2.0 / (g_v / 9.80665)
    phase = settings["filter"]["Fir"]["phase"].lower()
    clock = "internal" if "Fallback" in str(identity["restart"]) else "crystal"
    board = {
        "serial": "".join("%08x" % word for word in identity["serial"]),
        "platform": identity["platform"],
        "firmware": identity["firmware"],
        "converters": identity["converters"],
        "timer_hz": identity["timer_hz"],
        "converter_clock_hz": identity["converter_clock_hz"],
        "reference_v": identity["reference_uv"] * 1e-6,
        "range": identity["range"],
        "sensor_supply_v": identity["sensor_supply_uv"] * 1e-6,
        "restart": identity["restart"],
        "clock": clock if identity["platform"] == "stm32f405" else "emulated",
    }
    axes = [
        {
            "name": name,
            "unit": "m/s^2",
            "scale": scale,
            "zero": 0.0,
            "chain": "ads1281:%s+%dhz" % (phase, pole_hz),
        }
        for name, pole_hz in (("X", 400), ("Y", 400), ("Z", 300))
    ]
    return {
        "protocol": VERSION,
        "inm": "inm_client.py",
        "created": created,
        "rate_hz": float(settings["rate"][len("Sps") :]),
        "board": board,
        "settings": settings,
        "registers": registers,
        "registers_of": "record",
        "axes": axes,
    }


# --- the board ------------------------------------------------------------------------------------


class TermiosPort:
    """A serial port, or a pseudo terminal, by what POSIX has."""

    def __init__(self, path, baud):
        import termios
        import tty

        self.file = os.open(path, os.O_RDWR | os.O_NOCTTY)
        tty.setraw(self.file)
        settings = termios.tcgetattr(self.file)
        settings[4] = settings[5] = getattr(termios, "B%d" % baud)
        # A read returns with what there is, or with nothing after a tenth of a second.
        settings[6][termios.VMIN], settings[6][termios.VTIME] = 0, 1
        termios.tcsetattr(self.file, termios.TCSANOW, settings)

    def read(self, size):
        return os.read(self.file, size)

    def write(self, data):
        while data:
            data = data[os.write(self.file, data) :]

    def close(self):
        os.close(self.file)


def open_port(path, baud):
    """The port by pyserial, or by termios where pyserial is missing."""
    try:
        import serial
    except ImportError:
        try:
            return TermiosPort(path, baud)
        except ImportError:
            raise WireError("this system has no termios: pip install pyserial") from None
    return serial.Serial(path, baud, timeout=0.1)


class Board:
    """A board at a port. Whatever arrives is handed to `arrived(bytes, message)`, frame by frame."""

    def __init__(self, path, baud):
        self.path, self.port = path, open_port(path, baud)
        self.frames = Frames()
        self.id = random.randrange(0x80, 0x2000)
        self.arrived = lambda frame, message: None
        self.hello = self.version = None

    def take(self):
        """Reads once, and returns the messages that are complete."""
        messages = []
        for frame in self.frames.push(self.port.read(4096)):
            message = None
            try:
                version, message = message_of(frame)
                messages.append((version, message))
            except WireError as fault:
                print("%s: %s" % (self.path, fault), file=sys.stderr)
            self.arrived(frame + b"\0", message)
        return messages

    def ask(self, request):
        """The answer to a request. Raises WireError if there is none, or the board refuses."""
        id, self.id = self.id, self.id % 0xFFFF + 1
        for _ in range(TRIES):
            self.port.write(frame_of("ToBoard", {"Command": {"id": id, "request": request}}))
            deadline = time.monotonic() + WAIT_S
            while time.monotonic() < deadline:
                for version, message in self.take():
                    self.version = version
                    if "Hello" in message:
                        self.hello = message["Hello"]
                        if version != VERSION:
                            raise WireError("%s: %s" % (self.path, foreign(version, self.hello)))
                    reply = message.get("Reply", {})
                    if reply.get("id") == id:
                        if "Err" in reply["result"]:
                            raise WireError("the board refuses %s: %s" % (request, reply["result"]))
                        return reply["result"]["Ok"]
        if self.version not in (None, VERSION):
            # From before the hello: its version is all that its frames say.
            raise WireError("%s: %s" % (self.path, foreign(self.version)))
        raise WireError("%s: no answer to %s" % (self.path, request))


def record(board, path, samples, rate_hz):
    """Records so many samples an axis into a new capture; the samples as they came."""
    board.ask("Identify")
    # A board left streaming by an earlier host first comes to rest.
    board.ask("Stop")
    fir = {"Fir": {"phase": "Linear", "high_pass": None}}
    board.ask({"Configure": {"rate": "Sps%d" % rate_hz, "filter": fir}})
    identity = board.ask("Identify")["Identity"]
    got, early = Samples(), []

    def arrived(frame, message):
        early.append(frame)
        if message is not None:
            got.push(message)

    board.arrived = arrived
    created = datetime.datetime.now(datetime.timezone.utc).isoformat().replace("+00:00", "Z")
    board.ask("Start")
    registers = board.ask("ReadRegisters")["Registers"]
    with open(path, "xb") as file:
        header = header_of(identity, registers, created)
        file.write(MAGIC + json.dumps(header).encode() + b"\n")
        while (got.next or 0) < samples:
            board.take()
            file.write(b"".join(early))
            early.clear()
        board.ask("Stop")
        note = {"Note": {"End": {"unix_ms": int(time.time() * 1000)}}}
        file.write(b"".join(early) + frame_of("ToHost", note))
    got.finish()
    return got


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    sub = parser.add_subparsers(dest="command", required=True)
    for name in ("samples", "messages", "proof"):
        sub.add_parser(name).add_argument("capture")
    for name in ("identify", "record"):
        command = sub.add_parser(name)
        command.add_argument("port")
        command.add_argument("--baud", type=int, default=921600, help="bit/s")
    command.add_argument("capture")
    command.add_argument("--samples", type=int, required=True, help="samples an axis")
    command.add_argument("--rate", type=int, default=2000, help="samples a second")
    options = parser.parse_args()
    try:
        for line in run(options):
            print(line)
    except (WireError, OSError, json.JSONDecodeError) as error:
        sys.exit("inm_client.py: %s" % error)


def run(options):
    """The lines of a command."""
    if options.command == "messages":
        return [json.dumps(message) for message in capture(options.capture)[1]]
    if options.command == "proof":
        proof = Proof()
        for message in capture(options.capture)[1]:
            proof.push(message)
        return [json.dumps({"proven": proof.proven, "disagreements": proof.disagreements})]
    if options.command == "samples":
        samples = Samples()
        for message in capture(options.capture)[1]:
            samples.push(message)
        samples.finish()
        return samples.csv()
    board = Board(options.port, options.baud)
    if options.command == "identify":
        return [json.dumps(board.ask("Identify")["Identity"])]
    return record(board, options.capture, options.samples, options.rate).csv()


if __name__ == "__main__":
    main()

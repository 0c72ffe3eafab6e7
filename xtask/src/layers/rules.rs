//! What must never be imported, and what still is.

/// Modules that must not import others.
pub struct Never {
    pub from: &'static [&'static str],
    pub to: &'static [&'static str],
    /// Why, in a clause.
    pub why: &'static str,
}

/// An import that is there today.
pub struct Import {
    pub from: &'static str,
    pub to: &'static str,
    /// Why it is there, and what will take it away.
    pub why: &'static str,
}

pub const NEVER: [Never; 14] = [
    Never {
        from: &[
            "host::analyse",
            "host::bins",
            "host::calibrate",
            "host::capture",
            "host::chain",
            "host::data_sheet",
            "host::export",
            "host::fft",
            "host::fit",
            "host::flash",
            "host::inspect",
            "host::link",
            "host::live",
            "host::model",
            "host::navigate",
            "host::signal",
            "host::simulate",
            "host::source",
            "host::spectrum",
            "host::update",
        ],
        to: &["host::diagnosis", "host::report", "host::page", "host::cli"],
        why: "what measures knows nothing of who judges or shows it",
    },
    Never {
        from: &["host::diagnosis"],
        to: &[
            "host::capture",
            "host::link",
            "host::live",
            "host::export",
            "host::report",
            "host::page",
            "host::cli",
        ],
        why: "a diagnosis is made of samples, and its result is data",
    },
    Never {
        from: &["host::report"],
        to: &[
            "host::capture",
            "host::link",
            "host::live",
            "host::simulate",
            "host::source",
            "host::page",
            "host::cli",
        ],
        why: "a report is made of results, never of the record again",
    },
    Never {
        from: &["host::model"],
        to: &[
            "host::analyse",
            "host::bins",
            "host::fit",
            "host::simulate",
            "host::source",
            "host::spectrum",
        ],
        why: "a model is there before any record of it",
    },
    Never {
        from: &["host::spectrum"],
        to: &[
            "host::analyse",
            "host::bins",
            "host::fit",
            "host::model",
            "host::simulate",
            "host::source",
        ],
        why: "a spectrum is made of numbers, wherever they come from",
    },
    Never {
        from: &["host::bins"],
        to: &[
            "host::analyse",
            "host::fit",
            "host::model",
            "host::simulate",
        ],
        why: "what is counted depends on no model",
    },
    Never {
        from: &["host::fit"],
        to: &["host::analyse", "host::simulate", "host::source"],
        why: "a fit is made of bins and spectra, not of a record",
    },
    Never {
        from: &["host::source"],
        to: &[
            "host::analyse",
            "host::bins",
            "host::fit",
            "host::live",
            "host::simulate",
            "host::spectrum",
        ],
        why: "where samples come from does not depend on what is made of them",
    },
    Never {
        from: &["host::simulate"],
        to: &[
            "host::analyse",
            "host::bins",
            "host::fit",
            "host::live",
            "host::spectrum",
        ],
        why: "data are made without looking at them",
    },
    Never {
        from: &["host::calibrate"],
        to: &[
            "host::capture",
            "host::inspect",
            "host::link",
            "host::source",
            "host::virtual_board",
        ],
        why: "a calibration is made of readings at rest, whoever reads them",
    },
    Never {
        from: &["host::export"],
        to: &["host::analyse", "host::fit", "host::source"],
        why: "a model alone is what other programs get",
    },
    Never {
        from: &["host::fft", "host::chain"],
        to: &["host::bins", "host::model", "host::signal", "host::source"],
        why: "arithmetic for all the others",
    },
    Never {
        from: &[
            "firmware::acquire",
            "firmware::converters",
            "firmware::mma7331l",
            "firmware::platform",
            "firmware::proof",
            "firmware::update",
        ],
        to: &["firmware::emulated", "firmware::image"],
        why: "one code on the board and on the emulator",
    },
    Never {
        from: &["firmware::converters", "firmware::mma7331l"],
        to: &["firmware::acquire"],
        why: "a driver knows nothing of who uses it",
    },
];

/// Empty is the aim: an entry goes as its import is mended.
pub const KNOWN: [Import; 3] = [
    Import {
        from: "emulator::pins",
        to: "emulator::bench",
        why: "a pin refers to the bench that hands it out",
    },
    Import {
        from: "emulator::spi",
        to: "emulator::bench",
        why: "a port refers to the bench that hands it out",
    },
    Import {
        from: "protocol::command",
        to: "protocol::message",
        why: "an event's trouble, declared among the messages",
    },
];

/// The project's own crates that a crate may depend on, as its manifest names them.
pub const DEPENDENCIES: [(&str, &[&str]); 5] = [
    // For any board: it knows nothing of this one.
    ("ads1281", &[]),
    ("protocol", &[]),
    ("allan", &[]),
    ("emulator", &[]),
    (
        "firmware",
        &[
            "ads1281 = { workspace = true }",
            "inm-allan = { workspace = true }",
            // Behind a feature: the image for the board has none of it.
            "inm-emulator = { workspace = true, optional = true }",
            "inm-protocol = { workspace = true }",
        ],
    ),
];

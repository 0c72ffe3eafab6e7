//! What tests, examples and studies look at behind the face, by name; no promise to anyone else. What
//! is in no list here and not in the face is the library's own, so that the compiler tells what of it
//! is not used any more.

pub use crate::cli::described as command_line;

pub mod analyse {
    pub use crate::analyse::{
        Analysis, AnalysisOptions, AxisAnalysis, Fits, LikelihoodFit, LikelihoodValue, analyse,
        summarise,
    };
}

pub mod bins {
    pub mod point {
        pub use crate::bins::point::{interval, points};
    }
    pub mod record {
        pub use crate::bins::record::{Overlap, Record};
    }
    pub mod strided {
        pub use crate::bins::strided::Strided;
    }
}

pub mod calibrate {
    pub use crate::calibrate::{
        BLOCK_S, CUBE_NAMES, CUBE_PARAMETERS, CubeFit, Doubt, FEWEST, Face, Fit, NAMES, PARAMETERS,
        Position, Stretch, Unfit, Unsteady, alike_deg, doubts, fit, fit_cube,
    };
}

pub mod capture {
    pub use crate::capture::{
        CaptureError, ClockSource, Durable, Header, Reader, RegistersOf, SYNC_PERIOD, Writer,
    };
}

pub mod export {
    pub use crate::export::{Format, export};
    pub mod input {
        pub use crate::export::input::Input;
    }
}

pub mod inspect {
    pub use crate::inspect::Session;
    pub use crate::inspect::gravity::Readings;
}

pub mod fit {
    pub mod design {
        pub use crate::fit::design::Design;
    }
    pub mod likelihood {
        pub mod components {
            pub use crate::fit::likelihood::components::SEEN;
        }
        pub mod information {
            pub use crate::fit::likelihood::information::*;
        }
        pub mod terms {
            pub use crate::fit::likelihood::terms::*;
        }
        pub mod whittle {
            pub use crate::fit::likelihood::whittle::*;
        }
    }
}

#[cfg(feature = "image")]
pub mod flash {
    pub use crate::flash::{CHIP, Image};
    #[cfg(feature = "flash")]
    pub use crate::flash::{Line, LogError, LogTable, follow, program, ring, shipped};
}

pub mod link {
    pub use crate::link::{Client, Clock, Connect, LinkError, Patience, Port, SerialConnect};
}

pub mod model {
    pub use crate::model::{Coefficient, PerCoefficient, Seed, Term};
    pub mod axis {
        pub use crate::model::axis::ModelAxis;
    }
    pub mod catalogue {
        pub use crate::model::catalogue::CATALOGUE;
    }
    pub mod law {
        pub use crate::model::law::Law;
    }
    pub mod markov {
        pub use crate::model::markov::Markov;
    }
    pub mod published {
        pub use crate::model::published::{DURATION_S, PublishedAxis, RATE_HZ};
    }
    pub mod random {
        pub use crate::model::random::{Gaussian, Generator};
    }
    pub mod white {
        pub use crate::model::white::White;
    }
    pub mod whole {
        pub use crate::model::whole::{Model, SCHEMA};
    }
}

pub mod report {
    pub mod json {
        pub use crate::report::json::write;
    }
}

pub mod signal {
    pub use crate::signal::{Axis, Signal, Unit};
}

pub mod simulate {
    pub mod capture {
        pub use crate::simulate::capture::write_capture;
    }
    pub mod source {
        pub use crate::simulate::source::Simulation;
    }
}

pub mod source {
    pub use crate::source::{Block, Chunk, Column, Gap, Source, SourceError, Values};
    pub mod assemble {
        pub use crate::source::assemble::Losses;
    }
    pub mod audit {
        pub use crate::source::audit::{Proof, State};
    }
    pub mod frames {
        pub use crate::source::frames::Frames;
    }
    pub mod board {
        pub use crate::source::board::{BoardSource, Plan, Stop};
    }
    pub mod capture {
        pub use crate::source::capture::CaptureSource;
    }
    pub mod open {
        pub use crate::source::open::stream;
    }
}

pub mod spectrum {
    pub use crate::spectrum::{Cascade, Estimate, Plan, Settings};
}

pub mod virtual_board {
    pub use crate::virtual_board::cube::Cube;
    pub use crate::virtual_board::hand::Hand;
    pub use crate::virtual_board::turned::{Truth, Turned};
    pub use crate::virtual_board::{
        AxisWitness, ClocksOff, Misfortune, ProgramFlash, VirtualConnect, Witness,
    };
}

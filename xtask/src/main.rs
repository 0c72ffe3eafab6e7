//! The one door: what a developer or CI runs, with nothing installed beforehand but rustup.
//!
//! ```text
//!   main      the subcommands
//!   test      every check and every test, what is missing installed first
//!   firmware  the image for the board
//!   shipped   the images that come with `inm`, built again and compared; of which sources: `sources`
//!   size      flash and RAM of the images against their budgets
//!   instructions
//!             what a conversion takes of the processor, counted under QEMU
//!   faults    random fault runs, by `study`
//!   bench     the estimators beside other programs, the simulator
//!   docs      what the README shows of `inm demo`, by `excerpt`
//!   pictures  `inm live` as the documentation shows it, page and terminal
//!   study     simulations too long for every test run
//!   image_test
//!             the board's image on a model of its chip, where the tools are there
//!   fuzz      bytes that a reader does not bear, looked for
//!   deny      licences of what is linked, and defects that are known
//!
//!   image     building an image          elf    reading one
//!   assemble  loader and programs as one ELF
//!   tools     the target and QEMU        run    running a command
//!   layers    which module may import which, a test
//!   names     what an effect is called is said once, a test
//!   bring_up  the page on a first board says what the sources say, a test
//! ```

mod assemble;
mod bench;
#[cfg(test)]
mod bring_up;
mod deny;
mod docs;
mod elf;
mod excerpt;
mod firmware;
mod fuzz;
mod image;
mod image_test;
mod instructions;
#[cfg(test)]
mod layers;
mod links;
mod mark;
#[cfg(test)]
mod names;
mod packages;
mod pictures;
mod run;
mod shipped;
mod size;
mod sources;
mod study;
mod test;
mod tools;

use std::process::ExitCode;

const USAGE: &str = "\
usage: cargo xtask <command>

  test       every check and every test; adds the thumb target and unpacks QEMU where they are missing
  test --quick
             formatting, lints and the tests of the workspace: no image, no QEMU, nothing installed
  firmware   builds the image for the board and says where it is
  image      builds the images that come with `inm` into host/image, with a digest of their sources
  size       flash and RAM of the images and the loader, by section and symbol, held to their budgets
  instructions
             what a conversion takes of the processor at 4000/s, counted under QEMU
  image-test the board's image, unmodified, on a model of its chip; needs cmake and libclang
  faults [FIRST] [RUNS]
             RUNS random fault runs in company (1000) from seed FIRST (0), a tenth of them each on a dirty
             link and with frames out of place, a twentieth of each fault alone; 4 minutes for 20000
  faults --kills N
             kills N recordings, each at a random moment, and compares what is left with what had been written
  bench      speed and memory of the estimators beside other programs, and of the simulator; minutes
  bench simulator
             samples a second of the simulator alone
  docs       the README's figures and picture of `inm demo`, from the program; a minute
  pictures   `inm live` as the documentation shows it, page and terminal; needs Chromium, minutes
  fuzz [TARGET] [--seconds N]
             looks for bytes that a reader does not bear, a minute a target; needs nightly and cargo-fuzz
  deny       licences of all dependencies, sources, and known defects where their list is at hand
  night [--hours H] [--seed S] [options]
             a virtual board at 4000/s to which everything happens, recorded by `inm live`: every sample
             accounted for, memory flat; 12 hours of samples in some twenty minutes
  study intervals
             coverage of the 95 % intervals over thousands of simulated records; minutes
  study diagnose [--seeds N] [--part PART] [--kind KIND] [--strength M]
             whether `inm diagnose` finds effects hidden in records; hours for 200 seeds
  study everyday [--seeds N] [--kind KIND]
             whether `inm diagnose` says what happened: a knock, a door, a fan, a logger that averages
  study added --records LIST [--seeds N] [--kind KIND]
             whether `inm diagnose` names effects added to stretches of real records, and nothing beside;
             LIST is JSON: docs/explanation/judge.md says what is in it
  study robust [--records N] [--first-seed S]
             whether `inm diagnose` keeps its head on records of any length, type and content; an hour
             for 5000
  study live [--minutes N]
             three tabs in Chromium through N minutes (10) of a board at ten times its speed: no sample lost,
             none of the tabs grows; a minute and a build for ten
  study published [--records N]
             the published table simulated N times (400) an axis: published, weighted and likelihood
             fit beside the Cramér-Rao bound; a second and a half a record and axis
  study false-terms [--records N]
             terms claimed that are not there, intervals and bounds at the edge of being seen, over N
             (1000) records a case; half a minute for a hundred
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let result = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["test"] => test::run(),
        ["test", "--quick"] => test::quick(),
        ["firmware"] => firmware::run(),
        ["image"] => shipped::run(),
        ["size"] => size::run(),
        ["instructions"] => instructions::run(),
        ["image-test"] => image_test::run(),
        ["faults", ref options @ ..] => study::faults(options),
        ["bench"] => bench::run(),
        ["bench", "simulator"] => bench::simulator(),
        ["docs"] => docs::run(),
        ["pictures"] => pictures::pictures(),
        ["fuzz", ref options @ ..] => fuzz::run(options),
        ["deny"] => deny::run(),
        ["night", ref options @ ..] => study::night(options),
        ["study", "intervals"] => study::intervals(),
        ["study", "diagnose", ref options @ ..] => study::diagnose(options),
        ["study", "everyday", ref options @ ..] => study::everyday(options),
        ["study", "added", ref options @ ..] => study::added(options),
        ["study", "robust", ref options @ ..] => study::robust(options),
        ["study", "live"] => study::live(None),
        ["study", "live", "--minutes", minutes] => study::live(Some(minutes)),
        ["study", "published"] => study::example("study_published", None),
        ["study", "published", "--records", count] => {
            study::example("study_published", Some(count))
        }
        ["study", "false-terms"] => study::example("study_false_terms", None),
        ["study", "false-terms", "--records", count] => {
            study::example("study_false_terms", Some(count))
        }
        [] | ["help" | "--help" | "-h"] => {
            print!("{USAGE}");
            return ExitCode::SUCCESS;
        }
        _ => {
            eprint!("xtask does not know `{}`\n\n{USAGE}", arguments.join(" "));
            return ExitCode::from(2);
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("xtask: {error:#}");
            ExitCode::FAILURE
        }
    }
}

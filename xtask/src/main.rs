//! The one door: what a developer or CI runs, with nothing installed beforehand but rustup.
//!
//! ```text
//!   main      the subcommands
//!   test      every check and every test, what is missing installed first
//!   firmware  the image for the board
//!   size      flash and RAM of both images against their budgets
//!   instructions
//!             what a conversion takes of the processor, counted under QEMU
//!   bench     the estimators beside other programs
//!   study     simulations too long for every test run
//!
//!   image     building an image          elf    reading one
//!   tools     the target and QEMU        run    running a command
//! ```

mod bench;
mod elf;
mod firmware;
mod image;
mod instructions;
mod run;
mod size;
mod study;
mod test;
mod tools;

use std::process::ExitCode;

const USAGE: &str = "\
usage: cargo xtask <command>

  test       every check and every test; installs the thumb target and QEMU if they are missing
  firmware   builds the image for the board and says where it is
  size       flash and RAM of both images, by section and symbol, held to their budgets
  instructions
             what a conversion takes of the processor at 4000/s, counted under QEMU
  bench      speed and memory of the estimators beside other programs; minutes
  study intervals
             coverage of the 95 % intervals over thousands of simulated records; minutes
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let result = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["test"] => test::run(),
        ["firmware"] => firmware::run(),
        ["size"] => size::run(),
        ["instructions"] => instructions::run(),
        ["bench"] => bench::run(),
        ["study", "intervals"] => study::intervals(),
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

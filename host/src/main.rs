//! `inm`: the command line of the noise bench.

fn main() -> std::process::ExitCode {
    inm_host::command_line()
}

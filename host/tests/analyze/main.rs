//! `inm analyze` and `inm simulate` as a user runs them: on files, through the command line.

mod input;
mod refused;
mod result;

use assert_cmd::Command;
use std::path::Path;

/// The program, in a folder of its own so that messages name files without their folders.
fn inm(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("inm"));
    command.current_dir(folder).args(arguments);
    command
}

/// Runs a command that must succeed and returns its standard output.
fn succeed(folder: &Path, arguments: &[&str]) -> String {
    let output = inm(folder, arguments)
        .assert()
        .success()
        .get_output()
        .clone();
    String::from_utf8(output.stdout).expect("text")
}

/// Runs a command that must end with exit status 2 and returns its message.
fn fail(folder: &Path, arguments: &[&str]) -> String {
    let output = inm(folder, arguments).assert().code(2).get_output().clone();
    String::from_utf8(output.stderr).expect("text")
}

fn npy(descr: &str, fortran: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': {descr}, 'fortran_order': {fortran}, 'shape': {shape}, }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend(
        u16::try_from(header.len())
            .expect("short header")
            .to_le_bytes(),
    );
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    bytes
}

/// The 1000-point frequency set of NIST SP 1065, section 12.4, from its recurrence
/// `n[i+1] = 16807 n[i] mod 2147483647`, `n[0] = 1234567890`, divided by the modulus.
fn nbs_set() -> Vec<f64> {
    let next = |&n: &u64| Some(16_807 * n % 2_147_483_647);
    std::iter::successors(Some(1_234_567_890_u64), next)
        .take(1000)
        .map(|n| n as f64 / 2_147_483_647.0)
        .collect()
}

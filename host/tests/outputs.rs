//! Files that results go to, as a user names them.

use std::fs;

use assert_cmd::Command;

/// `inm analyze run.inmcap --json run.inmcap` destroyed the recording, and said that all was well.
#[test]
fn an_output_never_replaces_what_was_recorded() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let capture = fs::read("../tests/golden/board.inmcap").expect("a recording");
    let model = fs::read("../tests/golden/model.json").expect("a model");
    fs::write(folder.path().join("run.inmcap"), &capture).expect("written");
    fs::write(folder.path().join("model.json"), &model).expect("written");
    for (arguments, why) in [
        ("analyze run.inmcap --json run.inmcap", "is read"),
        ("analyze ./run.inmcap --report run.inmcap", "is read"),
        ("replay run.inmcap --png run.inmcap", "is read"),
        ("diagnose run.inmcap --save-model run.inmcap", "is read"),
        ("diagnose run.inmcap --model published", "built-in model"),
        (
            "diagnose run.inmcap --save-model published:X",
            "built-in model",
        ),
        ("analyze run.inmcap --json a.x --report a.x", "two results"),
        ("simulate --model model.json -o model.json", "is read"),
        ("simulate --model published -o run.inmcap", "is a recording"),
        (
            "export model.json --to state-space -o model.json",
            "is read",
        ),
        (
            "export published:X --to state-space -o run.inmcap",
            "is a recording",
        ),
    ] {
        let output = Command::new(assert_cmd::cargo::cargo_bin!("inm"))
            .current_dir(folder.path())
            .args(arguments.split(' '))
            .output()
            .expect("inm runs");
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments}: {message}");
        assert!(message.contains(why), "{arguments}: {message}");
    }
    assert_eq!(
        fs::read(folder.path().join("run.inmcap")).expect("there"),
        capture
    );
    assert_eq!(
        fs::read(folder.path().join("model.json")).expect("there"),
        model
    );
    assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 2);
}

//! Files that results go to; `-` is standard output.
//!
//! A result is written beside its file and renamed when it is whole: a full disk or a kill leaves what
//! was there before.

use std::fs::{self, File, Metadata};
use std::io::{BufWriter, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, bail, ensure};
use tempfile::NamedTempFile;

use crate::plain::shown;
use crate::source::open::{CAPTURE_START, STANDARD_INPUT};

/// Stands for standard output in place of a file name.
const STANDARD_OUTPUT: &str = "-";

/// Name of the models that need no file, and what it begins with.
const BUILT_IN: &str = "published";

/// Permissions of a new file, before the user's mask.
#[cfg(unix)]
const NEW_FILE: u32 = 0o666;

/// Refuses `outputs` that would destroy something, before any work is done: one of the `inputs`, a
/// recording, or each other; and the names of built-in models.
///
/// # Errors
/// The message names the file, and what it is.
pub fn check(outputs: &[Option<&str>], inputs: &[Option<&str>]) -> anyhow::Result<()> {
    let inputs = inputs
        .iter()
        .flatten()
        .filter(|input| **input != STANDARD_INPUT);
    let inputs: Vec<&str> = inputs.copied().collect();
    let outputs = outputs
        .iter()
        .flatten()
        .filter(|output| **output != STANDARD_OUTPUT);
    let outputs: Vec<&str> = outputs.copied().collect();
    for (number, output) in outputs.iter().enumerate() {
        ensure!(
            !inputs.iter().any(|input| is_same(input, output)),
            "{output}: is read, and would be overwritten; give the result another name"
        );
        ensure!(
            !outputs[..number].iter().any(|other| is_same(other, output)),
            "{output}: two results would go to this file; give them different names"
        );
        refuse(output)?;
    }
    Ok(())
}

/// Refuses a built-in name and a recording.
fn refuse(path: &str) -> anyhow::Result<()> {
    let is_built_in = path
        .strip_prefix(BUILT_IN)
        .is_some_and(|rest| rest.is_empty() || rest.starts_with(':'));
    ensure!(
        !is_built_in,
        "{path}: is the name of a built-in model, which no file can have; give another name, such as \
         found.json"
    );
    let mut start = Vec::new();
    // What cannot be read is no recording of ours, or fails when it is written.
    if fs::metadata(path).is_ok_and(|about| about.is_file())
        && let Ok(file) = File::open(path)
        && file
            .take(CAPTURE_START.len() as u64)
            .read_to_end(&mut start)
            .is_ok()
        && start == CAPTURE_START
    {
        bail!("{path}: is a recording, which is never overwritten; give the result another name");
    }
    Ok(())
}

/// Whether two names are of one file, there or not.
fn is_same(one: &str, other: &str) -> bool {
    let about = |path: &str| fs::metadata(path).ok();
    match (about(one), about(other)) {
        (Some(one_about), Some(other_about)) => {
            is_same_file(&one_about, &other_about) || resolved(one) == resolved(other)
        }
        _ => resolved(one) == resolved(other),
    }
}

/// Whether two files that are there are one by different links.
#[cfg(unix)]
fn is_same_file(one: &Metadata, other: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    one.is_file() && (one.dev(), one.ino()) == (other.dev(), other.ino())
}

#[cfg(not(unix))]
fn is_same_file(_: &Metadata, _: &Metadata) -> bool {
    false
}

/// The path without links, as far as it exists.
fn resolved(path: &str) -> PathBuf {
    let path = Path::new(path);
    fs::canonicalize(path).unwrap_or_else(|_| {
        let folder = folder(path);
        let folder = fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned());
        path.file_name()
            .map_or(folder.clone(), |name| folder.join(name))
    })
}

/// The folder that a file is in.
fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Shows text on standard output. A reader that went away, as `head` does, has had enough: that is no
/// error, and what the program is doing goes on.
///
/// # Errors
/// If it cannot be written, for instance because the disk is full.
pub fn say(text: &str) -> std::io::Result<()> {
    let mut output = std::io::stdout().lock();
    let said = output
        .write_all(shown(text).as_bytes())
        .and_then(|()| output.flush());
    match said {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        said => said,
    }
}

/// Writes to the file `path`, or to standard output if it is `-`. The file is there when all of it is
/// written; until then, and if that fails, what was there before stays.
///
/// # Errors
/// If the file is a recording, has the name of a built-in model, or cannot be written; the message
/// names it.
pub fn write_to(
    path: &str,
    write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> anyhow::Result<()> {
    if path == STANDARD_OUTPUT {
        let mut output = BufWriter::new(std::io::stdout().lock());
        write(&mut output)?;
        output.flush()?;
        return Ok(());
    }
    refuse(path)?;
    let create = || format!("{path}: cannot be created");
    let about = fs::metadata(path).ok();
    // A device or a pipe has no other name to be written under.
    if about
        .as_ref()
        .is_some_and(|about| !about.is_file() && !about.is_dir())
    {
        let mut output = BufWriter::new(File::create(path).with_context(create)?);
        return write(&mut output)
            .and_then(|()| output.flush())
            .with_context(|| format!("{path}: cannot be written"));
    }
    let target = resolved(path);
    let beside = beside(folder(&target), about.as_ref()).with_context(create)?;
    let mut output = BufWriter::new(beside);
    write(&mut output)
        .and_then(|()| {
            output
                .into_inner()
                .map_err(std::io::IntoInnerError::into_error)
        })
        .and_then(|beside| {
            beside.as_file().sync_all()?;
            beside.persist(&target).map_err(|error| error.error)
        })
        .with_context(|| format!("{path}: cannot be written"))?;
    Ok(())
}

/// A file in `folder` that is gone if it is not kept, with the permissions of the one that it replaces.
fn beside(folder: &Path, replaced: Option<&Metadata>) -> std::io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".inm-").suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(NEW_FILE));
    }
    fs::metadata(folder)?;
    // Without the name beside, which nobody asked for.
    let file = builder.tempfile_in(folder);
    let file = file.map_err(|error| std::io::Error::from(error.kind()))?;
    if let Some(replaced) = replaced {
        file.as_file().set_permissions(replaced.permissions())?;
    }
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder, and the names of files in it.
    fn place() -> (tempfile::TempDir, impl Fn(&str) -> String) {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().to_owned();
        (folder, move |name: &str| {
            path.join(name).display().to_string()
        })
    }

    #[test]
    fn what_fails_half_way_leaves_what_was_there() {
        let (folder, name) = place();
        let path = name("old.json");
        for before in [Some("old"), None] {
            match before {
                Some(text) => fs::write(&path, text).expect("written"),
                None => fs::remove_file(&path).expect("removed"),
            }
            let error = write_to(&path, |output| {
                output.write_all(b"half")?;
                Err(std::io::ErrorKind::StorageFull.into())
            });
            let said = format!("{:#}", error.expect_err("a full disk"));
            assert!(
                said.starts_with(&format!("{path}: cannot be written")),
                "{said}"
            );
            assert_eq!(fs::read_to_string(&path).ok().as_deref(), before);
            let left = fs::read_dir(folder.path()).expect("a folder").count();
            assert_eq!(left, usize::from(before.is_some()));
        }
        write_to(&path, |output| output.write_all(b"new")).expect("written");
        assert_eq!(fs::read_to_string(&path).expect("there"), "new");
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_one_and_permissions_stay() {
        use std::os::unix::fs::PermissionsExt;
        let (_folder, name) = place();
        let (file, link) = (name("file.json"), name("link.json"));
        fs::write(&file, "old").expect("written");
        fs::set_permissions(&file, fs::Permissions::from_mode(0o640)).expect("set");
        std::os::unix::fs::symlink(&file, &link).expect("linked");
        write_to(&link, |output| output.write_all(b"new")).expect("written");
        assert_eq!(fs::read_to_string(&file).expect("there"), "new");
        assert!(fs::symlink_metadata(&link).expect("there").is_symlink());
        let mode = fs::metadata(&file).expect("there").permissions().mode();
        assert_eq!(mode & 0o777, 0o640);
    }

    #[test]
    fn an_output_that_would_destroy_something_is_refused() {
        let (_folder, name) = place();
        let (record, capture) = (name("record.npy"), name("run.inmcap"));
        fs::write(&record, "samples").expect("written");
        fs::write(&capture, [CAPTURE_START, b" 1\n"].concat()).expect("written");
        let linked = name("linked.npy");
        fs::hard_link(&record, &linked).expect("linked");
        let detour = name("./record.npy");
        let (new, read) = (name("new.json"), Some(record.as_str()));
        for (outputs, why) in [
            ([Some(record.as_str()), None], "is read"),
            ([Some(&linked), None], "is read"),
            ([Some(&detour), None], "is read"),
            ([Some(&capture), None], "is a recording"),
            ([Some(&new), Some(&new)], "two results"),
            ([Some("published"), None], "built-in model"),
            ([Some("published:X"), None], "built-in model"),
        ] {
            let error = check(&outputs, &[read]).expect_err(why).to_string();
            assert!(error.contains(why), "{error}");
        }
        check(&[Some(&new), Some("-"), Some("-")], &[read, Some("-")]).expect("harmless");
        write_to(&capture, |_| Ok(())).expect_err("a recording");
    }
}

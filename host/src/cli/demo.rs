//! `inm demo`: the whole chain in one command, without hardware: a virtual board with an effect
//! hidden in it, recording, analysis, and a diagnosis that has to find it.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;

use super::interrupt;
use super::output::{say, write_to};
use super::recording::parse_positive;
use super::results::ResultOptions;
use crate::analyse::{AnalysisOptions, summarise};
use crate::bins::record::{Overlap, Record};
use crate::diagnosis::result::finding::Diagnosis;
use crate::face::diagnose::{DiagnosisError, DiagnosisOptions, diagnose};
use crate::live::{ScreenArtist, watch};
use crate::report::{self, Report, reveal};
use crate::source::Source;
use crate::source::board::{BoardSource, Plan};
use crate::source::open::open;
use crate::source::options::ArrayOptions;
use crate::virtual_board::{Hidden, VirtualConnect, hide};

/// Arguments of `inm demo`.
#[derive(Debug, Args)]
pub struct DemoCommand {
    /// Seconds of board time; the published experiment took 5400.
    #[arg(
        long,
        value_name = "S",
        default_value_t = 1800.0,
        allow_negative_numbers = true,
        value_parser = parse_positive
    )]
    duration: f64,
    /// Folder for capture, JSON, HTML, PNG and model; what an earlier demo left there is replaced.
    #[arg(long, value_name = "FOLDER", default_value = "inm-demo")]
    output: PathBuf,
    /// Seed of the virtual board's noise, and of what is hidden in it.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

impl DemoCommand {
    /// Runs the subcommand.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn run(self) -> anyhow::Result<()> {
        let place = |name: &str| self.output.join(name);
        std::fs::create_dir_all(&self.output)
            .with_context(|| format!("{}: the folder cannot be made", self.output.display()))?;
        let capture = place("demo.inmcap");
        forget(&capture)?;

        say(&format!(
            "A virtual board: three MMA7331L with the published noise, three ADS1281 at register\n\
             level, the firmware's own code, a 921600 baud link. Seed {}, {} s at 2000/s.\n\
             Something else acts on one of the sensors.\n\n",
            self.seed, self.duration
        ))?;
        let stop = interrupt::stop_on_signal()?;
        let plan = Plan {
            settings: Some(inm_protocol::Settings::default()),
            samples: Some((self.duration * 2000.0) as u64),
            ..Plan::default()
        };
        let hidden = hide::draw(self.seed, self.duration).map_err(anyhow::Error::msg)?;
        let connect = Box::new(VirtualConnect {
            hidden: Some(hidden.clone()),
            ..VirtualConnect::published(self.seed, 0.0)
        });
        let mut source = BoardSource::start(connect, plan, Some(&capture), stop)?;
        let signal = source.signal().clone();
        let mut record = Record::new(signal.axes.len(), Overlap::Strided);
        let screen = ScreenArtist::lines();
        watch(&mut source, Some(&mut record), screen)?;

        say("\n")?;
        let results = self.results("demo");
        results.write(&summarise(&signal, &record, &AnalysisOptions::default()))?;

        let diagnosis = diagnosed(&text(&capture))?;
        say("\nWhat the five terms get wrong, and why:\n\n")?;
        let pictures = self.results("diagnosis");
        pictures.write(&diagnosis)?;
        let [picture, model] = self.write_found(&hidden, &diagnosis)?;
        let mut told = format!(
            "\n{}\n{}\n",
            reveal::render(&hidden, &diagnosis),
            capture.display()
        );
        for path in [&results.json, &results.report, &results.png]
            .into_iter()
            .chain([&pictures.json, &pictures.report, &pictures.png])
            .flatten()
        {
            told += &format!("{path}\n");
        }
        told += &format!(
            "{picture}\n{model}\n\nAgain from the file: inm analyze {file}, inm diagnose {file}\n\
             Data of the model that was found: inm simulate --model {model} -o found.npy\n",
            file = capture.display()
        );
        Ok(say(&told)?)
    }

    /// Writes the picture of the axis with the hidden effect, and the model; their names.
    fn write_found(&self, hidden: &Hidden, diagnosis: &Diagnosis) -> anyhow::Result<[String; 2]> {
        let [picture, model] =
            ["hidden.png", "model.json"].map(|name| text(&self.output.join(name)));
        let bitmap = reveal::axis(hidden, diagnosis).bitmap()?;
        write_to(&picture, |output| output.write_all(&bitmap))?;
        write_to(&model, |mut output| {
            report::json::write(&diagnosis.model(), &mut output)
        })?;
        Ok([picture, model])
    }

    /// Files of a result in the folder.
    fn results(&self, name: &str) -> ResultOptions {
        let file = |ending| Some(text(&self.output.join(format!("{name}.{ending}"))));
        ResultOptions {
            json: file("json"),
            report: file("html"),
            png: file("png"),
        }
    }
}

/// The diagnosis of a capture as anyone would make it: from the file alone.
fn diagnosed(capture: &str) -> anyhow::Result<Diagnosis> {
    let mut source = open(capture, &ArrayOptions::default())?;
    diagnose(&mut *source, DiagnosisOptions::default(), &|_, _| {}).map_err(|error| match error {
        DiagnosisError::Source(error) => error.into(),
        DiagnosisError::Refused(refused) => {
            anyhow::anyhow!("{capture}: {refused}; give a longer --duration")
        }
    })
}

/// Removes what an earlier demo left.
fn forget(path: &Path) -> anyhow::Result<()> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            Err(error).with_context(|| format!("{}: cannot be replaced", path.display()))
        }
        _ => Ok(()),
    }
}

fn text(path: &Path) -> String {
    path.display().to_string()
}

//! Effects added to stretches of real records: what the judge promises.

use std::fs;
use std::path::Path;

use inm_tests::hidden::added::case::{Case, kinds, write};
use inm_tests::hidden::added::list::{self, Recording};
use inm_tests::hidden::added::score::{names, score};
use inm_tests::hidden::added::stretch::Stretch;
use inm_tests::hidden::draw::Draw;
use inm_tests::hidden::effect;
use inm_tests::hidden::judge::answer::{Answer, Axis, Finding, Rival};
use inm_tests::hidden::noise::measured::Measured;

const RATE_HZ: f64 = 100.0;

fn white(seed: u64, count: usize, deviation: f64) -> Vec<f64> {
    let mut draw = Draw::new(seed, "white");
    (0..count).map(|_| deviation * draw.normal()).collect()
}

fn recording(axis: Vec<f64>) -> Vec<Recording> {
    vec![Recording {
        name: "desk".into(),
        rate_hz: RATE_HZ,
        axes: vec![axis],
    }]
}

/// What a stretch of white noise of 0.01, rounded or not, is drawn as.
fn stretch(seed: u64, code: Option<f64>) -> Stretch {
    let round = |value: f64| code.map_or(value, |code| (value / code).round() * code);
    let values = white(seed, 60_000, 0.01).into_iter().map(round);
    let recordings = recording(values.collect());
    Stretch::draw(&recordings, seed).expect("all samples are there")
}

fn answer(given: &[&str]) -> Answer {
    let finding = |name: &&str| Finding {
        effect: (*name).to_owned(),
        ..Finding::default()
    };
    Answer {
        axes: vec![Axis {
            findings: given.iter().map(finding).collect(),
            ..Axis::default()
        }],
    }
}

#[test]
fn the_law_of_white_noise_and_of_its_sum_is_measured() {
    for seed in 1..=4 {
        let noise = white(seed, 50_021, 0.3);
        let sum = noise.iter().scan(0.0, |level, one| {
            *level += one;
            Some(*level)
        });
        let walk: Vec<f64> = sum.collect();
        let flat = Measured::of(&noise, RATE_HZ).expect("noise");
        let steep = Measured::of(&walk, RATE_HZ).expect("a walk");
        let density = 0.3 * 0.3 / RATE_HZ;
        for f_hz in [0.5, 3.0, 20.0, 45.0] {
            // A twelfth of an octave of ordinates 1 mHz apart; the logarithm of chi-squared scatters by 2.2.
            let ordinates = f_hz / 1e-3 * (2_f64.powf(1.0 / 12.0) - 1.0);
            let sd = 2.2 / ordinates.sqrt();
            let slope = (2.0 * RATE_HZ * (std::f64::consts::PI * f_hz / RATE_HZ).sin()).powi(2);
            let pairs = [
                (flat.density(f_hz), density),
                (steep.density(f_hz), density * RATE_HZ * RATE_HZ / slope),
            ];
            for (measured, law) in pairs {
                let off = (measured / law).ln();
                // By chance in one of 100 000, of 32.
                assert!(off.abs() < 4.5 * sd, "seed {seed}, {f_hz} Hz: {off}, {sd}");
            }
        }
        assert!(Measured::of(&[2.5; 9000], RATE_HZ).is_none());
    }
}

#[test]
fn codes_are_seen_and_stay_codes() {
    for seed in 1..=8 {
        let coded = stretch(seed, Some(0.002));
        let code = coded.code.expect("multiples of 0.002");
        assert!((code / 0.002 - 1.0).abs() < 1e-6, "seed {seed}: {code}");
        let sinusoid = effect::find("sinusoid").expect("a kind");
        let case = Case::draw(&coded, &[], sinusoid).expect("one that can be seen");
        let is_code = |sample: &f64| (sample / code - (sample / code).round()).abs() < 1e-6;
        assert!(case.samples.iter().all(is_code), "seed {seed}");
        assert_ne!(case.samples, coded.samples, "seed {seed}");
        assert_eq!(stretch(seed, None).code, None, "seed {seed}");
    }
}

#[test]
fn what_a_stretch_has_is_not_added() {
    let plain = stretch(3, None);
    let given = |held: &[&str], stretch: &Stretch| -> Vec<&str> {
        let held: Vec<String> = held.iter().map(|name| (*name).to_owned()).collect();
        let kinds = kinds(stretch, &held);
        kinds.iter().map(|kind| kind.name).collect()
    };
    let all = given(&[], &plain);
    for name in ["sinusoid", "rolloff", "stale", "steps"] {
        assert!(all.contains(&name), "{name}: {all:?}");
    }
    for name in ["thermal", "common_mode", "timebase"] {
        assert!(!all.contains(&name), "{name}: {all:?}");
    }
    let fewer = given(&["steps", "averaging"], &plain);
    for name in ["steps", "averaging", "rolloff"] {
        assert!(!fewer.contains(&name), "{name}: {fewer:?}");
    }
    let coded = given(&[], &stretch(3, Some(0.001)));
    assert!(!coded.contains(&"stale") && coded.contains(&"rolloff"));
    // Rounding by four deviations is most of the noise.
    let coarse = given(&[], &stretch(3, Some(0.04)));
    assert!(!coarse.contains(&"rolloff") && coarse.contains(&"steps"));
}

#[test]
fn repeats_of_a_stretch_that_holds_its_samples_stay_repeats() {
    let fresh = white(5, 30_000, 0.01);
    let held: Vec<f64> = fresh.iter().flat_map(|&value| [value; 2]).collect();
    let stretch = Stretch::draw(&recording(held), 5).expect("all samples are there");
    let kind = effect::find("markov").expect("a kind");
    let again = |held: &[String]| {
        let case = Case::draw(&stretch, held, kind).expect("one that can be seen");
        let pairs = case.samples.windows(2).zip(stretch.samples.windows(2));
        let (mut both, mut bare) = (0, 0);
        for (with, without) in pairs {
            bare += usize::from(without[0] == without[1]);
            both += usize::from(without[0] == without[1] && with[0] == with[1]);
        }
        (both, bare)
    };
    let (both, bare) = again(&["stale".to_owned()]);
    assert!(bare > 4000 && both == bare, "seed 5: {both} of {bare}");
    assert_eq!(again(&[]).0, 0, "seed 5");
}

#[test]
fn only_what_the_bare_stretch_has_not_is_extra() {
    let stretch = stretch(7, None);
    let case = Case::draw(&stretch, &[], effect::find("steps").expect("a kind"));
    let case = case.expect("one that can be seen");
    let bare = answer(&["outliers", "averaging"]);
    let right = score(&case, &stretch, &bare, &answer(&["steps", "outliers"]));
    assert!(right.is_right(), "{right:?}");
    assert_eq!(right.gone, ["averaging"]);
    let wrong = score(&case, &stretch, &bare, &answer(&["steps", "sinusoid"]));
    assert!(wrong.named && wrong.extra == ["sinusoid"], "{wrong:?}");
    let missed = score(&case, &stretch, &bare, &answer(&["outliers"]));
    assert!(!missed.named && missed.extra.is_empty(), "{missed:?}");
    assert_eq!(names(&answer(&["hum", "steps"])), ["hum", "steps"]);
}

#[test]
fn names_that_the_record_does_not_decide_between_are_counted_by_themselves() {
    let stretch = stretch(7, None);
    let case = Case::draw(&stretch, &[], effect::find("steps").expect("a kind"));
    let case = case.expect("one that can be seen");
    // Odds of e^2.9 are 18, of e^3.1 they are 22.
    let said = |name: &str, rival: &str, log_odds: f64| {
        let mut said = answer(&[name]);
        said.axes[0].findings[0].rivals.push(Rival {
            effect: rival.to_owned(),
            log_odds,
        });
        said
    };
    let bare = said("rolloff", "averaging", 2.9);
    let open = score(&case, &stretch, &bare, &said("telegraph", "steps", 2.9));
    assert!(!open.named && open.among && open.new.is_empty(), "{open:?}");
    assert_eq!(open.extra, ["telegraph"]);
    let decided = score(&case, &stretch, &bare, &said("telegraph", "steps", 3.1));
    assert!(!decided.among, "{decided:?}");
    assert_eq!(decided.new, ["telegraph"]);
    let known = score(&case, &stretch, &bare, &answer(&["averaging"]));
    assert!(
        known.extra == ["averaging"] && known.new.is_empty(),
        "{known:?}"
    );
    let bare = said("rolloff", "averaging", 3.1);
    let new = score(&case, &stretch, &bare, &answer(&["averaging"]));
    assert_eq!(new.new, ["averaging"]);
}

#[test]
fn records_of_a_list_are_read_from_its_folder() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = "a,b\n1,10\n2,20\n3,30\n4,40\n";
    fs::write(folder.path().join("desk.csv"), text).expect("a file");
    let list = r#"[{"name": "desk", "file": "desk.csv", "rate": 1, "columns": [1], "scale": 0.5, "from": 1}]"#;
    let path = folder.path().join("list.json");
    fs::write(&path, list).expect("a file");
    let read = list::read(&path).expect("a record");
    assert_eq!((read[0].name.as_str(), read[0].rate_hz), ("desk", 1.0));
    assert_eq!(read[0].axes, [vec![10.0, 15.0, 20.0]]);
    fs::write(&path, r#"[{"name": "desk"}]"#).expect("a file");
    let error = list::read(&path).expect_err("no file is named").to_string();
    assert!(error.contains("missing field `file`"), "{error}");
    let error = list::read(Path::new("no such list")).expect_err("no list");
    assert!(error.to_string().contains("no such list"));
}

#[test]
fn a_stretch_of_codes_is_written_as_integers() {
    let folder = tempfile::tempdir().expect("a folder");
    for (code, scaled) in [(Some(0.002), true), (None, false)] {
        let stretch = stretch(9, code);
        let files = write(&stretch.samples, &stretch, folder.path()).expect("a file");
        let has_scale = files.arguments.iter().any(|one| one == "--scale");
        assert_eq!(has_scale, scaled);
        let header = fs::read(&files.record).expect("the file");
        let descr: &[u8] = if scaled { b"<i4" } else { b"<f8" };
        assert!(header[..128].windows(3).any(|three| three == descr));
    }
}

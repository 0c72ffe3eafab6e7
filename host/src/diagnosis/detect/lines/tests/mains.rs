//! Which lines belong together.

use super::*;

#[test]
fn lines_of_one_base_are_one_and_a_line_by_itself_is_mains_only_where_its_base_or_twice_that_is() {
    let is_hum = |all: &[f64]| {
        let groups = with_hum(all.iter().map(|f_hz| measured(*f_hz)).collect());
        groups
            .iter()
            .any(|group| matches!(group, Group::Hum { .. }))
    };
    for (all, expected) in [
        (&[50.02][..], true),
        (&[119.96], true),
        (&[150.06], false),
        (&[150.06, 250.1], true),
        (&[150.06, 251.1], false),
        // A machine's harmonics, and lines that are none.
        (&[2340.0, 7020.0], true),
        (&[7020.0, 2340.0], true),
        (&[2340.0, 7020.1], false),
        (&[2340.0, 20.0 * 2340.0], true),
        (&[2340.0, 21.0 * 2340.0], false),
    ] {
        assert_eq!(is_hum(all), expected, "{all:?}");
    }
}

#[test]
fn lines_known_too_badly_are_multiples_by_chance() {
    for (sd_hz, is_machine) in [(1e-3, true), (0.1, false)] {
        let lines = [2340.0, 7020.0].map(|f_hz| {
            let mut one = measured(f_hz);
            one.line.frequency_sd_hz = sd_hz;
            one
        });
        let groups = with_hum(lines.to_vec());
        assert_eq!(groups.len() == 1, is_machine, "{sd_hz} Hz: {groups:?}");
    }
}

#[test]
fn mains_are_the_base_of_most_lines_and_of_as_many_that_of_the_strongest() {
    let bases_hz = |lines: &[(f64, f64)]| -> Vec<f64> {
        let lines = lines.iter().map(|(f_hz, ratio)| {
            let mut one = measured(*f_hz);
            one.line.ratio = *ratio;
            one
        });
        let groups = with_hum(lines.collect());
        let bases = groups.iter().filter_map(|group| match group {
            Group::Hum { base_hz, .. } => Some(*base_hz),
            _ => None,
        });
        bases.collect()
    };
    let most = [(50.02, 100.0), (60.0, 50.0), (120.0, 50.0), (180.0, 50.0)];
    assert!((bases_hz(&most)[0] - 60.0).abs() < 1e-6);
    assert_eq!(
        bases_hz(&most).len(),
        1,
        "the line at 50 Hz is one by itself"
    );
    for (ratios, base_hz) in [([50.0, 100.0], 60.01), ([100.0, 50.0], 50.02)] {
        let found = bases_hz(&[(50.02, ratios[0]), (60.01, ratios[1])]);
        assert!(
            found.len() == 1 && (found[0] - base_hz).abs() < 1e-6,
            "{ratios:?}: {found:?}"
        );
    }
    // Of both mains the lower multiple is the likelier.
    assert_eq!(mains_base(300.0), Some((60.0, 5)));
    assert_eq!(mains_base(53.0), None);
}

//! Programming against probe-rs's fake probe: everything but the wire to the chip.
#![cfg(feature = "flash")]

use std::path::Path;

use inm_host::internals::flash::{CHIP, Image, program};
use probe_rs::Permissions;
use probe_rs::integration::FakeProbe;

fn image(len: usize) -> Image {
    Image {
        segments: vec![(0x0800_0000, vec![0x55; len])],
        version: "1.0.0".to_owned(),
        revision: "unknown".to_owned(),
    }
}

#[test]
fn an_image_is_laid_out_for_the_boards_chip() {
    let probe = FakeProbe::with_mocked_core().into_probe();
    let mut session = probe
        .attach(CHIP, Permissions::default())
        .expect("the fake probe attaches");
    let image = image(20_000);
    program(&mut session, &image, true, |_| {}).expect("the dry run passes");
}

#[test]
fn an_image_beyond_the_chips_flash_is_refused() {
    let probe = FakeProbe::with_mocked_core().into_probe();
    let mut session = probe
        .attach(CHIP, Permissions::default())
        .expect("the fake probe attaches");
    // The STM32F405RG has 1 MiB.
    let image = image((1 << 20) + 1);
    let error = program(&mut session, &image, true, |_| {}).expect_err("it does not fit");
    assert!(error.to_string().contains(CHIP), "{error}");
}

#[test]
fn a_missing_file_is_an_error_of_its_own() {
    let error = Image::read(Path::new("no-such-image.elf")).expect_err("it is not there");
    assert!(error.to_string().contains("no-such-image.elf"), "{error}");
}

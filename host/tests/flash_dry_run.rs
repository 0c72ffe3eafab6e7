//! Programming against probe-rs's fake probe: everything but the wire to the chip.
#![cfg(feature = "flash")]

use std::path::Path;

use inm_host::internals::flash::{CHIP, Image, program};
use inm_protocol::image::BOARD;
use probe_rs::Permissions;
use probe_rs::integration::FakeProbe;

#[path = "image/mod.rs"]
mod image;

/// A loader, and programs of `len` bytes and a few.
fn image(len: usize) -> Image {
    let parts = image::image(BOARD, "1.0.0", len);
    Image::parse(&image::elf(&parts)).expect("a sound image")
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
    let mut image = image(20_000);
    // The STM32F405RG has 1 MiB.
    image.segments.push((0x0810_0000, vec![0x55]));
    let error = program(&mut session, &image, true, |_| {}).expect_err("it does not fit");
    assert!(error.to_string().contains(CHIP), "{error}");
}

#[test]
fn a_missing_file_is_an_error_of_its_own() {
    let error = Image::read(Path::new("no-such-image.elf")).expect_err("it is not there");
    assert!(error.to_string().contains("no-such-image.elf"), "{error}");
}

//! The image that comes with this program, so that who installs it needs nothing to build one
//! (`cargo xtask image` in a clone writes it, and a test there says when it is of other sources).

use super::Image;
use super::image_error::ImageError;

/// The board's program, an ELF file with its log table.
pub const BOARD: &[u8] = include_bytes!("../../image/inm-board.elf");

/// What it is called in messages.
pub const NAME: &str = "the image that comes with inm";

/// That program, checked as a file would be.
///
/// # Errors
/// It is none, which a test rules out.
pub fn image() -> Result<Image, ImageError> {
    Image::parse(BOARD).map_err(|problem| ImageError {
        path: NAME.into(),
        problem,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_a_sound_image_of_this_release() {
        let image = image().expect("an image");
        assert_eq!(image.version, env!("CARGO_PKG_VERSION"));
        assert!(image.revision.starts_with("sources "), "{}", image.revision);
    }
}

//! The image that comes with this program, so that who installs it needs nothing to build one
//! (`cargo xtask image` in a clone writes it, and a test there says when it is of other sources).

/// The board's program, an ELF file with its log table.
pub const BOARD: &[u8] = include_bytes!("../../image/inm-board.elf");

/// What it is called in messages.
pub const NAME: &str = "the image that comes with inm";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flash::Image;

    #[test]
    fn it_is_a_sound_image_of_this_release() {
        let image = Image::parse(BOARD).expect("an image");
        assert_eq!(image.version, env!("CARGO_PKG_VERSION"));
        assert!(image.revision.starts_with("sources "), "{}", image.revision);
    }
}

//! Which chip it is.

use stm32f4xx_hal::signature::Uid;

/// Unique number of the chip: place on the wafer, then wafer and lot.
pub fn serial_number() -> [u32; 3] {
    let uid = Uid::get();
    let place = u32::from(uid.x()) << 16 | u32::from(uid.y());
    let mut lot = [0; 8];
    let name = uid.lot_num().as_bytes();
    let len = name.len().min(lot.len() - 1);
    lot[0] = uid.waf_num();
    lot[1..=len].copy_from_slice(&name[..len]);
    let [a, b, c, d, e, f, g, h] = lot;
    [
        place,
        u32::from_le_bytes([a, b, c, d]),
        u32::from_le_bytes([e, f, g, h]),
    ]
}

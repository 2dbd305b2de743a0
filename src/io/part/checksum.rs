//! Tells a part that is as it was written from one that was damaged since.

use super::Sum;
use super::header::Header;
use glam::UVec2;

/// Of what a part says of itself and of its sums, row by row: FNV-1a (Fowler, Noll, Vo) over words of 64 bits instead of
/// bytes, as there are 48 bytes a pixel. Every step can be undone, so that no single word that differs goes unseen. It
/// guards against damage, not against forgers.
pub(super) fn checksum(header: &Header, size: UVec2, sums: impl Iterator<Item = Sum>) -> u64 {
    let mut hash = Hash(0xcbf2_9ce4_8422_2325);
    for byte in header.to_text().bytes() {
        hash.add(byte.into());
    }
    hash.add(u64::from(size.x) << 32 | u64::from(size.y));
    for sum in sums {
        for [a, b, c, d] in sum.to_words() {
            hash.add(u64::from(a) << 32 | u64::from(b));
            hash.add(u64::from(c) << 32 | u64::from(d));
        }
    }
    hash.0
}

struct Hash(u64);

impl Hash {
    fn add(&mut self, word: u64) {
        // A product keeps what stands high from what stands low: the turn brings it there.
        self.0 = (self.0 ^ word)
            .wrapping_mul(0x0000_0100_0000_01b3)
            .rotate_left(29);
    }
}

use super::budget::Budget;

/// How much a file may ask for. What asks for more is refused before anything is allocated.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of one file that is read.
    pub file_bytes: u64,
    /// Vertices of one mesh; indices are 32 bits wide.
    pub vertices: u64,
    /// Triangles of one file.
    pub triangles: u64,
    /// Pixels of one picture.
    pub pixels: u64,
    /// Entities of one file.
    pub entities: u64,
    /// Ancestors of an entity. Bevy removes and places children by recursion.
    pub depth: u64,
    /// Bytes of one line of a text file.
    pub line_bytes: usize,
    /// Memory of everything together.
    pub memory: Budget,
}

impl Limits {
    /// Pixels on either side of a picture.
    pub const PICTURE_SIDE: u64 = 65_536;
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            file_bytes: 1 << 36,
            vertices: 1 << 31,
            triangles: 1 << 31,
            pixels: 1 << 28,
            entities: 1 << 24,
            depth: 256,
            line_bytes: 1 << 20,
            memory: Budget::default(),
        }
    }
}

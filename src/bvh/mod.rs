//! Triangles, trees over them, and the rays that walk those trees.

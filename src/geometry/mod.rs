//! Ground: rays, boxes, the watertight triangle test and the eight-wide tree over triangles.

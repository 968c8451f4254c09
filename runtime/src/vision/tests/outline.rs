//! Tests of boxes and outlines.

//! Tests of what a corner detector looks at.

//! Tests of the layers drawn for a model.

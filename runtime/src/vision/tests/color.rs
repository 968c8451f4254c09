//! Tests of masks by colour and of grey levels.

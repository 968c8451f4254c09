//! Names the system packages that a build lacks, in one line with the command that installs them.
//!
//! There is no code here: the build script does it. The build script of OpenCV's bindings would fail with hundreds of
//! lines. Cargo shows the first failure alone, and runs first what more packages wait for. So this is a package of its
//! own below `fab-vision`: as the build script of `fab-vision` itself it would often come second.

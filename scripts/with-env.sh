#!/bin/sh
# Runs a command in the build's environment: with-env.sh COMMAND [ARGUMENT...]
#
# What that environment adds, and when, is said in the two scripts it reads.
set -eu
here=$(dirname "$0")
toolchain=$(sh "$here/toolchain-env.sh")
opencv=$(sh "$here/opencv-env.sh")
eval "$toolchain"
eval "$opencv"
exec "$@"

#!/bin/sh
# Runs a command in the build's environment: with-env.sh COMMAND [ARGUMENT...]
#
# toolchain-env.sh and opencv-env.sh say what that environment adds, and when.
set -eu
here=$(dirname "$0")
toolchain=$(sh "$here/toolchain-env.sh")
opencv=$(sh "$here/opencv-env.sh")
eval "$toolchain"
eval "$opencv"
exec "$@"

# shellcheck shell=bash
# Sourced by the tests of the build: TEST SOURCE_FOLDER BUILD_FOLDER LIBRARY_FOLDER.
set -euo pipefail

source_folder=$1
# shellcheck disable=SC2034
build_folder=$2 library_folder=$3
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT

fail() { printf 'FAILED: %s\n' "$*" >&2; exit 1; }
# ctest shows the reason, and counts the test as skipped.
skip() { printf 'SKIPPED: %s\n' "$*"; exit 77; }

# Runs a command as a new user's shell would: nothing of this one's environment.
bare() { env -i PATH=/usr/bin:/bin HOME="$work" LANG=C "$@"; }

# Configures a project quietly: FOLDER BUILD_FOLDER [ARGUMENT...]; shows the messages if it fails.
configure_project() {
  local folder=$1 build=$2
  shift 2
  bare cmake -S "$folder" -B "$build" -G Ninja "$@" >"$build.log" 2>&1 ||
    { cat "$build.log" >&2; fail "$folder does not configure with $*"; }
}

# Expects that a command fails, and that its output has each of the texts: TEXTS... -- COMMAND...
expect_failure() {
  local texts=() output text
  while [[ $1 != -- ]]; do texts+=("$1"); shift; done
  shift
  if output=$("$@" 2>&1); then fail "this should fail: $*: $output"; fi
  for text in "${texts[@]}"; do
    [[ $output == *"$text"* ]] || fail "the message lacks \"$text\": $output"
  done
}

# Without tests, nodes, GPU: what the smallest build has.
# shellcheck disable=SC2034
smallest=(-DPLIANT_ROS=OFF -DPLIANT_TESTS=OFF -DPLIANT_BENCH=OFF -DPLIANT_CUDA=OFF)

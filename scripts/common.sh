# shellcheck shell=bash
# Sourced by ./check and ./demo, under `set -euo pipefail`.

pliant_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
pliant_build=$pliant_root/build
# Beside the build folder, not in it: rosrun looks at nothing below a package's build/.
pliant_devel=$pliant_root/devel

# The setup files of catkin tolerate neither -e nor -u, and read the caller's arguments.
source_ros() {
  local file=$1
  set --
  set +eu
  # shellcheck disable=SC1090
  . "$file"
  set -eu
}

# ROS 1 works with the system's Python only, whichever other one the user has put first. Logs and
# test results stay in the build folder.
prepare_environment() {
  unset PYTHONHOME PYTHONPATH PYTHONSTARTUP ROS_IP ROS_NAMESPACE PLIANT_BRIEF
  if [[ -f /opt/ros/noetic/setup.sh ]]; then source_ros /opt/ros/noetic/setup.sh; fi
  export PATH=/usr/bin:/bin:$PATH
  export ROS_HOSTNAME=127.0.0.1
  export ROS_HOME=$pliant_build/ros ROS_LOG_DIR=$pliant_build/log
  export XDG_CACHE_HOME=$pliant_build/cache  # nothing that another build has kept
  mkdir -p "$ROS_HOME" "$ROS_LOG_DIR" "$XDG_CACHE_HOME"
  export NINJA_STATUS='[%p] '  # as make shows it
}

run_setup() {
  if [[ ${PLIANT_SKIP_SETUP:-0} == 1 ]]; then
    printf 'setup: skipped, since PLIANT_SKIP_SETUP=1\n'
  else
    "$pliant_root/scripts/setup"
  fi
}

configure() {
  local cache=$pliant_build/CMakeCache.txt home generator=()
  if [[ -f $cache ]]; then
    home=$(sed -n 's/^CMAKE_HOME_DIRECTORY:INTERNAL=//p' "$cache")
    if [[ -n $home && $home != "$pliant_root" ]]; then
      printf '%s was made for %s; remove it and try again: rm -r %q\n' \
        "$pliant_build" "$home" "$pliant_build" >&2
      return 1
    fi
  fi
  # make leaves a core idle at the end of each target; a folder that it was begun with stays with it.
  if [[ ! -f $cache && -z ${CMAKE_GENERATOR:-} ]] && command -v ninja >/dev/null; then
    generator=(-G Ninja)
  fi
  cmake -S "$pliant_root" -B "$pliant_build" "${generator[@]}" -DCMAKE_BUILD_TYPE=Release \
    -DCATKIN_DEVEL_PREFIX="$pliant_devel" -DPLIANT_TESTS=ON -DPLIANT_ROS="${PLIANT_ROS:-ON}"
}

# True when the build folder is configured as `configure` does it; CMake itself follows later
# changes of its files.
is_configured() {
  [[ -f $pliant_devel/setup.sh ]] &&
    [[ -f $pliant_build/Makefile || -f $pliant_build/build.ninja ]] &&
    grep -q "^CATKIN_DEVEL_PREFIX:[A-Z]*=$pliant_devel\$" "$pliant_build/CMakeCache.txt" &&
    grep -qx "CMAKE_HOME_DIRECTORY:INTERNAL=$pliant_root" "$pliant_build/CMakeCache.txt" &&
    grep -q '^CMAKE_BUILD_TYPE:[A-Z]*=Release$' "$pliant_build/CMakeCache.txt"
}

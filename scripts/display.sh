# shellcheck shell=bash
# Sourced after common.sh by what shows rviz and ends by itself: a virtual display, and a roslaunch
# beside it. Whoever sources it defines `fail`, and calls stop_launch and stop_display at its end.

launch_pid=
display_pid=
runtime_dir=

display_reachable() {
  [[ -n ${DISPLAY:-} ]] && timeout 10 /usr/bin/python3 - <<'PYTHON'
import ctypes, sys
x11 = ctypes.CDLL("libX11.so.6")
x11.XOpenDisplay.restype = ctypes.c_void_p
sys.exit(0 if x11.XOpenDisplay(None) else 1)
PYTHON
}

# Xvfb finds a free display by itself and writes its number. Started under job control (set -m), it
# is not reached by a Ctrl-C, nor is roslaunch below: the script stops them, in order.
start_display() {
  runtime_dir=$(mktemp -d)
  chmod 700 "$runtime_dir"
  set -m
  Xvfb -displayfd 3 -screen 0 "${1:-1280x800}x24" +extension GLX -nolisten tcp -noreset \
    3>"$runtime_dir/display" >"$pliant_build/log/xvfb.log" 2>&1 &
  display_pid=$!
  set +m
  for _ in {1..100}; do
    if [[ -s $runtime_dir/display ]]; then break; fi
    kill -0 "$display_pid" 2>/dev/null || break
    sleep 0.1
  done
  [[ -s $runtime_dir/display ]] ||
    fail "the virtual display did not start; see $pliant_build/log/xvfb.log, or use rviz:=false"
  DISPLAY=:$(<"$runtime_dir/display")
  export DISPLAY
  export XDG_RUNTIME_DIR=$runtime_dir LIBGL_ALWAYS_SOFTWARE=1 QT_QPA_PLATFORM=xcb
  unset XAUTHORITY WAYLAND_DISPLAY
}

stop_display() {
  if [[ -n $display_pid ]]; then
    kill "$display_pid" 2>/dev/null || true
    wait "$display_pid" 2>/dev/null || true
    display_pid=
  fi
  if [[ -n $runtime_dir ]]; then rm -rf -- "$runtime_dir"; fi
  runtime_dir=
}

free_port() {
  /usr/bin/python3 -c 'import socket
s = socket.socket()
s.bind(("127.0.0.1", 0))
print(s.getsockname()[1])'
}

# A master of its own, that nobody else talks to.
choose_master() {
  ROS_MASTER_URI=http://127.0.0.1:$(free_port)
  export ROS_MASTER_URI
}

start_launch() {
  set -m
  roslaunch "$@" </dev/null &
  launch_pid=$!
  set +m
}

# roslaunch stops its nodes when it is interrupted, and needs some time for that.
stop_launch() {
  [[ -n $launch_pid ]] || return 0
  local signal
  for signal in INT TERM KILL; do
    kill -"$signal" "$launch_pid" 2>/dev/null || break
    for _ in {1..200}; do
      kill -0 "$launch_pid" 2>/dev/null || break 2
      sleep 0.1 || true
    done
  done
  wait "$launch_pid" 2>/dev/null || true
  launch_pid=
}

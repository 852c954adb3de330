#pragma once

namespace pliant {

/// From now on Ctrl-C (SIGINT), SIGTERM and a terminal that is closed (SIGHUP) only set
/// interrupted(); a second one ends the program. A run under nohup ignores SIGHUP as before.
void catch_interrupts();
bool interrupted();

}  // namespace pliant

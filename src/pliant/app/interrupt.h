#pragma once

namespace pliant {

/// From now on Ctrl-C (SIGINT) and SIGTERM only set interrupted(); a second one ends the program.
void catch_interrupts();
bool interrupted();

}  // namespace pliant

#include "pliant/app/interrupt.h"

#include <csignal>

namespace pliant {
namespace {

volatile std::sig_atomic_t was_interrupted = 0;

extern "C" void remember_interrupt(int) { was_interrupted = 1; }

}  // namespace

void catch_interrupts() {
  struct sigaction action = {};
  action.sa_handler = remember_interrupt;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  struct sigaction before = {};
  sigaction(SIGHUP, nullptr, &before);
  if (before.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);
}

bool interrupted() { return was_interrupted != 0; }

}  // namespace pliant

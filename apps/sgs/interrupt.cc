// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "interrupt.h"

#include <csignal>

namespace sgs::app {
namespace {

volatile std::sig_atomic_t interrupt_requested = 0;

extern "C" void on_signal(int signal) {
  if (interrupt_requested) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }
  interrupt_requested = 1;
}

}  // namespace

void install_interrupt_handler() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  std::signal(SIGPIPE, SIG_IGN);  // a closed pipe becomes a write error with a message
}

bool interrupted() { return interrupt_requested != 0; }

}  // namespace sgs::app

// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "interrupt.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <thread>

#include "sgs/core/memory_reserve.h"

namespace sgs::app {
namespace {

volatile std::sig_atomic_t interrupt_requested = 0;
std::array<int, 2> wake_pipe = {-1, -1};

// Never destroyed: the thread that waits may be woken while the program exits.
std::stop_source& stop_source() {
  static auto* const source = new std::stop_source;
  return *source;
}

// Handlers may not lock, and a stop request may: they only wake the thread that makes the request.
void ask_to_stop() {
  interrupt_requested = 1;
  const char byte = 0;
  [[maybe_unused]] const auto written = write(wake_pipe[1], &byte, 1);
}

extern "C" void on_signal(int signal) {
  if (interrupt_requested) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }
  ask_to_stop();
}

void wait_for_signal() {
  char byte = 0;
  while (read(wake_pipe[0], &byte, 1) < 0) {
  }
  stop_source().request_stop();
}

}  // namespace

void install_interrupt_handler() {
  std::signal(SIGPIPE, SIG_IGN);  // a closed pipe becomes a write error with a message
  std::signal(SIGXFSZ, SIG_IGN);  // so does a file that may not grow
  if (pipe2(wake_pipe.data(), O_CLOEXEC) != 0) return;
  stop_source();  // made before a signal can come
  std::thread(wait_for_signal).detach();
  keep_memory_reserve(ask_to_stop);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, on_signal);
}

std::stop_token stop_token() { return stop_source().get_token(); }

bool interrupted() { return interrupt_requested != 0; }

}  // namespace sgs::app

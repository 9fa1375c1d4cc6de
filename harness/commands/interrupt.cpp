#include "harness/commands/interrupt.h"

#include <fmt/format.h>

#include "harness/commands/commands.h"

namespace quayside::harness {

namespace {

volatile std::sig_atomic_t received = 0;  // handlers can reach nothing but globals

void remember(int signal) { received = signal; }

}  // namespace

Interrupt::Interrupt() {
  received = 0;
  struct sigaction action {};
  action.sa_handler = remember;
  action.sa_flags = SA_RESTART | static_cast<int>(SA_RESETHAND);  // the second one is taken the default way
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, &previous_int_);
  sigaction(SIGTERM, &action, &previous_term_);
}

Interrupt::~Interrupt() {
  sigaction(SIGINT, &previous_int_, nullptr);
  sigaction(SIGTERM, &previous_term_, nullptr);
}

int Interrupt::signal() { return received; }

void end_interrupted(const std::string& results) {
  std::fflush(stdout);
  fmt::print(stderr, "quayside: stopped by signal {}{}{}\n", Interrupt::signal(), results.empty() ? "" : "; ", results);
  throw CLI::RuntimeError(stopped_by_signal + Interrupt::signal());
}

}  // namespace quayside::harness

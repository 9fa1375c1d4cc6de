// Ctrl-C and SIGTERM as a wish that work can ask for, instead of sudden death. A second one is sudden.
#pragma once

#include <csignal>
#include <string>

namespace quayside::harness {

class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  // The signal that came, or 0.
  static int signal();

 private:
  struct sigaction previous_int_ {}, previous_term_ {};
};

// Ends a command that was asked to stop: says so on stderr, with what became of its `results`, and throws for its exit code.
[[noreturn]] void end_interrupted(const std::string& results);

}  // namespace quayside::harness

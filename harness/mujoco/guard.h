// MuJoCo reports errors, warnings and passive forces through functions that are global to the process. Here they are
// bound to the call that runs on this thread, so that several models in one process do not disturb each other, nothing
// exits the process and nothing writes a log into the working directory.
#pragma once

#include <csetjmp>
#include <exception>
#include <stdexcept>
#include <string>

#include <mujoco/mujoco.h>

namespace quayside::harness::mujoco {

// An error or a warning of MuJoCo, in its words.
class MujocoError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Forces that a model adds in MuJoCo's passive stage, with positions and velocities of that stage in the data.
class PassiveLaw {
 public:
  virtual ~PassiveLaw() = default;
  virtual void add_passive_forces(const mjModel* model, mjData* data) = 0;
};

// While one of these lives MuJoCo's handlers are ours; with the last one the earlier handlers return.
class ProcessHooks {
 public:
  ProcessHooks();
  ~ProcessHooks();
  ProcessHooks(const ProcessHooks&) = delete;
  ProcessHooks& operator=(const ProcessHooks&) = delete;
};

namespace detail {

struct Call {
  PassiveLaw* law;
  const mjData* data;
  Call* outer;
  std::jmp_buf on_error;
  std::exception_ptr thrown;  // by the law: must not travel through MuJoCo's C frames
  char message[1024] = "";
};

Call*& current_call();
[[noreturn]] void report(const Call& call);

}  // namespace detail

// Runs `function`, which calls MuJoCo; a ProcessHooks must live. `law` acts on `data` alone. Throws MujocoError, or
// what the law threw. An error leaves by longjmp: `function` and what it calls up to MuJoCo must hold no objects with
// destructors.
template <typename Function>
void guarded(PassiveLaw* law, const mjData* data, const Function& function) {
  detail::Call call;
  call.law = law;
  call.data = data;
  call.outer = detail::current_call();
  detail::current_call() = &call;
  const bool failed = setjmp(call.on_error) != 0;
  if (!failed) function();
  detail::current_call() = call.outer;
  if (call.thrown) std::rethrow_exception(call.thrown);
  if (call.message[0] != '\0') detail::report(call);
}

template <typename Function>
void guarded(const Function& function) {
  guarded(nullptr, nullptr, function);
}

}  // namespace quayside::harness::mujoco

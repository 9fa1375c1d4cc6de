#include "harness/mujoco/guard.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>

namespace quayside::harness::mujoco {
namespace {

struct Handlers {
  void (*error)(const char*) = nullptr;
  void (*warning)(const char*) = nullptr;
  mjfGeneric passive = nullptr;
};

std::mutex hooks_mutex;  // taken when units are made and destroyed, never in a step
int hooks_alive = 0;
Handlers earlier;

void note(detail::Call& call, const char* message) {
  if (call.message[0] == '\0') std::strncpy(call.message, message, sizeof(call.message) - 1);
}

void on_error(const char* message) {
  if (detail::Call* call = detail::current_call()) {
    note(*call, message);
    std::longjmp(call->on_error, 1);
  }
  // Not our call: as it would have been without us.
  if (earlier.error) {
    earlier.error(message);
  } else {
    std::fprintf(stderr, "ERROR: %s\n", message);
    std::exit(EXIT_FAILURE);
  }
}

void on_warning(const char* message) {
  if (detail::Call* call = detail::current_call()) {
    note(*call, message);
  } else if (earlier.warning) {
    earlier.warning(message);
  } else {
    std::fprintf(stderr, "WARNING: %s\n", message);
  }
}

void on_passive(const mjModel* model, mjData* data) {
  detail::Call* call = detail::current_call();
  if (!call || !call->law || call->data != data) {
    if (earlier.passive) earlier.passive(model, data);
    return;
  }
  if (call->thrown) return;
  try {
    call->law->add_passive_forces(model, data);
  } catch (...) {
    call->thrown = std::current_exception();
  }
}

}  // namespace

namespace detail {

Call*& current_call() {
  thread_local Call* call = nullptr;
  return call;
}

void report(const Call& call) { throw MujocoError(call.message); }

}  // namespace detail

ProcessHooks::ProcessHooks() {
  const std::lock_guard<std::mutex> lock(hooks_mutex);
  if (hooks_alive++ > 0) return;
  earlier = {mju_user_error, mju_user_warning, mjcb_passive};
  mju_user_error = on_error;
  mju_user_warning = on_warning;
  mjcb_passive = on_passive;
}

ProcessHooks::~ProcessHooks() {
  const std::lock_guard<std::mutex> lock(hooks_mutex);
  if (--hooks_alive > 0) return;
  mju_user_error = earlier.error;
  mju_user_warning = earlier.warning;
  mjcb_passive = earlier.passive;
}

}  // namespace quayside::harness::mujoco

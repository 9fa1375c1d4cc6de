// An instance of an exported FMU, behind the C functions of FMI 2.0 and 3.0 alike.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>

#include "harness/fmi/case_unit.h"

namespace quayside::harness {

// The numbers that both versions of FMI give them.
enum class FmiStatus { ok = 0, warning = 1, discard = 2, error = 3, fatal = 4 };

class FmuInstance {
 public:
  using Log = std::function<void(FmiStatus status, const char* category, const std::string& message)>;

  // `resources`: the folder. Throws for a wrong token, for resources that cannot be read, and on a processor without
  // the instructions that this library was compiled to use.
  FmuInstance(const std::string& name, const std::string& token, const std::string& resources, Log log, bool logging);

  CaseUnit& unit() { return unit_; }
  void set_logging(bool on) { logging_ = on; }

  // By the FMU's value reference. Throw std::invalid_argument for one that does not exist or is of another type.
  double get(ValueReference reference, Type type) const;
  void set(ValueReference reference, Type type, double value);

  struct Step {
    double reached = 0;  // [s]
    bool event = false, early = false, terminate = false;
  };
  // To the time now + step [s], rounded to nanoseconds. `result` is right also when StepFailed is thrown.
  void step(double now, double step, Step& result);
  double last_time() const { return seconds(unit_.time()); }

  // A state with what tells to whom it belongs; saving restarts the solver. `restore` throws std::invalid_argument for
  // bytes that are no state of this FMU.
  UnitState save();
  void restore(const UnitState& state);

  // Runs `action`; what it throws is logged and becomes an error.
  template <typename Action>
  FmiStatus guarded(Action action) {
    try {
      action();
      return FmiStatus::ok;
    } catch (const std::exception& error) {
      return fail(error.what());
    } catch (...) {
      return fail("an error of unknown kind");
    }
  }
  FmiStatus fail(const std::string& message);

 private:
  ValueReference place(ValueReference reference, Type type) const;
  void log_events();

  Log log_;
  bool logging_;
  std::string token_;
  CaseUnit unit_;
};

}  // namespace quayside::harness

#include "harness/fmi/fmu_instance.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <stdexcept>

#include "harness/fmi/exported_case.h"
#include "harness/state_bytes.h"

namespace quayside::harness {

namespace {

// Importers that add steps up arrive at times that are a little off [s]: beyond this it is another time that they mean.
constexpr double kClockSlack = 1e-6;

// An instruction set that this file, and so the whole library, was compiled to use and this processor does not have.
const char* missing_instructions() {
#ifdef __AVX__
  if (!__builtin_cpu_supports("avx")) return "AVX";
#endif
#ifdef __AVX2__
  if (!__builtin_cpu_supports("avx2")) return "AVX2";
#endif
#ifdef __FMA__
  if (!__builtin_cpu_supports("fma")) return "FMA";
#endif
#ifdef __AVX512F__
  if (!__builtin_cpu_supports("avx512f")) return "AVX-512F";
#endif
#ifdef __AVX512VL__
  if (!__builtin_cpu_supports("avx512vl")) return "AVX-512VL";
#endif
#ifdef __AVX512DQ__
  if (!__builtin_cpu_supports("avx512dq")) return "AVX-512DQ";
#endif
#ifdef __AVX512BW__
  if (!__builtin_cpu_supports("avx512bw")) return "AVX-512BW";
#endif
  return nullptr;
}

const std::string& checked_token(const std::string& token, const std::string& resources) {
  if (const char* missing = missing_instructions()) {
    throw std::runtime_error(
        fmt::format("this FMU was built for processors with {}, which this one does not have; "
                    "build Quayside with QUAYSIDE_NATIVE=OFF and export it again",
                    missing));
  }
  const std::string own = instantiation_token(exported_case_text(resources));
  if (token != own) {
    throw std::invalid_argument(fmt::format(
        "the instantiation token is {}, expected {}: modelDescription.xml belongs to another FMU", token, own));
  }
  return token;
}

}  // namespace

FmuInstance::FmuInstance(const std::string& name, const std::string& token, const std::string& resources, Log log,
                         bool logging)
    : log_(std::move(log)),
      logging_(logging),
      token_(checked_token(token, resources)),
      unit_(name, load_exported_case(resources)) {}

FmiStatus FmuInstance::fail(const std::string& message) {
  log_(FmiStatus::error, "error", message);
  return FmiStatus::error;
}

ValueReference FmuInstance::place(ValueReference reference, Type type) const {
  const auto& variables = unit_.variables();
  const ValueReference i = reference - kFirstReference;
  if (reference < kFirstReference || i >= variables.size()) {
    throw std::invalid_argument(fmt::format("no variable has the value reference {}", reference));
  }
  if (variables[i].type != type) {
    throw std::invalid_argument(
        fmt::format("{} is {}", variables[i].name, type == Type::boolean ? "a number" : "a boolean"));
  }
  return i;
}

double FmuInstance::get(ValueReference reference, Type type) const {
  if (reference == kTimeReference && type == Type::float64) return last_time();
  return unit_.get(place(reference, type));
}

void FmuInstance::set(ValueReference reference, Type type, double value) { unit_.set(place(reference, type), value); }

void FmuInstance::step(double now, double step, Step& result) {
  result = {last_time(), false, false, false};
  if (!(std::abs(now - last_time()) <= kClockSlack)) {
    throw std::invalid_argument(fmt::format("a step from {} s, but the FMU is at {} s", now, last_time()));
  }
  const Time target = nanoseconds(now + step);
  if (!(target > unit_.time())) throw std::invalid_argument(fmt::format("a step of {} s does not go forward", step));
  try {
    const StepResult reached = unit_.do_step(unit_.time(), target - unit_.time());
    result = {last_time(), reached.event, reached.time < target, reached.terminate};
  } catch (...) {
    result.reached = last_time();
    throw;
  }
  log_events();
}

void FmuInstance::log_events() {
  for (const Event& event : unit_.take_events()) {
    if (logging_) {
      log_(FmiStatus::ok, "events",
           fmt::format("{:.9f} s: {} {}", seconds(event.time), to_string(event.kind), event.subject));
    }
  }
}

UnitState FmuInstance::save() {
  UnitState state = unit_.save();
  const auto* token = reinterpret_cast<const std::byte*>(token_.data());
  state.insert(state.begin(), token, token + token_.size());
  return state;
}

void FmuInstance::restore(const UnitState& state) {
  if (state.size() < token_.size() || std::memcmp(state.data(), token_.data(), token_.size()) != 0) {
    throw std::invalid_argument("the state belongs to another FMU or to another version of it");
  }
  unit_.restore(UnitState(state.begin() + static_cast<std::ptrdiff_t>(token_.size()), state.end()));
}

}  // namespace quayside::harness

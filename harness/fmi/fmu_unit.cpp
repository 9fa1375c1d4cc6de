#include "harness/fmi/fmu_unit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "harness/fmi/fmu_process.h"
#include "harness/names.h"
#include "harness/state_bytes.h"

namespace quayside::harness {

FmuUnit::FmuUnit(const std::string& name, const std::filesystem::path& fmu,
                 const std::vector<std::pair<std::string, double>>& parameters, double patience)
    : name_(name) {
  try {
    if (!std::filesystem::exists(fmu)) throw std::invalid_argument("no such file, expected an FMU");
    unpack_archive(fmu, folder_.path());
    description_ = read_description(folder_.path() / "modelDescription.xml");
    for (const FmuVariable& variable : description_.variables) variables_.push_back(variable.variable);
    for (const auto& [wanted, value] : parameters) {
      std::vector<std::string> known;
      for (ValueReference i = 0; i < variables_.size(); ++i) {
        if (variables_[i].causality != Causality::parameter) continue;
        known.push_back(variables_[i].name);
        if (variables_[i].name == wanted) parameters_.emplace_back(i, value);
      }
      if (std::find(known.begin(), known.end(), wanted) == known.end()) {
        throw std::invalid_argument(
            fmt::format("it has no parameter \"{}\"; {}", wanted, nearest_names(wanted, known)));
      }
    }
    fmu_ = start_fmu_process(folder_.path(), description_, name_, patience);
  } catch (const std::exception& error) {
    throw std::invalid_argument(fmt::format("unit {}: {}: {}", name, fmu.string(), error.what()));
  }
}

// Whatever the FMU answers with an error ends the run, with unit and time.
template <typename Action>
void FmuUnit::guarded(Action action) const {
  try {
    action();
  } catch (const std::runtime_error& error) {
    throw StepFailed(name_, time_, error.what());
  }
}

double FmuUnit::get(ValueReference variable) const {
  if (variable >= variables_.size()) throw std::invalid_argument(fmt::format("{}: no variable {}", name_, variable));
  const FmuVariable& v = description_.variables[variable];
  double value = 0;
  guarded([&] { value = v.factor * fmu_->get(v) + v.offset; });
  return value;
}

void FmuUnit::set(ValueReference variable, double value) {
  if (variable >= variables_.size() || variables_[variable].causality == Causality::output) {
    throw std::invalid_argument(fmt::format("{}: variable {} cannot be set", name_, variable));
  }
  const FmuVariable& v = description_.variables[variable];
  guarded([&] { fmu_->set(v, (value - v.offset) / v.factor); });
}

void FmuUnit::enter_initialization_mode(Time start) {
  time_ = start;
  for (const auto& [parameter, value] : parameters_) set(parameter, value);
  guarded([&] { fmu_->enter_initialization_mode(seconds(start)); });
}

void FmuUnit::exit_initialization_mode() {
  guarded([&] { fmu_->exit_initialization_mode(); });
}

StepResult FmuUnit::do_step(Time now, Time step) {
  if (now != time_ || step <= 0)
    throw std::invalid_argument(fmt::format("{}: a step of {} ns from {} ns", name_, step, now));
  ForeignFmu::Step result;
  try {
    result = fmu_->step(seconds(now), seconds(now + step) - seconds(now));
    for (ValueReference i = 0; i < variables_.size(); ++i) {
      if (variables_[i].causality != Causality::output) continue;
      const double value = fmu_->get(description_.variables[i]);
      if (!std::isfinite(value))
        throw std::runtime_error(fmt::format("its output {} is {}", variables_[i].name, value));
    }
  } catch (const std::runtime_error& error) {
    broken_ = true;
    throw StepFailed(name_, now, error.what());
  }
  time_ = std::min(now + step, nanoseconds(result.reached));
  if (time_ < now + step && !result.terminate) {
    throw StepFailed(name_, time_, "it stopped before the end of its step, though it was not allowed to");
  }
  return {time_, false, result.terminate};
}

void FmuUnit::demand_state() const {
  if (!description_.can_save) throw std::logic_error(fmt::format("{}: this FMU cannot serialize its state", name_));
}

UnitState FmuUnit::save() {
  demand_state();
  ByteWriter out;
  out.put(time_);
  UnitState state;
  guarded([&] { state = fmu_->save(); });
  for (const std::byte byte : state) out.put(byte);
  return out.take();
}

void FmuUnit::restore(const UnitState& state) {
  demand_state();
  ByteReader in(state);
  const Time time = in.get<Time>();
  guarded([&] { fmu_->restore(UnitState(state.begin() + sizeof time, state.end())); });
  time_ = time;
  broken_ = false;
}

void FmuUnit::terminate() {
  if (!broken_) guarded([&] { fmu_->terminate(); });
}

void FmuUnit::reset() {
  guarded([&] { fmu_->reset(); });
  time_ = 0;
  broken_ = false;
}

}  // namespace quayside::harness

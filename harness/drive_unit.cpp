#include "harness/drive_unit.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "harness/engine_unit.h"
#include "harness/names.h"
#include "harness/state_bytes.h"

namespace quayside::harness {

namespace {

using cases::ScriptEntry;
using crane_models::DriveMotion;

constexpr Time kNever = std::numeric_limits<Time>::max();
constexpr std::size_t kPerDrive = 3;    // value, rate, acceleration
constexpr double kLongestRamp = 1e9;    // [s]; what takes longer than thirty years to get up to speed is a mistake

// Events that would come after the end of time never come.
Time later(Time time, Time by) { return by < kNever - time ? time + by : kNever; }

// The place of a thing in a vector of named things, or its size.
template <typename Named>
std::size_t find(const std::vector<Named>& things, const std::string& name) {
  const auto found = std::find_if(things.begin(), things.end(), [&](const Named& thing) { return thing.name == name; });
  return static_cast<std::size_t>(found - things.begin());
}

template <typename Named>
std::vector<std::string> names_of(const std::vector<Named>& things) {
  std::vector<std::string> names;
  for (const Named& thing : things) names.push_back(thing.name);
  return names;
}

}  // namespace

DriveUnit::DriveUnit(const std::string& name, const cases::Case& description, const crane_models::Scene& scene)
    : name_(name), drives_(scene.drives) {
  // What the engines take is what this unit gives.
  const std::vector<Variable> signals = engine_variables(scene);
  for (const Variable& signal : signals) {
    if (signal.causality != Causality::input) continue;
    variables_.push_back(signal);
    variables_.back().causality = Causality::output;
  }
  std::vector<ValueReference> switches;
  for (const auto& landed : scene.landed_switches) {
    switches.push_back(static_cast<ValueReference>(variables_.size()));
    variables_.push_back({landed.name, "", Causality::input, Type::boolean, "the load has landed"});
  }

  for (std::size_t i = 0; i < description.script.size(); ++i) {
    const ScriptEntry& line = description.script[i];
    const auto refuse = [&](const std::string& key, const std::string& what) {
      throw cases::CaseError(fmt::format("{}: script[{}].{}: {}", description.file.string(), i, key, what));
    };
    const auto time_of = [&](const std::string& key, double value) {
      if (!(value >= 0 && value < seconds(kNever))) refuse(key, fmt::format("{} s is no time of a simulation", value));
      return nanoseconds(value);
    };
    Entry entry{line.condition, time_of("at", line.time), time_of("after", line.after), {}, line.threshold, {}, {}};

    if (line.condition == ScriptEntry::Condition::landed) {
      if (switches.empty()) refuse("when", "nothing here can land; \"landed\" needs a crane with a spreader");
      entry.watched = switches;
      entry.threshold = 0.5;
    } else if (line.condition != ScriptEntry::Condition::at) {
      std::size_t watched = find(variables_, line.signal);
      if (watched == variables_.size()) {
        const std::size_t signal = find(signals, line.signal);
        if (signal == signals.size() || signals[signal].causality != Causality::output) {
          auto known = names_of(signals);
          for (const Variable& own : variables_) known.push_back(own.name);
          refuse("when", fmt::format("no signal \"{}\" in the scene as it is simulated; {}", line.signal,
                                     nearest_names(line.signal, known)));
        }
        variables_.push_back(signals[signal]);
        variables_.back().causality = Causality::input;
      }
      entry.watched = {static_cast<ValueReference>(watched)};
    }

    for (const auto& [drive_name, speed] : line.speeds) {
      const std::size_t drive = find(drives_, drive_name);
      if (drive == drives_.size()) {
        refuse(drive_name, "no such drive; " + nearest_names(drive_name, names_of(drives_)));
      }
      const auto& limits = drives_[drive];
      if (!(std::abs(speed) <= limits.max_speed)) {
        refuse(drive_name, fmt::format("{} {}/s is beyond the limit of {} {}/s; command less, or raise max_speed of the {}",
                                       speed, limits.unit, limits.max_speed, limits.unit, drive_name));
      }
      if (!(limits.max_acceleration > 0 && 2 * limits.max_speed / limits.max_acceleration < kLongestRamp)) {
        refuse(drive_name, fmt::format("with {} {}/s² the {} cannot get up to speed; raise its max_acceleration",
                                       limits.max_acceleration, limits.unit, drive_name));
      }
      entry.rates.emplace_back(drive, limits.sign * speed);
    }
    for (const auto& [command_name, value] : line.commands) {
      const std::size_t command = find(scene.commands, command_name);
      if (command == scene.commands.size()) {
        refuse(command_name, "no such command; " + nearest_names(command_name, names_of(scene.commands)));
      }
      entry.values.emplace_back(command, value ? 1.0 : 0.0);
    }
    script_.push_back(std::move(entry));
  }

  commands_ = scene.commands.size();
  first_command_input_ = variables_.size() - kPerDrive * drives_.size();
  for (const auto& drive : drives_) {
    variables_.push_back({"command." + drive.name, drive.unit + "/s", Causality::input, Type::float64,
                          "speed that the operator asks for: " + drive.meaning, 0});
  }
  for (const auto& command : scene.commands) {
    variables_.push_back({"command." + command.name, "", Causality::input, Type::boolean,
                          "what the operator asks for: " + command.meaning, command.start ? 1.0 : 0.0});
  }
  by_input_.assign(drives_.size() + commands_, false);
  reset();
}

void DriveUnit::hand_over(const std::string& drive_or_command, bool to_input) {
  const std::size_t input = find(variables_, "command." + drive_or_command);
  if (input == variables_.size()) {
    throw std::invalid_argument(fmt::format("{}: no drive or command \"{}\"", name_, drive_or_command));
  }
  by_input_[input - kPerDrive * drives_.size() - first_command_input_] = to_input;
}

double DriveUnit::commanded_rate(std::size_t drive) const {
  const auto& limits = drives_[drive];
  return limits.sign * std::clamp(commanded(drive), -limits.max_speed, limits.max_speed);
}

bool DriveUnit::needs_event_mode() const {
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    if (by_input_[i] && commanded_rate(i) != segments_[i].target) return true;
  }
  for (std::size_t i = 0; i < commands_; ++i) {
    if (by_input_[drives_.size() + i] && commanded(drives_.size() + i) != values_[i]) return true;
  }
  return waits_for_what_holds();
}

void DriveUnit::reset() {
  segments_.clear();
  for (const auto& drive : drives_) segments_.push_back({0, kNever, {drive.start, 0, 0}, 0});
  progress_.clear();
  for (const Entry& entry : script_) {
    const bool timed = entry.condition == ScriptEntry::Condition::at;
    progress_.push_back({timed ? later(entry.at, entry.after) : kNever, false});
  }
  values_.clear();
  for (std::size_t i = kPerDrive * drives_.size(); i < variables_.size(); ++i) values_.push_back(variables_[i].start);
  time_ = 0;
}

double DriveUnit::get(ValueReference variable) const {
  if (variable >= variables_.size()) throw std::invalid_argument(fmt::format("{}: no variable {}", name_, variable));
  const std::size_t drive = variable / kPerDrive;
  if (drive >= drives_.size()) return values_[variable - kPerDrive * drives_.size()];
  const DriveMotion now = motion(drive);
  return variable % kPerDrive == 0 ? now.value : variable % kPerDrive == 1 ? now.rate : now.acceleration;
}

void DriveUnit::set(ValueReference variable, double value) {
  if (variable >= variables_.size() || variables_[variable].causality != Causality::input) {
    throw std::invalid_argument(fmt::format("{}: variable {} is not an input", name_, variable));
  }
  if (!std::isfinite(value)) {
    throw std::invalid_argument(fmt::format("{}: {} cannot be {}", name_, variables_[variable].name, value));
  }
  values_[variable - kPerDrive * drives_.size()] = value;
}

void DriveUnit::enter_initialization_mode(Time start) {
  time_ = start;
  for (Segment& segment : segments_) segment.begin = start;
}

DriveMotion DriveUnit::motion(std::size_t drive) const {
  const Segment& segment = segments_[drive];
  return segment.motion.after(seconds(time_ - segment.begin));
}

bool DriveUnit::holds(const Entry& entry) const {
  return std::any_of(entry.watched.begin(), entry.watched.end(), [&](ValueReference variable) {
    const bool below = entry.condition == ScriptEntry::Condition::signal_below;
    return below ? get(variable) < entry.threshold : get(variable) > entry.threshold;
  });
}

bool DriveUnit::waits_for_what_holds() const {
  for (std::size_t i = 0; i < script_.size(); ++i) {
    if (progress_[i].due == kNever && holds(script_[i])) return true;
  }
  return false;
}

Time DriveUnit::next_breakpoint() const {
  Time next = kNever;
  for (const Segment& segment : segments_) next = std::min(next, segment.end);
  for (const Progress& progress : progress_) {
    if (!progress.fired) next = std::min(next, progress.due);
  }
  return next;
}

StepResult DriveUnit::do_step(Time now, Time step) {
  assert(now == time_ && step > 0);
  const Time breakpoint = next_breakpoint();
  time_ = std::min(now + step, breakpoint);
  return {time_, time_ == breakpoint || waits_for_what_holds(), false};
}

std::optional<Time> DriveUnit::update_discrete_states() {
  for (Segment& segment : segments_) {
    if (segment.end <= time_) finish_ramp(segment);
  }
  for (std::size_t i = 0; i < script_.size(); ++i) {
    Progress& progress = progress_[i];
    if (progress.due == kNever && holds(script_[i])) progress.due = later(time_, script_[i].after);
    if (progress.fired || progress.due > time_) continue;
    progress.fired = true;
    fire(script_[i]);
  }
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    if (by_input_[i] && commanded_rate(i) != segments_[i].target) start_ramp(i, commanded_rate(i));
  }
  for (std::size_t i = 0; i < commands_; ++i) {
    if (by_input_[drives_.size() + i]) values_[i] = commanded(drives_.size() + i);
  }
  const Time next = next_breakpoint();
  return next == kNever ? std::nullopt : std::optional<Time>(next);
}

void DriveUnit::fire(const Entry& entry) {
  for (const auto& [drive, rate] : entry.rates) {
    if (!by_input_[drive]) start_ramp(drive, rate);
  }
  for (const auto& [command, value] : entry.values) {
    if (!by_input_[drives_.size() + command]) values_[command] = value;
  }
}

// A ramp at the drive's limit ends at a fraction of a nanosecond. It is made to end at the nearest whole one by an
// acceleration that differs from the limit accordingly, relatively half a nanosecond over the ramp's duration at most:
// so rate and value have no jump, and the ramp ends at the commanded speed itself.
void DriveUnit::start_ramp(std::size_t drive, double target) {
  Segment& segment = segments_[drive];
  const DriveMotion now = motion(drive);
  const double change = target - now.rate;
  if (change == 0) {
    segment = {time_, kNever, {now.value, target, 0}, target};
    return;
  }
  const Time duration = std::max<Time>(1, nanoseconds(std::abs(change) / drives_[drive].max_acceleration));
  segment = {time_, later(time_, duration), {now.value, now.rate, change / seconds(duration)}, target};
}

void DriveUnit::finish_ramp(Segment& segment) {
  const double value = segment.motion.after(seconds(segment.end - segment.begin)).value;
  segment = {segment.end, kNever, {value, segment.target, 0}, segment.target};
}

UnitState DriveUnit::save() {
  ByteWriter state;
  state.put(time_);
  for (const Segment& segment : segments_) {
    state.put(segment.begin);
    state.put(segment.end);
    for (const double number : {segment.motion.value, segment.motion.rate, segment.motion.acceleration, segment.target}) {
      state.put(number);
    }
  }
  for (const Progress& progress : progress_) {
    state.put(progress.due);
    state.put(progress.fired);
  }
  state.put(values_.data(), values_.size());
  return state.take();
}

void DriveUnit::restore(const UnitState& bytes) {
  ByteReader state(bytes);
  state.get(time_);
  for (Segment& segment : segments_) {
    state.get(segment.begin);
    state.get(segment.end);
    for (double* number : {&segment.motion.value, &segment.motion.rate, &segment.motion.acceleration, &segment.target}) {
      state.get(*number);
    }
  }
  for (Progress& progress : progress_) {
    state.get(progress.due);
    state.get(progress.fired);
  }
  state.get(values_.data(), values_.size());
  state.finish();
}

void connect_drives(Master& master, const Unit& plant, const DriveUnit& drives) {
  for (const Variable& variable : drives.variables()) {
    if (find(plant.variables(), variable.name) == plant.variables().size()) continue;
    const std::string at_drives = drives.name() + "::" + variable.name;
    const std::string at_plant = plant.name() + "::" + variable.name;
    if (variable.causality == Causality::output) master.connect(at_drives, at_plant, Carries::at_once);
    if (variable.causality == Causality::input) master.connect(at_plant, at_drives);
  }
}

}  // namespace quayside::harness

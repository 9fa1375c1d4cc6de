#include "harness/drive_unit.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "harness/names.h"
#include "harness/scene_engine.h"
#include "harness/state_bytes.h"

namespace quayside::harness {

namespace {

using cases::ScriptEntry;
using crane_models::DriveMotion;

constexpr Time kNever = std::numeric_limits<Time>::max();
constexpr double kLongestRamp = 1e9;    // [s]; what takes longer than thirty years to get up to speed is a mistake

constexpr double kRounding = 1e-12;     // of a limit that was written in degrees
constexpr double kSwitchTolerance = 1e-6;  // a script may stop a drive right at its limit switch [m, rad]
constexpr double kDegree = 3.14159265358979323846 / 180;

// What a person writes in degrees is in radians here.
double scale_of(const crane_models::Drive& drive) { return drive.unit == "rad" ? kDegree : 1; }
std::string written_unit(const crane_models::Drive& drive) { return drive.unit == "rad" ? "degrees" : drive.unit; }

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

// The forces between what hangs on the machine and everything else.
std::vector<std::string> contacts_of_load(const crane_models::Scene& scene) {
  std::vector<std::string> names;
  const auto hangs = [&](int body) {
    return std::any_of(scene.landed_switches.begin(), scene.landed_switches.end(), [&](const auto& landed) {
      return std::count(landed.bodies.begin(), landed.bodies.end(), body) > 0;
    });
  };
  for (const auto& group : crane_models::contact_groups(scene)) {
    const auto& pair = scene.pairs[group.pairs.front()];
    if (hangs(pair.body_a) != hangs(pair.body_b)) names.push_back("contact." + group.a + "." + group.b + ".force");
  }
  return names;
}

}  // namespace

DriveUnit::DriveUnit(const std::string& name, const cases::Case& description, const crane_models::Scene& scene)
    : name_(name), drives_(scene.drives), limits_(scene.load_limits) {
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
    entry.emergency_stop = line.emergency_stop;

    if (line.condition == ScriptEntry::Condition::landed) {
      if (switches.empty()) refuse("when", "nothing here can land; \"landed\" needs a crane with a spreader");
      entry.watched = switches;
      entry.threshold = 0.5;
    } else if (line.condition == ScriptEntry::Condition::locked) {
      for (const auto& lock : scene.locks) {
        if (lock.command < 0 || scene.commands[lock.command].name != "twistlocks") continue;
        entry.watched.push_back(watch(signals[find(signals, lock.name + ".closed")]));
      }
      if (entry.watched.empty()) {
        refuse("when", "no twistlocks close here; \"locked\" needs a container that they hold or pick up");
      }
      entry.threshold = 0.5;
    } else if (line.condition == ScriptEntry::Condition::contact) {
      for (const std::string& signal : contacts_of_load(scene)) {
        entry.watched.push_back(watch(signals[find(signals, signal)]));
      }
      if (entry.watched.empty()) {
        refuse("when", "nothing here can be touched; \"contact\" needs something beside the load");
      }
      entry.threshold = 0;
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
        watch(signals[signal]);
      }
      entry.watched = {static_cast<ValueReference>(watched)};
    }

    for (const auto& [drive_name, speed] : line.speeds) {
      const std::size_t drive = find(drives_, drive_name);
      if (drive == drives_.size()) {
        refuse(drive_name, "no such drive; " + nearest_names(drive_name, names_of(drives_)));
      }
      const auto& limits = drives_[drive];
      const double rate = speed * scale_of(limits);
      if (!(std::abs(rate) <= limits.max_speed * (1 + kRounding))) {
        refuse(drive_name, fmt::format("{} {}/s is beyond the limit of {} {}/s; command less, or raise max_speed of the {}",
                                       speed, written_unit(limits), limits.max_speed / scale_of(limits),
                                       written_unit(limits), drive_name));
      }
      if (!(limits.max_acceleration > 0 && 2 * limits.max_speed / limits.max_acceleration < kLongestRamp)) {
        refuse(drive_name, fmt::format("with {} {}/s² the {} cannot get up to speed; raise its max_acceleration",
                                       limits.max_acceleration, limits.unit, drive_name));
      }
      double within = 0;
      for (const auto& [ramped, time] : line.ramps) within = ramped == drive_name ? time : within;
      entry.rates.push_back({drive, limits.sign * rate, within});
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

  for (const auto& limit : limits_) {
    tensions_.emplace_back();
    for (const int rope : limit.ropes) {
      tensions_.back().push_back(watch(signals[find(signals, scene.ropes[rope].name + ".tension")]));
    }
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

// The place of an engine's signal among the inputs of this unit.
ValueReference DriveUnit::watch(const Variable& signal) {
  const std::size_t place = find(variables_, signal.name);
  if (place == variables_.size()) {
    variables_.push_back(signal);
    variables_.back().causality = Causality::input;
  }
  return static_cast<ValueReference>(place);
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
    if (by_input_[i] && !held(i) && commanded_rate(i) != segments_[i].target) return true;
  }
  for (std::size_t i = 0; i < commands_; ++i) {
    if (by_input_[drives_.size() + i] && commanded(drives_.size() + i) != values_[i]) return true;
  }
  return waits_for_what_holds();
}

void DriveUnit::reset() {
  segments_.clear();
  for (const auto& drive : drives_) segments_.push_back({0, kNever, {drive.start, 0, 0}, 0, {}, 0});
  guards_.assign(limits_.size() + drives_.size(), {kNever, false});
  stopped_ = false;
  events_.clear();
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
  const double all[kPerDrive] = {now.value, now.rate, now.acceleration, now.jerk};
  return all[variable % kPerDrive];
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
  const auto satisfies = [&](ValueReference variable) {
    const bool below = entry.condition == ScriptEntry::Condition::signal_below;
    return below ? get(variable) < entry.threshold : get(variable) > entry.threshold;
  };
  if (entry.condition == ScriptEntry::Condition::locked) {
    return std::all_of(entry.watched.begin(), entry.watched.end(), satisfies);
  }
  return std::any_of(entry.watched.begin(), entry.watched.end(), satisfies);
}

double DriveUnit::tension(std::size_t limit) const {
  double sum = 0;
  for (const ValueReference variable : tensions_[limit]) sum += get(variable);
  return sum;
}

bool DriveUnit::over(std::size_t limit) const {
  if (limit < limits_.size()) return tension(limit) > limits_[limit].threshold;
  const std::size_t drive = limit - limits_.size();
  const double value = motion(drive).value;
  return value < drives_[drive].lowest - kSwitchTolerance || value > drives_[drive].highest + kSwitchTolerance;
}

Time DriveUnit::delay(std::size_t limit) const { return limit < limits_.size() ? nanoseconds(limits_[limit].delay) : 0; }

bool DriveUnit::waits_for_what_holds() const {
  for (std::size_t i = 0; i < script_.size(); ++i) {
    if (progress_[i].due == kNever && holds(script_[i])) return true;
  }
  for (std::size_t i = 0; i < guards_.size(); ++i) {
    if (!guards_[i].tripped && over(i) != (guards_[i].since != kNever)) return true;
  }
  return false;
}

Time DriveUnit::next_breakpoint() const {
  Time next = kNever;
  for (const Segment& segment : segments_) next = std::min(next, segment.end);
  for (const Progress& progress : progress_) {
    if (!progress.fired) next = std::min(next, progress.due);
  }
  for (std::size_t i = 0; i < guards_.size(); ++i) {
    if (!guards_[i].tripped && guards_[i].since != kNever) next = std::min(next, later(guards_[i].since, delay(i)));
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
    if (segment.end <= time_) finish_phase(segment);
  }
  for (std::size_t i = 0; i < script_.size(); ++i) {
    Progress& progress = progress_[i];
    if (progress.due == kNever && holds(script_[i])) progress.due = later(time_, script_[i].after);
    if (progress.fired || progress.due > time_) continue;
    progress.fired = true;
    fire(script_[i]);
  }
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    if (by_input_[i] && !held(i) && commanded_rate(i) != segments_[i].target) {
      start_ramp(i, commanded_rate(i), drives_[i].max_acceleration, drives_[i].max_jerk);
    }
  }
  watch_limits();
  for (std::size_t i = 0; i < commands_; ++i) {
    if (by_input_[drives_.size() + i]) values_[i] = commanded(drives_.size() + i);
  }
  const Time next = next_breakpoint();
  return next == kNever ? std::nullopt : std::optional<Time>(next);
}

void DriveUnit::fire(const Entry& entry) {
  if (entry.emergency_stop) stop_all(EventKind::stopped, "emergency_stop");
  for (const Entry::Rate& rate : entry.rates) {
    if (by_input_[rate.drive] || held(rate.drive)) continue;
    double acceleration = drives_[rate.drive].max_acceleration;
    if (rate.within > 0) {
      acceleration = std::min(acceleration, std::abs(rate.rate - motion(rate.drive).rate) / rate.within);
    }
    start_ramp(rate.drive, rate.rate, acceleration, drives_[rate.drive].max_jerk);
  }
  for (const auto& [command, value] : entry.values) {
    if (!by_input_[drives_.size() + command]) values_[command] = value;
  }
}

void DriveUnit::stop_all(EventKind kind, const std::string& subject) {
  events_.push_back({time_, kind, subject, 0, 0, 0});
  if (stopped_) return;
  stopped_ = true;
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    if (held(i)) start_ramp(i, 0, drives_[i].emergency_stop, 0);  // brakes know no jerk limit
  }
}

void DriveUnit::watch_limits() {
  for (std::size_t i = 0; i < guards_.size(); ++i) {
    Guard& guard = guards_[i];
    if (guard.tripped) continue;
    if (!over(i)) {
      guard.since = kNever;
      continue;
    }
    if (guard.since == kNever) guard.since = time_;
    if (later(guard.since, delay(i)) > time_) continue;
    guard.tripped = true;
    stop_all(EventKind::tripped, i < limits_.size() ? limits_[i].name : "range." + drives_[i - limits_.size()].name);
  }
}

std::vector<Event> DriveUnit::take_events() { return std::exchange(events_, {}); }

// Without a limit of jerk a ramp is one phase of constant acceleration. With one, the acceleration goes from where it is
// to a peak, stays there, and goes back to nothing: with s the sign of what is missing to the target when the
// acceleration is first brought to nothing, the peak p follows from s·p² = j·Δv + s·a²/2 (a now, Δv to go), unless
// the limit cuts it off and a middle phase makes up for the rest.
//
// Phases end at fractions of a nanosecond, and are made to end at the nearest whole one: by an acceleration (without
// jerk) that differs from the limit accordingly, relatively half a nanosecond over the ramp's duration at most, so that
// rate and value have no jump and the ramp ends at the commanded speed itself; with jerk the rate is set right by less
// than 1e-9 of the acceleration at the end.
void DriveUnit::start_ramp(std::size_t drive, double target, double acceleration, double jerk) {
  Segment& segment = segments_[drive];
  const DriveMotion now = motion(drive);
  const double change = target - now.rate;
  if (change == 0 && (jerk == 0 || now.acceleration == 0)) {
    segment = {time_, kNever, {now.value, target, 0}, target, {}, 0};
    return;
  }
  if (jerk == 0) {
    const Time duration = std::max<Time>(1, nanoseconds(std::abs(change) / acceleration));
    segment = {time_, later(time_, duration), {now.value, now.rate, change / seconds(duration)}, target, {}, 0};
    return;
  }
  const double a = now.acceleration;
  const double s = change - a * std::abs(a) / (2 * jerk) < 0 ? -1 : 1;
  const double to_go = s * change, begin = s * a;  // as if the ramp went up
  double peak = std::sqrt(std::max(0.0, jerk * to_go + 0.5 * begin * begin));
  double flat = 0;
  const double limit = std::max(acceleration, begin);
  if (peak > limit) {
    peak = limit;
    flat = (to_go - (2 * peak * peak - begin * begin) / (2 * jerk)) / peak;
  }
  const auto whole = [](double duration) { return std::max<Time>(1, nanoseconds(duration)); };
  const Time rise = whole((peak - begin) / jerk), fall = whole(peak / jerk);
  segment = {time_, later(time_, rise), {now.value, now.rate, a, s * (peak - begin) / seconds(rise)}, target, {}, 2};
  segment.following[1] = {whole(flat), s * peak, 0};
  segment.following[0] = {fall, s * peak, -s * peak / seconds(fall)};
}

// On to the next phase of the ramp, or to the speed that it was for.
void DriveUnit::finish_phase(Segment& segment) {
  const DriveMotion now = segment.motion.after(seconds(segment.end - segment.begin));
  if (segment.left == 0) {
    segment = {segment.end, kNever, {now.value, segment.target, 0}, segment.target, {}, 0};
    return;
  }
  const Phase& next = segment.following[--segment.left];
  segment.begin = segment.end;
  segment.end = later(segment.begin, next.duration);
  segment.motion = {now.value, now.rate, next.acceleration, next.jerk};
}

UnitState DriveUnit::save() {
  ByteWriter state;
  state.put(time_);
  for (const Segment& segment : segments_) {
    state.put(segment.begin);
    state.put(segment.end);
    for (const double number : {segment.motion.value, segment.motion.rate, segment.motion.acceleration,
                                segment.motion.jerk, segment.target}) {
      state.put(number);
    }
    for (const Phase& phase : segment.following) {
      state.put(phase.duration);
      state.put(phase.acceleration);
      state.put(phase.jerk);
    }
    state.put(segment.left);
  }
  for (const Progress& progress : progress_) {
    state.put(progress.due);
    state.put(progress.fired);
  }
  state.put(values_.data(), values_.size());
  for (const Guard& guard : guards_) {
    state.put(guard.since);
    state.put(guard.tripped);
  }
  state.put(stopped_);
  return state.take();
}

void DriveUnit::restore(const UnitState& bytes) {
  ByteReader state(bytes);
  state.get(time_);
  for (Segment& segment : segments_) {
    state.get(segment.begin);
    state.get(segment.end);
    for (double* number : {&segment.motion.value, &segment.motion.rate, &segment.motion.acceleration,
                           &segment.motion.jerk, &segment.target}) {
      state.get(*number);
    }
    for (Phase& phase : segment.following) {
      state.get(phase.duration);
      state.get(phase.acceleration);
      state.get(phase.jerk);
    }
    state.get(segment.left);
  }
  for (Progress& progress : progress_) {
    state.get(progress.due);
    state.get(progress.fired);
  }
  state.get(values_.data(), values_.size());
  for (Guard& guard : guards_) {
    state.get(guard.since);
    state.get(guard.tripped);
  }
  state.get(stopped_);
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

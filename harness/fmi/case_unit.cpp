#include "harness/fmi/case_unit.h"

#include <fmt/format.h>

#include <stdexcept>

#include "harness/build_scene.h"
#include "harness/simbody/simbody_unit.h"
#include "harness/state_bytes.h"

namespace quayside::harness {

namespace {

void put(ByteWriter& out, const UnitState& state) {
  out.put(static_cast<std::uint64_t>(state.size()));
  for (const std::byte byte : state) out.put(byte);
}

UnitState get_state(ByteReader& in) {
  UnitState state;
  for (auto size = in.get<std::uint64_t>(); size > 0; --size) state.push_back(in.get<std::byte>());
  return state;
}

}  // namespace

CaseUnit::CaseUnit(const std::string& name, const cases::Case& description)
    : name_(name),
      scene_(build_scene(description)),
      plant_(make_simbody_engine(scene_, contact_settings(description.contact), solver_settings(description))),
      drives_("drives", description, scene_) {
  master_.add(*plant_);
  master_.add(drives_);
  connect_drives(master_, *plant_, drives_);

  variables_.push_back({"script", "", Causality::parameter, Type::boolean,
                        "true: the case's script moves drives and commands; false: the inputs command.* do", 1});
  places_.emplace_back(nullptr, 0);
  const auto show = [&](Unit& unit, Causality causality, const std::string& prefix) {
    for (ValueReference i = 0; i < unit.variables().size(); ++i) {
      const Variable& variable = unit.variables()[i];
      if (variable.causality != causality || variable.name.rfind(prefix, 0) != 0) continue;
      variables_.push_back(variable);
      places_.emplace_back(&unit, i);
    }
  };
  show(drives_, Causality::input, "command.");
  show(*plant_, Causality::output, "");
  show(drives_, Causality::output, "");
}

void CaseUnit::demand(bool legal, const char* what) const {
  if (!legal) throw std::logic_error(fmt::format("{}: {} is not possible now", name_, what));
}

double CaseUnit::get(ValueReference variable) const {
  if (variable >= places_.size()) throw std::invalid_argument(fmt::format("{}: no variable {}", name_, variable));
  const auto& [unit, place] = places_[variable];
  return unit ? unit->get(place) : script_;
}

void CaseUnit::set(ValueReference variable, double value) {
  if (variable >= places_.size() || variables_[variable].causality == Causality::output) {
    throw std::invalid_argument(fmt::format("{}: variable {} cannot be set", name_, variable));
  }
  const auto& [unit, place] = places_[variable];
  if (unit) return unit->set(place, value);
  if (is_running())
    throw std::invalid_argument(fmt::format("{}: 'script' is fixed before the simulation begins", name_));
  script_ = value != 0;
}

// The start as it is with the parameters and inputs as set.
void CaseUnit::start() {
  std::vector<double> inputs;
  for (ValueReference i = 0; i < variables_.size(); ++i) {
    if (variables_[i].causality == Causality::input) inputs.push_back(get(i));
  }
  plant_->reset();
  drives_.reset();
  auto input = inputs.begin();
  for (ValueReference i = 0; i < variables_.size(); ++i) {
    if (variables_[i].causality == Causality::input) set(i, *input++);
  }
  obey();
  master_.initialize(time_);
}

void CaseUnit::obey() {
  for (const auto& drive : scene_.drives) drives_.hand_over(drive.name, !script_);
  for (const auto& command : scene_.commands) drives_.hand_over(command.name, !script_);
}

void CaseUnit::enter_initialization_mode(Time start_time) {
  demand(mode_ == Mode::instantiated, "initialization mode");
  time_ = start_time;
  start();
  mode_ = Mode::initialization;
}

void CaseUnit::exit_initialization_mode() {
  demand(mode_ == Mode::initialization, "leaving initialization mode");
  start();
  mode_ = Mode::event;
}

std::optional<Time> CaseUnit::update_discrete_states() {
  demand(mode_ == Mode::event, "an update of discrete states");
  master_.handle_event();
  event_pending_ = false;
  return master_.next_event();
}

StepResult CaseUnit::do_step(Time now, Time step) {
  demand(mode_ == Mode::step, "a step");
  if (now != time_ || step <= 0) {
    throw std::invalid_argument(
        fmt::format("{}: a step of {} ns from {} ns, but the unit is at {} ns", name_, step, now, time_));
  }
  const Time target = now + step;
  bool event = false;
  try {
    if (event_pending_ || master_.needs_event_mode()) master_.handle_event();
    event_pending_ = false;
    if (stop_at_events_) {
      event = event_pending_ = master_.advance_to_event(target);
    } else {
      master_.advance_to(target);
    }
  } catch (const StepFailed&) {
    time_ = master_.time();
    throw;
  }
  time_ = master_.time();
  return {time_, event, master_.terminated()};
}

UnitState CaseUnit::save() {
  ByteWriter out;
  out.put(mode_);
  out.put(time_);
  out.put(script_);
  out.put(event_pending_);
  put(out, plant_->save());
  put(out, drives_.save());
  master_.save(out);
  return out.take();
}

void CaseUnit::restore(const UnitState& state) {
  ByteReader in(state);
  in.get(mode_);
  in.get(time_);
  in.get(script_);
  in.get(event_pending_);
  plant_->restore(get_state(in));
  drives_.restore(get_state(in));
  master_.restore(in);
  in.finish();
  obey();
}

void CaseUnit::terminate() {
  master_.terminate();
  mode_ = Mode::terminated;
}

void CaseUnit::reset() {
  plant_->reset();
  drives_.reset();
  script_ = true;
  event_pending_ = false;
  time_ = 0;
  mode_ = Mode::instantiated;
}

}  // namespace quayside::harness

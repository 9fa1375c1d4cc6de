#include "harness/fmi/interface_cost.h"

#include <algorithm>
#include <chrono>
#include <memory>

#include "harness/build_scene.h"
#include "harness/fmi/archive.h"
#include "harness/fmi/case_unit.h"
#include "harness/fmi/export_fmu.h"
#include "harness/fmi/fmu_unit.h"
#include "harness/fmi/foreign_fmu.h"
#include "harness/fmi/read_description.h"

namespace quayside::harness {

namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;

constexpr Time kStateAt = 1'000'000'000;  // where states are saved [ns]
constexpr int kStateCalls = 201;

double since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

void begin(Unit& unit) {
  unit.enter_initialization_mode(0);
  unit.exit_initialization_mode();
  unit.update_discrete_states();
  unit.enter_step_mode();
}

// What the engine is told at an event.
struct Orders {
  Time time;
  std::vector<double> inputs;
};

class Measurement {
 public:
  Measurement(const fs::path& case_file, const std::vector<std::string>& overrides, const fs::path& library, double step)
      : description_(cases::load_case(case_file, overrides)), scene_(build_scene(description_)), step_(nanoseconds(step)),
        end_(nanoseconds(description_.duration)), fmu_(folder_.path() / "case.fmu") {
    if (step_ < 1) throw std::invalid_argument("the step has to be a nanosecond at least");
    record_orders();
    export_fmu(case_file, overrides, FmiVersion::fmi3, library, fmu_);
    unpack_archive(fmu_, folder_.path() / "unpacked");
    foreign_ = read_description(folder_.path() / "unpacked" / "modelDescription.xml");
  }

  double engine(bool in_steps) const {
    const auto unit = make_engine("simbody");
    unit->enter_initialization_mode(0);
    unit->exit_initialization_mode();
    const Clock::time_point start = Clock::now();
    Time now = 0;
    for (std::size_t i = 0; i < orders_.size(); ++i) {
      for (ValueReference v = 0; v < orders_[i].inputs.size(); ++v) unit->set(v, orders_[i].inputs[v]);
      unit->enter_event_mode();
      const Time until = i + 1 < orders_.size() ? orders_[i + 1].time : end_;
      while (true) {
        unit->update_discrete_states();
        unit->enter_step_mode();
        StepResult result{now};
        while (now < until && !result.event) {
          const Time target = in_steps ? std::min(until, (now / step_ + 1) * step_) : until;
          result = unit->do_step(now, target - now);
          now = result.time;
        }
        if (now >= until) break;
        unit->enter_event_mode();
      }
    }
    return since(start);
  }

  double case_unit() const {
    CaseUnit unit("case", description_);
    begin(unit);
    return step_and_read(unit);
  }

  double fmu_here() const {
    const auto fmu = load_foreign_fmu(folder_.path() / "unpacked", foreign_, "case");
    fmu->enter_initialization_mode(0);
    fmu->exit_initialization_mode();
    double sum = 0;
    const Clock::time_point start = Clock::now();
    for (Time now = 0; now < end_;) {
      const Time next = std::min(end_, now + step_);
      fmu->step(seconds(now), seconds(next) - seconds(now));
      now = next;
      for (const FmuVariable& v : foreign_.variables) {
        if (v.variable.causality == Causality::output) sum += fmu->get(v);
      }
    }
    sink_ = sum;
    return since(start);
  }

  double fmu_elsewhere() const {
    FmuUnit unit("case", fmu_);
    begin(unit);
    return step_and_read(unit);
  }

  std::vector<StateCost> states() const {
    std::vector<StateCost> costs;
    const auto add = [&](Unit& unit) {
      begin(unit);
      for (Time now = 0; now < kStateAt;) {
        const StepResult result = unit.do_step(now, std::min(step_, kStateAt - now));
        now = result.time;
        if (!result.event) continue;
        unit.enter_event_mode();
        unit.update_discrete_states();
        unit.enter_step_mode();
      }
      std::vector<double> save, restore;
      UnitState state;
      for (int i = 0; i < kStateCalls; ++i) {
        Clock::time_point start = Clock::now();
        state = unit.save();
        save.push_back(since(start));
        start = Clock::now();
        unit.restore(state);
        restore.push_back(since(start));
      }
      costs.push_back({unit.name(), state.size(), median(save), median(restore)});
    };
    for (const char* name : {"simbody", "mujoco_same_law", "mujoco"}) add(*make_engine(name));
    DriveUnit drives("drives", description_, scene_);
    add(drives);
    CaseUnit whole("case", description_);
    add(whole);
    FmuUnit fmu("case as an FMU", fmu_);
    add(fmu);
    return costs;
  }

 private:
  std::unique_ptr<EngineUnit> make_engine(const std::string& name) const {
    return harness::make_engine(name, scene_, contact_settings(description_.contact), solver_settings(description_));
  }

  void record_orders() {
    const auto plant = make_engine("simbody");
    DriveUnit drives("drives", description_, scene_);
    Master master;
    master.add(*plant);
    master.add(drives);
    connect_drives(master, *plant, drives);
    const auto record = [&] {
      Orders orders{master.time(), {}};
      for (ValueReference i = 0; i < plant->variables().size() && plant->variables()[i].causality == Causality::input; ++i) {
        orders.inputs.push_back(plant->get(i));
      }
      orders_.push_back(std::move(orders));
    };
    master.initialize(0);
    record();
    for (Time point = step_; master.time() < end_; point += step_) {
      const Time target = std::min(point, end_);
      while (master.time() < target) {
        if (!master.advance_to_event(target)) continue;
        master.handle_event();
        record();
      }
    }
  }

  double step_and_read(Unit& unit) const {
    double sum = 0;
    const Clock::time_point start = Clock::now();
    for (Time now = 0; now < end_;) {
      now = unit.do_step(now, std::min(step_, end_ - now)).time;
      for (ValueReference i = 0; i < unit.variables().size(); ++i) {
        if (unit.variables()[i].causality == Causality::output) sum += unit.get(i);
      }
    }
    sink_ = sum;
    return since(start);
  }

  const cases::Case description_;
  const crane_models::Scene scene_;
  const Time step_, end_;
  const TemporaryFolder folder_;
  const fs::path fmu_;
  FmuDescription foreign_;
  std::vector<Orders> orders_;
  mutable volatile double sink_ = 0;  // so that no reading is optimised away
};

}  // namespace

double InterfaceRun::median_wall_s() const { return median(wall_s); }

InterfaceCosts measure_interface(const fs::path& case_file, const std::vector<std::string>& overrides, const fs::path& library,
                                 double step, int repetitions, const std::function<bool(double)>& progress) {
  const Measurement measurement(case_file, overrides, library, step);
  const std::vector<std::pair<std::string, std::function<double()>>> ways{
      {"engine, from event to event", [&] { return measurement.engine(false); }},
      {"engine, in communication steps", [&] { return measurement.engine(true); }},
      {"case as a unit, all outputs read", [&] { return measurement.case_unit(); }},
      {"case as an FMU in this process", [&] { return measurement.fmu_here(); }},
      {"case as an FMU in its own process", [&] { return measurement.fmu_elsewhere(); }}};
  InterfaceCosts costs;
  for (const auto& way : ways) costs.runs.push_back({way.first, {}});
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    for (std::size_t i = 0; i < ways.size(); ++i) {
      if (!progress((repetition + static_cast<double>(i) / ways.size()) / repetitions)) return costs;
      costs.runs[i].wall_s.push_back(ways[i].second());
    }
  }
  costs.states = measurement.states();
  return costs;
}

}  // namespace quayside::harness

#include "harness/run.h"

#include <time.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>

#include "harness/build_scene.h"
#include "harness/drive_unit.h"
#include "harness/fmi/fmu_unit.h"
#include "harness/master.h"
#include "harness/script_use.h"

namespace quayside::harness {

namespace {

using Clock = std::chrono::steady_clock;

// That this thread has had [s]: what others run on the machine does not count.
double cpu_time() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

MasterSettings master_settings(const cases::MasterSpec& spec) { return {spec.method, spec.tolerance, spec.relaxation}; }

crane_models::ReductionReport nothing_reduced(const crane_models::Scene& scene) {
  crane_models::ReductionReport report;
  report.bodies_before = report.bodies_after = static_cast<int>(scene.bodies.size());
  report.degrees_of_freedom_before = report.degrees_of_freedom_after = crane_models::degrees_of_freedom(scene);
  report.pairs_before = report.pairs_after = static_cast<int>(scene.pairs.size());
  return report;
}

// One engine with drives of its own: a plant that may stop at its events, and the drives that follow it.
class Chain {
 public:
  Chain(const std::string& engine, std::unique_ptr<EngineUnit> plant, DriveUnit drives, const cases::Case& description,
        bool cpu_times)
      : plant_(std::move(plant)), drives_(std::move(drives)), master_(master_settings(description.master)),
        cpu_times_(cpu_times) {
    run_.engine = engine;
    master_.add(*plant_);
    master_.add(drives_);
    connect_drives(master_, *plant_, drives_);
    record_outputs(*plant_, "");
    record_outputs(drives_, "");
    for (const cases::UnitSpec& spec : description.units) {
      units_.push_back(std::make_unique<FmuUnit>(spec.name, spec.file, spec.parameters, spec.timeout));
      master_.add(*units_.back());
      record_outputs(*units_.back(), spec.name + ".");
    }
    for (const cases::ConnectionSpec& connection : description.connections) {
      const std::string commanded = commanded_by(connection);
      if (!commanded.empty()) drives_.hand_over(commanded, true);
      master_.connect(endpoint(connection.from), endpoint(connection.to));
    }
    run_.trajectory.columns.resize(recorded_.size());
  }

  const std::string& engine() const { return run_.engine; }
  bool active() const { return active_; }

  void initialize() {
    guarded([&] {
      master_.initialize(0);
      initialized_ = true;
      record();
    });
  }

  void advance_to(Time time) {
    guarded([&] {
      const Clock::time_point begin = Clock::now();
      const double cpu_begin = cpu_times_ ? cpu_time() : 0;
      active_ = master_.advance_to(time);
      if (cpu_times_) run_.step_cpu_s.push_back(cpu_time() - cpu_begin);
      run_.step_times_s.push_back(std::chrono::duration<double>(Clock::now() - begin).count());
      run_.wall_s += run_.step_times_s.back();
      record();
    });
  }

  EngineRun finish() {
    guarded([&] {
      if (!initialized_) return;
      run_.simulated_s = seconds(master_.time());
      run_.events = plant_->take_events();
      for (Event& event : drives_.take_events()) run_.events.push_back(std::move(event));
      std::stable_sort(run_.events.begin(), run_.events.end(), [](const Event& a, const Event& b) { return a.time < b.time; });
      run_.open_contacts = plant_->open_contacts();
      run_.energy = plant_->energy();
      run_.statistics = plant_->statistics();
      master_.terminate();
    });
    return std::move(run_);
  }

 private:
  void record_outputs(const Unit& unit, const std::string& prefix) {
    for (ValueReference i = 0; i < unit.variables().size(); ++i) {
      const Variable& variable = unit.variables()[i];
      if (variable.causality != Causality::output) continue;
      recorded_.emplace_back(&unit, i);
      run_.trajectory.names.push_back(prefix + variable.name);
      run_.trajectory.units.push_back(variable.unit);
    }
  }

  // As the master writes it: what a case calls "antisway.speed" is "antisway::speed", what it calls "load.position.y" is
  // the plant's.
  std::string endpoint(const std::string& name) const {
    const std::string first = name.substr(0, name.find('.'));
    for (const auto& unit : units_) {
      if (unit->name() == first && first.size() < name.size()) return first + "::" + name.substr(first.size() + 1);
    }
    for (const Variable& variable : drives_.variables()) {
      const bool input = variable.name.rfind("command.", 0) == 0;
      if (variable.name == name && (input || variable.causality == Causality::output)) return drives_.name() + "::" + name;
    }
    return plant_->name() + "::" + name;
  }

  // Runs `action`; what it throws ends this engine's run, and this one's alone. The first failure is the one to report.
  template <typename Action>
  void guarded(Action action) {
    try {
      action();
    } catch (const std::exception& error) {
      active_ = false;
      if (!run_.failure) run_.failure = error.what();
    }
  }

  void record() {
    Recording& trajectory = run_.trajectory;
    if (!trajectory.times.empty() && seconds(master_.time()) <= trajectory.times.back()) return;
    // Read all of the row before any of it is kept, so that a failure leaves no ragged table.
    row_.clear();
    for (const auto& [unit, variable] : recorded_) row_.push_back(unit->get(variable));
    trajectory.times.push_back(seconds(master_.time()));
    run_.steps_taken.push_back(plant_->statistics().steps);
    for (std::size_t i = 0; i < row_.size(); ++i) trajectory.columns[i].push_back(row_[i]);
  }

  std::unique_ptr<EngineUnit> plant_;
  DriveUnit drives_;
  std::vector<std::unique_ptr<FmuUnit>> units_;
  Master master_;
  const bool cpu_times_;
  std::vector<std::pair<const Unit*, ValueReference>> recorded_;
  std::vector<double> row_;
  EngineRun run_;
  bool initialized_ = false;
  bool active_ = true;
};

void check_engines(const std::vector<std::string>& engines) {
  if (engines.empty()) throw std::invalid_argument("no engine to run; name at least one");
  for (std::size_t i = 0; i < engines.size(); ++i) {
    if (std::count(engines.begin(), engines.end(), engines[i]) > 1) {
      throw std::invalid_argument(fmt::format("engine \"{}\" is named twice; name every engine once", engines[i]));
    }
  }
}

}  // namespace

crane_models::Scene simulated_scene(const cases::Case& description, bool full_scene, crane_models::ReductionReport& reduction) {
  if (full_scene) {
    crane_models::Scene scene = build_scene(description);
    reduction = nothing_reduced(scene);
    return scene;
  }
  LeftOut left_out;
  const crane_models::Scene whole = build_scene(description, left_out);
  crane_models::Scene scene = crane_models::reduce(whole, use_of(whole, description), reduction);
  left_out.add_to(reduction);
  return scene;
}

// All engines pass the same communication points, one after another: multiples of the output interval and the end. Each point
// is rounded to nanoseconds from its number, never reached by adding intervals up.
RunResult run_case(const cases::Case& description, const RunOptions& options, const EngineFactory& factory) {
  check_engines(options.engines);
  const Time end = nanoseconds(description.duration);
  if (end < 1 || nanoseconds(description.output_interval) < 1) {
    throw std::invalid_argument("duration and output interval have to be a nanosecond at least");
  }

  RunResult result;
  result.description = description;
  result.scene = simulated_scene(description, options.full_scene, result.reduction);

  const DriveUnit drives("drives", description, result.scene);
  std::vector<std::unique_ptr<Chain>> chains;  // a master refers to the units beside it: chains stay where they are
  for (const std::string& engine : options.engines) {
    auto plant = factory(engine, result.scene, contact_settings(description.contact), solver_settings(description));
    chains.push_back(std::make_unique<Chain>(engine, std::move(plant), drives, description, options.cpu_times));
  }

  for (const auto& chain : chains) chain->initialize();
  const auto any_active = [&] {
    return std::any_of(chains.begin(), chains.end(), [](const auto& chain) { return chain->active(); });
  };
  const Clock::time_point begin = Clock::now();
  Time time = 0;
  for (std::uint64_t point = 1; time < end && any_active() && !result.interrupted; ++point) {
    time = std::min(end, nanoseconds(static_cast<double>(point) * description.output_interval));
    for (const auto& chain : chains) {
      if (!chain->active()) continue;
      chain->advance_to(time);
      if (options.progress && !options.progress(seconds(time), chain->engine())) result.interrupted = true;
    }
    if (options.real_time) {
      const Clock::time_point due = begin + std::chrono::nanoseconds(time);
      if (!result.pacing) result.pacing.emplace();
      const double late_by = std::chrono::duration<double>(Clock::now() - due).count();
      ++result.pacing->frames;
      result.pacing->late += late_by > 0;
      result.pacing->latest_s = std::max(result.pacing->latest_s, late_by);
      std::this_thread::sleep_until(due);
    }
  }

  for (const auto& chain : chains) result.engines.push_back(chain->finish());
  return result;
}

}  // namespace quayside::harness

#include "harness/coupling/split_crane.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include <fmt/format.h>

#include "harness/build_scene.h"

namespace quayside::harness {

namespace {

constexpr double kLookAt = 0.2;  // [s]
// Simbody is to be exact, so that what is seen is the coupling.
constexpr double kTolerance = 1e-9;
constexpr double kAgreement = 1e-9;  // of iterations

}  // namespace

// What the ropes pull the trolley with, along y: without state, from where both ends are and the tensions.
class SplitCrane::RopePull final : public Unit {
 public:
  explicit RopePull(const crane_models::Scene& scene) : ropes_(scene.ropes) {
    for (const auto& frame : scene.frames) {
      if (frame.name != "trolley" && frame.name != "spreader") continue;
      ends_[frame.body] = {variables_.size(), frame.X_BR};
      for (const char* axis : {"x", "y", "z"}) input(frame.name + ".position." + axis, "m");
      for (const char* axis : {"w", "x", "y", "z"}) input(frame.name + ".orientation." + axis, "1");
    }
    tensions_ = variables_.size();
    for (const auto& rope : ropes_) input(rope.name + ".tension", "N");
    variables_.push_back({"pull", "N", Causality::output, Type::float64, "of the ropes on the trolley, along y", 0});
  }

  const std::string& name() const override { return name_; }
  const std::vector<Variable>& variables() const override { return variables_; }
  double get(ValueReference variable) const override {
    return variable + 1 == variables_.size() ? pull() : inputs_.at(variable);
  }
  void set(ValueReference variable, double value) override { inputs_.at(variable) = value; }
  void enter_initialization_mode(Time) override {}
  void exit_initialization_mode() override {}
  void enter_event_mode() override {}
  std::optional<Time> update_discrete_states() override { return std::nullopt; }
  void enter_step_mode() override {}
  StepResult do_step(Time now, Time step) override { return {now + step}; }
  UnitState save() override {
    ByteWriter out;
    out.put(inputs_.data(), inputs_.size());
    return out.take();
  }
  void restore(const UnitState& state) override {
    ByteReader in(state);
    in.get(inputs_.data(), inputs_.size());
    in.finish();
  }
  void terminate() override {}
  void reset() override { std::fill(inputs_.begin(), inputs_.end(), 0.0); }

 private:
  struct End {
    std::size_t first;  // of its inputs
    crane_models::Pose X_BR;
  };

  void input(const std::string& name, const std::string& unit) {
    variables_.push_back({name, unit, Causality::input, Type::float64, "", 0});
    inputs_.push_back(0);
  }
  Eigen::Vector3d point(const spreader::Attachment& attachment) const {
    const End& end = ends_.at(attachment.body);
    const double* v = inputs_.data() + end.first;
    crane_models::Pose X_WR = crane_models::Pose::Identity();
    X_WR.translation() = Eigen::Map<const Eigen::Vector3d>(v);
    X_WR.linear() = Eigen::Quaterniond(v[3], v[4], v[5], v[6]).toRotationMatrix();
    return X_WR * end.X_BR.inverse() * attachment.p_B;
  }
  double pull() const {
    double sum = 0;
    for (std::size_t i = 0; i < ropes_.size(); ++i) {
      const Eigen::Vector3d along = point(ropes_[i].lower) - point(ropes_[i].upper);
      if (along.norm() > 0) sum += inputs_[tensions_ + i] * along.y() / along.norm();
    }
    return sum;
  }

  const std::string name_ = "ropes";
  const std::vector<spreader::Rope> ropes_;
  std::vector<Variable> variables_;
  std::vector<double> inputs_;
  std::map<int, End> ends_;  // by body
  std::size_t tensions_ = 0;
};

SplitCrane::SplitCrane(const cases::Case& description, const TrolleyMotor& motor, const MasterSettings& settings)
    : master_(settings) {
  const crane_models::Scene scene = build_scene(description);
  load_ = make_engine("simbody", scene, contact_settings(description.contact), solver_settings(description));
  pull_ = std::make_unique<RopePull>(scene);
  drives_ = std::make_unique<DriveUnit>("drives", description, scene);

  LinearSystem carriage;
  const double m = motor.mass;
  carriage.A = (Eigen::Matrix2d() << 0, 1, -motor.i / m, -motor.p / m).finished();
  carriage.B = (Eigen::Matrix<double, 2, 3>() << 0, 0, 0, motor.i / m, motor.p / m, 1 / m).finished();
  carriage.C.resize(3, 2);
  carriage.C << Eigen::Matrix2d::Identity(), carriage.A.row(1);
  carriage.D = Eigen::MatrixXd::Zero(3, 3);
  carriage.D.row(2) = carriage.B.row(1);
  carriage.start = Eigen::Vector2d(description.crane.trolley_position, 0);
  carriage.inputs = {{"position_wanted", "m"}, {"speed_wanted", "m/s"}, {"pull", "N"}};
  carriage.outputs = {{"value", "m"}, {"rate", "m/s"}, {"acceleration", "m/s2"}};
  trolley_ = std::make_unique<LinearUnit>("trolley", carriage);

  // The load may stop early where it lands: it comes first.
  for (Unit* unit : {static_cast<Unit*>(load_.get()), static_cast<Unit*>(pull_.get()), static_cast<Unit*>(trolley_.get()),
                     static_cast<Unit*>(drives_.get())}) {
    master_.add(*unit);
  }
  for (const Variable& variable : pull_->variables()) {
    if (variable.causality == Causality::input) master_.connect("simbody::" + variable.name, "ropes::" + variable.name);
  }
  master_.connect("ropes::pull", "trolley::pull");
  master_.connect("drives::trolley.value", "trolley::position_wanted");
  master_.connect("drives::trolley.rate", "trolley::speed_wanted");
  for (const std::string motion : {"value", "rate", "acceleration"}) {
    master_.connect("trolley::" + motion, "simbody::trolley." + motion, Carries::at_once);
  }
  for (const Variable& variable : drives_->variables()) {
    const auto& known = load_->variables();
    const bool shared = std::any_of(known.begin(), known.end(), [&](const Variable& v) { return v.name == variable.name; });
    if (!shared || variable.name.rfind("trolley.", 0) == 0) continue;
    const std::string at_drives = "drives::" + variable.name, at_load = "simbody::" + variable.name;
    if (variable.causality == Causality::output) master_.connect(at_drives, at_load, Carries::at_once);
    if (variable.causality == Causality::input) master_.connect(at_load, at_drives);
  }
}

SplitCrane::~SplitCrane() = default;

double SplitCrane::value(const std::string& name) const {
  const auto& variables = load_->variables();
  for (ValueReference i = 0; i < variables.size(); ++i) {
    if (variables[i].name == name) return load_->get(i);
  }
  throw std::invalid_argument(fmt::format("the crane has no {}", name));
}

double SplitCrane::trolley_position() const { return value("trolley.position.y"); }
double SplitCrane::load_position() const { return value("spreader.position.y"); }

// --- The study -------------------------------------------------------------------------------------------------------

namespace {

cases::Case crane_case(double duration) {
  cases::Case description;
  description.file = "split_crane";
  description.duration = duration;
  description.solver.relative_tolerance = kTolerance;
  description.crane.type = "quayside";
  description.crane.trolley_position = 20;
  description.crane.trolley_height = 32;
  description.crane.rope_length = 15;
  description.spreader.emplace();
  cases::ContainerSpec load;
  load.name = "load";
  load.mass = 30480;
  load.on_spreader = true;
  description.containers.push_back(load);
  description.script.resize(2);
  description.script[0].speeds = {{"trolley", 2.0}};
  description.script[1].time = 0.55 * duration;
  description.script[1].speeds = {{"trolley", 0.0}};
  return description;
}

struct Track {
  std::vector<double> positions;  // of trolley and spreader, in turn
  std::uint64_t evaluations = 0;
};

Track follow(const cases::Case& description, const MasterSettings& settings, double step) {
  SplitCrane crane(description, TrolleyMotor{}, settings);
  crane.master().initialize(0);
  Track track;
  const auto per_look = std::lround(kLookAt / step);
  const auto steps = std::lround(description.duration / step);
  for (long i = 1; i <= steps; ++i) {
    crane.master().advance_to(nanoseconds(static_cast<double>(i) * step));
    if (i % per_look != 0) continue;
    track.positions.push_back(crane.trolley_position());
    track.positions.push_back(crane.load_position());
  }
  track.evaluations = crane.evaluations();
  return track;
}

}  // namespace

std::vector<SplitPoint> split_crane_errors(const std::vector<double>& steps, const std::vector<double>& tolerances,
                                           double reference, double duration) {
  const cases::Case description = crane_case(duration);
  const Track truth = follow(description, {"iterated", kAgreement, 1}, reference);
  std::vector<SplitPoint> points;
  const auto add = [&](const std::string& method, double tolerance, double step, bool first) {
    const Track track = follow(description, {method, tolerance > 0 ? tolerance : kAgreement, 1}, step);
    SplitPoint point{method, step, tolerance, 0, track.evaluations, std::nan("")};
    for (std::size_t i = 0; i < truth.positions.size(); ++i) {
      point.error = std::max(point.error, std::abs(track.positions.at(i) - truth.positions[i]));
    }
    if (!first && tolerance == 0) point.order = std::log(points.back().error / point.error) / std::log(points.back().step / step);
    points.push_back(point);
  };
  for (const char* method : {"jacobi", "gauss_seidel", "iterated"}) {
    for (const double step : steps) add(method, 0, step, step == steps.front());
  }
  for (const double tolerance : tolerances) add("error_controlled", tolerance, kLookAt, true);
  return points;
}

}  // namespace quayside::harness

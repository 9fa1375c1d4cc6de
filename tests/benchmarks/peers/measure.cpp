#include "tests/benchmarks/peers/measure.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "contact_nn/random.h"

namespace quayside::peers {
namespace {

using Clock = std::chrono::steady_clock;
using Eigen::Vector3d;

double nanoseconds(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double, std::nano>(to - from).count();
}

double distance(const Box& box, const Placement& X_WB, const Vector3d& p_W) {
  const Vector3d p = X_WB.R.transpose() * (p_W - X_WB.p);
  return (p.cwiseAbs() - box.half).cwiseMax(0).norm();
}

double angle_in_degrees(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / M_PI;
}

void judge(const Placed& pair, const Truth& truth, const Answer& answer, Accuracy& accuracy) {
  ++accuracy.poses;
  const bool touching = truth.gap < 0;
  accuracy.missed += touching && !answer.touching;
  accuracy.phantom += !touching && answer.touching;
  if (!touching || !answer.touching) return;
  accuracy.depth_error.push_back(std::abs(answer.depth + truth.gap));
  double angle = 180;
  for (const Vector3d& n : truth.normals_W) angle = std::min(angle, angle_in_degrees(n, answer.n_W));
  accuracy.normal_error.push_back(answer.n_W.allFinite() ? angle : Answer::kNone);
  // Libraries differ in which of the two surfaces they put a point on: along the normal it is not judged.
  const Vector3d& n = truth.normals_W.front();
  const Vector3d error = answer.point_W - truth.centre_W;
  accuracy.point_error.push_back((error - n * n.dot(error)).norm());
  const double outside =
      std::max(distance(pair.a, pair.X_WA, answer.point_W), distance(pair.b, pair.X_WB, answer.point_W));
  accuracy.point_outside.push_back(std::max(0.0, outside + truth.gap));
}

// Does nothing: what is timed is the clock and the virtual call.
class Nothing final : public Contender {
 public:
  Nothing() : Contender("nothing", Kind::ours) {}
  void load(const std::vector<Placed>& pairs) override {}
  double query(std::size_t i) override { return static_cast<double>(i); }
  Answer answer() const override { return {}; }
  std::string note() const override { return ""; }
};

struct Timing {
  Contender* contender;
  std::size_t poses;
  std::vector<std::vector<double>> single;  // by pose, then by round
  std::vector<double> pass;                 // by round
};

void time_round(Timing& timing, double& sink) {
  Contender& contender = *timing.contender;
  for (std::size_t i = 0; i < timing.poses; ++i) sink += contender.query(i);  // brings poses and code into the caches
  for (std::size_t i = 0; i < timing.poses; ++i) {
    const auto start = Clock::now();
    sink += contender.query(i);
    timing.single[i].push_back(nanoseconds(start, Clock::now()));
  }
  const auto start = Clock::now();
  sink += contender.pass(timing.poses);
  timing.pass.push_back(nanoseconds(start, Clock::now()) / static_cast<double>(timing.poses));
}

Times summary(const Timing& timing, double overhead) {
  std::vector<double> by_pose;
  for (const std::vector<double>& rounds : timing.single) by_pose.push_back(quantile(rounds, 0.5) - overhead);
  return {timing.poses, quantile(by_pose, 0.5), quantile(by_pose, 0.99), quantile(timing.pass, 0.5)};
}

}  // namespace

double quantile(std::vector<double> values, double q) {
  values.erase(std::remove_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); }), values.end());
  if (values.empty()) return Answer::kNone;
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

Measurement measure(const Contenders& contenders, const std::vector<Scene>& scenes, const Effort& effort) {
  Measurement out;
  std::vector<double> overheads;
  contact_nn::Random random(1);
  double sink = 0;
  for (const Scene& scene : scenes) {
    std::vector<Truth> truths;
    for (const Placed& pair : scene.pairs) truths.push_back(truth_of(pair));

    std::vector<Timing> timings;
    for (const auto& contender : contenders) {
      Result result{contender.get(), &scene, {}, {}};
      contender->load(scene.pairs);
      const auto start = Clock::now();
      double seconds_in_queries = 0;
      std::size_t done = 0;
      for (; done < scene.pairs.size(); ++done) {
        const double seconds = 1e-9 * nanoseconds(start, Clock::now());
        if (done >= effort.least_poses && seconds > effort.accuracy_budget) break;
        const auto before = Clock::now();
        sink += contender->query(done);
        seconds_in_queries += 1e-9 * nanoseconds(before, Clock::now());
        judge(scene.pairs[done], truths[done], contender->answer(), result.accuracy);
      }
      out.results.push_back(std::move(result));
      const double affordable = effort.pass_budget * static_cast<double>(done) / seconds_in_queries;
      const std::size_t poses =
          std::clamp(static_cast<std::size_t>(affordable), std::min(effort.least_poses, done), done);
      timings.push_back({contender.get(), poses, std::vector<std::vector<double>>(poses), {}});
    }
    Nothing nothing;
    timings.push_back({&nothing, scene.pairs.size(), std::vector<std::vector<double>>(scene.pairs.size()), {}});

    std::vector<std::size_t> order(timings.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
    for (int round = 0; round < effort.rounds; ++round) {
      for (std::size_t k = order.size(); k > 1; --k) std::swap(order[k - 1], order[random.below(k)]);
      for (const std::size_t k : order) time_round(timings[k], sink);
      if (effort.progress) effort.progress(fmt::format("{}: round {} of {}", scene.name, round + 1, effort.rounds));
    }
    const double overhead = summary(timings.back(), 0).median;
    overheads.push_back(overhead);
    const std::size_t first = out.results.size() - contenders.size();
    for (std::size_t k = 0; k < contenders.size(); ++k) out.results[first + k].times = summary(timings[k], overhead);
  }
  volatile double kept = sink;
  (void)kept;
  out.clock_overhead = quantile(overheads, 0.5);
  return out;
}

std::vector<std::string> check(const Contenders& contenders) {
  const Box cube{{1, 1, 1}};
  const double depth = 0.02;
  const auto placed = [&](const Vector3d& p, const Eigen::Matrix3d& R) {
    Placed pair{cube, cube, contact_nn::Pose::Identity(), contact_nn::Pose::Identity()};
    pair.X_WB.R = R;
    pair.X_WB.p = p;
    return pair;
  };
  // B on its corner: its diagonal, √3 long from the centre, points down. Not exactly above A's centre, where a mesh has a corner.
  const Eigen::Matrix3d on_corner =
      Eigen::Quaterniond::FromTwoVectors(Vector3d(1, 1, 1), -Vector3d::UnitZ()).toRotationMatrix();
  const Vector3d corner(0.11, 0.23, 1);
  const std::vector<Placed> pairs{
      placed({0.013, 0.017, 2 - depth}, Eigen::AngleAxisd(1e-3, Vector3d::UnitZ()).toRotationMatrix()),  // flat
      placed(corner + Vector3d(0, 0, std::sqrt(3.0) - depth), on_corner),
      placed({0, 0, 2.5}, Eigen::Matrix3d::Identity()),  // apart
  };

  std::vector<std::string> failures;
  for (const auto& contender : contenders) {
    contender->load(pairs);
    const auto fail = [&](const std::string& what) { failures.push_back(contender->name + ": " + what); };
    const bool mesh = contender->mesh_resolution > 0;
    // A mesh is as good as its grid, and it is not asked for a depth or a normal.
    const double tolerance = contender->check_tolerance;
    const double point_tolerance = mesh ? 2 * contender->mesh_resolution : contender->check_point_tolerance;
    const double expected = depth * contender->reported_depth;

    for (const std::size_t i : {0, 1}) {
      const std::string scene = i == 0 ? "flat cubes: " : "corner in a face: ";
      contender->query(i);
      const Answer answer = contender->answer();
      if (!answer.touching) {
        fail(scene + "no contact");
        continue;
      }
      const Placed& pair = pairs[i];
      if (std::abs(answer.depth - expected) > tolerance && !mesh) {  // never for a method that gives no depth
        fail(fmt::format("{}depth {:.6f} m instead of {:.6f}", scene, answer.depth, expected));
      }
      const double angle = angle_in_degrees(Vector3d::UnitZ(), answer.n_W);
      if (!(angle * M_PI / 180 <= tolerance) && !mesh) fail(fmt::format("{}normal off by {:.3f} degrees", scene, angle));
      if (!contender->gives_point) continue;
      const double outside = std::max(distance(pair.a, pair.X_WA, answer.point_W), distance(pair.b, pair.X_WB, answer.point_W));
      if (!(outside <= depth + point_tolerance)) fail(fmt::format("{}point {:.4f} m outside the boxes", scene, outside));
      const double away = (answer.point_W - corner).norm();
      if (i == 1 && !(away <= depth + point_tolerance)) fail(fmt::format("{}point {:.4f} m from the corner", scene, away));
    }
    contender->query(2);
    if (contender->answer().touching) fail("contact between cubes half a metre apart");
  }
  return failures;
}

}  // namespace quayside::peers

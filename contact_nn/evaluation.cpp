#include "contact_nn/evaluation.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include "contact_nn/committee.h"
#include "contact_nn/dataset.h"
#include "contact_nn/exact_module.h"
#include "contact_nn/gate_features.h"

namespace quayside::contact_nn {
namespace {

using Eigen::Vector3d;

// Edge directions whose sine is smaller have no common normal worth trying [1]; see separating_axes.cpp.
constexpr double kParallelSine = 1e-7;

// Force and torque of the committee and of the exact law, relative to their size [1].
constexpr double kForceTolerance = 1e-9;

// Poses that share a seed: as small as it may be without starting generators all the time.
constexpr std::uint64_t kBlock = 5000;

// ---- Who meets whom

struct SizePair {
  const char* name;
  std::function<std::pair<Box, Box>(Random&)> draw;
};

const std::vector<SizePair>& size_pairs() {
  static const auto stretched = [](const Vector3d& half, Random& random) {  // from half to twice each extent
    Box box{half};
    for (double& h : box.half) h *= std::pow(4.0, random.uniform() - 0.5);
    return box;
  };
  static const auto container = [](Random& random) {
    constexpr BoxKind kinds[] = {BoxKind::container_20ft, BoxKind::container_40ft, BoxKind::container_45ft};
    return sample_box(kinds[random.below(3)], random);
  };
  static const auto two = [](const Vector3d& half) {
    return [half](Random& random) { return std::pair(stretched(half, random), stretched(half, random)); };
  };
  static const std::vector<SizePair> all{
      {"cubes", [](Random&) { return std::pair(Box{{1, 1, 1}}, Box{{1, 1, 1}}); }},
      {"slabs", two({3, 1.2, 0.05})},
      {"needles", two({2, 0.02, 0.03})},
      {"containers", [](Random& random) { return std::pair(container(random), container(random)); }},
      {"spreader on container",
       [](Random& random) { return std::pair(container(random), sample_box(BoxKind::spreader, random)); }},
      {"container on ground",
       [](Random& random) { return std::pair(sample_box(BoxKind::ground, random), container(random)); }}};
  return all;
}

// ---- The truth

double extent(const Box& a, const Box& b, const Eigen::Matrix3d& R, const Vector3d& direction) {
  return a.half.dot(direction.cwiseAbs()) + b.half.dot((R.transpose() * direction).cwiseAbs());
}

double separation_along(const BoxPair& pair, const Vector3d& direction) {
  return std::abs(direction.dot(pair.X_AB.translation())) - extent(pair.a, pair.b, pair.X_AB.linear(), direction);
}

// Separation along each axis, numbered as in separating_axes.h.
std::array<double, kAxisCount> all_separations(const BoxPair& pair) {
  const Eigen::Matrix3d R = pair.X_AB.linear();
  std::array<double, kAxisCount> all;
  for (int i = 0; i < 3; ++i) {
    all[i] = separation_along(pair, Vector3d::Unit(i));
    all[3 + i] = separation_along(pair, R.col(i));
    for (int j = 0; j < 3; ++j) {
      const Vector3d normal = Vector3d::Unit(i).cross(R.col(j));
      const double sine = normal.norm();
      all[6 + 3 * i + j] =
          sine < kParallelSine ? -std::numeric_limits<double>::infinity() : separation_along(pair, normal / sine);
    }
  }
  return all;
}

double true_separation(const BoxPair& pair) {
  const auto separations = all_separations(pair);
  return *std::max_element(separations.begin(), separations.end());
}

double size_of(const BoxPair& pair) { return pair.a.half.norm() + pair.b.half.norm(); }

double distance_outside(const Box& box, const Vector3d& p) { return (p.cwiseAbs() - box.half).cwiseMax(0).norm(); }

// ---- The verdicts

bool equal(const Vector3d& x, const Vector3d& y) { return (x - y).norm() <= kForceTolerance * y.norm(); }

// The modules as they are deployed, and the gate by itself.
struct Judge {
  explicit Judge(const EvaluationOptions& options)
      : points_file(options.network.empty() ? shipped_gate(Law::points)
                                            : read_network(options.network, kPointsInterface)),
        gate(points_file.network) {
    const ContactSettings settings;
    deployed = make_committee_module(settings);
    exact = make_exact_module(settings);
  }

  void committee(const BoxPair& pair, const RelativeVelocity& V, SizeVerdict& verdict) const {
    ContactCounters counters, ignored;
    judge(pair, deployed->query(pair.a, pair.b, pair.X_AB, counters), verdict);

    const double truth = true_separation(pair), tolerance = kEvaluationTolerance * size_of(pair);
    const ContactForce f = deployed->force(pair.a, pair.b, pair.X_AB, V, counters);
    const ContactForce g = exact->force(pair.a, pair.b, pair.X_AB, V, ignored);
    verdict.phantom += truth > tolerance && (f.touching || f.f_A != Vector3d::Zero() || f.t_A != Vector3d::Zero());
    verdict.missed += truth < -tolerance && !f.touching;
    verdict.force_off += !(equal(f.f_A, g.f_A) && equal(f.t_A, g.t_A));
    verdict.fallbacks += counters.fallbacks;
  }

  void gate_alone(const BoxPair& pair, GateVerdict& verdict) const {
    const auto separations = all_separations(pair);
    const double truth = *std::max_element(separations.begin(), separations.end());
    double named = -std::numeric_limits<double>::infinity();
    for (const int axis : top_three(gate(GateView(pair.a, pair.b, pair.X_AB).inputs)))
      named = std::max(named, separations[static_cast<std::size_t>(axis)]);
    ++verdict.poses;
    verdict.off += truth - named > kGateTolerance;
    verdict.worst = std::max(verdict.worst, truth - named);
  }

  NetworkFile points_file;
  PointsGate gate;
  std::unique_ptr<ContactModule> deployed, exact;
};

Evaluation empty_evaluation() {
  Evaluation evaluation;
  for (const SizePair& sizes : size_pairs()) {
    evaluation.sizes.emplace_back();
    evaluation.sizes.back().name = sizes.name;
  }
  evaluation.gate = {{"40 ft pairs, any pose in the shell", 0, 0, 0, 2e-3}, {"crane poses", 0, 0, 0, 1e-3}};
  return evaluation;
}

void add(const Evaluation& part, Evaluation& whole) {
  for (std::size_t i = 0; i < whole.sizes.size(); ++i) {
    SizeVerdict& w = whole.sizes[i];
    const SizeVerdict& p = part.sizes[i];
    for (const auto count : {&SizeVerdict::poses, &SizeVerdict::touching, &SizeVerdict::phantom, &SizeVerdict::missed,
                             &SizeVerdict::deeper, &SizeVerdict::gap_off, &SizeVerdict::normal_off,
                             &SizeVerdict::too_many,
                             &SizeVerdict::off_surface, &SizeVerdict::force_off, &SizeVerdict::fallbacks})
      w.*count += p.*count;
    w.worst_gap = std::max(w.worst_gap, p.worst_gap);
  }
  for (std::size_t i = 0; i < whole.gate.size(); ++i) {
    whole.gate[i].poses += part.gate[i].poses;
    whole.gate[i].off += part.gate[i].off;
    whole.gate[i].worst = std::max(whole.gate[i].worst, part.gate[i].worst);
  }
}

// One block: the committee on `count` poses of one size pair, all kinds of poses in turn, and the gate alone on as
// many.
void evaluate_block(const Judge& judge, std::uint64_t seed, std::uint64_t block, std::uint64_t count, Evaluation& out) {
  const std::size_t which = block % size_pairs().size();
  Random random(seed * 1000003 + block);
  const std::vector<PoseDomain>& domains = all_pose_domains();
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto [a, b] = size_pairs()[which].draw(random);
    // Depths and gaps up to a tenth of the thinner box, and not more than what containers meet.
    const double thin = 0.1 * std::min(a.half.minCoeff(), b.half.minCoeff()), most = std::min(thin, 0.05);
    const BoxPair pair = sample_pair(a, b, domains[i % domains.size()], {most, most}, random);
    judge.committee(pair, {0.2 * random.direction(), 0.5 * random.direction()}, out.sizes[which]);
  }

  constexpr GapRange shell{0.05, 0.05};
  const Box container{{6.096, 1.219, 1.2955}};
  for (std::uint64_t i = 0; i < count; i += 2)
    judge.gate_alone(sample_pair(container, container, PoseDomain::any, shell, random), out.gate[0]);
  const std::vector<PoseDomain> crane{PoseDomain::landing, PoseDomain::aligned, PoseDomain::resting, PoseDomain::side};
  for (const BoxPair& pair : sample_pairs(count / 2, crane, shell, random.below(std::uint64_t{1} << 62)))
    judge.gate_alone(pair, out.gate[1]);
}

}  // namespace

void judge(const BoxPair& pair, const Manifold& m, SizeVerdict& verdict) {
  const double truth = true_separation(pair), size = size_of(pair), tolerance = kEvaluationTolerance * size;
  ++verdict.poses;
  verdict.touching += truth < -tolerance;
  verdict.worst_gap = std::max(verdict.worst_gap, std::abs(m.gap - truth) / size);
  verdict.phantom += truth > tolerance && (m.count > 0 || m.gap < 0);
  verdict.missed += truth < -tolerance && m.count == 0;
  verdict.gap_off += !(std::abs(m.gap - truth) <= tolerance);
  verdict.normal_off += !(std::abs(m.n_A.norm() - 1) <= kEvaluationTolerance &&
                          std::abs(separation_along(pair, m.n_A) - truth) <= tolerance &&
                          m.n_A.dot(pair.X_AB.translation()) >= -tolerance);
  verdict.too_many += m.count > static_cast<int>(m.points.size());
  bool deeper = false, off = false;
  for (int i = 0; i < m.count; ++i) {
    const ManifoldPoint& point = m.points[static_cast<std::size_t>(i)];
    const double allowed = 0.5 * std::max(point.depth, 0.0) + tolerance;
    deeper |= !(point.depth <= -truth + tolerance);
    off |= !(distance_outside(pair.a, point.p_A) <= allowed &&
             distance_outside(pair.b, pair.X_AB.inverse(Eigen::Isometry) * point.p_A) <= allowed);
  }
  verdict.deeper += deeper;
  verdict.off_surface += off;
}

std::uint64_t Evaluation::failures() const {
  std::uint64_t sum = 0;
  for (const SizeVerdict& verdict : sizes) sum += verdict.failures();
  return sum;
}

// Blocks are numbered and each has its own seed, so it does not matter who does which.
Evaluation evaluate_committee(const EvaluationOptions& options) {
  const Judge judge(options);
  const std::uint64_t block_size = std::min(kBlock, options.poses / size_pairs().size() + 1);
  const std::uint64_t blocks = (options.poses + block_size - 1) / block_size;
  std::atomic<std::uint64_t> next{0};
  std::mutex mutex;
  Evaluation whole = empty_evaluation();
  std::uint64_t done = 0;
  const auto work = [&] {
    for (std::uint64_t block; (block = next++) < blocks;) {
      Evaluation part = empty_evaluation();
      evaluate_block(judge, options.seed, block, std::min(block_size, options.poses - block * block_size), part);
      const std::lock_guard lock(mutex);
      add(part, whole);
      if (options.progress) options.progress(static_cast<double>(++done) / static_cast<double>(blocks));
    }
  };
  std::vector<std::thread> threads;
  const unsigned count = options.threads > 0 ? options.threads : std::max(1u, std::thread::hardware_concurrency());
  for (unsigned i = 1; i < count; ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  return whole;
}

}  // namespace quayside::contact_nn

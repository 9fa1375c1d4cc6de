#include "contact_nn/dataset.h"

#include <algorithm>
#include <cmath>

namespace quayside::contact_nn {

namespace {

constexpr double degree = M_PI / 180;
// Of what is drawn by orders of magnitude.
constexpr double smallest_gap = 1e-9;     // [m]
constexpr double smallest_offset = 1e-6;  // [m]
constexpr double smallest_angle = 1e-7;   // [rad]
// Boxes that are locked together, or have come to rest, are off by little more than rounding.
constexpr double smallest_disturbance = 1e-15;  // [m], [rad]
constexpr double largest_disturbance = 1e-3;
constexpr double largest_tilt = 3 * degree;

// Evenly or by orders of magnitude, with either sign.
double spread(double smallest, double largest, Random& random) {
  const double size =
      random.uniform() < 0.5 ? random.uniform(0, largest) : smallest * std::pow(largest / smallest, random.uniform());
  return random.sign() * size;
}

Eigen::Matrix3d rotation(double yaw, double pitch, double roll) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  return (AngleAxisd(yaw, Vector3d::UnitZ()) * AngleAxisd(pitch, Vector3d::UnitY()) *
          AngleAxisd(roll, Vector3d::UnitX()))
      .toRotationMatrix();
}

// Every fifth tilt is exactly zero.
double tilt(Random& random) { return random.uniform() < 0.2 ? 0 : spread(smallest_angle, largest_tilt, random); }

double yaw(Random& random) {
  if (random.uniform() < 0.3) return random.uniform(-M_PI, M_PI);
  return static_cast<double>(random.below(4)) * M_PI / 2 + spread(smallest_angle, 5 * degree, random);
}

// By quarter turns, exact to the last bit.
Eigen::Matrix3d quarter_turns(Random& random) {
  static const int cosines[] = {1, 0, -1, 0}, sines[] = {0, 1, 0, -1};
  const auto turns = random.below(4);
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R(0, 0) = R(1, 1) = cosines[turns];
  R(1, 0) = sines[turns];
  R(0, 1) = -R(1, 0);
  return R;
}

// Moves B along `direction` until the separation is `gap`. Separation is convex along a line and grows without bound,
// so seen from far out there is one such place.
void slide_to_gap(BoxPair& pair, const Eigen::Vector3d& direction, double gap) {
  const Eigen::Vector3d from = pair.X_AB.translation();
  double low = 0, high = 2 * (pair.a.half.sum() + pair.b.half.sum() + from.norm()) + std::abs(gap);
  const auto separation_at = [&](double distance) {
    pair.X_AB.translation() = from + distance * direction;
    return separation(pair.a, pair.b, pair.X_AB);
  };
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (separation_at(middle) > gap ? high : low) = middle;
  }
  separation_at(high);
}

// Where B stands over A, along axis k of A: from exactly above to beside it.
double offset(int k, const BoxPair& pair, double reach_b, bool exact, Random& random) {
  const double flush = std::abs(pair.a.half[k] - reach_b), all = pair.a.half[k] + reach_b;
  const double choice = random.uniform();
  if (exact && choice < 0.3) return 0;
  if (exact && choice < 0.5) return random.sign() * flush;
  if (choice < 0.65) return spread(smallest_offset, 0.1, random);
  if (choice < 0.75) return random.sign() * flush + spread(smallest_offset, 0.1, random);
  return random.uniform(-all, all);
}

}  // namespace

Box sample_box(BoxKind kind, Random& random) {
  switch (kind) {
    case BoxKind::container_20ft: return {{3.029, 1.219, 1.2955}};
    case BoxKind::container_40ft: return {{6.096, 1.219, random.uniform() < 0.5 ? 1.2955 : 1.448}};  // standard, high
    case BoxKind::container_45ft: return {{6.858, 1.219, 1.448}};
    case BoxKind::spreader: {  // telescopic: as long as what it lifts
      static const double half_lengths[] = {3.029, 6.096, 6.858};
      return {{half_lengths[random.below(3)], 1.219, random.uniform(0.2, 0.5)}};
    }
    case BoxKind::ground: return {{random.uniform(10, 200), random.uniform(10, 200), random.uniform(0.5, 2)}};
    case BoxKind::trailer_deck: return {{6.25, 1.25, 0.15}};
  }
  return {};
}

const std::vector<PoseDomain>& all_pose_domains() {
  static const std::vector<PoseDomain> all{PoseDomain::landing, PoseDomain::aligned, PoseDomain::resting,
                                           PoseDomain::side, PoseDomain::any};
  return all;
}

const char* name_of(PoseDomain domain) {
  switch (domain) {
    case PoseDomain::landing: return "landing";
    case PoseDomain::aligned: return "aligned";
    case PoseDomain::resting: return "resting";
    case PoseDomain::side: return "side";
    case PoseDomain::any: return "any";
  }
  return "?";
}

BoxPair sample_pair(const Box& a, const Box& b, PoseDomain domain, const GapRange& gaps, Random& random) {
  BoxPair pair{a, b, Pose::Identity()};
  const double smaller = std::min(a.half.minCoeff(), b.half.minCoeff());
  const double least_range = domain == PoseDomain::any ? 0.1 * smaller : 0;
  const double deepest = std::min(std::max(gaps.deepest, least_range), smaller);
  const double farthest = gaps.farthest > 0 ? std::max(gaps.farthest, least_range) : 0;
  const bool touching = farthest == 0 || random.uniform() < 0.7;
  const double gap = touching ? -std::abs(spread(smallest_gap, deepest, random))
                              : std::abs(spread(smallest_gap, farthest, random));

  Eigen::Vector3d direction;
  if (domain == PoseDomain::any) {
    pair.X_AB.linear() = random.rotation();
    direction = random.direction();
    const Eigen::Vector3d reach = a.half + pair.X_AB.linear().cwiseAbs() * b.half;
    for (int k = 0; k < 3; ++k) pair.X_AB.translation()[k] = 0.7 * random.uniform(-reach[k], reach[k]);
    // Off the line through the centres, so that ends and corners meet as often as middles.
    pair.X_AB.translation() -= direction * direction.dot(pair.X_AB.translation());
  } else {
    const bool side = domain == PoseDomain::side, resting = domain == PoseDomain::resting;
    const bool exact = resting || domain == PoseDomain::aligned;
    const int axis = side ? static_cast<int>(random.below(2)) : 2;
    direction = Eigen::Vector3d::Unit(axis) * (side ? random.sign() : 1);
    pair.X_AB.linear() = exact ? quarter_turns(random) : rotation(yaw(random), tilt(random), tilt(random));
    const Eigen::Vector3d reach = pair.X_AB.linear().cwiseAbs() * b.half;
    for (int k = 0; k < 3; ++k) {
      if (k != axis) pair.X_AB.translation()[k] = offset(k, pair, reach[k], exact, random);
    }
    if (resting) {
      const double size =
          smallest_disturbance * std::pow(largest_disturbance / smallest_disturbance, random.uniform());
      // A box rocks about its long axis more than about the short one: the two tilts may differ by orders.
      const auto small_tilt = [&] { return size * std::pow(1e-4, random.uniform()) * random.normal(); };
      const double turn = random.uniform() < 0.5 ? yaw(random) : size * random.normal();
      pair.X_AB.linear() = rotation(turn, small_tilt(), small_tilt()) * pair.X_AB.linear();
      pair.X_AB.translation() += size * Eigen::Vector3d(random.normal(), random.normal(), 0);
    }
  }
  slide_to_gap(pair, direction, gap);
  if (random.uniform() < 0.5) return pair;
  return {pair.b, pair.a, pair.X_AB.inverse(Eigen::Isometry)};
}

std::vector<BoxPair> sample_pairs(std::size_t count, const std::vector<PoseDomain>& domains, const GapRange& gaps,
                                  std::uint64_t seed) {
  Random random(seed);
  std::vector<BoxPair> pairs;
  pairs.reserve(count);
  const auto lies_below = [](BoxKind kind) { return kind == BoxKind::ground || kind == BoxKind::trailer_deck; };
  while (pairs.size() < count) {
    const auto lower = static_cast<BoxKind>(random.below(kBoxKinds));
    const auto upper = static_cast<BoxKind>(random.below(kBoxKinds));
    if (lies_below(upper)) continue;
    const Box a = sample_box(lower, random), b = sample_box(upper, random);
    pairs.push_back(sample_pair(a, b, domains[pairs.size() % domains.size()], gaps, random));
  }
  return pairs;
}

}  // namespace quayside::contact_nn

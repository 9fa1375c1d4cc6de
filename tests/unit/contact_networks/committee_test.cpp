#include "contact_nn/committee.h"

#include <cmath>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "contact_nn/dataset.h"
#include "contact_nn/exact_module.h"
#include "contact_nn/gate_features.h"
#include "contact_nn/gate_training.h"
#include "contact_nn/separating_axes.h"
#include "tests/unit/contact_networks/heap_counter.h"

namespace quayside::contact_nn {
namespace {

const std::vector<PoseDomain>& all = all_pose_domains();

RelativeVelocity some_velocity(Random& random) {
  return {0.2 * random.direction(), 0.5 * random.direction()};
}

ContactSettings settings_for(Law law, const std::string& network = "") {
  ContactSettings settings;
  settings.law = law;
  settings.network = network;
  return settings;
}

// A gate with random weights, in a file that is gone with it.
class RandomGate {
 public:
  RandomGate(Law law, std::uint64_t seed)
      : path_(testing::TempDir() + "random_gate_" + std::to_string(static_cast<int>(law)) + "_" + std::to_string(seed)) {
    GateTrainingOptions options;
    options.law = law;
    options.seed = seed;
    options.pairs = 100;
    options.epochs = 0;
    write_network(path_, train_gate(options));
  }
  ~RandomGate() { std::filesystem::remove(path_); }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

// Boxes that are no containers: a gate has not seen them, which must cost time, not truth.
std::vector<BoxPair> strange_pairs(std::size_t count, std::uint64_t seed) {
  const Box cube{{0.5, 0.5, 0.5}}, slab{{3, 1.2, 0.05}}, needle{{2, 0.02, 0.03}}, grain{{5e-4, 5e-4, 5e-4}},
      yard{{200, 150, 2}};
  const std::vector<std::pair<Box, Box>> kinds{{cube, cube}, {cube, slab}, {slab, needle}, {needle, needle},
                                               {yard, grain}, {yard, cube}};
  Random random(seed);
  std::vector<BoxPair> pairs;
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [a, b] = kinds[i % kinds.size()];
    pairs.push_back(sample_pair(a, b, all[random.below(all.size())], {0.02, 0.02}, random));
  }
  return pairs;
}

struct Comparison {
  ContactCounters counters;
  std::size_t touching = 0;

  double fallback_share() const {
    return static_cast<double>(counters.fallbacks) / static_cast<double>(counters.queries);
  }
};

bool identical(const ContactForce& x, const ContactForce& y) {
  return x.touching == y.touching && x.f_A == y.f_A && x.t_A == y.t_A && x.impact_point_A == y.impact_point_A &&
         x.normal_force == y.normal_force && x.potential_energy == y.potential_energy &&
         x.dissipated_power == y.dissipated_power;
}

// To the last bit: pieces that are left out are empty in the exact law too, and the others are summed in the same order;
// the axis that stands is the one that the whole separating-axis test finds.
Comparison expect_equal_forces(const ContactSettings& settings, const std::vector<BoxPair>& pairs) {
  const auto committee = make_committee_module(settings), exact = make_exact_module(settings);
  Comparison result;
  ContactCounters ignored;
  Random random(99);
  std::size_t different = 0;
  for (const BoxPair& pair : pairs) {
    const RelativeVelocity V = some_velocity(random);
    const ContactForce x = committee->force(pair.a, pair.b, pair.X_AB, V, result.counters);
    const ContactForce y = exact->force(pair.a, pair.b, pair.X_AB, V, ignored);
    result.touching += y.touching;
    different += !identical(x, y);
  }
  EXPECT_EQ(different, 0u);
  EXPECT_EQ(result.counters.queries, pairs.size());
  return result;
}

void expect_equal_manifolds(const ContactSettings& settings, const std::vector<BoxPair>& pairs, double margin) {
  const auto committee = make_committee_module(settings), exact = make_exact_module(settings);
  ContactCounters counters;
  std::size_t different = 0;
  for (const BoxPair& pair : pairs) {
    const Manifold x = committee->query(pair.a, pair.b, pair.X_AB, counters, margin);
    const Manifold y = exact->query(pair.a, pair.b, pair.X_AB, counters, margin);
    bool same = x.gap == y.gap && x.n_A == y.n_A && x.contact_class == y.contact_class && x.count == y.count;
    for (std::size_t i = 0; same && i < static_cast<std::size_t>(x.count); ++i)
      same = x.points[i].p_A == y.points[i].p_A && x.points[i].depth == y.points[i].depth;
    different += !same;
  }
  EXPECT_EQ(different, 0u);
  EXPECT_EQ(counters.network_evaluations, 0u);  // the geometry query asks no gate
}

TEST(Committee, ForcesAreThoseOfTheExactLaw) {
  const auto pairs = sample_pairs(100000, all, {0.05, 0.01}, 42);
  for (const Law law : {Law::potential, Law::points}) {
    const Comparison result = expect_equal_forces(settings_for(law), pairs);
    EXPECT_GT(result.touching, pairs.size() / 2);
    EXPECT_GT(result.counters.network_evaluations, pairs.size() / 2);
    // Pairs that an axis separates need no network.
    EXPECT_LT(result.counters.network_evaluations, pairs.size() * 9 / 10);
  }
}

TEST(Committee, ForcesBetweenStrangeBoxesAreThoseOfTheExactLaw) {
  const auto pairs = strange_pairs(20000, 1);
  for (const Law law : {Law::potential, Law::points}) {
    const Comparison result = expect_equal_forces(settings_for(law), pairs);
    EXPECT_GT(result.touching, 8000u);
  }
}

TEST(Committee, ManifoldsAreThoseOfTheExactModel) {
  for (const Law law : {Law::potential, Law::points}) {
    expect_equal_manifolds(settings_for(law), sample_pairs(50000, all, {0.05, 0.05}, 43), 0.02);
    expect_equal_manifolds(settings_for(law), strange_pairs(10000, 2), 0);
  }
}

// What the network says decides how long it takes, never what comes out.
TEST(Committee, ARandomGateGivesTheSameAnswersAndFallsBackMoreOften) {
  const auto pairs = sample_pairs(20000, all, {}, 44);
  for (const Law law : {Law::potential, Law::points}) {
    const double trained = expect_equal_forces(settings_for(law), pairs).fallback_share();
    for (const std::uint64_t seed : {1, 2, 3}) {
      const RandomGate gate(law, seed);
      const double random = expect_equal_forces(settings_for(law, gate.path()), pairs).fallback_share();
      EXPECT_GT(random, 20 * trained);
    }
  }
}

// How far from exactly parallel and exactly placed boxes are.
struct Disturbance {
  const char* name;
  double tilt;      // [rad]
  double yaw;       // [rad]
  double offset;    // [m]
  double shallowest, deepest;  // [m]
};

// Landings as an integrator meets them, drawn independently of the generator that training uses.
std::vector<BoxPair> landings(const Box& lower, const Box& upper, const Disturbance& how, Random& random) {
  std::vector<BoxPair> pairs;
  while (pairs.size() < 4000) {
    const auto within = [&](double range) { return random.uniform(-range, range); };
    BoxPair pair{lower, upper, Pose::Identity()};
    pair.X_AB.linear() = (Eigen::AngleAxisd(within(how.yaw), Eigen::Vector3d::UnitZ()) *
                          Eigen::AngleAxisd(within(how.tilt), Eigen::Vector3d::UnitY()) *
                          Eigen::AngleAxisd(within(how.tilt), Eigen::Vector3d::UnitX())).toRotationMatrix();
    if (how.yaw == 0 && how.tilt == 0) pair.X_AB.linear().setIdentity();
    for (int k = 0; k < 2; ++k) pair.X_AB.translation()[k] = within(std::min(how.offset, lower.half[k]));
    double low = 0, high = lower.half[2] + upper.half.norm();
    const double depth = random.uniform(how.shallowest, how.deepest);
    for (int i = 0; i < 60; ++i) {
      pair.X_AB.translation().z() = 0.5 * (low + high);
      (separation(pair.a, pair.b, pair.X_AB) > -depth ? high : low) = pair.X_AB.translation().z();
    }
    pairs.push_back(pair);
  }
  return pairs;
}

// Boxes at rest were the hard part: what is left of their tilts and offsets is rounding, or what a yaw leaves of it, and
// an integrator asks for the same pose many thousand times.
TEST(Committee, FallsBackOnAtMostOneInAHundredLandings) {
  const Box container{{6.096, 1.219, 1.2955}}, spreader{{6.1, 1.22, 0.25}}, ground{{60, 60, 1}}, quay{{100, 75, 1}};
  const double degree = M_PI / 180, any_yaw = M_PI;
  const std::vector<Disturbance> disturbances{
      {"exactly aligned and centred", 0, 0, 0, 1e-4, 0.03},
      {"exactly aligned", 0, 0, 3, 1e-4, 0.03},
      {"locked together", 1e-11, 1e-11, 1e-11, 1e-4, 1e-3},
      {"at rest after a true landing", 1e-8, 1e-8, 0.05, 1e-4, 1e-3},
      {"at rest, skewed", 1e-8, 2 * degree, 0.05, 1e-4, 1e-3},
      {"at rest, any yaw", 1e-6, any_yaw, 3, 1e-4, 1e-3},
      {"landing almost flat", 0.01 * degree, any_yaw, 3, 0, 0.03},
      {"landing", 0.5 * degree, any_yaw, 3, 0, 0.03},
      {"landing hard on a corner", 3 * degree, any_yaw, 3, 0, 0.05},
  };
  Random random(7);
  for (const Law law : {Law::potential, Law::points}) {
    for (const auto& [lower, upper] : {std::pair{container, container}, std::pair{ground, container},
                                       std::pair{quay, container}, std::pair{container, spreader}}) {
      for (const Disturbance& how : disturbances) {
        const Comparison result = expect_equal_forces(settings_for(law), landings(lower, upper, how, random));
        EXPECT_GT(result.touching, 3900u) << how.name;
        EXPECT_LE(result.fallback_share(), 0.01)
            << (law == Law::potential ? "potential, " : "points, ") << how.name << ", half length of the lower box "
            << lower.half[0] << " m, half height of the upper " << upper.half[2] << " m";
      }
    }
  }
}

TEST(Committee, AskedForAForceItDoesNotTouchTheHeap) {
  const auto pairs = sample_pairs(400, all, {0.05, 0.01}, 45);
  const RandomGate gate(Law::potential, 1);  // so that fallbacks are among them
  for (const ContactSettings& settings :
       {settings_for(Law::potential), settings_for(Law::points), settings_for(Law::potential, gate.path())}) {
    const auto committee = make_committee_module(settings);
    ContactCounters counters;
    double sum = 0;
    const std::size_t before = heap_requests();
    for (const BoxPair& pair : pairs) {
      const RelativeVelocity V{Eigen::Vector3d(0.1, 0.2, 0.3), Eigen::Vector3d(0.1, 0, -0.2)};
      sum += committee->force(pair.a, pair.b, pair.X_AB, V, counters).normal_force;
      sum += committee->query(pair.a, pair.b, pair.X_AB, counters, 0.01).gap;
    }
    EXPECT_EQ(heap_requests(), before);
    EXPECT_GT(sum, 0);
  }
}

TEST(Committee, RefusesANetworkThatCannotBeUsed) {
  EXPECT_THROW(make_committee_module(settings_for(Law::potential, "/no/such/file.onnx")), std::runtime_error);
  const RandomGate other(Law::points, 1);  // the gate of the other law
  try {
    make_committee_module(settings_for(Law::potential, other.path()));
    FAIL() << "was accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("made for 'quayside gate_points/1'"), std::string::npos) << error.what();
  }
}

TEST(Committee, IsWhatTheDefaultSettingsMake) {
  ContactCounters counters;
  Pose X = Pose::Identity();
  X.translation().z() = 2.59;
  const Box box{{6.096, 1.219, 1.2955}};
  make_contact_module({})->force(box, box, X, {}, counters);
  EXPECT_EQ(counters.queries, 1u);
  EXPECT_EQ(counters.network_evaluations, 1u);
}

// How the shipped gates were made is told in their files, and they do what is told there.
TEST(Committee, ShippedGatesTellHowTheyWereMade) {
  for (const Law law : {Law::potential, Law::points}) {
    const NetworkFile file = shipped_gate(law);
    for (const char* key : {"seed", "data", "kept", "training", "loss", "fallbacks.landing", "fallbacks.aligned"})
      EXPECT_TRUE(file.how_made.count(key)) << key;
    const double told = std::stod(file.how_made.at("fallbacks.landing"));
    // Fresh pairs; a share of half a percent of 20 000 varies by 0.05 percent.
    EXPECT_NEAR(fallback_share(law, file.network, sample_pairs(20000, {PoseDomain::landing}, {}, 4711)), told, 2e-3);
  }
}

TEST(GateTraining, TheSameSeedGivesTheSameBytes) {
  GateTrainingOptions options;
  options.pairs = 2000;
  options.epochs = 3;
  for (const Law law : {Law::potential, Law::points}) {
    options.law = law;
    options.seed = 1;
    const std::string bytes = network_bytes(train_gate(options));
    EXPECT_EQ(network_bytes(train_gate(options)), bytes);
    options.seed = 2;
    EXPECT_NE(network_bytes(train_gate(options)), bytes);
  }
}

}  // namespace
}  // namespace quayside::contact_nn

#include "contact_nn/learned_potential.h"

#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "contact_nn/learned_potential_training.h"
#include "contact_nn/separating_axes.h"
#include "tests/unit/contact_networks/heap_counter.h"
#include "tests/unit/contact_nn/poses.h"

namespace quayside::contact_nn {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::kContainer;
using test::pose;
using test::rotation;

ContactSettings elastic() {
  ContactSettings s;
  s.model = Model::exact;
  s.law = Law::learned;
  s.friction = 0;
  s.restitution = 1;
  return s;
}

ContactSettings exact_of(ContactSettings s) {
  s.law = Law::potential;
  return s;
}

// Pairs of the domain (reach 1) or of the domain and its seam (1.25).
template <class Function>
void for_landings(double reach, int count, Function f, const learned::Domain& domain = {}) {
  Random random(7);
  for (const LandingPoses poses : {LandingPoses::any, LandingPoses::edge, LandingPoses::resting, LandingPoses::aligned})
    for (int i = 0; i < count; ++i) f(sample_landing(poses, reach, random, domain));
}

const learned::Domain kCraneDomain = learned::domain_named(learned::kCrane);

// Settings with a network for crane poses that has learned little: what must hold for any weights.
ContactSettings with_crane_network(ContactSettings settings) {
  static const std::string path = [] {
    PotentialTrainingOptions options;
    options.domain = learned::kCrane;
    options.pairs = 1000;
    options.steps = 300;
    const std::string file = testing::TempDir() + "potential_crane_test.onnx";
    write_network(file, train_potential(options));
    return file;
  }();
  settings.network = path;
  return settings;
}

ContactForce force_of(const ContactModule& module, const BoxPair& x, const RelativeVelocity& V = {}) {
  ContactCounters counters;
  return module.force(x.a, x.b, x.X_AB, V, counters);
}

// ---- gradient -------------------------------------------------------------------------------------------------

// Central differences of the energy, in double precision. Their error is h²/6 U‴: with h = 3e-4 of the gap, over which the
// depths and so U change, relative 1e-7 times the constants of a seam between two energies that differ; rounding of U (1e-14
// of 1e-5 m depths measured from 100 m: 1e-9 relative) over h: 3e-6. Bound: 1e-4 of the force, and of its moment over the boxes'
// size; ten times longer steps break it in the seam of a network that has learned little, and would not shorten a wrong term.
void expect_gradient(const ContactSettings& settings, const learned::Domain& domain) {
  const auto module = make_learned_module_in_double(settings);
  int seam = 0;
  for_landings(1.25, 300, [&](const BoxPair& x) {
    const double gap = -separation(x.a, x.b, x.X_AB);
    if (gap < 1e-4) return;  // rounding would decide
    const ContactForce f = force_of(*module, x);
    ASSERT_TRUE(f.touching);
    ContactCounters counters;
    module->force(x.a, x.b, x.X_AB, {}, counters);
    seam += counters.fallbacks > 0 && counters.network_evaluations > 0;
    const auto energy = [&](const Pose& X) { return force_of(*module, {x.a, x.b, X}).potential_energy; };
    const double h = 3e-4 * gap, arm = x.a.half.norm() + x.b.half.norm();
    Vector3d force, torque;
    for (int i = 0; i < 3; ++i) {
      const Pose move = pose(h * Vector3d::Unit(i)), back = pose(-h * Vector3d::Unit(i));
      force[i] = (energy(back * x.X_AB) - energy(move * x.X_AB)) / (2 * h);
      const double turn = h / arm;
      const Pose left = pose(Vector3d::Zero(), rotation(turn, Vector3d::Unit(i)));
      torque[i] = (energy(left.inverse() * x.X_AB) - energy(left * x.X_AB)) / (2 * turn);
    }
    EXPECT_LT((f.f_A - force).norm(), 1e-4 * f.f_A.norm());
    EXPECT_LT((f.t_A - torque).norm(), 1e-4 * f.f_A.norm() * arm);
  }, domain);
  EXPECT_GT(seam, 30);
}

TEST(LearnedPotential, ForceAndTorqueAreTheGradientOfTheEnergyAlsoAcrossTheSeam) { expect_gradient(elastic(), {}); }

TEST(LearnedPotential, ForceAndTorqueAreTheGradientInTheDomainOfCranesAsWell) {
  expect_gradient(with_crane_network(elastic()), kCraneDomain);
}

// What is deployed computes the network in single precision: the rest of the way is the same. Rounding is amplified by the
// gradient's cancellations, tens of times 6e-8.
TEST(LearnedPotential, SinglePrecisionIsGoodEnough) {
  const auto single = make_learned_module(elastic()), twice = make_learned_module_in_double(elastic());
  for_landings(1.25, 300, [&](const BoxPair& x) {
    const ContactForce f = force_of(*single, x), g = force_of(*twice, x);
    EXPECT_LT((f.f_A - g.f_A).norm(), 1e-4 * g.f_A.norm());
    EXPECT_NEAR(f.potential_energy / g.potential_energy, 1, 1e-4);
  });
}

// ---- zero, exact, continuous ----------------------------------------------------------------------------------

// No phantom and no missed contact. The gap is moved by ±1e-9 m around zero, more than rounding (1e-13 m).
void expect_zero_when_apart(const ContactSettings& settings, const learned::Domain& domain) {
  const auto module = make_learned_module(settings);
  for_landings(1, 1000, [&](BoxPair x) {
    // Along z of A, the direction it was set down in from either side.
    const double up = x.X_AB.translation().z() < 0 ? -1 : 1;
    double low = 0, high = 1;
    const double from = x.X_AB.translation().z();
    for (int i = 0; i < 80; ++i) {
      const double middle = 0.5 * (low + high);
      x.X_AB.translation().z() = from + up * middle;
      (separation(x.a, x.b, x.X_AB) > 0 ? high : low) = middle;
    }
    for (const double gap : {1e-9, 1e-6, 1e-3, 0.1}) {
      x.X_AB.translation().z() = from + up * (high + gap);
      const ContactForce f = force_of(*module, x);
      EXPECT_FALSE(f.touching);
      EXPECT_EQ(f.f_A, Vector3d::Zero());
      EXPECT_EQ(f.t_A, Vector3d::Zero());
      EXPECT_EQ(f.potential_energy, 0);
    }
    x.X_AB.translation().z() = from + up * (low - 1e-9);
    EXPECT_TRUE(force_of(*module, x).touching);
  }, domain);
}

TEST(LearnedPotential, ZeroWhenApartAndOnlyThen) { expect_zero_when_apart(elastic(), {}); }

TEST(LearnedPotential, ZeroWhenApartAndOnlyThenInTheDomainOfCranesAsWell) {
  expect_zero_when_apart(with_crane_network(elastic()), kCraneDomain);
}

TEST(LearnedPotential, OutsideTheDomainItIsTheExactLawToTheLastBit) {
  ContactSettings settings;
  settings.model = Model::exact;  // the committee would count its gate's evaluations
  settings.law = Law::learned;
  const auto module = make_contact_module(settings), exact = make_contact_module(exact_of(settings));
  RelativeVelocity V;
  V.v_A = {0.01, 0.02, -0.1};
  int compared = 0;
  for (const BoxPair& x : sample_pairs(3000, {PoseDomain::side, PoseDomain::any}, GapRange{}, 3)) {
    ContactCounters counters;
    const ContactForce f = module->force(x.a, x.b, x.X_AB, V, counters), g = force_of(*exact, x, V);
    if (counters.network_evaluations > 0) continue;  // in the domain or its seam
    ++compared;
    EXPECT_EQ(f.f_A, g.f_A);
    EXPECT_EQ(f.t_A, g.t_A);
  }
  EXPECT_GT(compared, 2500);
}

// Through every part of the seam: halving the steps halves the largest change of the force, as it would not if there were a
// jump. (A step in the seam is a few hundredths of it, so the change is nearly linear in the step.)
struct Sweep {
  const char* name;
  std::function<Pose(double)> at;
};

void expect_continuous(const ContactModule& module, const std::vector<Sweep>& sweeps) {
  for (const Sweep& sweep : sweeps) {
    const auto largest_change = [&](int steps) {
      double most = 0;
      Vector3d before = force_of(module, {kContainer, kContainer, sweep.at(0)}).f_A;
      for (int i = 1; i <= steps; ++i) {
        const Vector3d f = force_of(module, {kContainer, kContainer, sweep.at(i / double(steps))}).f_A;
        most = std::max(most, (f - before).norm());
        before = f;
      }
      return most;
    };
    const double coarse = largest_change(1000), fine = largest_change(2000);
    EXPECT_GT(coarse, 0) << sweep.name;
    EXPECT_LT(fine, 0.6 * coarse) << sweep.name;
  }
}

TEST(LearnedPotential, ContinuousAcrossTheSeam) {
  const double d = M_PI / 180, top = 2 * kContainer.half.z();
  expect_continuous(*make_learned_module(elastic()), {
      {"tilt", [&](double t) {
         const Matrix3d R = rotation(0.5 * d + t * 2.5 * d, {1, 0.3, 0});
         return test::at_depth(kContainer, kContainer, pose({0.1, 0.2, 0}, R), Vector3d::UnitZ(), 0.01);
       }},
      {"yaw", [&](double t) { return pose({0.1, 0.2, top - 0.005}, rotation(t * 8 * d, Vector3d::UnitZ())); }},
      {"depth", [&](double t) { return pose({0.1, 0.2, top - 0.06 * t}, rotation(0.1 * d, {1, 2, 3})); }},
      {"lift-off", [&](double t) { return pose({0.1, 0.2, top + 2e-3 * (t - 0.5)}, rotation(1e-4, {1, 2, 3})); }},
      {"overlap", [&](double t) { return pose({11.5 + 0.6 * t, 0.2, top - 0.005}, rotation(0.02 * d, {1, 2, 3})); }},
      {"aligned", [&](double t) { return pose({0.1, 0.2, top - 5e-4}, rotation(1e-3 * (t - 0.5), {0.3, 1, 0.2})); }},
  });
}

// From parallel to crossed, through both seams and the exact law between them; and where a half turn is counted anew.
TEST(LearnedPotential, ContinuousFromParallelToCrossed) {
  const double d = M_PI / 180;
  const auto turned = [&](double from, double to) {
    return [=](double t) {
      const Matrix3d R = rotation(0.3 * d, {1, 0.3, 0}) * rotation((from + t * (to - from)) * d, Vector3d::UnitZ());
      return test::at_depth(kContainer, kContainer, pose({0.1, 0.2, 0}, R), Vector3d::UnitZ(), 0.01);
    };
  };
  expect_continuous(*make_learned_module(with_crane_network(elastic())),
                    {{"9 to 14 degrees", turned(9, 14)}, {"-14 to -9 degrees", turned(-14, -9)},
                     {"38 to 52 degrees", turned(38, 52)}, {"70 to 110 degrees", turned(70, 110)},
                     {"128 to 142 degrees", turned(128, 142)}, {"164 to 195 degrees", turned(164, 195)}});
}

// ---- accuracy -------------------------------------------------------------------------------------------------

// Limits a little above what the shipped network reaches on 20,000 pairs of each kind (`quayside contact potential evaluate`).
TEST(LearnedPotential, ShippedNetworkIsAsGoodAsPublished) {
  const auto module = make_learned_module(elastic());
  const auto errors = [&](LandingPoses poses) {
    Random random(99);
    std::vector<BoxPair> pairs;
    for (int i = 0; i < 5000; ++i) pairs.push_back(sample_landing(poses, 1, random));
    return potential_errors(*module, pairs);
  };
  const PotentialErrors any = errors(LandingPoses::any), aligned = errors(LandingPoses::aligned);
  EXPECT_LT(any.force_median, 0.004);
  EXPECT_LT(any.force_p99, 0.065);
  EXPECT_LT(aligned.force_median, 0.001);
  EXPECT_LT(aligned.force_p99, 0.006);
  EXPECT_EQ(any.covered, 1);
}

// Exactly aligned and centred: no force sideways, no torque, nothing but the flat contact, to the network's error.
TEST(LearnedPotential, AlignedBoxesArePressedStraightApart) {
  const auto module = make_learned_module(elastic()), exact = make_learned_module(elastic());
  for (const double depth : {1e-5, 3e-4, 1e-3, 1e-2}) {
    const BoxPair x{kContainer, kContainer, pose({0, 0, 2 * kContainer.half.z() - depth})};
    const ContactForce f = force_of(*module, x), g = force_of(*make_contact_module(exact_of(elastic())), x);
    EXPECT_NEAR(f.f_A.z() / g.f_A.z(), 1, 0.01) << depth;
    EXPECT_LT(f.f_A.head<2>().norm(), 1e-3 * g.f_A.z()) << depth;
    EXPECT_LT(f.t_A.norm(), 0.1 * g.f_A.z()) << depth;  // a lever of 10 cm on a box of 12 m
  }
}

// ---- batches, motion, files -------------------------------------------------------------------------------------

// The same numbers in another order of sums: rounding of single precision.
void expect_batches_as_single_calls(const ContactSettings& settings, const ContactSettings& elastic,
                                    const learned::Domain& domain) {
  const auto module = make_learned_module(settings), bare = make_learned_module(elastic);
  std::vector<LearnedPair> pairs;
  RelativeVelocity V;
  V.v_A = {0.01, 0.02, -0.1};
  V.w_A = {0.01, 0.03, 0.02};
  for_landings(1.25, 50, [&](const BoxPair& x) { pairs.push_back({x.a, x.b, x.X_AB, V}); }, domain);
  for (const BoxPair& x : sample_pairs(50, all_pose_domains(), GapRange{0.05, 0.05}, 5))
    pairs.push_back({x.a, x.b, x.X_AB, V});
  std::vector<ContactForce> forces(pairs.size());
  ContactCounters batch, single;
  module->forces(pairs.data(), pairs.size(), forces.data(), batch);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const ContactForce f = module->force(pairs[i].a, pairs[i].b, pairs[i].X_AB, V, single);
    EXPECT_EQ(forces[i].touching, f.touching);
    // Damping may have taken away the whole force, but not the torsion that goes with it: the elastic force is the measure.
    const double load = force_of(*bare, {pairs[i].a, pairs[i].b, pairs[i].X_AB}).f_A.norm();
    const double arm = pairs[i].a.half.norm() + pairs[i].b.half.norm();
    EXPECT_LE((forces[i].f_A - f.f_A).norm(), 1e-4 * (load + f.f_A.norm())) << i;
    EXPECT_LE((forces[i].t_A - f.t_A).norm(), 1e-4 * (load + f.f_A.norm()) * arm) << i;
  }
  EXPECT_EQ(batch.queries, single.queries);
  EXPECT_EQ(batch.fallbacks, single.fallbacks);
}

TEST(LearnedPotential, BatchesAnswerAsSingleCalls) {
  ContactSettings settings;
  settings.law = Law::learned;
  expect_batches_as_single_calls(settings, elastic(), {});
  expect_batches_as_single_calls(with_crane_network(settings), with_crane_network(elastic()), kCraneDomain);
}

// The reported dissipation is the power of the whole wrench less that of the elastic one, and never negative.
TEST(LearnedPotential, DampingAndFrictionOnlyTakeEnergy) {
  ContactSettings settings = elastic();
  settings.friction = 0.4;
  settings.restitution = 0.3;
  const auto module = make_learned_module(settings), bare = make_learned_module(elastic());
  Random random(3);
  for_landings(1.25, 300, [&](const BoxPair& x) {
    RelativeVelocity V;
    V.v_A = random.uniform(0, 2) * random.direction();
    V.w_A = random.uniform(0, 0.3) * random.direction();
    const ContactForce f = force_of(*module, x, V), e = force_of(*bare, x);
    const Vector3d force = f.f_A - e.f_A, torque = f.t_A - e.t_A - x.X_AB.translation().cross(force);
    const double taken = -(force.dot(V.v_A) + torque.dot(V.w_A));
    EXPECT_GE(f.dissipated_power, 0);
    EXPECT_GE(f.normal_force, 0);
    EXPECT_NEAR(f.dissipated_power, taken, 1e-9 * (e.f_A.norm() + f.f_A.norm()) * 10);
  });
}

// In the domain, in the seam and outside of it, one by one and in batches.
TEST(LearnedPotential, TheStepPathTakesNothingFromTheHeap) {
  ContactSettings settings;
  settings.law = Law::learned;
  const auto module = make_learned_module(settings);
  std::vector<LearnedPair> pairs;
  for_landings(1.25, 100, [&](const BoxPair& x) { pairs.push_back({x.a, x.b, x.X_AB, {{0.01, 0.03, 0.02}, {0.1, 0, -0.2}}}); });
  for (const BoxPair& x : sample_pairs(100, all_pose_domains(), GapRange{0.05, 0.05}, 5)) pairs.push_back({x.a, x.b, x.X_AB, {}});
  std::vector<ContactForce> forces(pairs.size());
  ContactCounters counters;
  double sum = 0;
  const std::size_t before = heap_requests();
  for (const LearnedPair& x : pairs) sum += module->force(x.a, x.b, x.X_AB, x.V_AB, counters).normal_force;
  module->forces(pairs.data(), pairs.size(), forces.data(), counters);
  EXPECT_EQ(heap_requests(), before);
  EXPECT_GT(sum, 0);
  EXPECT_GT(counters.network_evaluations, 500u);
  EXPECT_GT(counters.fallbacks, 100u);
}

// Where a network may answer is for its file to say.
TEST(LearnedPotential, ANetworkThatDoesNotNameItsDomainIsRefused) {
  NetworkFile file = shipped_potential();
  EXPECT_EQ(learned::domain_of(file).outer_crossed_yaw, 0);
  file.how_made["domain"] = "anywhere: I am brave";
  EXPECT_THROW(learned::domain_of(file), std::runtime_error);
  file.how_made.erase("domain");
  EXPECT_THROW(learned::domain_of(file), std::runtime_error);
}

TEST(LearnedPotential, AnotherInterfaceIsRefused) {
  ContactSettings settings;
  settings.law = Law::learned;
  settings.network = "/no/such/file.onnx";
  EXPECT_THROW(make_contact_module(settings), std::runtime_error);
}

// Training is a function of its options: the same seed, the same bytes.
TEST(LearnedPotential, TrainingIsDeterministicAndLearns) {
  PotentialTrainingOptions options;
  options.pairs = 2000;
  options.steps = 50;
  const std::string once = network_bytes(train_potential(options)), again = network_bytes(train_potential(options));
  EXPECT_EQ(once, again);
  double first = 0, last = 0;
  options.steps = 2001;
  options.progress = [&](long step, double loss) { (step == 0 ? first : last) = loss; };
  train_potential(options);
  const double untrained = 10 * first;  // a running mean that took in a tenth of the first batch's loss
  EXPECT_GT(untrained, 0.5);            // the force is off by its own size
  EXPECT_LT(last, 0.4 * untrained);
}

}  // namespace
}  // namespace quayside::contact_nn

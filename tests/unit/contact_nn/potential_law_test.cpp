#include "contact_nn/potential_law.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "tests/unit/contact_nn/poses.h"

namespace quayside::contact_nn {
namespace {

using namespace test;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kStiffness = 6e8;
const LawParameters kElastic{kStiffness, 0, 0, 1e-3};
const LawParameters kFull{kStiffness, 4, 0.4, 1e-3};
const Box kBoxes[] = {kContainer, kCube, kSlab, kGround, kNeedle};

ContactForce elastic(const Box& a, const Box& b, const Pose& X_AB) {
  return potential_force(a, b, X_AB, {}, kElastic);
}

// Calls f(a, b, X_AB, depth) for random shallow contacts of all pairs of boxes; depth is the penetration.
template <class Function>
void for_random_contacts(unsigned seed, int trials, Function f) {
  Random random(seed);
  for (const Box& a : kBoxes)
    for (const Box& b : kBoxes)
      for (int trial = 0; trial < trials; ++trial) {
        const double thinnest = std::min(a.half.minCoeff(), b.half.minCoeff());
        const double depth = random.log_uniform(1e-3, std::min(0.05, 0.5 * thinnest));
        const Pose turned = pose(Vector3d::Zero(), random.rotation());
        f(a, b, at_depth(a, b, turned, random.direction(), depth), depth);
      }
}

RelativeVelocity random_motion(Random& random, double speed) {
  return {random.uniform(0, speed) * random.direction(), random.uniform(0, speed) * random.direction()};
}

// Power that the contact takes out of the motion: minus the work of the wrench on B, moving relative to A.
double power_taken(const ContactForce& f, const Pose& X_AB, const RelativeVelocity& V) {
  const Vector3d p = X_AB.translation();
  return -(f.f_A.dot(V.v_A) + (f.t_A - p.cross(f.f_A)).dot(V.w_A));
}

struct Gradient {
  Vector3d force, torque;
};

// Central differences of the energy: B moved by ±h, and turned about A's centre by ±h over its distance.
Gradient minus_gradient(const Box& a, const Box& b, const Pose& X_AB, double h) {
  Gradient g;
  const double turn = h / (a.half.norm() + b.half.norm());
  const auto energy = [&](const Pose& X) { return elastic(a, b, X).potential_energy; };
  for (int i = 0; i < 3; ++i) {
    const Pose move = pose(h * Vector3d::Unit(i)), back = pose(-h * Vector3d::Unit(i));
    g.force[i] = (energy(back * X_AB) - energy(move * X_AB)) / (2 * h);
    const Pose left = pose(Vector3d::Zero(), rotation(turn, Vector3d::Unit(i)));
    g.torque[i] = (energy(left.inverse() * X_AB) - energy(left * X_AB)) / (2 * turn);
  }
  return g;
}

// ---- the potential and its gradient ---------------------------------------------------------------------------

// The error of central differences is h²/6 U‴. U grows at least as δ², at most as δ^2.5, and its derivatives scale with
// the depth d of the deepest point: relative error of order (h/d)². Rounding of U, itself good to some 1e-12 (the
// depth of a vertex is good to 1e-14 m of d ≥ 1 mm, times p), gives U 1e-12 / h = F d 1e-12 / h. With h = 1e-4 d both are
// 1e-8; the bound leaves a factor of 50 for the constants and for forces that nearly cancel.
TEST(PotentialLaw, ForceAndTorqueAreTheGradientOfTheEnergy) {
  for_random_contacts(1, 40, [](const Box& a, const Box& b, const Pose& X_AB, double depth) {
    const ContactForce f = elastic(a, b, X_AB);
    ASSERT_TRUE(f.touching);
    const Gradient g = minus_gradient(a, b, X_AB, 1e-4 * depth);
    const double scale = f.f_A.norm(), arm = a.half.norm() + b.half.norm();
    EXPECT_LT((g.force - f.f_A).norm(), 5e-7 * scale);
    EXPECT_LT((g.torque - f.t_A).norm(), 5e-7 * scale * arm);
    EXPECT_EQ(f.dissipated_power, 0);
  });
}

// An exactly aligned pair, and one turned by so little that the cells' borders are nearly parallel. Moving B sideways
// crosses the aligned pose, where U‴ jumps: the error there is of first order in h/d, 1e-4, of the sideways force, which is
// itself δ/L of the normal one.
TEST(PotentialLaw, IsTheGradientInAlignedPoses) {
  for (const double angle : {0.0, 1e-12, 1e-9, 1e-6, 1e-4})
    for (const Vector3d& offset : {Vector3d(0, 0, 0), Vector3d(0.03, 0.02, 0), Vector3d(12.19, 0, 0)}) {
      const Vector3d up(0, 0, 2.591 - 1e-3);
      const Pose X_AB = pose(offset + up, rotation(angle, Vector3d(1, 2, 3)));
      const ContactForce f = elastic(kContainer, kContainer, X_AB);
      const Gradient g = minus_gradient(kContainer, kContainer, X_AB, 1e-7);
      const double scale = f.f_A.norm();
      EXPECT_LT((g.force - f.f_A).norm(), 1e-6 * scale) << angle << " " << offset.transpose();
      EXPECT_LT((g.torque - f.t_A).norm(), 1e-6 * scale * 12) << angle << " " << offset.transpose();
    }
}

// A cube of side s stands δ deep in the ground. Its bottom contributes s² δ^p, its four sides 4 s δ^(p+1)/(p+1), and the
// ground's face inside the cube, where the nearest side may be closer than the bottom, ∫ min(δ, distance to the border)^p
// = δ^p [(s − 2δ)² + 4 δ (s/(p+1) − 2δ/(p+2))]. Depths are good to 1e-15 m of 1e-2.
TEST(PotentialLaw, EnergyOfACubeStandingInTheGround) {
  const double s = 1, K = kStiffness, p = 8;
  for (const double d : {1e-2, 0.1, 0.3}) {
    const double area = s * s + 4 * s * d / (p + 1) + std::pow(s - 2 * d, 2) + 4 * d * (s / (p + 1) - 2 * d / (p + 2));
    const double expected = 0.5 * K * std::pow(0.5 * area * std::pow(d, p) / kReferenceArea, 2 / p);
    const ContactForce f = elastic(kGround, kCube, pose({3, -7, 1 - d}));
    EXPECT_NEAR(f.potential_energy / expected, 1, 1e-11) << d;
    EXPECT_LT((f.impact_point_A.head<2>() - Eigen::Vector2d(3, -7)).norm(), 1e-9);
  }
}

// The settings promise K δ over 29.7 m² and K (A/A_f)^(2/p) δ over another area. At δ = 1 µm the borders, δ wide, hold
// some 1e-6 of the area.
TEST(PotentialLaw, FlatContactHasTheStiffnessOfTheSettings) {
  const double d = 1e-6;
  for (const auto& [x, y] : {std::pair{11.0, 2.7}, {1.0, 1.0}, {0.2, 0.1}}) {
    const Box box{{x / 2, y / 2, 0.5}};
    const ContactForce f = elastic(kGround, box, pose({1, 2, 1 - d}));
    const double K = kStiffness * std::pow(x * y / 29.7, 0.25);
    EXPECT_NEAR(f.f_A.z() / (K * d), 1, 4e-6 * (1 / x + 1 / y)) << x;
    EXPECT_NEAR(f.normal_force / f.f_A.z(), 1, 4e-6 * (1 / x + 1 / y));
  }
}

// Near a corner the overlap of depth δ is the same shape at every δ, so U grows as δ^(2 + 4/p) and F as δ^(1 + 4/p); near a
// straight edge, but for its ends, as δ^(1 + 2/p).
TEST(PotentialLaw, EdgesAndCornersStiffenByTheirPowers) {
  const Matrix3d corner = rotation(0.6, Vector3d(1, 0.8, 0)), edge = rotation(0.7, Vector3d::UnitY());
  const auto force_at = [](const Matrix3d& R, double depth) {
    return elastic(kGround, kContainer, at_depth(kGround, kContainer, pose({0, 0, 0}, R), Vector3d::UnitZ(), depth)).f_A.z();
  };
  EXPECT_NEAR(force_at(corner, 2e-3) / force_at(corner, 1e-3), std::pow(2, 1.5), 1e-9);
  EXPECT_NEAR(force_at(edge, 2e-3) / force_at(edge, 1e-3), std::pow(2, 1.25), 1e-3);  // ends: δ/L = 1e-3
}

// Oracle: ∫φ^p by the midpoint rule on a fine grid over every face, straight from the definition of φ. φ^p has kinks, so
// the error is (grid step/extent of the overlap)², some 1e-3 in I, a quarter of that in U.
double energy_by_grid(const Box& a, const Box& b, const Pose& X_AB) {
  constexpr int kSteps = 500;
  const auto surface_integral = [](const Box& x, const Box& y, const Pose& X_YX) {
    double sum = 0;
    for (int k = 0; k < 3; ++k)
      for (const double side : {-1.0, 1.0}) {
        const int u = (k + 1) % 3, v = (k + 2) % 3;
        for (int i = 0; i < kSteps; ++i)
          for (int j = 0; j < kSteps; ++j) {
            Vector3d p;
            p[k] = side * x.half[k];
            p[u] = x.half[u] * (2 * (i + 0.5) / kSteps - 1);
            p[v] = x.half[v] * (2 * (j + 0.5) / kSteps - 1);
            const double phi = (y.half - (X_YX * p).cwiseAbs()).minCoeff();
            if (phi > 0) sum += std::pow(phi, 8) * 4 * x.half[u] * x.half[v] / (kSteps * kSteps);
          }
      }
    return sum;
  };
  const double I = 0.5 * (surface_integral(a, b, X_AB.inverse()) + surface_integral(b, a, X_AB));
  return 0.5 * kStiffness * std::pow(I / kReferenceArea, 0.25);
}

TEST(PotentialLaw, EnergyAgreesWithABruteForceGrid) {
  Random random(2);
  const Box a{{1, 0.7, 0.5}}, b{{0.4, 0.9, 0.6}};
  for (int trial = 0; trial < 12; ++trial) {
    // Some shallow, some with B deep inside A.
    const Pose X_AB = pose(random.uniform(0.1, 1.1) * random.direction(), random.rotation());
    const double expected = energy_by_grid(a, b, X_AB);
    if (expected == 0) continue;
    EXPECT_NEAR(elastic(a, b, X_AB).potential_energy / expected, 1, 2e-3) << trial;
  }
}

// ---- where it must be zero, and where it must not break ---------------------------------------------------------

TEST(PotentialLaw, IsZeroWhenApart) {
  Random random(3);
  for (const Box& a : kBoxes)
    for (const Box& b : kBoxes)
      for (int trial = 0; trial < 40; ++trial) {
        const double distance = random.log_uniform(1e-9, 1);
        const Pose X_AB = at_depth(a, b, pose({0, 0, 0}, random.rotation()), random.direction(), -distance);
        const ContactForce f = potential_force(a, b, X_AB, random_motion(random, 1), kFull);
        EXPECT_FALSE(f.touching);
        EXPECT_EQ(f.f_A, Vector3d(0, 0, 0));
        EXPECT_EQ(f.t_A, Vector3d(0, 0, 0));
        EXPECT_EQ(f.potential_energy, 0);
        // Without the separating-axis test in front, the pieces alone say the same.
        EXPECT_EQ(potential_force(a, b, X_AB, {}, kFull, all_pieces()).f_A, Vector3d(0, 0, 0));
      }
}

// A face of B in the sheet from which two faces of A are equally far: each point counts once, so the energy is that of the
// neighbouring poses. (Counted twice or not at all, it would be off by 2^(1/4) or be less by as much.)
TEST(PotentialLaw, AFaceInTheSheetBetweenTwoCellsCountsOnce) {
  const Box cube{{1, 1, 1}}, plate{{0.1, 0.2, 0.3}};
  const double quarter = std::acos(-1.0) / 4;
  const Matrix3d tilted[] = {Matrix3d::Identity(), rotation(1e-17, Vector3d::UnitX()), rotation(1e-16, Vector3d(1, 1, 0)),
                             rotation(quarter, Vector3d::UnitZ())};
  for (const Matrix3d& R : tilted)
    for (int k = 0; k < 3; ++k) {
      const Vector3d in_the_sheet = R.col(k) * plate.half[k];
      const double middle = elastic(cube, plate, pose(in_the_sheet, R)).potential_energy;
      const double beside = elastic(cube, plate, pose(in_the_sheet + 1e-7 * R.col(k), R)).potential_energy;
      EXPECT_NEAR(middle / beside, 1, 1e-6) << k;  // 1e-7 of movement, times p · 2/p / 1 m, and as much again
    }
}

TEST(PotentialLaw, OneInsideTheOtherIsFiniteAndPushesOut) {
  const Box big{{5, 5, 5}};
  const ContactForce centred = elastic(big, kCube, pose({0, 0, 0}));
  EXPECT_TRUE(centred.touching);
  EXPECT_LT(centred.f_A.norm(), 1e-9 * kStiffness);  // by symmetry
  const ContactForce near_top = elastic(big, kCube, pose({0, 0, 4}));
  EXPECT_GT(near_top.f_A.z(), 0);
  EXPECT_LT(near_top.f_A.head<2>().norm(), 1e-9 * near_top.f_A.z());
  // The same box at the same place: no surface of one is inside the other, so there is nothing to push.
  const ContactForce same = elastic(kCube, kCube, pose({0, 0, 0}));
  EXPECT_EQ(same.f_A, Vector3d(0, 0, 0));
  EXPECT_TRUE(std::isfinite(same.potential_energy));
}

// U scales as length^(2 + 4/p): I has the dimension length^(p + 2). From a millimetre to a hundred metres, and depths down to
// 1e-12 of the size, nothing overflows or vanishes. Depths are good to ε of the size.
TEST(PotentialLaw, ScalesWithTheSize) {
  const Matrix3d R = rotation(0.6, Vector3d(1, 0.8, 0));
  for (const double relative_depth : {1e-2, 1e-6, 1e-10})
    for (const double scale : {1e-3, 1e2}) {
      const Box unit{{0.5, 0.4, 0.3}}, scaled{scale * unit.half};
      const Pose X = at_depth(unit, unit, pose({0, 0, 0}, R), Vector3d(0.1, 0.2, 1).normalized(), relative_depth);
      const ContactForce small = elastic(unit, unit, X);
      const ContactForce other = elastic(scaled, scaled, pose(scale * X.translation(), R));
      const double accuracy = 50 * 2.2e-16 / relative_depth + 1e-12;
      EXPECT_NEAR(other.potential_energy / (std::pow(scale, 2.5) * small.potential_energy), 1, accuracy);
      EXPECT_LT((other.f_A / std::pow(scale, 1.5) - small.f_A).norm(), accuracy * small.f_A.norm());
    }
}

// ---- continuity -------------------------------------------------------------------------------------------------

struct Sweep {
  const char* name;
  Box a, b;
  std::function<Pose(double)> pose_at;  // of B in A, over [0, 1]
};

std::vector<Sweep> sweeps() {
  const double turn = 2 * std::acos(-1.0);
  const auto held = [](const Box& a, const Box& b, const Matrix3d& R, const Vector3d& from, const Vector3d& direction) {
    return at_depth(a, b, pose(from, R), direction, 5e-3);
  };
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  return {
      {"slide off, aligned", kContainer, kContainer, [](double t) { return pose({13 * t, 0, 2.591 - 5e-3}); }},
      {"slide off, skewed", kContainer, kContainer,
       [=](double t) { return pose({13 * t, 0.5, 2.591 - 5e-3}, rotation(0.03, z)); }},
      {"pitch through flat", kContainer, kContainer,
       [=](double t) { return pose({0.03, 0.02, 2.591 - 5e-3}, rotation(1e-2 * (2 * t - 1), y)); }},
      {"roll through flat, aligned", kContainer, kContainer,
       [=](double t) { return pose({0, 0, 2.591 - 5e-3}, rotation(1e-2 * (2 * t - 1), x)); }},
      {"yaw through aligned", kContainer, kContainer,
       [=](double t) { return pose({0, 0, 2.591 - 5e-3}, rotation(0.2 * (2 * t - 1), z)); }},
      {"tumble on the ground: face, edge, corner, edge, face", kGround, kCube,
       [=](double t) { return held(kGround, kCube, rotation(turn * t, Vector3d(1, 0.3, 0.2)), {1, 2, 0}, z); }},
      {"crossed edges turning parallel", kCube, kCube,
       [=](double t) { return held(kCube, kCube, rotation(0.5 * turn * t, y + z), {0.1, 0, 0}, y + z); }},
      {"corner along an edge and past its end", kContainer, kCube,
       [=](double t) { return pose({8 * t - 0.5, 1.3, 1.9}, rotation(0.6, Vector3d(1, 0.8, 0))); }},
      {"edge to edge past the ends", kContainer, kSlab,
       [=](double t) { return pose({9.0 * (2 * t - 1), 1.2, 1.3}, rotation(0.4, y) * rotation(0.3, x)); }},
  };
}

// Every step of a sweep is halved again and again towards the larger change. At a jump the change stays; where the force is
// continuous it falls with the step. In the end the pose moves by 1e-10 m, of 1e-3 m depth: p times that, 1e-6 of the force.
// Damping and friction are on, and fast enough for the (1 + c s)₊ cut to occur.
TEST(PotentialLaw, IsContinuousThroughEveryClassChange) {
  constexpr int kSteps = 3000, kHalvings = 24;
  RelativeVelocity motion;
  motion.v_A = {0.1, -0.2, -0.15};
  motion.w_A = {0.1, 0.15, -0.1};
  for (const Sweep& sweep : sweeps()) {
    const auto force = [&](double t) { return potential_force(sweep.a, sweep.b, sweep.pose_at(t), motion, kFull); };
    const auto change = [](const ContactForce& f, const ContactForce& g) {
      return (f.f_A - g.f_A).norm() + (f.t_A - g.t_A).norm();  // torques about 1 m
    };
    double largest = 0, jump = 0, at = 0;
    ContactForce last = force(0);
    for (int i = 0; i < kSteps; ++i) {
      double from = double(i) / kSteps, to = double(i + 1) / kSteps;
      ContactForce left = last, right = force(to);
      last = right;
      largest = std::max(largest, last.f_A.norm());
      for (int halving = 0; halving < kHalvings && change(left, right) > 0; ++halving) {
        const double middle = 0.5 * (from + to);
        const ContactForce between = force(middle);
        if (change(left, between) > change(between, right)) {
          to = middle;
          right = between;
        } else {
          from = middle;
          left = between;
        }
      }
      if (change(left, right) > jump) jump = change(left, right), at = from;
    }
    EXPECT_GT(largest, 0) << sweep.name;
    EXPECT_LT(jump, 1e-5 * largest) << sweep.name << " at " << at;
  }
}

// Turning a flat contact by θ changes depths by θ L, so the force by some p θ L/δ of itself; no more, however small θ. This
// is where a rule by axes or points would jump.
TEST(PotentialLaw, NearlyParallelIsNearlyTheSame) {
  const double d = 1e-3;
  for (const Vector3d& offset : {Vector3d(0, 0, 0), Vector3d(0.03, 0.02, 0)}) {
    const ContactForce flat = elastic(kContainer, kContainer, pose(offset + Vector3d(0, 0, 2.591 - d)));
    Random random(4);
    for (const double angle : {1e-12, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6})
      for (int trial = 0; trial < 20; ++trial) {
        const Matrix3d R = rotation(angle, random.direction());
        const ContactForce f = elastic(kContainer, kContainer, pose(offset + Vector3d(0, 0, 2.591 - d), R));
        const double bound = 8 * angle * 6.5 / d + 1e-10;  // rounding: 1e-15 m of 1e-3, times p
        EXPECT_LT((f.f_A - flat.f_A).norm() / flat.f_A.norm(), bound) << angle;
        EXPECT_LT((f.t_A - flat.t_A).norm() / flat.f_A.norm(), bound * 12) << angle;
      }
  }
}

// ---- symmetry, pieces ---------------------------------------------------------------------------------------------

// Asked from the other side the answer is the opposite wrench: −Rᵀf on A, with its torque about B's centre. Rounding only.
TEST(PotentialLaw, SwappingTheBoxesGivesTheOppositeWrench) {
  Random random(5);
  for_random_contacts(6, 20, [&](const Box& a, const Box& b, const Pose& X_AB, double depth) {
    const RelativeVelocity V = random_motion(random, 0.5);
    const Vector3d p = X_AB.translation();
    const Matrix3d R_BA = X_AB.linear().transpose();
    RelativeVelocity back;
    back.w_A = -R_BA * V.w_A;
    back.v_A = -R_BA * (V.v_A - V.w_A.cross(p));
    const ContactForce f = potential_force(a, b, X_AB, V, kFull);
    const ContactForce g = potential_force(b, a, X_AB.inverse(), back, kFull);
    const double accuracy = 1e-13 / depth, arm = a.half.norm() + b.half.norm();
    const double load = elastic(a, b, X_AB).normal_force;
    EXPECT_LT((g.f_A + R_BA * f.f_A).norm(), (accuracy * arm + 1e-12) * load);
    EXPECT_LT((g.t_A + R_BA * (f.t_A - p.cross(f.f_A))).norm(), (accuracy * arm + 1e-12) * arm * load);
    EXPECT_NEAR(g.potential_energy / f.potential_energy, 1, accuracy * arm + 1e-12);
    EXPECT_NEAR(g.dissipated_power, f.dissipated_power, (accuracy * arm + 1e-12) * load * arm);
  });
}

TEST(PotentialLaw, PossiblePiecesHoldEveryPieceThatCarriesLoad) {
  for_random_contacts(7, 40, [](const Box& a, const Box& b, const Pose& X_AB, double) {
    const PieceMask possible = possible_pieces(a, b, X_AB);
    const auto loads = piece_loads(a, b, X_AB);
    PieceMask carrying;
    double sum = 0;
    for (int i = 0; i < kPieceCount; ++i) {
      carrying[i] = loads[i] > 0;
      sum += loads[i];
    }
    EXPECT_NEAR(sum, 1, 1e-12);
    EXPECT_TRUE((carrying & ~possible).none());
    const ContactForce all = elastic(a, b, X_AB), some = potential_force(a, b, X_AB, {}, kElastic, possible);
    EXPECT_EQ(all.f_A, some.f_A);  // the same pieces in the same order: to the last bit
    EXPECT_EQ(all.t_A, some.t_A);
    const ContactForce few = potential_force(a, b, X_AB, {}, kElastic, carrying);
    EXPECT_LT((few.f_A - all.f_A).norm(), 1e-12 * all.f_A.norm());
  });
}

// ---- damping and friction -----------------------------------------------------------------------------------------

// The reported dissipation is what damping and friction take from the motion: the power of the whole wrench less that of the
// elastic one. It is never negative, and the normal force never pulls. Fast motion: every kind of cut occurs.
TEST(PotentialLaw, DissipationIsThePowerTakenAndNeverNegative) {
  Random random(8);
  for_random_contacts(9, 60, [&](const Box& a, const Box& b, const Pose& X_AB, double) {
    const RelativeVelocity V = random_motion(random, random.log_uniform(1e-4, 10));
    const ContactForce whole = potential_force(a, b, X_AB, V, kFull), bare = elastic(a, b, X_AB);
    const double taken = power_taken(whole, X_AB, V) - power_taken(bare, X_AB, V);
    const double speed = V.v_A.norm() + V.w_A.norm() * (a.half.norm() + b.half.norm());
    EXPECT_GE(whole.dissipated_power, 0);
    EXPECT_GE(whole.normal_force, 0);
    EXPECT_NEAR(whole.dissipated_power, taken, 1e-10 * speed * (whole.f_A.norm() + bare.f_A.norm()));
    EXPECT_EQ(whole.potential_energy, bare.potential_energy);
    EXPECT_LT((whole.impact_point_A - bare.impact_point_A).norm(), 1e-12);
  });
}

// Leaving faster than 1/c, the pressure on every surface that moves away is cut to zero. The cube's sides, δ deep, are still
// squeezed, but do not move apart: they cancel.
TEST(PotentialLaw, NothingPullsBack) {
  RelativeVelocity away;
  away.v_A = {0, 0, 1.01 / kFull.damping};
  const LawParameters frictionless{kStiffness, 4, 0, 1e-3};
  const ContactForce f = potential_force(kGround, kCube, pose({0, 0, 0.99}), away, frictionless);
  EXPECT_TRUE(f.touching);
  EXPECT_EQ(f.f_A.z(), 0);
  EXPECT_LT(f.f_A.norm(), 1e-9 * elastic(kGround, kCube, pose({0, 0, 0.99})).f_A.z());
}

// A cube rocking about y on the ground: the damping torque is c ω times the second moment of the pressure, N s²/12 for a
// uniform one. (The borders of the pressure, δ = 1e-5 wide, hold 1e-5 of it.)
TEST(PotentialLaw, RockingIsDamped) {
  RelativeVelocity rocking;
  rocking.w_A = {0, 0.1, 0};
  const Pose X_AB = pose({0, 0, 1 - 1e-5});
  const LawParameters frictionless{kStiffness, 4, 0, 1e-3};
  const ContactForce f = potential_force(kGround, kCube, X_AB, rocking, frictionless);
  EXPECT_NEAR(f.t_A.y() / (-4 * 0.1 * f.normal_force / 12), 1, 1e-4);
  EXPECT_NEAR(f.dissipated_power / (4 * 0.01 * f.normal_force / 12), 1, 1e-4);
}

// Sliding flat at v: μ N v/√(v² + v0²) against it. Turning on the spot at ω: torque μ N r² ω/√(r² ω² + v0²), with the polar
// moment r² = s²/6 of a uniform square. Tolerances for the borders as above.
TEST(PotentialLaw, FrictionOfAFlatContact) {
  const Pose X_AB = pose({0, 0, 1 - 1e-5});
  for (const double v : {1e-4, 1e-3, 1.0}) {
    RelativeVelocity sliding;
    sliding.v_A = {v, 0, 0};
    const ContactForce f = potential_force(kGround, kCube, X_AB, sliding, kFull);
    EXPECT_NEAR(f.f_A.x() / (-0.4 * f.normal_force * v / std::hypot(v, 1e-3)), 1, 1e-4);
    EXPECT_LE(std::abs(f.f_A.x()), 0.4 * f.normal_force * (1 + 1e-4));
    RelativeVelocity spinning;
    spinning.w_A = {0, 0, v};
    const ContactForce g = potential_force(kGround, kCube, X_AB, spinning, kFull);
    const double r2 = 1.0 / 6;
    EXPECT_NEAR(g.t_A.z() / (-0.4 * g.normal_force * r2 * v / std::hypot(std::sqrt(r2) * v, 1e-3)), 1, 1e-4);
  }
}

}  // namespace
}  // namespace quayside::contact_nn

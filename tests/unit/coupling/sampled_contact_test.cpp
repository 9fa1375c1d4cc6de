// Contact forces held between communication points: they do what held forces do by theory, alike in both engines that
// obey our laws, keep momentum, and are part of the saved state.
#include <cmath>

#include <gtest/gtest.h>

#include "harness/build_scene.h"
#include "harness/coupling/sampled_study.h"
#include "harness/engine_unit.h"

namespace quayside::harness {
namespace {

// The container leaves faster than it came by what the recursion of the explicit step gives, and that is exp(π ω h/4) for
// short steps. The law is linear to 0.2 % over this depth; what it gives away of the growth (4 % at 0.5 ms) is a hundredth.
TEST(SampledContact, BouncesGainAsTheTheorySays) {
  const double omega = std::sqrt(6e8 / 30480);
  for (const SampledBounce& bounce : sampled_bounces({1e-4, 5e-4})) {
    EXPECT_NEAR(bounce.theory, std::exp(M_PI / 4 * omega * bounce.step), 2 * std::pow(omega * bounce.step, 2));
    EXPECT_NEAR(bounce.restitution, bounce.theory, 1e-3) << bounce.engine << " " << bounce.step;
  }
}

// A box comes down on another one that floats: whatever is held, both together keep their momentum and their angular
// momentum (without gravity; about the origin), to the tolerance of the integrator.
TEST(SampledContact, HeldForcesKeepMomentum) {
  for (const std::string& engine : kSampledEngines) {
    cases::Case description;
    description.ground = false;
    description.gravity.setZero();
    description.allow_overlap = true;
    description.sampled_contact = true;
    description.solver.relative_tolerance = 1e-9;
    for (const double side : {0.0, 1.0}) {
      cases::BodySpec box;
      box.name = side > 0 ? "upper" : "lower";
      box.mass = 1000 * (1 + side);
      box.size = {2, 2, 1};
      box.position = {0.3 * side, 0.2 * side, 1.001 * side};
      box.velocity = {0.1 * side, 0, -0.5 * side};
      description.bodies.push_back(box);
    }
    const auto unit = make_engine(engine, build_scene(description), contact_settings(description.contact), solver_settings(description));
    unit->enter_initialization_mode(0);
    unit->exit_initialization_mode();
    unit->enter_step_mode();
    const auto value = [&](const std::string& name) {
      for (ValueReference i = 0; i < unit->variables().size(); ++i) {
        if (unit->variables()[i].name == name) return unit->get(i);
      }
      throw std::invalid_argument(name);
    };
    const auto vector = [&](const std::string& name) {
      return Eigen::Vector3d(value(name + ".x"), value(name + ".y"), value(name + ".z"));
    };
    const auto momenta = [&] {
      Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
      for (const cases::BodySpec& box : description.bodies) {
        const Eigen::Vector3d p = box.mass * vector(box.name + ".velocity");
        const Eigen::Quaterniond q(value(box.name + ".orientation.w"), value(box.name + ".orientation.x"),
                                   value(box.name + ".orientation.y"), value(box.name + ".orientation.z"));
        const Eigen::Vector3d squares = box.size.cwiseAbs2();
        const Eigen::Vector3d inertia = box.mass / 12 * (squares.sum() - squares.array()).matrix();
        sum.head<3>() += p;
        sum.tail<3>() += vector(box.name + ".position").cross(p) +
                         q * inertia.cwiseProduct(q.conjugate() * vector(box.name + ".angular_velocity"));
      }
      return sum;
    };
    const auto before = momenta();
    constexpr Time kStep = 200'000;
    for (int i = 0; i < 100; ++i) unit->do_step(i * kStep, kStep);
    EXPECT_GT(value("lower.velocity.z"), -2 * 0.5) << engine;
    EXPECT_LT(value("lower.velocity.z"), -0.1) << engine << ": they have met";
    EXPECT_LT((momenta() - before).norm(), 1e-5 * before.norm()) << engine;
  }
}

TEST(SampledContact, SavedRunsContinueToTheLastBit) {
  for (const std::string& engine : kSampledEngines) {
    cases::Case description;
    description.sampled_contact = true;
    cases::BodySpec box;
    box.name = "box";
    box.mass = 1000;
    box.size = {2, 2, 1};
    box.position = {0, 0, 0.502};
    box.velocity = {0.1, 0, -0.5};
    description.bodies.push_back(box);
    const auto make = [&] {
      return make_engine(engine, build_scene(description), contact_settings(description.contact), solver_settings(description));
    };
    const auto unit = make(), other = make();
    unit->enter_initialization_mode(0);
    unit->exit_initialization_mode();
    unit->enter_step_mode();
    constexpr Time kStep = 500'000;
    for (int i = 0; i < 12; ++i) unit->do_step(i * kStep, kStep);  // in contact
    const UnitState saved = unit->save();
    const auto go_on = [&](EngineUnit& continued) {
      for (int i = 12; i < 40; ++i) continued.do_step(i * kStep, kStep);
      return continued.save();
    };
    const UnitState end = go_on(*unit);
    unit->restore(saved);
    EXPECT_EQ(go_on(*unit), end) << engine;
    other->restore(saved);
    EXPECT_EQ(go_on(*other), end) << engine;
  }
}

}  // namespace
}  // namespace quayside::harness

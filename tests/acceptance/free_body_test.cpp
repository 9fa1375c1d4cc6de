// A body on which nothing acts.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/acceptance/scenes.h"

namespace quayside::harness {
namespace {

const Eigen::Vector3d kSize{3, 2, 1};  // about x, y, z the smallest, the middle, the largest moment of inertia
constexpr double kMass = 1000;
constexpr double kSpin = 2;  // about the middle axis [rad/s]

Simulation spinning(const Eigen::Vector3d& w, double relative_tolerance) {
  crane_models::Scene scene;
  scene.gravity.setZero();
  add_body(scene, free_box("box", kMass, kSize, at(1, 2, 3)));
  scene.bodies[0].v_WB = {0.3, -0.2, 0.1};
  scene.bodies[0].w_WB = w;
  return Simulation(scene, exact_contact(), relative_tolerance);
}

// Angular momentum about the centre of mass, in the world.
Eigen::Vector3d angular_momentum(const Simulation& simulation) {
  const Eigen::Matrix3d R = simulation.quaternion("box.orientation").toRotationMatrix();
  return R * box_inertia(kMass, kSize) * R.transpose() * simulation.vector("box.angular_velocity");
}

// Energy, momentum and angular momentum of a free body stay. 60 s of a box that tumbles about its middle axis, turning
// over several times; at a tolerance of 1e-10 a step errors of some hundred steps a second add up to parts in 1e6.
TEST(FreeBody, KeepsEnergyAndMomentumAboutItsMiddleAxis) {
  Simulation simulation = spinning({0.01, kSpin, 0.01}, 1e-10);
  const Eigen::Vector3d momentum = angular_momentum(simulation);
  const double energy = simulation.engine().energy().kinetic;
  double momentum_error = 0, energy_error = 0, most_turned = 1;
  simulation.run_to(60, 0.1, [&] {
    momentum_error = std::max(momentum_error, (angular_momentum(simulation) - momentum).norm() / momentum.norm());
    energy_error = std::max(energy_error, std::abs(simulation.engine().energy().kinetic / energy - 1));
    const Eigen::Vector3d w_B = simulation.quaternion("box.orientation").conjugate() *
                                simulation.vector("box.angular_velocity");
    most_turned = std::min(most_turned, w_B.y() / kSpin);
  });
  EXPECT_LT(most_turned, -0.9);  // it did turn over
  EXPECT_LT(momentum_error, 1e-6);
  EXPECT_LT(energy_error, 1e-6);
  const Eigen::Vector3d straight_on = Eigen::Vector3d(1, 2, 3) + 60 * Eigen::Vector3d(0.3, -0.2, 0.1);
  EXPECT_LT((simulation.vector("box.position") - straight_on).norm(), 1e-7);
  EXPECT_NEAR(simulation.quaternion("box.orientation").norm(), 1, 1e-12);
}

// A small perturbation of the spin ω about the middle axis grows as exp(λt), λ = ω √[(I₂−I₁)(I₃−I₂)/(I₁I₃)], when it
// starts along the growing eigenvector of Euler's equations I₁ ẇ₁ = (I₂−I₃) ω w₃, I₃ ẇ₃ = (I₁−I₂) ω w₁. From 1e-6 it
// stays linear over e⁶.
TEST(FreeBody, LeavesItsMiddleAxisAtEulersRate) {
  const Eigen::Vector3d I = box_inertia(kMass, kSize).diagonal();
  const double rate = kSpin * std::sqrt((I[1] - I[0]) * (I[2] - I[1]) / (I[0] * I[2]));
  const double w1 = 1e-6, w3 = rate * I[0] / ((I[1] - I[2]) * kSpin) * w1;
  Simulation simulation = spinning({w1, kSpin, w3}, 1e-11);
  simulation.run_to(6 / rate, 0.1);
  const Eigen::Vector3d w_B = simulation.quaternion("box.orientation").conjugate() *
                              simulation.vector("box.angular_velocity");
  // Local errors of 1e-11 grow along: some 1e-3 of the start.
  EXPECT_NEAR(std::log(w_B.x() / w1) / 6, 1, 1e-3);
}

}  // namespace
}  // namespace quayside::harness

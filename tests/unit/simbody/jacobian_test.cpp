// The Jacobian that takes the columns of bodies together which do not feel each other.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "harness/simbody/multibody_model.h"
#include "tests/acceptance/scenes.h"

namespace quayside::harness {
namespace {

// Boxes on one another, 1 mm inside of each other and a little aside and in motion, so that nothing is symmetric.
crane_models::Scene stack(int boxes) {
  crane_models::Scene scene;
  add_body(scene, ground());
  const double height = kContainerSize.z() - 1e-3;
  for (int i = 0; i < boxes; ++i) {
    crane_models::Body box = free_box("box" + std::to_string(i), kContainerMass, kContainerSize,
                                      at(0.02 * i, 0.01 * (i % 2), -1e-3 + kContainerSize.z() / 2 + i * height));
    box.v_WB = {0.01, -0.02, 0.005 * i};
    box.w_WB = {0.001, 0.002, -0.001};
    add_body(scene, box);
  }
  return scene;
}

contact_nn::ContactSettings sticking() {
  contact_nn::ContactSettings contact;
  contact.friction_law = contact_nn::Friction::bristle;
  return contact;
}

struct Result {
  std::vector<double> jacobian;
  std::uint64_t evaluations;
};

// Column by column, with shifts of 1e-8 as the model takes them.
std::vector<double> by_columns(MultibodyModel& model, const std::vector<double>& y, const std::vector<double>& y_dot) {
  std::vector<double> jacobian, shifted = y, rates(y.size());
  for (std::size_t column = 0; column < y.size(); ++column) {
    shifted[column] = y[column] + 1e-8;
    model.derivative(0, shifted.data(), rates.data());
    for (std::size_t row = 0; row < y.size(); ++row) {
      jacobian.push_back((rates[row] - y_dot[row]) / (shifted[column] - y[column]));
    }
    shifted[column] = y[column];
  }
  return jacobian;
}

Result jacobian_of(MultibodyModel& model, const std::vector<double>& y, std::vector<double>& y_dot) {
  model.derivative(0, y.data(), y_dot.data());
  const std::uint64_t before = model.evaluations;
  Result result{std::vector<double>(y.size() * y.size()), 0};
  model.jacobian(0, y.data(), y_dot.data(), result.jacobian.data());
  result.evaluations = model.evaluations - before;
  return result;
}

// With everything that the accelerations are made of: a centre of mass beside the origin, axes that are not principal, a turned
// and tumbling body, contacts. Accelerations of some 100 /s² differ by rounding.
TEST(FreeBodies, HaveTheRatesOfTheTree) {
  crane_models::Scene scene = stack(3);
  for (auto& body : scene.bodies) {
    if (body.is_static()) continue;
    body.p_BBcm = {0.3, -0.1, 0.2};
    body.I_BBcm_B += 0.1 * body.I_BBcm_B(0, 0) * (Eigen::Matrix3d() << 0, 1, -1, 1, 0, 1, -1, 1, 0).finished();
    body.w_WB = {0.5, -0.3, 0.8};
  }
  scene.bodies.back().X_WB.linear() = Eigen::AngleAxisd(0.02, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  MultibodyModel tree(scene, contact_nn::make_contact_module({}));
  MultibodyModel direct(scene, contact_nn::make_contact_module({}), {}, true);
  std::vector<double> y(tree.size()), of_tree(tree.size()), found(tree.size());
  tree.start(0, y.data());
  tree.derivative(0, y.data(), of_tree.data());
  for (int look = 0; look < 2; ++look) {  // the first one places what does not move
    direct.derivative(0, y.data(), found.data());
    for (int i = 0; i < tree.size(); ++i) EXPECT_NEAR(found[i], of_tree[i], 1e-9) << i;
  }
  EXPECT_NEAR(direct.kinetic_energy(), tree.kinetic_energy(), 1e-12 * tree.kinetic_energy());
}

// A shift of a body that is not felt leaves its neighbours' rates as they are to the last bit, but for Simbody's sums over
// all bodies: rounding of accelerations of 100 m/s² and of (rad/s²) over a shift of 1e-8 is 1e-6 of the entries.
void expect_columns_one_by_one(const contact_nn::ContactSettings& contact) {
  const crane_models::Scene scene = stack(5);
  MultibodyModel model(scene, contact_nn::make_contact_module(contact), contact_nn::bristle_friction(contact));
  std::vector<double> y(model.size()), y_dot(model.size());
  model.start(0, y.data());
  for (int i = 0; i < model.size(); ++i) {
    if (model.quantities()[i] == MultibodyModel::Quantity::deflection) y[i] = 1e-5 * (i % 7);
  }
  const Result grouped = jacobian_of(model, y, y_dot);
  const std::vector<double> single = by_columns(model, y, y_dot);
  double largest = 0;
  for (const double entry : single) largest = std::max(largest, std::abs(entry));
  EXPECT_GT(largest, 1e3);  // contacts are in it: k/m = 2e4 /s²
  for (std::size_t i = 0; i < single.size(); ++i) ASSERT_NEAR(grouped.jacobian[i], single[i], 1e-6 * largest) << i;
}

TEST(Jacobian, IsThatOfColumnsTakenOneByOne) { expect_columns_one_by_one({}); }

TEST(Jacobian, IsThatOfColumnsTakenOneByOneWhereFrictionSticks) { expect_columns_one_by_one(sticking()); }

// A body of a stack feels two others: three colours of 13 coordinates each, and where they are shifted from, however high
// the stack.
TEST(Jacobian, CostsTheSameForEveryHeight) {
  for (const int boxes : {3, 5, 9}) {
    const crane_models::Scene scene = stack(boxes);
    MultibodyModel model(scene, contact_nn::make_contact_module({}));
    std::vector<double> y(model.size()), y_dot(model.size());
    model.start(0, y.data());
    EXPECT_EQ(jacobian_of(model, y, y_dot).evaluations, 40u) << boxes;
  }
}

// The bristle of a pair feels its two bodies, and so does their other bristle: two colours of four more.
TEST(Jacobian, CostsTheSameForEveryHeightWhereFrictionSticks) {
  for (const int boxes : {3, 5, 9}) {
    const crane_models::Scene scene = stack(boxes);
    MultibodyModel model(scene, contact_nn::make_contact_module(sticking()), contact_nn::bristle_friction(sticking()));
    std::vector<double> y(model.size()), y_dot(model.size());
    model.start(0, y.data());
    EXPECT_EQ(jacobian_of(model, y, y_dot).evaluations, 48u) << boxes;
  }
}

// Nothing touches: all bodies at once.
TEST(Jacobian, TakesBodiesThatAreApartTogether) {
  crane_models::Scene scene = stack(0);
  for (int i = 0; i < 4; ++i) add_body(scene, free_box("box" + std::to_string(i), 1000, {1, 1, 1}, at(5 * i, 0, 10)));
  MultibodyModel model(scene, contact_nn::make_contact_module({}));
  std::vector<double> y(model.size()), y_dot(model.size());
  model.start(0, y.data());
  EXPECT_EQ(jacobian_of(model, y, y_dot).evaluations, 14u);
}

}  // namespace
}  // namespace quayside::harness

#include "contact_nn/paper/optimisers.h"

#include <cmath>

#include <gtest/gtest.h>

#include "contact_nn/random.h"

namespace quayside::contact_nn::paper {
namespace {

// A smooth function that a small network can follow: (sin 2x + y, x y).
Samples lesson(int count, std::uint64_t seed) {
  Random random(seed);
  Samples samples;
  samples.inputs.resize(2, count);
  samples.targets.resize(2, count);
  for (int i = 0; i < count; ++i) {
    const float x = static_cast<float>(random.uniform(-1, 1)), y = static_cast<float>(random.uniform(-1, 1));
    samples.inputs.col(i) << x, y;
    samples.targets.col(i) << std::sin(2 * x) + y, x * y;
  }
  return samples;
}

Recipe short_recipe(Method method) {
  Recipe recipe = recipe_for(method);
  recipe.hidden = {8, 7};
  recipe.epochs = method == Method::levenberg_marquardt ? 30 : 600;
  if (method == Method::momentum) recipe.adaptation = 0.03;
  return recipe;
}

double mean_square(const Network& network, const Samples& samples) {
  return (network(samples.inputs.cast<double>()) - samples.targets.cast<double>()).array().square().mean();
}

constexpr Method all_methods[] = {Method::momentum, Method::adam, Method::levenberg_marquardt};

// The targets' mean square is (½ + ⅓ + ⅑ …)/2 ≈ 0.5; a method that works comes far below a hundredth of it on new data.
TEST(Optimisers, EveryMethodLearns) {
  const Samples training = lesson(400, 1), validation = lesson(100, 2), fresh = lesson(500, 3);
  for (const Method method : all_methods) {
    const Trained trained = train(training, validation, short_recipe(method));
    EXPECT_LT(mean_square(trained.network, fresh), 2e-3) << name_of(method);
  }
  Recipe absolute = short_recipe(Method::adam);
  absolute.cost = Cost::absolute;
  EXPECT_LT(mean_square(train(training, validation, absolute).network, fresh), 2e-3);
}

TEST(Optimisers, TheSameSeedGivesTheSameNetwork) {
  const Samples training = lesson(100, 1), validation = lesson(50, 2);
  for (const Method method : all_methods) {
    Recipe recipe = short_recipe(method);
    recipe.epochs = 5;
    const Network first = train(training, validation, recipe).network,
                  second = train(training, validation, recipe).network;
    recipe.seed = 2;
    const Network other = train(training, validation, recipe).network;
    for (std::size_t i = 0; i < first.layers.size(); ++i) {
      EXPECT_EQ(first.layers[i].weights, second.layers[i].weights) << name_of(method);
      EXPECT_NE(first.layers[i].weights, other.layers[i].weights) << name_of(method);
    }
  }
}

// Without momentum, one step over all patterns is −η times the mean gradient; with it, the second step repeats m times
// the first. Both are read off the bias of a network whose hidden units say nothing, because its weights are all but
// zero: the bias b of the output then follows b' = b − η (b − t) exactly, to the amplitude of the weights.
TEST(Optimisers, MomentumRepeatsAShareOfTheLastStep) {
  Samples samples;
  samples.inputs = Eigen::MatrixXf::Random(1, 10);
  samples.targets = Eigen::MatrixXf::Constant(1, 10, 2.0f);
  const auto bias_after = [&](int epochs, double momentum) {
    Recipe recipe;
    recipe.hidden = {1, 1};
    recipe.amplitude = 1e-6;
    recipe.adaptation = 0.1;
    recipe.momentum = momentum;
    recipe.batch = 10;
    recipe.epochs = epochs;
    return train(samples, samples, recipe).network.layers.back().bias[0];
  };
  EXPECT_NEAR(bias_after(1, 0.5), 0.2, 1e-5);
  EXPECT_NEAR(bias_after(2, 0.0), 0.2 + 0.1 * 1.8, 1e-5);
  EXPECT_NEAR(bias_after(2, 0.5), 0.2 + 0.1 * 1.8 + 0.5 * 0.2, 1e-5);
}

// Validation targets that contradict the training set get worse from the start: training must stop after `patience`
// epochs and give back an early network.
TEST(Optimisers, StopsEarlyAndGivesBackTheBest) {
  const Samples training = lesson(200, 1);
  Samples contrary = lesson(100, 2);
  contrary.targets *= -1;
  Recipe recipe = short_recipe(Method::momentum);
  recipe.patience = 4;
  const Trained trained = train(training, contrary, recipe);
  EXPECT_LT(trained.best_epoch, 5);
  EXPECT_EQ(trained.epochs, trained.best_epoch + 4);
}

TEST(Optimisers, StopsWhenAsked) {
  Recipe recipe = short_recipe(Method::adam);
  int asked = 0;
  recipe.stopped = [&] { return ++asked == 3; };
  const Trained trained = train(lesson(50, 1), lesson(50, 2), recipe);
  EXPECT_TRUE(trained.stopped);
  EXPECT_EQ(trained.epochs, 3);
}

// A step far too long must end in an early stop, not in a network of infinities.
TEST(Optimisers, DivergenceLeavesAFiniteNetwork) {
  Recipe recipe = short_recipe(Method::momentum);
  recipe.adaptation = 1e6;
  const Trained trained = train(lesson(100, 1), lesson(50, 2), recipe);
  for (const auto& layer : trained.network.layers) EXPECT_TRUE(layer.weights.allFinite());
}

TEST(Optimisers, RefusesWhatCannotWork) {
  const Samples good = lesson(20, 1);
  const auto refused = [&](const Samples& training, auto change) {
    Recipe recipe;
    change(recipe);
    EXPECT_THROW(train(training, good, recipe), std::invalid_argument);
  };
  refused(Samples{}, [](Recipe&) {});
  Samples broken = good;
  broken.inputs(0, 0) = NAN;
  refused(broken, [](Recipe&) {});
  refused(good, [](Recipe& r) { r.hidden = {5, 0}; });
  refused(good, [](Recipe& r) { r.momentum = 1; });
  refused(good, [](Recipe& r) { r.adaptation = 0; });
  refused(good, [](Recipe& r) { r.batch = 0; });
  refused(good, [](Recipe& r) { r.method = Method::levenberg_marquardt, r.cost = Cost::absolute; });
}

}  // namespace
}  // namespace quayside::contact_nn::paper

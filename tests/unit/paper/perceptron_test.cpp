#include "contact_nn/paper/perceptron.h"

#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

#include "contact_nn/random.h"
#include "contact_nn/training.h"

namespace quayside::contact_nn::paper {
namespace {

// Sizes below, at and above the width of a vector, with and without padding.
const std::vector<std::vector<int>> architectures{{6, 20, 18, 4}, {3, 15, 2}, {5, 16, 31, 7, 1}};
constexpr int samples = 37;

struct Example {
  explicit Example(const std::vector<int>& sizes) : shape(sizes), weights(shape.size(), 0.0f) {
    Random random(1);
    for (std::size_t place : shape.places()) weights[place] = static_cast<float>(random.uniform(-0.5, 0.5));
    std::srand(1);  // Eigen's random matrices
    inputs = Eigen::MatrixXf::Random(sizes.front(), samples);
    targets = Eigen::MatrixXf::Random(sizes.back(), samples);
    network = network_of(shape, weights, Eigen::VectorXd::Zero(sizes.front()), Eigen::VectorXd::Ones(sizes.front()));
  }
  Shape shape;
  Floats weights;
  Eigen::MatrixXf inputs, targets;
  Network network;
};

// In the order of `Shape::places`: columns of the weights, then the bias, layer by layer.
std::vector<double> listed(const Network& network) {
  std::vector<double> list;
  for (const auto& layer : network.layers) {
    for (double w : layer.weights.reshaped()) list.push_back(w);
    for (double b : layer.bias) list.push_back(b);
  }
  return list;
}

// Against the general backpropagation in double precision. A sum of some hundred products in single precision, each of
// order 1, errs by about 100 · 6e-8.
constexpr double single = 1e-5;

TEST(Perceptron, CostAndGradientAreThoseOfDoublePrecision) {
  for (const auto& sizes : architectures) {
    Example x(sizes);
    Perceptron perceptron(x.shape);
    Floats gradient(x.shape.size(), 1.0f);
    const double cost =
        perceptron.cost(x.weights, Columns(x.inputs), Columns(x.targets), 0, samples, Cost::square, gradient);
    Network expected;
    const double loss =
        mean_loss(x.network, x.inputs.cast<double>(), x.targets.cast<double>(), Loss::mean_square, 1, expected);
    EXPECT_NEAR(cost / samples, loss, single);
    const auto list = listed(expected);
    const auto places = x.shape.places();
    ASSERT_EQ(list.size(), places.size());
    ASSERT_EQ(list.size(), static_cast<std::size_t>(x.shape.weights()));
    double padding = 0;
    for (float g : gradient) padding += std::abs(static_cast<double>(g));
    for (std::size_t i = 0; i < places.size(); ++i) {
      EXPECT_NEAR(static_cast<double>(gradient[places[i]]) / samples, list[i], single);
      padding -= std::abs(static_cast<double>(gradient[places[i]]));
    }
    EXPECT_NEAR(padding, 0, 1e-9) << "padding must never learn";
  }
}

TEST(Perceptron, ABlockCountsItsOwnSamplesOnly) {
  Example x(architectures[0]);
  Perceptron perceptron(x.shape);
  const Columns inputs(x.inputs), targets(x.targets);
  const auto cost = [&](Eigen::Index begin, Eigen::Index count) {
    return perceptron.cost(x.weights, inputs, targets, begin, count, Cost::square);
  };
  EXPECT_NEAR(cost(0, 10) + cost(10, samples - 10), cost(0, samples), samples * single);
}

// √(e² + c²) − c by hand in double precision; its gradient by central differences with h = 1e-4 of that: they err by
// h² f‴/6, with f‴ up to 1/c² = 400 for errors near zero.
TEST(Perceptron, TheAbsoluteCostIsSmoothedAndItsGradientFits) {
  Example x(architectures[1]);
  const auto cost_of = [&](const Network& network) {
    const Eigen::ArrayXXd e = network(x.inputs.cast<double>()) - x.targets.cast<double>();
    return ((e.square() + 0.05 * 0.05).sqrt() - 0.05).sum();
  };
  Perceptron perceptron(x.shape);
  Floats gradient(x.shape.size());
  EXPECT_NEAR(perceptron.cost(x.weights, Columns(x.inputs), Columns(x.targets), 0, samples, Cost::absolute, gradient),
              cost_of(x.network), samples * single);
  const auto places = x.shape.places();
  std::size_t place = 0;
  for (auto& layer : x.network.layers) {
    const auto check = [&](auto&& parameters) {
      for (Eigen::Index k = 0; k < parameters.size(); ++k) {
        double& w = parameters.reshaped()[k];
        const double middle = w, h = 1e-4;
        w = middle + h;
        const double above = cost_of(x.network);
        w = middle - h;
        const double below = cost_of(x.network);
        w = middle;
        EXPECT_NEAR(static_cast<double>(gradient[places[place++]]), (above - below) / (2 * h), samples * single);
      }
    };
    check(layer.weights);
    check(layer.bias);
  }
}

// Jᵀe is the gradient of ½ Σ e².
TEST(Perceptron, TheJacobianGivesTheGradient) {
  Example x(architectures[0]);
  Perceptron perceptron(x.shape);
  const Columns inputs(x.inputs), targets(x.targets);
  Floats gradient(x.shape.size());
  perceptron.cost(x.weights, inputs, targets, 0, samples, Cost::square, gradient);
  Eigen::MatrixXf rows, errors;
  perceptron.jacobian(x.weights, inputs, targets, 0, samples, rows, errors);
  ASSERT_EQ(rows.rows(), 4 * samples);
  ASSERT_EQ(rows.cols(), 594);  // 6·20 + 20 + 20·18 + 18 + 18·4 + 4
  const Eigen::MatrixXf by_output = errors.transpose();
  const Eigen::VectorXf product = rows.transpose() * by_output.reshaped();
  const auto places = x.shape.places();
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_NEAR(product[static_cast<Eigen::Index>(i)], gradient[places[i]], samples * single);
  }
}

TEST(Perceptron, StandardisedInputsAreFoldedIntoTheFirstLayer) {
  Example x({2, 5, 1});
  const Eigen::Vector2d mean(3, -1), deviation(0.5, 4);
  const Network folded = network_of(x.shape, x.weights, mean, deviation);
  const Eigen::Vector2d raw(2.2, 5);
  EXPECT_NEAR(folded(raw)(0, 0), x.network((raw - mean).cwiseQuotient(deviation))(0, 0), 1e-14);
}

}  // namespace
}  // namespace quayside::contact_nn::paper

#include "contact_nn/training.h"

#include <gtest/gtest.h>

#include "contact_nn/random.h"
#include "contact_nn/soap.h"

namespace quayside::contact_nn {
namespace {

// A target for one loss: any numbers, yes or no, one of many.
Eigen::MatrixXd targets_for(Loss loss, int outputs, int samples) {
  Eigen::MatrixXd targets = Eigen::MatrixXd::Random(outputs, samples);
  if (loss == Loss::binary_cross_entropy) targets = (targets.array() > 0).cast<double>();
  if (loss == Loss::softmax_cross_entropy || loss == Loss::top_three_cross_entropy) {
    for (int i = 0; i < samples; ++i) targets.col(i) = Eigen::VectorXd::Unit(outputs, i % outputs);
  }
  return targets;
}

// Backpropagation against central differences: with step h = 1e-5 they err by h² f‴/6 and ε/h, both near 1e-10, so
// 1e-7 of a gradient of order 1 leaves room for curvature and still sees any wrong term.
TEST(Training, GradientIsTheDerivativeOfTheLoss) {
  std::srand(1);  // Eigen's random matrices
  for (const Loss loss : {Loss::mean_square, Loss::binary_cross_entropy, Loss::softmax_cross_entropy,
                          Loss::top_three_cross_entropy}) {
    for (const Activation activation : {Activation::tanh, Activation::relu}) {
      Network network = random_network({4, 7, 5, 6}, activation, 3);
      const Eigen::MatrixXd inputs = Eigen::MatrixXd::Random(4, 12), targets = targets_for(loss, 6, 12);
      const double weight = loss == Loss::binary_cross_entropy ? 5 : 1, h = 1e-5;
      Network gradient;
      const double value = mean_loss(network, inputs, targets, loss, weight, gradient);
      EXPECT_NEAR(value, mean_loss(network, inputs, targets, loss, weight), 1e-14);
      for (std::size_t i = 0; i < network.layers.size(); ++i) {
        const auto check = [&](auto& parameters, const auto& derivative) {
          for (Eigen::Index k = 0; k < parameters.size(); ++k) {
            double& x = parameters.reshaped()[k];
            const double middle = x;
            x = middle + h;
            const double above = mean_loss(network, inputs, targets, loss, weight);
            x = middle - h;
            const double below = mean_loss(network, inputs, targets, loss, weight);
            x = middle;
            EXPECT_NEAR(derivative.reshaped()[k], (above - below) / (2 * h), 1e-7);
          }
        };
        check(network.layers[i].weights, gradient.layers[i].weights);
        check(network.layers[i].bias, gradient.layers[i].bias);
      }
    }
  }
}

// Losses with a known value: ½ y² for one output y against 0; log 2 for a logit of 0; log n for n equal logits, of which the first
// three's loss leaves out two.
TEST(Training, LossesHaveTheirKnownValues) {
  Network zero;
  zero.layers.push_back({Eigen::MatrixXd::Zero(4, 1), Eigen::VectorXd::Zero(4), Activation::identity});
  const Eigen::MatrixXd input = Eigen::MatrixXd::Ones(1, 1), yes = Eigen::VectorXd::Unit(4, 2);
  EXPECT_NEAR(mean_loss(zero, input, yes, Loss::mean_square), 0.5, 1e-15);
  EXPECT_NEAR(mean_loss(zero, input, yes, Loss::binary_cross_entropy), 4 * std::log(2.0), 1e-15);
  EXPECT_NEAR(mean_loss(zero, input, yes, Loss::binary_cross_entropy, 10), 13 * std::log(2.0), 1e-14);
  EXPECT_NEAR(mean_loss(zero, input, yes, Loss::softmax_cross_entropy), std::log(4.0), 1e-15);
  EXPECT_NEAR(mean_loss(zero, input, yes, Loss::top_three_cross_entropy), std::log(2.0), 1e-15);

  zero.layers[0].bias << 800, -800, 0, 0;  // neither loss may overflow
  EXPECT_NEAR(mean_loss(zero, input, yes, Loss::softmax_cross_entropy), 800, 1e-9);
  EXPECT_NEAR(mean_loss(zero, input, yes, Loss::binary_cross_entropy), 800 + 2 * std::log(2.0), 1e-9);
}

// What the loss is for: a right answer that is third, far behind two others, costs nothing; a fourth one costs its distance
// to the third.
TEST(Training, OnlyTheFirstThreeCountInTheLossOfTheFirstThree) {
  Network network;
  network.layers.push_back({Eigen::MatrixXd::Zero(5, 1), Eigen::VectorXd::Zero(5), Activation::identity});
  const Eigen::MatrixXd input = Eigen::MatrixXd::Ones(1, 1), yes = Eigen::VectorXd::Unit(5, 2);
  network.layers[0].bias << 500, 300, 100, 0, 0;
  EXPECT_NEAR(mean_loss(network, input, yes, Loss::top_three_cross_entropy), 0, 1e-12);
  network.layers[0].bias << 500, 300, 100, 150, 0;
  EXPECT_NEAR(mean_loss(network, input, yes, Loss::top_three_cross_entropy), 50, 1e-12);
}

// A linear layer on strongly correlated inputs: the squares' Hessian has the eigenvalues 1 + (n − 1) c and 1 − c, here some
// 1e4 apart, along directions that mix all inputs. A method that scales single weights crawls along the flat ones (Adam is
// wrong by 0.03 after as many steps); one that finds the directions does not: at most 1e-3 over twelve seeds and three vector
// widths, whose rounding decides how far exactly.
TEST(Training, TheOptimiserFindsTheAxesOfCorrelatedInputs) {
  constexpr int kInputs = 12, kSamples = 200;
  Random random(4);
  Eigen::MatrixXf inputs(kInputs, kSamples), weights = Eigen::MatrixXf::Zero(3, kInputs), wanted(3, kInputs);
  for (float& w : wanted.reshaped()) w = static_cast<float>(random.normal());
  for (int i = 0; i < kSamples; ++i) {
    const double common = random.normal();
    for (int j = 0; j < kInputs; ++j) inputs(j, i) = static_cast<float>(common + 0.03 * random.normal());
  }
  Eigen::VectorXf bias = Eigen::VectorXf::Zero(3);
  const Eigen::MatrixXf targets = (wanted * inputs).colwise() + Eigen::Vector3f(1, -2, 0.5);
  Soap soap(3, kInputs);
  constexpr int kSteps = 2000;
  for (int step = 0; step < kSteps; ++step) {
    const Eigen::MatrixXf error = ((weights * inputs - targets).colwise() + bias) / kSamples;
    soap.step(weights, bias, error * inputs.transpose(), error.rowwise().sum(), 0.05 * (1 - step / double(kSteps)));
  }
  EXPECT_LT((weights - wanted).cwiseAbs().maxCoeff(), 3e-3);
  EXPECT_LT((bias - Eigen::Vector3f(1, -2, 0.5)).cwiseAbs().maxCoeff(), 3e-3);
}

Samples sine_samples(int count, std::uint64_t seed) {
  Random random(seed);
  Samples samples{Eigen::MatrixXf(2, count), Eigen::MatrixXf(1, count)};
  for (int i = 0; i < count; ++i) {
    // An input far from zero and one in thousandths: scaling is the trainer's business.
    const double x = random.uniform(-2, 2), y = random.uniform(-2, 2);
    samples.inputs.col(i) << static_cast<float>(100 + x), static_cast<float>(1e-3 * y);
    samples.targets(0, i) = static_cast<float>(std::sin(x) * y);
  }
  return samples;
}

TrainingOptions quick() {
  TrainingOptions options;
  options.hidden = {16, 16};
  options.activation = Activation::tanh;
  options.epochs = 60;
  options.batch = 50;
  options.learning_rate = 1e-2;
  options.seed = 5;
  return options;
}

// sin(x) y has variance about 0.8 on this square. A net that learned it leaves a thousandth of that; one whose scaling
// is not folded back, or whose gradient is wrong, leaves most of it.
TEST(Training, LearnsAFunctionFromRawInputs) {
  const Samples training = sine_samples(2000, 1), validation = sine_samples(500, 2), test = sine_samples(500, 3);
  const TrainingResult result = train(training, validation, quick());
  const Eigen::MatrixXd errors = result.network(test.inputs.cast<double>()) - test.targets.cast<double>();
  EXPECT_LT(errors.squaredNorm() / 500, 1e-3);
  EXPECT_NEAR(mean_loss(result.network, validation.inputs.cast<double>(), validation.targets.cast<double>(),
                        Loss::mean_square),
              result.validation_loss, 1e-4);  // single precision, inputs near 100
}

TEST(Training, TheSameSeedGivesTheSameWeightsAndAnotherOneOthers) {
  const Samples training = sine_samples(300, 1), validation = sine_samples(100, 2);
  TrainingOptions options = quick();
  options.epochs = 5;
  const Network a = train(training, validation, options).network, b = train(training, validation, options).network;
  options.seed = 6;
  const Network c = train(training, validation, options).network;
  for (std::size_t i = 0; i < a.layers.size(); ++i) {
    EXPECT_EQ(a.layers[i].weights, b.layers[i].weights);
    EXPECT_EQ(a.layers[i].bias, b.layers[i].bias);
    EXPECT_NE(a.layers[i].weights, c.layers[i].weights);
  }
}

// Targets of pure noise cannot be learned, only memorised: the validation loss turns, and training must stop and hand
// back the best epoch, not the last.
TEST(Training, StopsWhenTheValidationLossTurns) {
  Samples training = sine_samples(60, 1), validation = sine_samples(60, 2);
  Random random(1);
  for (float& t : training.targets.reshaped()) t = static_cast<float>(random.normal());
  for (float& t : validation.targets.reshaped()) t = static_cast<float>(random.normal());
  TrainingOptions options = quick();
  options.epochs = 1000;
  options.patience = 10;
  std::vector<double> losses;
  options.progress = [&](int, double, double loss) { losses.push_back(loss); };
  const TrainingResult result = train(training, validation, options);
  EXPECT_LT(result.epochs, 1000);
  EXPECT_EQ(result.epochs, result.best_epoch + 10);
  ASSERT_EQ(static_cast<int>(losses.size()), result.epochs);
  EXPECT_EQ(*std::min_element(losses.begin(), losses.end()), result.validation_loss);
  EXPECT_EQ(losses[static_cast<std::size_t>(result.best_epoch - 1)], result.validation_loss);
}

TEST(Training, RefusesWhatCannotBeTrained) {
  const Samples good = sine_samples(10, 1), none;
  EXPECT_THROW(train(none, good, quick()), std::invalid_argument);
  EXPECT_THROW(train(good, none, quick()), std::invalid_argument);
  Samples odd = good;
  odd.targets.conservativeResize(1, 9);
  EXPECT_THROW(train(odd, good, quick()), std::invalid_argument);
  odd = good;
  odd.inputs(0, 0) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(train(odd, good, quick()), std::invalid_argument);
  TrainingOptions bad = quick();
  bad.hidden = {0};
  EXPECT_THROW(train(good, good, bad), std::invalid_argument);
  bad = quick();
  bad.batch = 0;
  EXPECT_THROW(train(good, good, bad), std::invalid_argument);
}

}  // namespace
}  // namespace quayside::contact_nn

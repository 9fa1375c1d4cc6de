#include "contact_nn/paper/optimisers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include <Eigen/Cholesky>

#ifdef __SSE__
#include <xmmintrin.h>
#endif

#include "contact_nn/random.h"

namespace quayside::contact_nn::paper {

namespace {

using Map = Eigen::Map<Eigen::ArrayXf, Eigen::AlignedMax>;
Map array(Floats& x) { return Map(x.data(), static_cast<Eigen::Index>(x.size())); }

constexpr Eigen::Index validation_block = 256;  // samples at a time: their values stay in the nearest cache

// Weights that nothing needs fade away to numbers so small that processors take a hundred times longer over them: they
// become zero while this lives.
class NoSubnormals {
#ifdef __SSE__
 public:
  NoSubnormals() { _mm_setcsr(before_ | flush_results | flush_operands); }
  ~NoSubnormals() { _mm_setcsr(before_); }

 private:
  static constexpr unsigned flush_results = 0x8000, flush_operands = 0x0040;
  unsigned before_ = _mm_getcsr();
#endif
};

void require(bool holds, const char* message) {
  if (!holds) throw std::invalid_argument(message);
}

void check(const Samples& training, const Samples& validation, const Recipe& recipe) {
  for (const Samples* samples : {&training, &validation}) {
    require(samples->size() > 0, "training needs patterns to learn from and to validate on");
    require(samples->targets.cols() == samples->size(), "every pattern needs an input and a target");
    require(samples->inputs.allFinite() && samples->targets.allFinite(), "inputs and targets must be finite");
  }
  require(training.inputs.rows() == validation.inputs.rows() && training.targets.rows() == validation.targets.rows(),
          "training and validation patterns must have the same sizes");
  require(!recipe.hidden.empty() && *std::min_element(recipe.hidden.begin(), recipe.hidden.end()) > 0,
          "every hidden layer needs at least one unit");
  require(recipe.adaptation > 0, "the adaptation constant must be positive");
  require(recipe.momentum >= 0 && recipe.momentum < 1, "the momentum constant must be in [0, 1)");
  require(recipe.amplitude > 0, "the amplitude of the initial weights must be positive");
  require(recipe.batch > 0 && recipe.epochs > 0 && recipe.patience > 0, "batch, epochs and patience must be positive");
  require(recipe.method != Method::levenberg_marquardt || recipe.cost == Cost::square,
          "Levenberg-Marquardt minimises squares: take another method for the absolute error");
}

// Training in progress: the data in standard form, the weights, and the best of them so far.
class Session {
 public:
  Session(const Samples& training, const Samples& validation, const Recipe& recipe)
      : recipe_(recipe), shape_(sizes(training, recipe)), perceptron_(shape_), random_(recipe.seed) {
    const Eigen::MatrixXd raw = training.inputs.cast<double>();
    mean_ = raw.rowwise().mean();
    deviation_ = ((raw.colwise() - mean_).rowwise().squaredNorm() / static_cast<double>(raw.cols())).cwiseSqrt();
    constexpr double constant_input = 1e-6;  // an input that does not vary carries nothing: left unscaled
    deviation_ = (deviation_.array() > constant_input).select(deviation_.array(), 1.0);
    inputs_ = standardised(training.inputs);
    targets_ = Columns(training.targets);
    validation_inputs_ = standardised(validation.inputs);
    validation_targets_ = Columns(validation.targets);
    weights_.assign(shape_.size(), 0.0f);
    for (std::size_t place : shape_.places()) {
      weights_[place] = static_cast<float>(random_.uniform(-recipe.amplitude, recipe.amplitude));
    }
    best_ = weights_;
  }

  // `epoch()` changes the weights by one pass over the data; false when it can get no further.
  template <class Epoch>
  Trained run(Epoch epoch) {
    Trained result;
    double lowest = std::numeric_limits<double>::infinity();
    for (int k = 1; k <= recipe_.epochs; ++k) {
      const bool going_on = epoch(k);
      const double error = validation_cost();
      result.epochs = k;
      if (error < lowest) {
        lowest = error;
        best_ = weights_;
        result.best_epoch = k;
      }
      if (!going_on || k - result.best_epoch >= recipe_.patience || !std::isfinite(error)) break;
      if (recipe_.stopped && recipe_.stopped()) {
        result.stopped = true;
        break;
      }
    }
    result.network = network_of(shape_, best_, mean_, deviation_);
    return result;
  }

  // One pass in random order, `step(gradient of the mean cost)` after every batch.
  template <class Step>
  void pass(Step step) {
    if (order_.empty()) {
      order_.resize(static_cast<std::size_t>(inputs_.count));
      std::iota(order_.begin(), order_.end(), 0);
      batch_inputs_ = Columns(inputs_.size, recipe_.batch);
      batch_targets_ = Columns(targets_.size, recipe_.batch);
      gradient_.assign(shape_.size(), 0.0f);
    }
    for (std::size_t i = order_.size(); i > 1; --i) std::swap(order_[i - 1], order_[random_.below(i)]);
    for (Eigen::Index begin = 0; begin < inputs_.count; begin += recipe_.batch) {
      const Eigen::Index n = std::min<Eigen::Index>(recipe_.batch, inputs_.count - begin);
      for (Eigen::Index i = 0; i < n; ++i) {
        const Eigen::Index from = order_[static_cast<std::size_t>(begin + i)];
        std::copy_n(inputs_[from], inputs_.stride, batch_inputs_[i]);
        std::copy_n(targets_[from], targets_.stride, batch_targets_[i]);
      }
      perceptron_.cost(weights_, batch_inputs_, batch_targets_, 0, n, recipe_.cost, gradient_);
      step(array(gradient_), 1.0f / static_cast<float>(n));
    }
  }

  double training_cost(const Floats& weights) { return mean_cost(weights, inputs_, targets_, Cost::square); }
  const Shape& shape() const { return shape_; }
  Floats& weights() { return weights_; }

  // JᵀJ and Jᵀe of the mean over all patterns.
  void normal_equations(Eigen::MatrixXd& squares, Eigen::VectorXd& slope) {
    constexpr Eigen::Index block = 64;  // patterns at a time
    const int size = shape_.weights();
    squares_.setZero(size, size);
    slope.setZero(size);
    for (Eigen::Index begin = 0; begin < inputs_.count; begin += block) {
      const Eigen::Index n = std::min(block, inputs_.count - begin);
      perceptron_.jacobian(weights_, inputs_, targets_, begin, n, rows_, errors_);
      squares_.selfadjointView<Eigen::Lower>().rankUpdate(rows_.transpose());
      const Eigen::MatrixXf by_output = errors_.transpose();
      slope +=
          (rows_.transpose() * Eigen::Map<const Eigen::VectorXf>(by_output.data(), by_output.size())).cast<double>();
    }
    const double n = static_cast<double>(inputs_.count);
    squares = squares_.cast<double>() / n;
    slope /= n;
  }

 private:
  static std::vector<int> sizes(const Samples& training, const Recipe& recipe) {
    std::vector<int> sizes{static_cast<int>(training.inputs.rows())};
    sizes.insert(sizes.end(), recipe.hidden.begin(), recipe.hidden.end());
    sizes.push_back(static_cast<int>(training.targets.rows()));
    return sizes;
  }

  Columns standardised(const Eigen::MatrixXf& inputs) const {
    const Eigen::MatrixXd centred = inputs.cast<double>().colwise() - mean_;
    return Columns(Eigen::MatrixXf((deviation_.cwiseInverse().asDiagonal() * centred).cast<float>()));
  }

  double mean_cost(const Floats& weights, const Columns& inputs, const Columns& targets, Cost cost) {
    double sum = 0;
    for (Eigen::Index begin = 0; begin < inputs.count; begin += validation_block) {
      sum += perceptron_.cost(weights, inputs, targets, begin, std::min(validation_block, inputs.count - begin), cost);
    }
    return sum / static_cast<double>(inputs.count);
  }

  double validation_cost() { return mean_cost(weights_, validation_inputs_, validation_targets_, recipe_.cost); }

  const Recipe& recipe_;
  Shape shape_;
  Perceptron perceptron_;
  Random random_;
  Eigen::VectorXd mean_, deviation_;
  Columns inputs_, targets_, validation_inputs_, validation_targets_;
  Columns batch_inputs_, batch_targets_;
  std::vector<Eigen::Index> order_;
  Floats weights_, best_, gradient_;
  Eigen::MatrixXf squares_, rows_, errors_;
};

Trained train_with_momentum(Session& session, const Recipe& recipe) {
  Floats change(session.shape().size(), 0.0f);
  const float m = static_cast<float>(recipe.momentum), rate = static_cast<float>(recipe.adaptation);
  return session.run([&](int) {
    session.pass([&](const Map& gradient, float scale) {
      array(change) = m * array(change) - (rate * scale) * gradient;
      array(session.weights()) += array(change);
    });
    return true;
  });
}

Trained train_with_adam(Session& session, const Recipe& recipe) {
  constexpr double beta1 = 0.9, beta2 = 0.999;  // the authors'
  constexpr float epsilon = 1e-8f;
  Floats mean(session.shape().size(), 0.0f), square = mean;
  long steps = 0;
  return session.run([&](int epoch) {
    const double progress = (epoch - 1.0) / recipe.epochs;
    const double rate = recipe.adaptation * (0.01 + 0.99 * 0.5 * (1 + std::cos(M_PI * progress)));
    session.pass([&](const Map& gradient, float scale) {
      ++steps;
      const float step =
          static_cast<float>(rate * std::sqrt(1 - std::pow(beta2, steps)) / (1 - std::pow(beta1, steps)));
      array(mean) = float(beta1) * array(mean) + float(1 - beta1) * scale * gradient;
      array(square) = float(beta2) * array(square) + float(1 - beta2) * (scale * gradient).square();
      array(session.weights()) -= step * array(mean) / (array(square).sqrt() + epsilon);
    });
    return true;
  });
}

// Gauss-Newton steps (JᵀJ + μ I)⁻¹ Jᵀe; μ falls tenfold after a step that lowers the error and grows tenfold until one
// does. When none does, the method is done.
Trained train_with_levenberg_marquardt(Session& session) {
  constexpr double smallest = 1e-10, largest = 1e10;  // of μ; the network's outputs and weights are of order 1
  double damping = 1e-2;
  double error = session.training_cost(session.weights());
  const auto places = session.shape().places();
  Eigen::MatrixXd squares;
  Eigen::VectorXd slope;
  Floats candidate;
  return session.run([&](int) {
    session.normal_equations(squares, slope);
    for (; damping <= largest; damping *= 10) {
      Eigen::MatrixXd damped = squares;
      damped.diagonal().array() += damping;
      const Eigen::VectorXd step = damped.selfadjointView<Eigen::Lower>().llt().solve(slope);
      candidate = session.weights();
      for (std::size_t i = 0; i < places.size(); ++i)
        candidate[places[i]] -= static_cast<float>(step[static_cast<Eigen::Index>(i)]);
      const double reached = session.training_cost(candidate);
      if (reached < error) {  // false for a step that is no number
        session.weights() = candidate;
        error = reached;
        damping = std::max(smallest, damping / 10);
        return true;
      }
    }
    return false;
  });
}

}  // namespace

const char* name_of(Method method) {
  switch (method) {
    case Method::momentum: return "momentum";
    case Method::adam: return "adam";
    case Method::levenberg_marquardt: return "lm";
  }
  return "?";
}

Recipe recipe_for(Method method) {
  Recipe recipe;
  recipe.method = method;
  if (method == Method::adam) {
    recipe.adaptation = 0.003;
    recipe.batch = 32;
    recipe.epochs = 1000;
  }
  if (method == Method::levenberg_marquardt) {
    recipe.epochs = 60;
    recipe.patience = 15;
  }
  return recipe;
}

Trained train(const Samples& training, const Samples& validation, const Recipe& recipe) {
  check(training, validation, recipe);
  const NoSubnormals guard;
  Session session(training, validation, recipe);
  switch (recipe.method) {
    case Method::momentum: return train_with_momentum(session, recipe);
    case Method::adam: return train_with_adam(session, recipe);
    case Method::levenberg_marquardt: return train_with_levenberg_marquardt(session);
  }
  throw std::invalid_argument("unknown method");
}

}  // namespace quayside::contact_nn::paper

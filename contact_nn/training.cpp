#include "contact_nn/training.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "contact_nn/random.h"
#include "contact_nn/soap.h"

namespace quayside::contact_nn {

namespace {

template <class Scalar>
using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
template <class Scalar>
using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

template <class Scalar>
struct Parameters {
  std::vector<Matrix<Scalar>> weights;
  std::vector<Vector<Scalar>> biases;
  std::vector<Activation> activations;
};

template <class Scalar>
Parameters<Scalar> parameters_of(const Network& network) {
  Parameters<Scalar> p;
  for (const Layer& layer : network.layers) {
    p.weights.push_back(layer.weights.cast<Scalar>());
    p.biases.push_back(layer.bias.cast<Scalar>());
    p.activations.push_back(layer.activation);
  }
  return p;
}

template <class Scalar>
Network network_of(const Parameters<Scalar>& p) {
  Network network;
  for (std::size_t i = 0; i < p.weights.size(); ++i) {
    network.layers.push_back(
        {p.weights[i].template cast<double>(), p.biases[i].template cast<double>(), p.activations[i]});
  }
  return network;
}

// Makes the two largest of the wrong answers' logits so small that they do not count.
template <class Target, class Scalar>
void leave_out_two(const Target& target, Vector<Scalar>& logits) {
  constexpr Scalar none = std::numeric_limits<Scalar>::lowest();
  for (int k = 0; k < 2; ++k) {
    Eigen::Index largest;
    (target.array() > 0).select(none, logits.array()).maxCoeff(&largest);
    if (target[largest] == 0) logits[largest] = none;
  }
}

// Sum of the losses of all samples; `error` becomes its derivative with respect to the outputs.
template <class Scalar>
double loss_of(Loss loss, Scalar positive_weight, const Matrix<Scalar>& y, const Matrix<Scalar>& t,
               Matrix<Scalar>& error) {
  switch (loss) {
    case Loss::mean_square: {
      error = y - t;
      return 0.5 * static_cast<double>(error.squaredNorm());
    }
    case Loss::binary_cross_entropy: {
      // w t log(1 + e^−y) + (1 − t) log(1 + e^y), with log(1 + e^y) = max(y, 0) + log(1 + e^−|y|)
      const auto weight = (t.array() * (positive_weight - 1) + 1).eval();  // w where t = 1, 1 where t = 0
      const auto tail = (-y.array().abs()).exp().eval();
      const auto sigmoid = (y.array() >= 0).select(1 / (1 + tail), tail / (1 + tail)).eval();
      error = (weight * sigmoid - positive_weight * t.array()).matrix();
      const auto losses = weight * (tail + 1).log() + (1 - t.array()) * y.array().max(Scalar(0)) -
                          positive_weight * t.array() * y.array().min(Scalar(0));
      return static_cast<double>(losses.sum());
    }
    case Loss::softmax_cross_entropy:
    case Loss::top_three_cross_entropy: {
      double sum = 0;
      error.resizeLike(y);
      Vector<Scalar> left;  // the logits that count
      for (Eigen::Index i = 0; i < y.cols(); ++i) {
        left = y.col(i);
        if (loss == Loss::top_three_cross_entropy) leave_out_two(t.col(i), left);
        const Scalar largest = left.maxCoeff();
        const auto powers = (left.array() - largest).exp().eval();
        const Scalar total = powers.sum();
        error.col(i) = (powers / total).matrix() - t.col(i);
        sum += static_cast<double>(largest + std::log(total) - y.col(i).dot(t.col(i)));
      }
      return sum;
    }
  }
  throw std::invalid_argument("unknown loss");
}

// Backpropagation, one column per sample. Holds every intermediate value, so that no step allocates.
template <class Scalar>
class Backpropagation {
 public:
  // Sum of the losses; `gradient` becomes its derivative.
  double operator()(const Parameters<Scalar>& p, const Matrix<Scalar>& inputs, const Matrix<Scalar>& targets, Loss loss,
                    Scalar positive_weight, Parameters<Scalar>& gradient) {
    const double sum = forward(p, inputs, targets, loss, positive_weight);
    const std::size_t count = p.weights.size();
    for (std::size_t i = count; i-- > 0;) {
      through_activation(p.activations[i], values_[i + 1], error_);
      gradient.weights[i].noalias() = error_ * values_[i].transpose();
      gradient.biases[i].noalias() = error_.rowwise().sum();
      if (i > 0) {
        next_error_.noalias() = p.weights[i].transpose() * error_;
        error_.swap(next_error_);
      }
    }
    return sum;
  }

  double forward(const Parameters<Scalar>& p, const Matrix<Scalar>& inputs, const Matrix<Scalar>& targets, Loss loss,
                 Scalar positive_weight) {
    const std::size_t count = p.weights.size();
    values_.resize(count + 1);
    values_[0] = inputs;
    for (std::size_t i = 0; i < count; ++i) {
      Matrix<Scalar>& y = values_[i + 1];
      y.noalias() = p.weights[i] * values_[i];
      y.colwise() += p.biases[i];
      if (p.activations[i] == Activation::tanh) y = y.array().tanh();
      if (p.activations[i] == Activation::relu) y = y.array().max(Scalar(0));
    }
    return loss_of(loss, positive_weight, values_[count], targets, error_);
  }

 private:
  static void through_activation(Activation activation, const Matrix<Scalar>& y, Matrix<Scalar>& error) {
    if (activation == Activation::tanh) error.array() *= 1 - y.array().square();
    if (activation == Activation::relu) error.array() *= (y.array() > 0).template cast<Scalar>();
  }

  std::vector<Matrix<Scalar>> values_;
  Matrix<Scalar> error_, next_error_;
};

void shuffle(std::vector<Eigen::Index>& order, Random& random) {
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
}

void require(bool holds, const char* message) {
  if (!holds) throw std::invalid_argument(message);
}

void check(const Samples& training, const Samples& validation, const TrainingOptions& options) {
  require(training.size() > 0 && validation.size() > 0, "training needs samples to learn from and to validate on");
  for (const Samples* samples : {&training, &validation}) {
    require(samples->inputs.cols() == samples->targets.cols(), "every sample needs an input and a target");
    require(samples->inputs.allFinite() && samples->targets.allFinite(), "inputs and targets must be finite");
  }
  require(training.inputs.rows() == validation.inputs.rows() && training.targets.rows() == validation.targets.rows(),
          "training and validation samples must have the same sizes");
  require(options.batch > 0 && options.epochs > 0 && options.patience > 0, "batch, epochs and patience must be positive");
  require(options.learning_rate > 0 && options.positive_weight > 0, "learning rate and weight must be positive");
  for (int size : options.hidden) require(size > 0, "a hidden layer needs at least one unit");
}

}  // namespace

Network random_network(const std::vector<int>& sizes, Activation hidden, std::uint64_t seed) {
  Random random(seed);
  Network network;
  for (std::size_t i = 0; i + 1 < sizes.size(); ++i) {
    const double fan_in = sizes[i], fan_out = sizes[i + 1];
    const double deviation = std::sqrt(hidden == Activation::relu ? 2 / fan_in : 2 / (fan_in + fan_out));
    Layer layer;
    layer.weights.resize(sizes[i + 1], sizes[i]);
    for (double& w : layer.weights.reshaped()) w = deviation * random.normal();
    layer.bias = Eigen::VectorXd::Zero(sizes[i + 1]);
    layer.activation = i + 2 < sizes.size() ? hidden : Activation::identity;
    network.layers.push_back(std::move(layer));
  }
  return network;
}

double mean_loss(const Network& network, const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& targets, Loss loss,
                 double positive_weight) {
  Backpropagation<double> backpropagation;
  return backpropagation.forward(parameters_of<double>(network), inputs, targets, loss, positive_weight) /
         static_cast<double>(inputs.cols());
}

double mean_loss(const Network& network, const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& targets, Loss loss,
                 double positive_weight, Network& gradient) {
  Backpropagation<double> backpropagation;
  Parameters<double> parameters = parameters_of<double>(network);
  Parameters<double> derivative = parameters;
  const double n = static_cast<double>(inputs.cols());
  const double sum = backpropagation(parameters, inputs, targets, loss, positive_weight, derivative);
  gradient = network_of(derivative);
  for (Layer& layer : gradient.layers) {
    layer.weights /= n;
    layer.bias /= n;
  }
  return sum / n;
}

// Inputs are shifted and scaled to mean 0 and deviation 1 over the training set, which is then folded into the first
// layer: W ((x − m)/s) + b = (W/s) x + (b − (W/s) m).
TrainingResult train(const Samples& training, const Samples& validation, const TrainingOptions& options) {
  check(training, validation, options);
  const Eigen::VectorXd mean = training.inputs.cast<double>().rowwise().mean();
  const Eigen::VectorXd variance =
      (training.inputs.cast<double>().colwise() - mean).rowwise().squaredNorm() / static_cast<double>(training.size());
  const double constant_input = 1e-12;  // variance below which an input carries nothing: left unscaled
  const Eigen::VectorXd scale = (variance.array() > constant_input).select(1 / variance.array().sqrt(), 1.0);
  const Eigen::VectorXf mean_f = mean.cast<float>(), scale_f = scale.cast<float>();
  const auto scaled = [&](const auto& inputs) {
    return Eigen::MatrixXf(scale_f.asDiagonal() * (inputs.colwise() - mean_f));
  };

  std::vector<int> sizes{static_cast<int>(training.inputs.rows())};
  sizes.insert(sizes.end(), options.hidden.begin(), options.hidden.end());
  sizes.push_back(static_cast<int>(training.targets.rows()));
  Parameters<float> p = parameters_of<float>(random_network(sizes, options.activation, options.seed));
  Parameters<float> best = p, gradient = p;
  std::vector<Soap> optimisers;
  for (const Eigen::MatrixXf& weights : p.weights) optimisers.emplace_back(weights.rows(), weights.cols());
  Backpropagation<float> backpropagation;
  Random random(options.seed + 1);
  std::vector<Eigen::Index> order(static_cast<std::size_t>(training.size()));
  std::iota(order.begin(), order.end(), 0);

  const float weight = static_cast<float>(options.positive_weight);
  const Eigen::MatrixXf all_inputs = scaled(training.inputs), validation_inputs = scaled(validation.inputs);
  Eigen::MatrixXf inputs, targets;
  TrainingResult result;
  result.validation_loss = std::numeric_limits<double>::infinity();
  for (int epoch = 1; epoch <= options.epochs; ++epoch) {
    const double progress = (epoch - 1.0) / options.epochs;
    const double rate = options.learning_rate * (0.01 + 0.99 * 0.5 * (1 + std::cos(M_PI * progress)));
    shuffle(order, random);
    double training_loss = 0;
    for (Eigen::Index begin = 0; begin < training.size(); begin += options.batch) {
      const Eigen::Index n = std::min<Eigen::Index>(options.batch, training.size() - begin);
      inputs.resize(all_inputs.rows(), n);
      targets.resize(training.targets.rows(), n);
      for (Eigen::Index i = 0; i < n; ++i) {
        inputs.col(i) = all_inputs.col(order[static_cast<std::size_t>(begin + i)]);
        targets.col(i) = training.targets.col(order[static_cast<std::size_t>(begin + i)]);
      }
      training_loss += backpropagation(p, inputs, targets, options.loss, weight, gradient);
      for (std::size_t k = 0; k < optimisers.size(); ++k) {
        gradient.weights[k] /= static_cast<float>(n);
        gradient.biases[k] /= static_cast<float>(n);
        optimisers[k].step(p.weights[k], p.biases[k], gradient.weights[k], gradient.biases[k], rate);
      }
    }
    training_loss /= static_cast<double>(training.size());

    double validation_loss = 0;
    for (Eigen::Index begin = 0; begin < validation.size(); begin += options.batch) {
      const Eigen::Index n = std::min<Eigen::Index>(options.batch, validation.size() - begin);
      inputs = validation_inputs.middleCols(begin, n);
      targets = validation.targets.middleCols(begin, n);
      validation_loss += backpropagation.forward(p, inputs, targets, options.loss, weight);
    }
    validation_loss /= static_cast<double>(validation.size());

    result.epochs = epoch;
    if (options.progress) options.progress(epoch, training_loss, validation_loss);
    if (validation_loss < result.validation_loss) {
      best = p;
      result.best_epoch = epoch;
      result.training_loss = training_loss;
      result.validation_loss = validation_loss;
    } else if (epoch - result.best_epoch >= options.patience) {
      break;
    }
  }

  result.network = network_of(best);
  Layer& first = result.network.layers.front();
  first.weights = first.weights * scale.asDiagonal();
  first.bias -= first.weights * mean;
  for (Layer& layer : result.network.layers) {  // single precision, as trained and as stored
    layer.weights = layer.weights.cast<float>().cast<double>();
    layer.bias = layer.bias.cast<float>().cast<double>();
  }
  return result;
}

}  // namespace quayside::contact_nn

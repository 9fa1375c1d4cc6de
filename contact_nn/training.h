// Training of networks: minibatches, SOAP (soap.h), early stopping. Deterministic: the same data, options and seed give the
// same network to the last bit (on one machine and build; the order of sums depends on the vector width).
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "contact_nn/mlp.h"

namespace quayside::contact_nn {

// One column per sample.
struct Samples {
  Eigen::MatrixXf inputs;
  Eigen::MatrixXf targets;

  Eigen::Index size() const { return inputs.cols(); }
};

enum class Loss {
  mean_square,            // ½ Σ (y − t)²
  binary_cross_entropy,   // independent yes/no outputs; y is the logit, t is 0 or 1
  softmax_cross_entropy,  // one of many; y are the logits, t sums to 1
  top_three_cross_entropy,  // the same, with the two largest logits of wrong answers left out: zero when the right one
                            // is clearly among the first three. (Lapin, Hein and Schiele, "Loss functions for top-k
                            // error", 2016: truncated top-k entropy)
};

struct TrainingOptions {
  std::vector<int> hidden = {32, 32};
  Activation activation = Activation::relu;
  Loss loss = Loss::mean_square;
  double positive_weight = 1;   // binary_cross_entropy: what missing a "yes" costs, against a false "yes"
  int batch = 256;              // samples per step
  int epochs = 100;             // at most
  int patience = 15;            // epochs without a better validation loss before training stops
  double learning_rate = 3e-3;  // of the first epoch; falls to a hundredth along a cosine
  std::uint64_t seed = 1;       // of initial weights and shuffling

  // Called after every epoch: epoch, training loss, validation loss.
  std::function<void(int, double, double)> progress;
};

struct TrainingResult {
  Network network;             // of the best epoch; takes raw inputs, since their scaling is folded into it
  int best_epoch = 0;
  int epochs = 0;              // run
  double training_loss = 0;    // mean per sample, at the best epoch (while it was learning)
  double validation_loss = 0;  // mean per sample, at the best epoch
};

// Throws std::invalid_argument for empty or inconsistent samples or options out of range.
TrainingResult train(const Samples& training, const Samples& validation, const TrainingOptions& options);

// Weights after Glorot and Bengio (2010) for tanh, He et al. (2015) for relu.
Network random_network(const std::vector<int>& sizes, Activation hidden, std::uint64_t seed);

// Mean loss over the samples (columns).
double mean_loss(const Network& network, const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& targets, Loss loss,
                 double positive_weight = 1);

// The same, and its gradient with respect to every weight and bias, in a network of the same shape.
double mean_loss(const Network& network, const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& targets, Loss loss,
                 double positive_weight, Network& gradient);

}  // namespace quayside::contact_nn

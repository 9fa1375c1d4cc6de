// Training of the paper's networks: backpropagation with momentum, as the paper did it, and two methods of later
// standing. Each stops early on a validation set. Deterministic: the same data and options give the same network (on
// one build).
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "contact_nn/mlp.h"
#include "contact_nn/paper/perceptron.h"
#include "contact_nn/training.h"

namespace quayside::contact_nn::paper {

enum class Method {
  momentum,             // Δw ← m Δw − η g: backpropagation as in Haykin (1999); constant η and m
  adam,                 // Kingma and Ba (2015); the rate falls to a hundredth along a cosine
  levenberg_marquardt,  // Hagan and Menhaj (1994); squares only
};
const char* name_of(Method method);

struct Recipe {
  Method method = Method::momentum;
  Cost cost = Cost::square;
  std::vector<int> hidden = {20, 18};
  double adaptation = 0.005;  // η, on the mean gradient of a batch
  double momentum = 0.9;      // m, in [0, 1)
  double amplitude = 0.3;     // initial weights are uniform in [−amplitude, amplitude]
  int batch = 64;             // patterns per step; Levenberg-Marquardt takes all
  int epochs = 3000;          // at most
  int patience = 200;         // epochs without a lower validation error before training stops
  std::uint64_t seed = 1;     // of initial weights and order

  std::function<bool()> stopped;  // asked after every epoch; true ends training
};

// Settings with which each method does well on the paper's problem.
Recipe recipe_for(Method method);

struct Trained {
  Network network;  // of the epoch with the lowest validation error; takes raw inputs
  int epochs = 0;
  int best_epoch = 0;
  bool stopped = false;  // by `Recipe::stopped`
};

// Throws std::invalid_argument for empty or inconsistent samples or settings out of range.
Trained train(const Samples& training, const Samples& validation, const Recipe& recipe);

}  // namespace quayside::contact_nn::paper

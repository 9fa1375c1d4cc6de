// The paper's tuning: many networks with random adaptation and momentum constants, hidden units and initial weights,
// trained on the same data. Stoppable and resumable: every finished network is a row of a CSV file.
#pragma once

#include <atomic>
#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

#include "contact_nn/paper/experiment.h"

namespace quayside::contact_nn::paper {

struct TuningOptions {
  Problem problem;
  int networks = 2000;
  std::uint64_t seed = 1;  // network k is drawn from (seed, k) alone
  int threads = 0;         // 0: one per core
  int epochs = 1000;       // at most, per network
  int patience = 50;
  std::string file;        // CSV to write or to continue

  const std::atomic<bool>* stop = nullptr;  // networks in training when it turns true are dropped
  // After every network: how many there are, of which so many in this run. Called by one thread at a time.
  std::function<void(int finished, int in_this_run)> progress = [](int, int) {};
};

struct TunedNetwork {
  int number = 0;
  Recipe recipe;
  int epochs = 0, best_epoch = 0;
  double seconds = 0;
  OutputErrors training, validation, external;
};

// What network `number` is trained with: 5 to 30 units in each hidden layer; η in [0.001, 0.2], 1 − m in [0.02, 1] and
// the amplitude in [0.03, 2], all three spread evenly over the orders of magnitude; batches of 16 patterns.
Recipe random_recipe(const TuningOptions& options, int number);

// All networks there are in the end, by number; fewer than asked for when it was stopped. Throws std::invalid_argument
// for a file that was begun with other settings, std::runtime_error for one that cannot be written.
std::vector<TunedNetwork> tune(const TuningOptions& options);

// The ten best on the validation set, and what each constant did.
void print(const std::vector<TunedNetwork>& networks, std::ostream& out);

}  // namespace quayside::contact_nn::paper

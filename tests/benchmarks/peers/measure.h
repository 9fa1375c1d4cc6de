// How right a method is on a scene, and how long it takes.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/benchmarks/peers/scenes.h"
#include "tests/benchmarks/peers/truth.h"

namespace quayside::peers {

// The q-quantile, 0 ≤ q ≤ 1, of the finite values; NaN for none.
double quantile(std::vector<double> values, double q);

struct Accuracy {
  std::size_t poses = 0, missed = 0, phantom = 0;  // contacts not found, contacts found between boxes that are apart
  // One value per pose in which both truth and method see a contact.
  std::vector<double> depth_error;    // [m]
  std::vector<double> normal_error;   // angle to the nearest right normal [degree]
  std::vector<double> point_error;    // from the centroid of the overlap, across the normal [m]
  std::vector<double> point_outside;  // how far outside either box, beyond the depth [m]
};

struct Times {
  std::size_t poses = 0;
  double median = 0, p99 = 0;  // over the poses, of each pose's median over the rounds, less the clock's own time [ns]
  double mean = 0;             // of a whole pass without a clock in between, median over the rounds [ns]
};

struct Result {
  const Contender* contender;
  const Scene* scene;
  Accuracy accuracy;
  Times times;
};

struct Effort {
  int rounds = 15;
  double accuracy_budget = 1.0;  // for one method on one scene, after which fewer poses must do [s]
  double pass_budget = 0.03;     // for one timed pass [s]
  std::size_t least_poses = 100;
  std::function<void(const std::string&)> progress;  // may be empty
};

struct Measurement {
  std::vector<Result> results;  // scene by scene, all methods
  double clock_overhead = 0;    // what the clock itself takes, subtracted from the single times [ns]
};

// All methods are timed in turn, in every round in another order, so that a busy moment of the machine strikes all alike.
Measurement measure(const Contenders& contenders, const std::vector<Scene>& scenes, const Effort& effort);

// One line per method that does not answer the simplest questions rightly: two cubes flat on each other, a cube's corner in a
// face, and two cubes apart. Empty when all is well.
std::vector<std::string> check(const Contenders& contenders);

}  // namespace quayside::peers

// Training of the network for the contact potential, on values and gradients of the exact law.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "contact_nn/dataset.h"
#include "contact_nn/learned_potential.h"
#include "contact_nn/onnx_file.h"

namespace quayside::contact_nn {

// What the poses are like. Boxes of all known sizes, every second pair seen from the upper box.
enum class LandingPoses {
  any,      // tilts and yaws spread evenly over the domain, offsets over all that overlap
  edge,     // as any, but tilted nearly about an edge: down to a hundred-thousandth off
  resting,  // axes parallel but for a disturbance from rounding to milliradians
  aligned,  // axes exactly parallel, half without yaw; offsets of none, flush or any
};

// `reach` 1 for the domain itself, larger for its seam.
BoxPair sample_landing(LandingPoses poses, double reach, Random& random, const learned::Domain& domain = {});

struct PotentialTrainingOptions {
  std::string domain = learned::kLanding;
  std::size_t pairs = 800000;
  long steps = 600000;
  std::uint64_t seed = 1;
  std::function<void(long step, double loss)> progress;  // now and then
};
NetworkFile train_potential(const PotentialTrainingOptions& options);

// Errors against the exact law, elastic. Force: |F − F*|/|F*|; torque: about the exact impact point, over |F*| [m].
struct PotentialErrors {
  double force_median, force_p99, force_most;
  double lever_median, lever_p99;
  double covered;  // share of the pairs answered by the network alone
};
PotentialErrors potential_errors(const ContactModule& learned, const std::vector<BoxPair>& pairs);

}  // namespace quayside::contact_nn

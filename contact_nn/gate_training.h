// Making a gate: from a seed to a network file.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "contact_nn/contact.h"
#include "contact_nn/dataset.h"
#include "contact_nn/onnx_file.h"

namespace quayside::contact_nn {

struct GateTrainingOptions {
  Law law = Law::potential;
  std::uint64_t seed = 1;
  std::size_t pairs = 1000000;  // drawn for training; a tenth as many for validation and for each figure reported
  int epochs = 80;             // 0: a gate with random weights, to show that answers do not depend on training

  std::function<void(int epoch, double training_loss, double validation_loss)> progress;
};

// The network with how it was made. The same options give the same bytes. Throws std::invalid_argument for too few pairs.
NetworkFile train_gate(const GateTrainingOptions& options);

// Share of touching pairs on which the check would send this gate's answer to the exact law.
double fallback_share(Law law, const Network& gate, const std::vector<BoxPair>& pairs);

}  // namespace quayside::contact_nn

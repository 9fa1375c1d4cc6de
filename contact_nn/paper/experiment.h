// One experiment: patterns drawn, a network trained on them, its errors beside those of a constant.
#pragma once

#include <cstdint>
#include <functional>

#include "contact_nn/paper/optimisers.h"
#include "contact_nn/paper/patterns.h"
#include "contact_nn/paper/trihedra.h"

namespace quayside::contact_nn::paper {

struct Sizes {
  std::size_t training, validation, external;
};
inline constexpr Sizes kTable1Sizes{8000, 5000, 75000};   // the paper's, with discontinuities
inline constexpr Sizes kTable2Sizes{10000, 6000, 50000};  // the paper's, without

struct Problem {
  Reading reading = Reading::valid;
  Subset subset;
  Coding coding;
  Sizes sizes = kTable1Sizes;
  std::uint64_t seed = 1;  // of the draws
};

struct Poses {
  std::vector<TouchingPose> training, validation, external;
  DrawCounts counts;
};
Poses draw(const Problem& problem);

struct Data {
  Samples training, validation, external;
};
Data data_of(const Poses& poses, const Coding& coding);

struct Errors {
  OutputErrors training, validation, external;
  PhysicalErrors physical;  // of the external set
};
Errors errors_of(const Network& network, const Data& data, Encoding encoding);

// Those of the best constant: the medians of the training targets.
Errors errors_of_constant(const Data& data, Encoding encoding);

struct Outcome {
  Trained trained;
  Errors errors;
  double seconds = 0;  // of training, all starts together
};

// The start with the lowest absolute validation error of `starts`, seeds counted up from the recipe's. The external set
// has no part in the choice.
Outcome best_of(int starts, const Data& data, Encoding encoding, Recipe recipe);

}  // namespace quayside::contact_nn::paper

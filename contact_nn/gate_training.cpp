#include "contact_nn/gate_training.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "contact_nn/gate_features.h"
#include "contact_nn/training.h"

namespace quayside::contact_nn {

namespace {

// Landings, and what comes to rest after them, are most of what a crane asks: they get most of the samples.
const std::vector<PoseDomain> training_domains{PoseDomain::landing, PoseDomain::resting, PoseDomain::side,
                                               PoseDomain::resting, PoseDomain::any,     PoseDomain::landing,
                                               PoseDomain::resting, PoseDomain::aligned};

// The points gate is asked for any pose of two 40 ft boxes besides: this share of its samples [1].
constexpr double share_of_any_pose = 0.4;

std::vector<BoxPair> pairs_for(Law law, std::size_t count, const GapRange& gaps, std::uint64_t seed) {
  std::vector<BoxPair> pairs = sample_pairs(count, training_domains, gaps, seed);
  if (law != Law::points) return pairs;
  constexpr std::uint64_t of_their_own = 1 << 20;  // a seed that nothing else uses
  Random random(seed + of_their_own);
  const Box container{{6.096, 1.219, 1.2955}};
  for (BoxPair& pair : pairs) {
    if (random.uniform() < share_of_any_pose) pair = sample_pair(container, container, PoseDomain::any, gaps, random);
  }
  return pairs;
}

// Missing a piece costs the whole exact law, naming one too many next to nothing, since the check drops it again.
constexpr double missed_over_needless = 100;

// Of what an output should name, on validation.
constexpr double missed_share = 5e-5;

constexpr double naming_margin = 1.5;  // in logits: odds of 4.5

// The points gate is asked for separated pairs as well.
GapRange gaps_of(Law law) { return law == Law::potential ? GapRange{} : GapRange{0.05, 0.05}; }

struct Labelled {
  Samples samples;
  double kept = 0;    // share of the drawn pairs
  double wanted = 0;  // mean number of outputs that should say yes
};

Labelled labelled(Law law, const std::vector<BoxPair>& pairs) {
  const bool potential = law == Law::potential;
  const auto count = static_cast<Eigen::Index>(pairs.size());
  Labelled result;
  Samples& samples = result.samples;
  samples.inputs.resize(kGateInputs, count);
  samples.targets.resize(potential ? kPotentialOutputs : kPointsOutputs, count);
  Eigen::Index kept = 0;
  for (const BoxPair& pair : pairs) {
    if (potential && surely_apart(pair.a, pair.b, pair.X_AB)) continue;
    const GateView view(pair.a, pair.b, pair.X_AB);
    samples.inputs.col(kept) = view.inputs;
    if (potential) {
      samples.targets.col(kept) = view.wanted(possible_pieces(pair.a, pair.b, pair.X_AB));
    } else {
      samples.targets.col(kept) = PointsOutputs::Unit(largest_separation(pair.a, pair.b, pair.X_AB).axis);
    }
    ++kept;
  }
  samples.inputs.conservativeResize(Eigen::NoChange, kept);
  samples.targets.conservativeResize(Eigen::NoChange, kept);
  result.kept = static_cast<double>(kept) / static_cast<double>(count);
  result.wanted = samples.targets.sum() / static_cast<double>(kept);
  return result;
}

bool certain(const PotentialGate& gate, const BoxPair& pair) {
  const GateView view(pair.a, pair.b, pair.X_AB);
  return (possible_pieces(pair.a, pair.b, pair.X_AB) & ~view.named(gate(view.inputs))).none();
}

bool certain(const PointsGate& gate, const BoxPair& pair) {
  const auto axes = top_three(gate(GateView(pair.a, pair.b, pair.X_AB).inputs));
  return largest_separation(pair.a, pair.b, pair.X_AB, axes).certified;
}

// Raises the bias of each output until it misses at most this share of what it should name on validation, and then by a
// margin: poses are not spread like samples, and an integrator may rest where a logit is just below zero.
void calibrate(Network& gate, const Samples& validation, double missed_share) {
  const Eigen::MatrixXd logits = gate(validation.inputs.cast<double>());
  for (Eigen::Index output = 0; output < logits.rows(); ++output) {
    std::vector<double> wanted;
    for (Eigen::Index i = 0; i < logits.cols(); ++i) {
      if (validation.targets(output, i) > 0) wanted.push_back(logits(output, i));
    }
    if (wanted.empty()) continue;
    const auto rank = wanted.begin() + static_cast<std::ptrdiff_t>(missed_share * static_cast<double>(wanted.size()));
    std::nth_element(wanted.begin(), rank, wanted.end());
    double& bias = gate.layers.back().bias[output];
    bias = static_cast<float>(bias + std::max(0.0, -*rank) + naming_margin);
  }
}

// Mean number of pieces that are possible, and that the gate names.
std::pair<double, double> mean_pieces(const PotentialGate& gate, const std::vector<BoxPair>& pairs) {
  double possible = 0, named = 0;
  for (const BoxPair& pair : pairs) {
    const GateView view(pair.a, pair.b, pair.X_AB);
    possible += static_cast<double>(possible_pieces(pair.a, pair.b, pair.X_AB).count());
    named += static_cast<double>(view.named(gate(view.inputs)).count());
  }
  return {possible / static_cast<double>(pairs.size()), named / static_cast<double>(pairs.size())};
}

template <class Gate>
double share_of_fallbacks(const Gate& gate, const std::vector<BoxPair>& pairs) {
  std::size_t asked = 0, fallbacks = 0;
  for (const BoxPair& pair : pairs) {
    if (surely_apart(pair.a, pair.b, pair.X_AB)) continue;
    ++asked;
    fallbacks += !certain(gate, pair);
  }
  return asked == 0 ? 0 : static_cast<double>(fallbacks) / static_cast<double>(asked);
}

}  // namespace

double fallback_share(Law law, const Network& gate, const std::vector<BoxPair>& pairs) {
  return law == Law::potential ? share_of_fallbacks(PotentialGate(gate), pairs)
                               : share_of_fallbacks(PointsGate(gate), pairs);
}

NetworkFile train_gate(const GateTrainingOptions& options) {
  if (options.pairs < 100) throw std::invalid_argument("a gate needs at least 100 pairs to learn from");
  const bool potential = options.law == Law::potential;
  const GapRange gaps = gaps_of(options.law);
  const std::size_t few = options.pairs / 10;
  // Three seeds out of one, far enough apart that neighbouring seeds share no data.
  const std::uint64_t base = options.seed * 1000;
  const Labelled training = labelled(options.law, pairs_for(options.law, options.pairs, gaps, base));
  const Labelled validation = labelled(options.law, pairs_for(options.law, few, gaps, base + 1));

  NetworkFile file;
  file.interface = potential ? kPotentialInterface : kPointsInterface;
  file.golden_inputs = validation.samples.inputs.leftCols(4).cast<double>();
  auto& made = file.how_made;
  made["seed"] = std::to_string(options.seed);
  if (options.epochs == 0) {
    file.network = random_network(potential ? PotentialGate::layer_sizes() : PointsGate::layer_sizes(),
                                  Activation::relu, options.seed);
    for (Layer& layer : file.network.layers) layer.weights = layer.weights.cast<float>().cast<double>();
    made["training"] = "none: random weights";
  } else {
    TrainingOptions how;
    const std::vector<int> sizes = potential ? PotentialGate::layer_sizes() : PointsGate::layer_sizes();
    how.hidden.assign(sizes.begin() + 1, sizes.end() - 1);
    how.loss = potential ? Loss::binary_cross_entropy : Loss::top_three_cross_entropy;
    how.positive_weight = potential ? missed_over_needless : 1;
    how.epochs = options.epochs;
    how.seed = options.seed;
    how.progress = options.progress;
    const TrainingResult result = train(training.samples, validation.samples, how);
    file.network = result.network;
    if (potential) calibrate(file.network, validation.samples, missed_share);
    made["training"] = fmt::format(
        "SOAP, rate {} falling along a cosine, batches of {}, {} of at most {} epochs, best on validation: {}",
        how.learning_rate, how.batch, result.epochs, how.epochs, result.best_epoch);
    made["loss"] = fmt::format("{}; training {:.6f}, validation {:.6f}",
                               potential ? fmt::format("binary cross entropy, a miss weighs {} times a needless name",
                                                       missed_over_needless)
                                         : std::string("cross entropy of the first three"),
                               result.training_loss, result.validation_loss);
  }
  made["data"] = fmt::format(
      "{} pairs drawn for training, {} for validation, over 20, 40 and 45 ft containers, spreader, ground and trailer "
      "deck; 2 of 8 landings, 3 at rest, and 1 each exactly aligned, from the side and in any pose{}; gaps from {} to {} m",
      options.pairs, few,
      potential ? "" : fmt::format("; {} of them replaced by two 40 ft boxes in any pose", share_of_any_pose),
      -gaps.deepest, gaps.farthest);
  made["kept"] = fmt::format("{:.4f} of the pairs drawn: {}", training.kept, potential ? "those that touch" : "all");
  if (potential) made["wanted"] = fmt::format("{:.2f} of {} outputs on average", training.wanted, kPotentialOutputs);
  for (const PoseDomain domain : all_pose_domains()) {
    const std::vector<BoxPair> fresh = sample_pairs(few, {domain}, gaps, base + 2);
    const double share = fallback_share(options.law, file.network, fresh);
    made[fmt::format("fallbacks.{}", name_of(domain))] = fmt::format("{:.5f} of fresh touching pairs", share);
    if (potential) {
      const auto [possible, named] = mean_pieces(PotentialGate(file.network), fresh);
      made[fmt::format("pieces.{}", name_of(domain))] = fmt::format("{:.2f} named, {:.2f} possible", named, possible);
    }
  }
  return file;
}

}  // namespace quayside::contact_nn

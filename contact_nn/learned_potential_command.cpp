#include "contact_nn/learned_potential_command.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "contact_nn/learned_potential_training.h"
#include "contact_nn/potential_law.h"

namespace quayside::contact_nn {

namespace {

struct TrainArguments {
  std::string out;
  PotentialTrainingOptions options;
};

void run_train(TrainArguments arguments) {
  const auto start = std::chrono::steady_clock::now();
  arguments.options.progress = [&](long step, double loss) {
    fmt::print(stderr, "\rstep {} of {}   loss {:.5f}\033[K", step, arguments.options.steps, loss);
    std::fflush(stderr);
  };
  const NetworkFile file = train_potential(arguments.options);
  fmt::print(stderr, "\r\033[K");
  write_network(arguments.out, file);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  fmt::print("{}  {}, {}, made in {:.0f} s\n", arguments.out, file.interface, file.network.architecture(), seconds);
  for (const auto& [key, text] : file.how_made) fmt::print("  {:<10} {}\n", key, text);
}

struct EvaluateArguments {
  std::string network;
  std::size_t pairs = 20000;
  std::uint64_t seed = 1;
};

// Time per pair of the fastest of several rounds [ns].
template <class Round>
double nanoseconds(std::size_t pairs, Round round) {
  double best = std::numeric_limits<double>::infinity(), sum = 0;
  for (int i = 0; i < 15; ++i) {
    const auto start = std::chrono::steady_clock::now();
    sum += round();
    best = std::min(best, std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count());
  }
  volatile double sink = sum;  // the compiler must not drop what nobody reads
  (void)sink;
  return best / static_cast<double>(pairs);
}

void run_evaluate(const EvaluateArguments& arguments) {
  ContactSettings settings;
  settings.network = arguments.network;
  settings.model = Model::exact;
  settings.friction = 0;
  settings.restitution = 1;
  const auto learned = make_learned_module(settings);
  const learned::Domain domain = learned::domain_of(
      arguments.network.empty() ? shipped_potential() : read_network(arguments.network, learned::kInterface));
  settings.law = Law::potential;
  settings.network.clear();
  const auto exact = make_contact_module(settings);

  const auto boxes = [&](LandingPoses poses) {
    Random random(1000 * arguments.seed + 500);
    std::vector<BoxPair> pairs;
    while (pairs.size() < arguments.pairs) pairs.push_back(sample_landing(poses, 1, random, domain));
    return pairs;
  };
  const auto row = [&](const char* name, const std::vector<BoxPair>& pairs) {
    const PotentialErrors e = potential_errors(*learned, pairs);
    const std::size_t few = std::min<std::size_t>(pairs.size(), 2048);
    std::vector<LearnedPair> some;
    for (std::size_t i = 0; i < few; ++i) some.push_back({pairs[i].a, pairs[i].b, pairs[i].X_AB, {}});
    std::vector<ContactForce> forces(few);
    ContactCounters counters;
    const auto one_by_one = [&](const ContactModule& module) {
      return nanoseconds(few, [&] {
        double sum = 0;
        for (const LearnedPair& x : some) sum += module.force(x.a, x.b, x.X_AB, x.V_AB, counters).f_A[2];
        return sum;
      });
    };
    const double control = one_by_one(*exact), single = one_by_one(*learned);
    const double batch = nanoseconds(few, [&] {
      learned->forces(some.data(), few, forces.data(), counters);
      return forces.front().f_A[2];
    });
    fmt::print("{:<12}{:>8.3f}{:>8.2f}{:>9.1f}{:>9.1f}{:>9.0f}{:>8.4f}{:>9.0f}{:>9.0f}{:>9.0f}{:>8.1f}{:>8.1f}\n", name,
               100 * e.force_median, 100 * e.force_p99, 100 * e.force_most, 1e3 * e.lever_median, 1e3 * e.lever_p99,
               e.covered, control, single, batch, control / single, control / batch);
  };
  fmt::print("elastic force of the network against the exact law; times in ns, fastest of 15 rounds\n\n");
  fmt::print("{:<12}{:>8}{:>8}{:>9}{:>9}{:>9}{:>8}{:>9}{:>9}{:>9}{:>8}{:>8}\n", "poses", "median%", "p99 %", "most %",
             "lever mm", "p99 mm", "covered", "exact", "single", "batch", "faster", "batched");
  row("domain", boxes(LandingPoses::any));
  row("edge", boxes(LandingPoses::edge));
  row("resting", boxes(LandingPoses::resting));
  row("aligned", boxes(LandingPoses::aligned));
  // Outside the domain the exact law answers: what is left is the cost of asking.
  row("crane poses", sample_pairs(arguments.pairs, {PoseDomain::landing}, GapRange{}, arguments.seed));
  row("any", sample_pairs(arguments.pairs, {PoseDomain::any}, GapRange{}, arguments.seed));
}

}  // namespace

void add_learned_commands(CLI::App& contact) {
  CLI::App* potential = contact.add_subcommand("potential", "The network for the contact potential (law 'learned')");
  potential->require_subcommand(1);

  auto train = std::make_shared<TrainArguments>();
  CLI::App* command = potential->add_subcommand("train", "Make it from a seed, on values and gradients of the exact law");
  command->add_option("--seed", train->options.seed, "Of data, initial weights and batches")->capture_default_str();
  command->add_option("--pairs", train->options.pairs, "Pairs to learn from")->check(CLI::Range(1000, 10000000))
      ->capture_default_str();
  command->add_option("--domain", train->options.domain, "For which poses")
      ->check(CLI::IsMember({learned::kLanding, learned::kCrane}))->capture_default_str();
  command->add_option("--steps", train->options.steps, "Of the optimiser")->check(CLI::Range(0, 100000000))
      ->capture_default_str();
  command->add_option("--out,-o", train->out, "ONNX file to write")->required();
  command->footer(
      "The network that ships is made by\n"
      "  quayside contact potential train --out contact_nn/networks/potential_landing.onnx");
  command->callback([train] { run_train(*train); });

  auto evaluate = std::make_shared<EvaluateArguments>();
  command = potential->add_subcommand("evaluate", "Errors and times against the exact law");
  command->add_option("--network", evaluate->network, "ONNX file; the one that ships by default");
  command->add_option("--pairs", evaluate->pairs, "Per kind of poses")->check(CLI::Range(100, 10000000))
      ->capture_default_str();
  command->add_option("--seed", evaluate->seed, "Of the random draws")->capture_default_str();
  command->callback([evaluate] { run_evaluate(*evaluate); });
}

}  // namespace quayside::contact_nn

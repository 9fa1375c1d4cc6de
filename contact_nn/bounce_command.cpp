#include "contact_nn/bounce_command.h"

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "contact_nn/bounces.h"
#include "contact_nn/status_line.h"

namespace quayside::contact_nn {
namespace {

struct Arguments {
  std::uint64_t bounces = 10000, seed = 1;
  double tolerance = 1e-9;  // [m]
  unsigned threads = 0;
};

struct Who {
  std::string name;
  Model model;
  Law law;
};

// Every bounce has its own seed, so it does not matter which thread makes it.
BounceTrials trials_of(const ContactModule& module, const Arguments& arguments, const std::string& name,
                       StatusLine& progress) {
  BounceTrials all;
  std::atomic<std::uint64_t> next{0};
  std::mutex mutex;
  const auto work = [&] {
    ContactCounters counters;
    const ElasticLaw law = [&](const Pose& X_AB) -> Wrench {
      const ContactForce f = module.force(kBounceBox, kBounceBox, X_AB, {}, counters);
      return {f.f_A, f.t_A};
    };
    for (std::uint64_t i; (i = next++) < arguments.bounces;) {
      const Bounce b = bounce(random_bounce_start(arguments.seed * 1000003 + i), law, arguments.tolerance);
      const std::lock_guard lock(mutex);
      all.add(b);
      if (i % 100 == 0) progress.show(fmt::format("{}: {} of {} bounces", name, i, arguments.bounces));
    }
  };
  const unsigned count = arguments.threads > 0 ? arguments.threads : std::max(1u, std::thread::hardware_concurrency());
  std::vector<std::thread> threads;
  for (unsigned i = 1; i < count; ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  return all;
}

void run(const Arguments& arguments) {
  fmt::print("{} random starts of a 40 ft box against a fixed one, elastic, without friction, seed {}, error of a step {:.0e} m\n\n",
             arguments.bounces, arguments.seed, arguments.tolerance);
  fmt::print("{:<24}{:>9}{:>12}{:>18}{:>14}{:>14}{:>14}\n", "law, model", "touched", "unfinished", "gained > 0.1 %",
             "most gained", "most lost", "evaluations");
  StatusLine progress;
  for (const Who& who : {Who{"potential, exact", Model::exact, Law::potential},
                         Who{"potential, committee", Model::committee, Law::potential},
                         Who{"points, exact", Model::exact, Law::points},
                         Who{"points, committee", Model::committee, Law::points}}) {
    ContactSettings settings;
    settings.model = who.model;
    settings.law = who.law;
    settings.restitution = 1;
    settings.friction = 0;
    const BounceTrials t = trials_of(*make_contact_module(settings), arguments, who.name, progress);
    progress.show("");
    const double finished = static_cast<double>(std::max<std::uint64_t>(t.touched - t.unfinished, 1));
    fmt::print("{:<24}{:>9}{:>12}{:>16.2f} %{:>14.1e}{:>14.1e}{:>14.0f}\n", who.name, t.touched, t.unfinished,
               100.0 * static_cast<double>(t.gained) / finished, t.most_gained, t.most_lost,
               static_cast<double>(t.evaluations) / static_cast<double>(t.bounces));
  }
  fmt::print("(of the energy at the start; evaluations of the force per bounce; unfinished: touching after 3 s)\n");
}

}  // namespace

void add_bounce_command(CLI::App& contact_app) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = contact_app.add_subcommand("bounces", "Does a contact law make energy? Elastic bounces from random starts");
  command->add_option("--bounces", arguments->bounces, "Of each law and model")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 40))->capture_default_str();
  command->add_option("--seed", arguments->seed, "Of the starts")->capture_default_str();
  command->add_option("--tolerance", arguments->tolerance, "Error of a step of the integrator [m]")
      ->check(CLI::PositiveNumber)->capture_default_str();
  command->add_option("--threads", arguments->threads, "0: all cores. The figures do not depend on it")
      ->capture_default_str();
  command->footer("Example:\n  quayside contact bounces --bounces 10000");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace quayside::contact_nn

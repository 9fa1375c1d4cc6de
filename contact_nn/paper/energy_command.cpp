#include "contact_nn/paper/energy_command.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "contact_nn/free_box.h"
#include "contact_nn/paper/experiment.h"
#include "contact_nn/paper/mlp_contact.h"
#include "contact_nn/potential_law.h"
#include "contact_nn/status_line.h"

namespace quayside::contact_nn {

namespace {

using namespace paper;

struct EnergyArguments {
  int bounces = 1000;
  std::uint64_t seed = 1;
  double tolerance = 1e-9;
  std::string network;
  std::vector<std::string> boxes{"cubes", "anywhere", "landing"};
};

constexpr double kStiffness = 6e8;  // flat contact over the reference area [N/m]

// The paper's cubes, as dense as a container of 30 t.
constexpr double kMassOfCube = 3e3;  // [kg]

const Box kContainer{{6.096, 1.219, 1.2955}};  // 40 ft

// Touching as in the paper, without overlap, and backed off along the normal by 2 mm; thrown as `throw_from_anywhere` does.
// During a bounce the cubes turn by a few mrad: the network is asked for poses like those that it learned from.
Throw throw_of_trihedra(Random& random) {
  constexpr double kStartGap = 2e-3;  // [m]
  DrawCounts counts;
  const TouchingPose touching = draw_poses(1, Reading::valid, {}, random, counts).front();
  Throw start{cube(), cube(), kMassOfCube, touching.X_AB, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  start.X_AB.translation() += kStartGap * touching.n_A;
  start.v_A = random.uniform(0.2, 1) * (-touching.n_A + 0.3 * random.direction());
  start.w_B = random.uniform(0, 0.1) * random.direction();
  return start;
}

// Each start has its own seed, so it does not matter who follows which.
ReboundFigures figures(const std::function<Throw(Random&)>& draw, const FreeBox::Force& force,
                      const EnergyArguments& arguments) {
  std::vector<Rebound> bounces(static_cast<std::size_t>(arguments.bounces));
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i; (i = next++) < bounces.size();) {
      Random random(arguments.seed * 1000003 + i);
      bounces[i] = rebound(draw(random), force, arguments.tolerance);
    }
  };
  std::vector<std::thread> threads;
  for (unsigned i = 1; i < std::max(1u, std::thread::hardware_concurrency()); ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  return figures_of(bounces);
}

// The module's own models, elastic and frictionless.
FreeBox::Force module_force(Law law, Model model, const Box& a, const Box& b, const std::string& network = {}) {
  ContactSettings settings;
  settings.law = law;
  settings.model = model;
  settings.stiffness = kStiffness;
  settings.restitution = 1;
  settings.friction = 0;
  settings.network = network;
  const std::shared_ptr<ContactModule> module = make_contact_module(settings);
  return [module, a, b](const Pose& X_AB, const RelativeVelocity& V_AB) {
    ContactCounters counters;
    return module->force(a, b, X_AB, V_AB, counters);
  };
}

// The paper's network on poses as in its table 1, trained as in its table 1.
FreeBox::Force mlp_force(const Coding& coding, Depth depth, std::uint64_t seed) {
  Problem problem;
  problem.coding = coding;
  problem.seed = seed;
  problem.sizes.external = 10;
  const Data data = data_of(draw(problem), coding);
  Recipe recipe = recipe_for(Method::momentum);
  recipe.seed = seed;
  const double stiffness = kStiffness * kEdge * kEdge / kReferenceArea;  // of a flat contact
  const MlpContact contact(best_of(3, data, coding.encoding, recipe).trained.network, coding.encoding, depth, stiffness);
  return [contact](const Pose& X_AB, const RelativeVelocity&) { return contact(X_AB); };
}

void run_energy(const EnergyArguments& arguments) {
  StatusLine status;
  fmt::print("{} elastic, frictionless bounces each; seed {}, error of a step at most {:g} m\n", arguments.bounces,
             arguments.seed, arguments.tolerance);
  std::function<Throw(Random&)> draw;
  const auto heading = [&](const std::string& text) {
    status.show("");
    fmt::print("\n{}\n\n{:<52}{:>9}{:>16}{:>16}{:>9}{:>12}{:>14}\n", text, "who answers", "touched", "gain > 0.1 %",
               "lose > 0.1 %", "near", "median", "most gained");
  };
  const auto row = [&](const std::string& name, const std::function<FreeBox::Force()>& make) {
    status.show(name + " ...");
    const ReboundFigures f = figures(draw, make(), arguments);
    const double share = 100.0 / std::max(1, f.touched);
    status.show("");
    fmt::print("{:<52}{:>9}{:>14.2f} %{:>14.2f} %{:>9}{:>12.1e}{:>14.1e}\n", name, f.touched, share * f.gained,
               share * f.lost, f.still_near, f.median, f.most_gained);
    std::fflush(stdout);
  };
  const auto rows = [&](const Box& box) {
    row("exact, law potential", [&] { return module_force(Law::potential, Model::exact, box, box); });
    row("committee, law potential", [&] { return module_force(Law::potential, Model::committee, box, box); });
    row("exact, law points", [&] { return module_force(Law::points, Model::exact, box, box); });
  };
  const auto wanted = [&](const char* name) {
    return std::find(arguments.boxes.begin(), arguments.boxes.end(), name) != arguments.boxes.end();
  };
  if (wanted("cubes")) {
    heading("two cubes of edge 2 m and 3 t, from the paper's touching poses");
    draw = throw_of_trihedra;
    const Coding smooth{Target::pressure, Encoding::vectors, 0.01 * kEdge};
    row("mlp, the paper's outputs, exact depth", [&] { return mlp_force({}, Depth::exact, arguments.seed); });
    row("mlp, the paper's outputs, depth along its direction",
        [&] { return mlp_force({}, Depth::own, arguments.seed); });
    row("mlp, continuous targets, exact depth", [&] { return mlp_force(smooth, Depth::exact, arguments.seed); });
    row("mlp, continuous targets, depth along its direction",
        [&] { return mlp_force(smooth, Depth::own, arguments.seed); });
    rows(cube());
  }
  const auto learned = [&] {
    row("learned", [&] {
      return module_force(Law::learned, Model::exact, kContainer, kContainer, arguments.network);
    });
  };
  if (wanted("anywhere")) {
    heading("two 40 ft containers of 30 t, thrown from anywhere");
    draw = [](Random& random) { return throw_from_anywhere(kContainer, kContainer, random); };
    rows(kContainer);
    learned();
  }
  if (wanted("landing")) {
    heading("two 40 ft containers of 30 t, one set down on the other");
    draw = [](Random& random) { return throw_down(kContainer, kContainer, random); };
    rows(kContainer);
    learned();
  }
}

}  // namespace

void add_energy_command(CLI::App& contact) {
  auto arguments = std::make_shared<EnergyArguments>();
  CLI::App* command = contact.add_subcommand("energy", "Elastic bounces under every contact model: who makes energy?");
  command->add_option("--bounces", arguments->bounces, "Per row")->check(CLI::Range(1, 10000000))->capture_default_str();
  command->add_option("--seed", arguments->seed, "Of the starts and of the paper's network")->capture_default_str();
  command->add_option("--tolerance", arguments->tolerance, "Error of a step of the integrator, at most [m]")
      ->check(CLI::PositiveNumber)->capture_default_str();
  command->add_option("--boxes", arguments->boxes, "Which boxes")
      ->check(CLI::IsMember({"cubes", "anywhere", "landing"}))->capture_default_str();
  command->add_option("--network", arguments->network, "Another network for the law 'learned' (ONNX)");
  command->footer("Example:\n  quayside contact energy --boxes cubes --bounces 10000");
  command->callback([arguments] { run_energy(*arguments); });
}

}  // namespace quayside::contact_nn

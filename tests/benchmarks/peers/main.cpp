// contact_peers: the contact module among the methods that the paper cites. See README.md.
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "contact_nn/contact.h"
#include "tests/benchmarks/peers/bounce_table.h"
#include "tests/benchmarks/peers/report.h"

namespace quayside::peers {
namespace {

struct Options {
  std::size_t poses = 1000, bounces = 1000;
  std::uint64_t seed = 1;
  Effort effort;
  std::vector<std::string> only;
  std::string scene, csv, markdown, svg;
  bool check_only = false;
};

// Poses of each scene for which the brute force, at some milliseconds each, confirms the truth.
constexpr std::size_t kBruteForcePoses = 30;

std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  }
  return "unknown processor";
}

std::vector<std::string> circumstances(const Options& options, const std::vector<Scene>& scenes) {
  double load[3] = {};
  getloadavg(load, 3);
  std::vector<std::string> lines{
      fmt::format("{}, {} processors, load average {:.1f} at the start (a busy machine makes tails longer)", processor(),
                  sysconf(_SC_NPROCESSORS_ONLN), load[0]),
      fmt::format("gcc {}, built with: {}; the libraries as Debian builds them: {}", __VERSION__, BUILD_FLAGS, LIBRARIES),
      fmt::format("{} poses a scene, seed {}, {} rounds, all methods in turn", options.poses, options.seed,
                  options.effort.rounds)};
  for (const Scene& scene : scenes) lines.push_back(scene.name + ": " + scene.description);
  return lines;
}

// What the truth says, what the contact module says and what the brute force says must be one.
std::string verify_truth(const std::vector<Scene>& scenes) {
  double module = 0, brute = 0;
  for (const Scene& scene : scenes) {
    for (std::size_t i = 0; i < scene.pairs.size(); ++i) {
      const Placed& pair = scene.pairs[i];
      const double gap = truth_of(pair).gap;
      module = std::max(module, std::abs(gap - contact_nn::separation(pair.a, pair.b, relative_pose(pair))));
      if (i < kBruteForcePoses && scene.touching) brute = std::max(brute, std::abs(gap + brute_force_depth(pair)));
    }
  }
  constexpr double kAgreement = 1e-9;  // of boxes of 12 m [m]
  if (!(module < kAgreement && brute < kAgreement)) {
    throw std::runtime_error(fmt::format("the truth is in doubt: {:.1e} m off the contact module, {:.1e} m off the brute force",
                                         module, brute));
  }
  return fmt::format("truth: 15 axes by corners; at most {:.0e} m off the contact module's separation (all poses), {:.0e} m off the brute "
                     "force ({} poses a scene)", module, brute, kBruteForcePoses);
}

void write(const std::string& file, const std::string& content) {
  std::ofstream out(file);
  out << content;
  out.close();
  if (!out) throw std::runtime_error(file + " cannot be written: does its folder exist?");
}

bool wanted(const std::string& name, const std::vector<std::string>& only) {
  return only.empty() || std::any_of(only.begin(), only.end(), [&](const auto& part) { return name.find(part) != std::string::npos; });
}

int run(const Options& options) {
  Contenders contenders;
  add_ours(contenders);
  add_module(BULLET_FLOAT_MODULE, contenders);
  add_module(BULLET_DOUBLE_MODULE, contenders);
  add_ode_and_mujoco(contenders);
  add_libccd(contenders);
  add_module(FCL_MODULE, contenders);
  std::stable_sort(contenders.begin(), contenders.end(), [](const auto& x, const auto& y) { return x->kind < y->kind; });
  contenders.erase(std::remove_if(contenders.begin(), contenders.end(),
                                  [&](const auto& x) { return !wanted(x->name, options.only); }),
                   contenders.end());
  if (contenders.empty()) throw std::invalid_argument("no method has a name that contains what --only says");
  const std::vector<std::string> failures = check(contenders);
  for (const std::string& failure : failures) fmt::print(stderr, "{}\n", failure);
  if (!failures.empty()) return 1;
  fmt::print("{} methods answer the check rightly\n", contenders.size());
  if (options.check_only) return 0;

  std::vector<Scene> scenes = make_scenes(options.poses, options.seed);
  scenes.erase(std::remove_if(scenes.begin(), scenes.end(),
                              [&](const Scene& x) { return x.name.find(options.scene) == std::string::npos; }),
               scenes.end());
  if (scenes.empty()) throw std::invalid_argument("no scene has '" + options.scene + "' in its name");
  std::vector<std::string> lines = circumstances(options, scenes);
  lines.push_back(verify_truth(scenes));
  Effort effort = options.effort;
  if (isatty(STDERR_FILENO)) effort.progress = [](const std::string& where) { fmt::print(stderr, "\r{}\033[K", where); };
  const Measurement measurement = measure(contenders, scenes, effort);
  if (effort.progress) effort.progress("");
  std::string tables = markdown(measurement, lines);
  if (options.bounces > 0) tables += bounce_table(contenders, options.bounces, options.seed);
  fmt::print("{}", tables);
  if (!options.markdown.empty()) write(options.markdown, tables);
  if (!options.csv.empty()) write(options.csv, csv(measurement, contenders, lines));
  if (!options.svg.empty()) write(options.svg, chart(measurement, scenes, lines.front()));
  return 0;
}

}  // namespace
}  // namespace quayside::peers

int main(int argc, char** argv) {
  quayside::peers::Options options;
  CLI::App app("The contact module among its peers: speed against error");
  app.add_option("--poses", options.poses, "In each scene")->check(CLI::Range(1, 1000000))->capture_default_str();
  app.add_option("--rounds", options.effort.rounds, "How often every method is timed on every pose")->check(CLI::Range(1, 10000))
      ->capture_default_str();
  app.add_option("--bounces", options.bounces, "Elastic bounces for every method, to see whether it makes energy; 0: none")
      ->capture_default_str();
  app.add_option("--seed", options.seed, "Of the poses")->capture_default_str();
  app.add_option("--only", options.only, "Only methods whose names contain one of these");
  app.add_option("--scene", options.scene, "Only scenes whose names contain this");
  app.add_option("--csv", options.csv, "Table to write");
  app.add_option("--markdown", options.markdown, "Tables to write");
  app.add_option("--svg", options.svg, "Chart to write");
  app.add_flag("--check", options.check_only, "Only see that every method answers simple questions rightly");
  CLI11_PARSE(app, argc, argv);
  try {
    return quayside::peers::run(options);
  } catch (const std::exception& error) {
    std::cerr << "contact_peers: " << error.what() << "\n";
    return 3;
  }
}

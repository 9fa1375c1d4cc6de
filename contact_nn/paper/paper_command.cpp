#include "contact_nn/paper/paper_command.h"

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "contact_nn/onnx_file.h"
#include "contact_nn/paper/energy_command.h"
#include "contact_nn/paper/figure.h"
#include "contact_nn/paper/tables.h"
#include "contact_nn/paper/tuning.h"
#include "contact_nn/status_line.h"

namespace quayside::contact_nn {

namespace {

using namespace paper;

const std::map<std::string, Reading> reading_names{{"valid", Reading::valid}, {"unfiltered", Reading::unfiltered}};
const std::vector<std::string> subset_names{"everything", "octant", "vertex_face", "edge_edge"};
const std::vector<std::string> table_names{"1", "2", "targets", "experts"};

struct SubsetArguments {
  std::string name = "everything";
  int of_a = 0, of_b = 0;

  Subset subset() const {
    if (name == "vertex_face" || name == "edge_edge") {
      const bool vertex = name == "vertex_face";
      const int most_a = vertex ? kFaces : kEdges, most_b = vertex ? kVertices : kEdges;
      if (of_a < 0 || of_a >= most_a || of_b < 0 || of_b >= most_b) {
        throw std::invalid_argument(fmt::format("--of-a must be in 0 to {} and --of-b in 0 to {} for {}", most_a - 1,
                                                most_b - 1, name));
      }
      return Subset::pair(vertex ? Touch::vertex_on_face : Touch::edge_on_edge, of_a, of_b);
    }
    Subset subset;
    if (name == "octant") subset.kind = Subset::Kind::octant;
    return subset;
  }
};

void add_data_options(CLI::App& command, std::string& reading, SubsetArguments& subset) {
  std::vector<std::string> names;
  for (const auto& entry : reading_names) names.push_back(entry.first);
  command.add_option("--reading", reading, "Only poses that do not overlap, or all")->check(CLI::IsMember(names))
      ->capture_default_str();
  command.add_option("--subset", subset.name, "Which touching features; the last two have no discontinuities")
      ->check(CLI::IsMember(subset_names))->capture_default_str();
  command.add_option("--of-a", subset.of_a, "vertex_face: A's face, 0 to 2 (x, y, z); edge_edge: A's edge, 0 to 8")
      ->capture_default_str();
  command.add_option("--of-b", subset.of_b, "vertex_face: B's vertex, 0 to 6; edge_edge: B's edge, 0 to 8")
      ->capture_default_str();
}

void write_file(const std::filesystem::path& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw std::runtime_error(fmt::format("{} cannot be written: does its folder exist?", path.string()));
}

// ---- trihedra

struct TrihedraArguments {
  std::string reading = "valid", out;
  SubsetArguments subset;
  std::size_t poses = 88000;
  std::uint64_t seed = 1;
};

void run_trihedra(const TrihedraArguments& arguments) {
  Random random(arguments.seed);
  DrawCounts counts;
  const Subset subset = arguments.subset.subset();
  const auto poses = draw_poses(arguments.poses, reading_names.at(arguments.reading), subset, random, counts);
  const Samples samples = patterns(poses, {});
  fmt::print("{} poses, {}, seed {}\n", arguments.reading, describe(subset), arguments.seed);
  for (const std::string& line : describe(counts)) fmt::print("  {}\n", line);
  const Eigen::VectorXd constant = best_constant(samples.targets);
  const Eigen::MatrixXd targets = samples.targets.cast<double>();
  fmt::print("  a constant (the medians) has MAE {:.4f}\n",
             output_errors(constant.replicate(1, targets.cols()), targets).absolute);
  if (arguments.out.empty()) return;
  std::string text =
      "px [m],py [m],pz [m],alpha [rad],beta [rad],gamma [rad],impact azimuth [rad],impact elevation [rad],"
      "force azimuth [rad],force elevation [rad],touch,of_a,of_b\n";
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const TouchingPose& pose = poses[i];
    const Eigen::Vector3d& p = pose.X_AB.translation();
    const Eigen::Vector2d point = spherical(pose.impact_A), force = spherical(pose.n_A);
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", p[0], p[1], p[2], pose.euler[0], pose.euler[1],
                        pose.euler[2], point[0], point[1], force[0], force[1],
                        pose.touch == Touch::vertex_on_face ? "vertex_face" : "edge_edge", pose.of_a, pose.of_b);
  }
  write_file(arguments.out, text);
  fmt::print("  written to {}\n", arguments.out);
}

// ---- evaluate

struct EvaluateArguments {
  std::vector<std::string> tables = table_names;
  std::string out;
  TableOptions options;
};

NetworkFile network_file(const Prediction& prediction, const std::string& problem, const TableOptions& options) {
  NetworkFile file;
  file.network = prediction.network;
  file.interface = "paper_impact/1";
  file.how_made = {{"problem", problem},
                   {"inputs", "p_AB [m], Euler angles alpha, beta, gamma [rad]; R_AB = Rz(gamma) Ry(beta) Rx(alpha)"},
                   {"outputs", "azimuth and elevation of the impact point, then of the force on B [rad]"},
                   {"optimiser", "backpropagation with momentum, stopped early"},
                   {"seed", std::to_string(options.seed)}};
  file.golden_inputs.resize(6, 3);
  file.golden_inputs << 2, 1, 0.5, 0.5, 2, -1, 0, 1, 2, 0.1, -0.5, 1, 0.2, 0.6, -1, -0.3, 0, 1.2;
  return file;
}

void run_evaluate(EvaluateArguments arguments) {
  StatusLine status;
  TableOptions& options = arguments.options;
  options.progress = [&](const std::string& text) { status.show(text); };
  const std::filesystem::path folder(arguments.out);
  if (!arguments.out.empty()) std::filesystem::create_directories(folder);
  std::vector<Table> tables;
  const auto figure = [&](const Prediction& p, const std::string& name, const std::string& title,
                          const std::string& network) {
    if (arguments.out.empty()) return;
    std::string csv = "pattern,desired [rad],predicted [rad]\n";
    for (std::size_t i = 0; i < p.desired.size(); ++i)
      csv += fmt::format("{},{:.9g},{:.9g}\n", i, p.desired[i], p.predicted[i]);
    write_file(folder / (name + ".csv"), csv);
    write_file(folder / (name + ".svg"), prediction_svg(title, "first output [rad]", p.desired, p.predicted));
    write_network((folder / (network + ".onnx")).string(), network_file(p, title, options));
  };
  for (const std::string& name : arguments.tables) {
    Prediction prediction;
    if (name == "1") {
      tables.push_back(table1(options, prediction));
      figure(prediction, "figure5", "Figure 5: external set, with discontinuities", "with_discontinuities");
    } else if (name == "2") {
      tables.push_back(table2(options, prediction));
      figure(prediction, "figure6", "Figure 6: external set, without discontinuities", "without_discontinuities");
    } else {
      tables.push_back(name == "targets" ? target_table(options) : experts_table(options));
    }
    status.show("");
    print(tables.back(), std::cout);
    std::cout.flush();
  }
  if (arguments.out.empty()) return;
  std::ofstream csv(folder / "tables.csv");
  write_csv(tables, csv);
  csv.close();
  if (!csv) throw std::runtime_error(fmt::format("{} cannot be written", (folder / "tables.csv").string()));
  fmt::print("Tables, figures and networks are in {}\n", folder.string());
}

// ---- tune

struct TuneArguments {
  std::string reading = "valid";
  SubsetArguments subset;
  TuningOptions options;
};

std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set by a signal handler");

// Ctrl-C asks for a stop while this lives; a second one ends the program as usual.
class StopOnInterrupt {
 public:
  StopOnInterrupt() {
    interrupted = false;
    before_ = std::signal(SIGINT, [](int) {
      interrupted = true;
      std::signal(SIGINT, SIG_DFL);
    });
  }
  ~StopOnInterrupt() { std::signal(SIGINT, before_); }

 private:
  void (*before_)(int);
};

std::string time_left(double seconds) {
  const int total = static_cast<int>(seconds + 0.5);
  return total >= 3600 ? fmt::format("{} h {:02} min", total / 3600, total / 60 % 60)
                       : fmt::format("{} min {:02} s", total / 60, total % 60);
}

void run_tune(TuneArguments arguments) {
  TuningOptions& options = arguments.options;
  options.problem.reading = reading_names.at(arguments.reading);
  options.problem.subset = arguments.subset.subset();
  if (options.problem.subset.kind != Subset::Kind::everything) options.problem.sizes = kTable2Sizes;
  options.stop = &interrupted;
  std::vector<TunedNetwork> networks;
  {
    const StopOnInterrupt guard;
    StatusLine status;
    status.show("drawing patterns ...");
    const auto begin = std::chrono::steady_clock::now();
    options.progress = [&](int finished, int in_this_run) {
      const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
      status.show(fmt::format("{} of {} networks   {} left   (Ctrl-C stops, the same command continues)", finished,
                              options.networks, time_left(elapsed / in_this_run * (options.networks - finished))));
    };
    networks = tune(options);
  }
  print(networks, std::cout);
  const int finished = static_cast<int>(networks.size());
  if (finished < options.networks) {
    fmt::print("\nStopped after {} of {} networks: the same command continues {}\n", finished, options.networks,
               options.file);
  } else {
    fmt::print("\nAll {} networks are in {}\n", finished, options.file);
  }
}

}  // namespace

void add_paper_commands(CLI::App& contact) {
  auto trihedra = std::make_shared<TrihedraArguments>();
  CLI::App* command = contact.add_subcommand("trihedra", "Draw the paper's data: touching trihedra of two cubes");
  add_data_options(*command, trihedra->reading, trihedra->subset);
  command->add_option("--poses", trihedra->poses, "How many to keep")
      ->check(CLI::Range(1, 100000000))
      ->capture_default_str();
  command->add_option("--seed", trihedra->seed, "Of the random draws")->capture_default_str();
  command->add_option("--out,-o", trihedra->out, "CSV file to write; without it only the counts are printed");
  command->footer("Example:\n  quayside contact trihedra --reading unfiltered -o patterns.csv");
  command->callback([trihedra] { run_trihedra(*trihedra); });

  auto evaluate = std::make_shared<EvaluateArguments>();
  command = contact.add_subcommand("evaluate",
                                   "Make the paper's tables 1 and 2 and figures 5 and 6 again, and two more tables");
  command
      ->add_option("--table", evaluate->tables,
                   "Which: 1, 2, targets (continuous targets), experts (one per feature pair)")
      ->check(CLI::IsMember(table_names));
  command->add_option("--starts", evaluate->options.starts, "Networks per row; the best on the validation set is shown")
      ->check(CLI::Range(1, 10000))->capture_default_str();
  command->add_option("--scale", evaluate->options.scale, "Of the sizes of all sets: 0.1 for a quick look")
      ->check(CLI::Range(0.001, 100.0))->capture_default_str();
  command->add_option("--seed", evaluate->options.seed, "Of data, initial weights and order")->capture_default_str();
  command->add_option("--out,-o", evaluate->out, "Folder for tables.csv, figures (CSV, SVG) and networks (ONNX)");
  command->footer("Example:\n  quayside contact evaluate --table 1 --table 2 -o paper_tables");
  command->callback([evaluate] { run_evaluate(*evaluate); });

  auto tuning = std::make_shared<TuneArguments>();
  tuning->options.file = "tuning.csv";
  command = contact.add_subcommand("tune", "Train thousands of networks with random constants, as the paper did");
  add_data_options(*command, tuning->reading, tuning->subset);
  command->add_option("--networks", tuning->options.networks, "How many in all")->check(CLI::Range(1, 10000000))
      ->capture_default_str();
  command->add_option("--threads", tuning->options.threads, "At a time; 0: one per core")->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->add_option("--epochs", tuning->options.epochs, "At most, per network")->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command
      ->add_option("--patience", tuning->options.patience, "Epochs without a better validation error before one stops")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command->add_option("--seed", tuning->options.seed, "Of the constants and initial weights")->capture_default_str();
  command->add_option("--out,-o", tuning->options.file, "CSV file to write, or to continue")->capture_default_str();
  command->footer("Ctrl-C stops; the same command continues where it stopped.\n\n"
                  "Example:\n  quayside contact tune --networks 2000 -o tuning.csv");
  command->callback([tuning] { run_tune(*tuning); });

  add_energy_command(contact);
}

}  // namespace quayside::contact_nn

#include "contact_nn/contact_command.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <stdexcept>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "contact_nn/check_command.h"
#include "contact_nn/gate_training.h"
#include "contact_nn/learned_potential_command.h"
#include "contact_nn/onnx_file.h"
#include "contact_nn/separating_axes.h"
#include "contact_nn/status_line.h"

namespace quayside::contact_nn {

namespace {

// How far a quaternion's length may be from 1 [1]: six printed digits are enough, a mistaken one is not.
constexpr double quaternion_tolerance = 1e-5;

const std::map<std::string, Law> law_names{{"potential", Law::potential}, {"points", Law::points}};
const std::map<std::string, Model> model_names{{"exact", Model::exact}, {"committee", Model::committee}};
const std::map<std::string, PoseDomain> domain_names = [] {
  std::map<std::string, PoseDomain> names;
  for (const PoseDomain domain : all_pose_domains()) names[name_of(domain)] = domain;
  return names;
}();

const char* name_of(ContactClass contact_class) {
  switch (contact_class) {
    case ContactClass::apart: return "apart";
    case ContactClass::face_a: return "face_a";
    case ContactClass::face_b: return "face_b";
    case ContactClass::edge_edge: return "edge_edge";
  }
  return "?";
}

// A row of a table of poses: text, then numbers.
struct Row {
  std::string id;
  std::vector<double> numbers;
  bool all_numbers = true;  // false for a header
};

Row parse_row(const std::string& line) {
  Row row;
  std::size_t begin = line.find(',');
  row.id = line.substr(0, begin);
  while (begin != std::string::npos) {
    const char* text = line.c_str() + begin + 1;
    char* end = nullptr;
    row.numbers.push_back(std::strtod(text, &end));
    while (*end == ' ' || *end == '\t' || *end == '\r') ++end;
    row.all_numbers &= end != text && (*end == ',' || *end == '\0');
    begin = line.find(',', begin + 1);
  }
  return row;
}

BoxPair pair_of(const std::vector<double>& x, const std::string& where) {
  const auto demand = [&](bool good, const std::string& message) {
    if (!good) throw std::invalid_argument(fmt::format("{}: {}", where, message));
  };
  demand(x.size() == 13, fmt::format("{} numbers after the id, but 13 are needed: ax,ay,az, bx,by,bz, px,py,pz, "
                                     "qw,qx,qy,qz", x.size()));
  demand(std::all_of(x.begin(), x.end(), [](double v) { return std::isfinite(v); }), "every number must be finite");
  demand(*std::min_element(x.begin(), x.begin() + 6) > 0, "half extents must be positive");
  BoxPair pair{{{x[0], x[1], x[2]}}, {{x[3], x[4], x[5]}}, Pose::Identity()};
  pair.X_AB.translation() = Eigen::Vector3d(x[6], x[7], x[8]);
  const Eigen::Quaterniond q(x[9], x[10], x[11], x[12]);
  demand(std::abs(q.norm() - 1) <= quaternion_tolerance,
         fmt::format("the quaternion has length {:.9g} instead of 1", q.norm()));
  pair.X_AB.linear() = q.normalized().toRotationMatrix();
  return pair;
}

// ---- dataset

struct DatasetArguments {
  std::string domain = "landing", out;
  std::size_t pairs = 10000;
  std::uint64_t seed = 1;
  GapRange gaps{0.05, 0.05};
};

void run_dataset(const DatasetArguments& arguments) {
  const auto pairs =
      sample_pairs(arguments.pairs, {domain_names.at(arguments.domain)}, arguments.gaps, arguments.seed);
  std::ofstream out(arguments.out);
  write_pairs(pairs, out);
  out.close();
  if (!out) throw std::runtime_error(fmt::format("{} cannot be written: does its folder exist?", arguments.out));

  ContactSettings settings;
  settings.model = Model::exact;
  const auto exact = make_contact_module(settings);
  std::map<std::string, std::size_t> classes;
  std::size_t touching = 0;
  ContactCounters counters;
  for (const BoxPair& pair : pairs) {
    ++classes[name_of(exact->query(pair.a, pair.b, pair.X_AB, counters, arguments.gaps.farthest).contact_class)];
    touching += !surely_apart(pair.a, pair.b, pair.X_AB);
  }
  const double share = 100.0 / static_cast<double>(pairs.size());
  fmt::print("{} pairs, {:.2f} % touching, written to {}\n", pairs.size(), share * static_cast<double>(touching),
             arguments.out);
  for (const auto& [name, count] : classes) fmt::print("  {:<10} {:6.2f} %\n", name, share * static_cast<double>(count));
}

// ---- train

struct TrainArguments {
  std::string gate = "potential", out;
  GateTrainingOptions options;
};

void run_train(TrainArguments arguments) {
  arguments.options.law = law_names.at(arguments.gate);
  const auto start = std::chrono::steady_clock::now();
  NetworkFile file;
  {
    StatusLine progress;
    progress.show("drawing and labelling pairs ...");
    arguments.options.progress = [&](int epoch, double training, double validation) {
      progress.show(fmt::format("epoch {} of {}   loss: training {:.5f}, validation {:.5f}", epoch,
                                arguments.options.epochs, training, validation));
    };
    file = train_gate(arguments.options);
  }
  write_network(arguments.out, file);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  fmt::print("{}  {}, {}, made in {:.0f} s\n", arguments.out, file.interface, file.network.architecture(), seconds);
  for (const auto& [key, text] : file.how_made) fmt::print("  {:<18} {}\n", key, text);
}

// ---- query

struct QueryArguments {
  std::string poses, model = "committee", out;
  double margin = 0;
};

void run_query(const QueryArguments& arguments) {
  ContactSettings settings;
  settings.model = model_names.at(arguments.model);
  const auto module = make_contact_module(settings);

  std::ifstream file;
  if (arguments.poses != "-") {
    file.open(arguments.poses);
    if (!file) throw std::invalid_argument(fmt::format("{} cannot be read", arguments.poses));
  }
  std::istream& poses = arguments.poses == "-" ? std::cin : file;
  if (arguments.out.empty()) {
    answer_queries(poses, arguments.poses, *module, arguments.margin, std::cout);
    return;
  }
  std::ofstream out(arguments.out);
  answer_queries(poses, arguments.poses, *module, arguments.margin, out);
  out.close();
  if (!out) throw std::runtime_error(fmt::format("{} cannot be written: does its folder exist?", arguments.out));
}

// ---- bench

struct BenchArguments {
  std::size_t pairs = 2000;
  std::string network;
  std::string law = "potential";
};

// Time per call of the fastest of several rounds over all pairs, so that other work on the machine counts least [ns].
template <class Call>
double nanoseconds(const std::vector<BoxPair>& pairs, Call call) {
  constexpr int rounds = 15;
  double best = std::numeric_limits<double>::infinity(), sum = 0;
  for (int round = 0; round < rounds; ++round) {
    const auto start = std::chrono::steady_clock::now();
    for (const BoxPair& pair : pairs) sum += call(pair);
    best = std::min(best, std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count());
  }
  volatile double sink = sum;  // the compiler must not drop what nobody reads
  (void)sink;
  return best / static_cast<double>(pairs.size());
}

void run_bench(const BenchArguments& arguments) {
  ContactSettings settings;
  settings.law = law_names.at(arguments.law);
  settings.model = Model::exact;
  const auto exact = make_contact_module(settings);
  settings.model = Model::committee;
  settings.network = arguments.network;
  const auto committee = make_contact_module(settings);
  RelativeVelocity V;
  V.v_A = Eigen::Vector3d(0.01, 0, -0.1);

  fmt::print("law {}, touching pairs, ns per call (fastest of 15 rounds over {} pairs)\n\n", arguments.law,
             arguments.pairs);
  fmt::print("{:<10}{:>14}{:>14}{:>14}{:>12}{:>12}\n", "poses", "exact force", "committee", "query", "fallbacks",
             "different");
  for (const PoseDomain domain : all_pose_domains()) {
    const auto pairs = sample_pairs(arguments.pairs, {domain}, GapRange{}, 1);
    ContactCounters counters;
    std::size_t different = 0;
    for (const BoxPair& pair : pairs) {
      ContactCounters ignored;
      const ContactForce x = exact->force(pair.a, pair.b, pair.X_AB, V, ignored);
      const ContactForce y = committee->force(pair.a, pair.b, pair.X_AB, V, counters);
      different += x.f_A != y.f_A || x.t_A != y.t_A;
    }
    const double fallbacks = static_cast<double>(counters.fallbacks) / static_cast<double>(counters.queries);
    const auto force = [&](const ContactModule& module) {
      return nanoseconds(
          pairs, [&](const BoxPair& pair) { return module.force(pair.a, pair.b, pair.X_AB, V, counters).f_A[2]; });
    };
    const double query = nanoseconds(
        pairs, [&](const BoxPair& pair) { return exact->query(pair.a, pair.b, pair.X_AB, counters).gap; });
    fmt::print("{:<10}{:>14.0f}{:>14.0f}{:>14.0f}{:>11.2f}%{:>12}\n", name_of(domain), force(*exact), force(*committee),
               query, 100 * fallbacks, different);
  }
}

template <class Value>
std::vector<std::string> names_in(const std::map<std::string, Value>& names) {
  std::vector<std::string> list;
  for (const auto& entry : names) list.push_back(entry.first);
  return list;
}

}  // namespace

void write_pairs(const std::vector<BoxPair>& pairs, std::ostream& out) {
  out << "id,ax,ay,az,bx,by,bz,px,py,pz,qw,qx,qy,qz\n";
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const BoxPair& x = pairs[i];
    const Eigen::Vector3d p = x.X_AB.translation();
    const Eigen::Quaterniond q(x.X_AB.linear());
    out << fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", i, x.a.half[0], x.a.half[1], x.a.half[2],
                       x.b.half[0], x.b.half[1], x.b.half[2], p[0], p[1], p[2], q.w(), q.x(), q.y(), q.z());
  }
}

void answer_queries(std::istream& poses, const std::string& name, const ContactModule& module, double margin,
                    std::ostream& answers) {
  answers << "id,gap,nx,ny,nz,class,n,then n times px,py,pz,depth\n";
  ContactCounters counters;
  std::string line;
  for (std::size_t number = 1; std::getline(poses, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    const Row row = parse_row(line);
    const std::string where = fmt::format("{}:{}", name, number);
    if (!row.all_numbers) {
      if (number == 1) continue;  // a header
      throw std::invalid_argument(where + ": every field after the id must be a number");
    }
    const BoxPair pair = pair_of(row.numbers, where);
    const Manifold m = module.query(pair.a, pair.b, pair.X_AB, counters, margin);
    std::string text = fmt::format("{},{},{},{},{},{},{}", row.id, m.gap, m.n_A[0], m.n_A[1], m.n_A[2],
                                   name_of(m.contact_class), m.count);
    for (int i = 0; i < m.count; ++i) {
      const ManifoldPoint& point = m.points[static_cast<std::size_t>(i)];
      text += fmt::format(",{},{},{},{}", point.p_A[0], point.p_A[1], point.p_A[2], point.depth);
    }
    answers << text << '\n';
  }
}

void add_contact_commands(CLI::App& app) {
  CLI::App* contact = app.add_subcommand("contact", "The contact module by itself: data, training, queries, speed");
  contact->require_subcommand(1);
  contact->footer(
      "Examples:\n"
      "  quayside contact query poses.csv --margin 0.01      where do boxes of my own touch?\n"
      "  quayside contact train --gate potential --out g.onnx\n"
      "  quayside contact bench                              committee against exact");

  auto dataset = std::make_shared<DatasetArguments>();
  CLI::App* command = contact->add_subcommand("dataset", "Draw pairs of boxes in a shell of gaps around contact");
  command->add_option("--domain", dataset->domain, "What the poses are like")
      ->check(CLI::IsMember(names_in(domain_names)))->capture_default_str();
  command->add_option("--pairs", dataset->pairs, "How many")->check(CLI::Range(1, 100000000))->capture_default_str();
  command->add_option("--seed", dataset->seed, "Of the random draws")->capture_default_str();
  command->add_option("--deepest", dataset->gaps.deepest, "Deepest overlap [m]")->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--farthest", dataset->gaps.farthest, "Widest gap [m]; 0: only touching pairs")
      ->check(CLI::NonNegativeNumber)->capture_default_str();
  command->add_option("--out,-o", dataset->out, "CSV file to write, as 'query' reads it")->required();
  command->footer("Example:\n  quayside contact dataset --domain landing --pairs 100000 -o poses.csv");
  command->callback([dataset] { run_dataset(*dataset); });

  auto train = std::make_shared<TrainArguments>();
  command = contact->add_subcommand("train", "Make a gate network from a seed");
  command->add_option("--gate", train->gate, "For which law")->check(CLI::IsMember(names_in(law_names)))
      ->capture_default_str();
  command->add_option("--seed", train->options.seed, "Of data, initial weights and shuffling")->capture_default_str();
  command->add_option("--pairs", train->options.pairs, "Pairs to learn from")->check(CLI::Range(100, 100000000))
      ->capture_default_str();
  command->add_option("--epochs", train->options.epochs, "At most; 0: random weights, to see that answers stay right")
      ->check(CLI::Range(0, 100000))->capture_default_str();
  command->add_option("--out,-o", train->out, "ONNX file to write")->required();
  command->footer(
      "The networks that ship are made by\n"
      "  quayside contact train --gate potential --out contact_nn/networks/gate_potential.onnx\n"
      "  quayside contact train --gate points --out contact_nn/networks/gate_points.onnx");
  command->callback([train] { run_train(*train); });

  auto query = std::make_shared<QueryArguments>();
  command = contact->add_subcommand("query", "Where do two boxes touch? For a table of poses");
  command->add_option("poses", query->poses, "CSV file, '-' for standard input")->required()->type_name("POSES.csv");
  command->add_option("--model", query->model, "Who answers; both give the same")->check(CLI::IsMember(names_in(model_names)))
      ->capture_default_str();
  command->add_option("--margin", query->margin, "Give points for gaps up to this [m]")->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--out,-o", query->out, "File to write; standard output by default");
  command->footer(
      "Rows in:  id, ax,ay,az (half extents of A), bx,by,bz (of B), px,py,pz (centre of B in A), qw,qx,qy,qz\n"
      "Rows out: id, gap, nx,ny,nz, class, n, then n times px,py,pz,depth\n"
      "Gap is the largest separation over the 15 axes, negative when the boxes overlap; the normal points from A to B;\n"
      "points lie halfway between the surfaces; everything is in A's frame, in metres.\n\n"
      "Examples:\n"
      "  quayside contact query poses.csv\n"
      "  echo '1, 1,1,1, 1,1,1, 0,0,1.99, 1,0,0,0' | quayside contact query -");
  command->callback([query] { run_query(*query); });

  auto bench = std::make_shared<BenchArguments>();
  command = contact->add_subcommand("bench", "Time per call and fallbacks of the committee beside exact");
  command->add_option("--law", bench->law, "Whose force")->check(CLI::IsMember(names_in(law_names)))
      ->capture_default_str();
  command->add_option("--pairs", bench->pairs, "Pairs per kind of pose")->check(CLI::Range(10, 10000000))
      ->capture_default_str();
  command->add_option("--network", bench->network, "Gate of the committee (ONNX); the one that ships by default");
  command->footer("Example:\n  quayside contact bench --law points");
  command->callback([bench] { run_bench(*bench); });

  add_check_command(*contact);
  add_learned_commands(*contact);
}

}  // namespace quayside::contact_nn

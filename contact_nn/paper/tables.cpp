#include "contact_nn/paper/tables.h"

#include <algorithm>
#include <chrono>
#include <ostream>

#include <fmt/format.h>

namespace quayside::contact_nn::paper {

namespace {

struct Contender {
  std::string name;
  Recipe recipe;
};

Recipe with(const TableOptions& options, Recipe recipe, const std::vector<int>& hidden) {
  recipe.hidden = hidden;
  recipe.seed = options.seed;
  if (options.epochs > 0) recipe.epochs = options.epochs;
  return recipe;
}

// The paper's training, the two later methods, and what is best here for the absolute error.
std::vector<Contender> contenders(const TableOptions& options, const std::vector<int>& hidden) {
  std::vector<Contender> all;
  for (const Method method : {Method::momentum, Method::adam, Method::levenberg_marquardt}) {
    all.push_back({name_of(method), with(options, recipe_for(method), hidden)});
  }
  all.push_back({"adam, absolute error", all[1].recipe});
  all.back().recipe.cost = Cost::absolute;
  return all;
}

std::size_t scaled(std::size_t size, double scale) {
  return std::max<std::size_t>(10, static_cast<std::size_t>(static_cast<double>(size) * scale));
}

Sizes scaled(const Sizes& sizes, double scale) {
  return {scaled(sizes.training, scale), scaled(sizes.validation, scale), scaled(sizes.external, scale)};
}

TableRow paper_row(const std::string& network, const OutputErrors& training, const OutputErrors& validation,
                   const OutputErrors& external) {
  TableRow row{"paper", network, {}, false};
  row.errors.training = training;
  row.errors.validation = validation;
  row.errors.external = external;
  return row;
}

TableRow row_of(const std::string& data, const std::string& name, const Outcome& outcome) {
  return {data, name, outcome.errors, true, outcome.trained.epochs, outcome.seconds};
}

Prediction prediction(const Network& network, const Samples& external) {
  const Eigen::Index count = std::min<Eigen::Index>(100, external.size());
  const Eigen::MatrixXd outputs = network(external.inputs.leftCols(count).cast<double>());
  Prediction p;
  for (Eigen::Index i = 0; i < count; ++i) {
    p.desired.push_back(static_cast<double>(external.targets(0, i)));
    p.predicted.push_back(outputs(0, i));
  }
  p.network = network;
  return p;
}

void note(Table& table, const std::string& data, const DrawCounts& counts, const Subset& subset = {}) {
  for (const std::string& line : describe(counts)) {
    table.notes.push_back(data + ": " + line);
    if (subset.kind == Subset::Kind::pair) break;  // all counts in one class
  }
}

const char* name_of(Reading reading) { return reading == Reading::valid ? "valid" : "unfiltered"; }

}  // namespace

std::vector<std::string> describe(const DrawCounts& counts) {
  const double draws = static_cast<double>(counts.draws);
  const std::uint64_t kept = counts.vertices() + counts.edges();
  std::vector<std::string> lines{fmt::format(
      "{} draws, {:.1f} % overlap, {:.1f} % kept: {} vertex on face, {} edge on edge", counts.draws,
      100 * static_cast<double>(counts.overlapping) / draws, 100 * static_cast<double>(kept) / draws, counts.vertices(),
      counts.edges())};
  if (counts.vertices() > 0) {
    std::string text = "vertices of B on A's faces";
    for (int face = 0; face < kFaces; ++face) {
      std::uint64_t sum = 0;
      for (auto n : counts.vertex_on_face[face]) sum += n;
      text += fmt::format("{} {} = +1: {}", face == 0 ? "" : ",", "xyz"[face], sum);
    }
    lines.push_back(text);
  }
  if (counts.edges() > 0) {
    std::array<std::uint64_t, 2> along{};  // parts of A's edges at the corner, and the outer ones
    for (int a = 0; a < kEdges; ++a) {
      for (auto n : counts.edge_on_edge[a]) along[a % 3 == 0 ? 0 : 1] += n;
    }
    lines.push_back(
        fmt::format("edges of B on A's three edges at the corner: {}, on its six outer edges: {}", along[0], along[1]));
  }
  return lines;
}

Table table1(const TableOptions& options, Prediction& figure5) {
  Table table{"Table 1: 6x20x18x4, with discontinuities", {}, {}};
  table.rows.push_back(
      paper_row("6x20x18x4", {0.0332, 0.4161, 0.6947}, {0.0259, 0.4383, 0.7363}, {-0.0005, 0.5624, 0.8667}));
  for (const Reading reading : {Reading::valid, Reading::unfiltered}) {
    Problem problem;
    problem.reading = reading;
    problem.sizes = scaled(kTable1Sizes, options.scale);
    problem.seed = options.seed;
    const std::string name = name_of(reading);
    options.progress("table 1, " + name + ": drawing");
    const Poses poses = draw(problem);
    const Data data = data_of(poses, problem.coding);
    note(table, name, poses.counts);
    table.rows.push_back({name, "constant", errors_of_constant(data, Encoding::angles)});
    for (const Contender& contender : contenders(options, {20, 18})) {
      options.progress("table 1, " + name + ": " + contender.name);
      const Outcome outcome = best_of(options.starts, data, Encoding::angles, contender.recipe);
      table.rows.push_back(row_of(name, contender.name, outcome));
      if (reading == Reading::valid && contender.recipe.method == Method::momentum) {
        figure5 = prediction(outcome.trained.network, data.external);
      }
    }
  }
  return table;
}

Table table2(const TableOptions& options, Prediction& figure6) {
  Table table{"Table 2: 6x20x17x4, subsets without discontinuities (and the octant), valid poses", {}, {}};
  table.rows.push_back(
      paper_row("6x20x17x4", {-0.0008, 0.2765, 0.5410}, {0.0031, 0.2883, 0.5748}, {0.0467, 0.4523, 0.7302}));
  Subset octant;
  octant.kind = Subset::Kind::octant;
  const std::vector<Subset> subsets{Subset::pair(Touch::vertex_on_face, 0, 0),
                                    Subset::pair(Touch::vertex_on_face, 2, 0), Subset::pair(Touch::edge_on_edge, 0, 3),
                                    octant};
  for (const Subset& subset : subsets) {
    Problem problem;
    problem.subset = subset;
    problem.sizes = scaled(kTable2Sizes, options.scale);
    problem.seed = options.seed;
    const std::string name = describe(subset);
    options.progress("table 2, " + name + ": drawing");
    const Poses poses = draw(problem);
    const Data data = data_of(poses, problem.coding);
    note(table, name, poses.counts, subset);
    table.rows.push_back({name, "constant", errors_of_constant(data, Encoding::angles)});
    for (const Contender& contender : contenders(options, {20, 17})) {
      options.progress("table 2, " + name + ": " + contender.name);
      const Outcome outcome = best_of(options.starts, data, Encoding::angles, contender.recipe);
      table.rows.push_back(row_of(name, contender.name, outcome));
      if (&subset == &subsets.front() && contender.recipe.method == Method::momentum) {
        figure6 = prediction(outcome.trained.network, data.external);
      }
    }
  }
  return table;
}

Table target_table(const TableOptions& options) {
  Table table{"Continuous targets: 6x20x18x4 (6 outputs for vectors), valid poses, all features", {}, {}};
  Problem problem;
  problem.sizes = scaled(kTable1Sizes, options.scale);
  problem.seed = options.seed;
  options.progress("targets: drawing");
  const Poses poses = draw(problem);
  note(table, "valid", poses.counts);
  const Recipe recipe = with(options, recipe_for(Method::momentum), {20, 18});
  const auto add = [&](const std::string& what, const Coding& coding) {
    const char* encodings[] = {"angles", "turned angles", "vectors"};
    const std::string name = fmt::format("{}, {}", what, encodings[static_cast<int>(coding.encoding)]);
    options.progress("targets: " + name);
    const Data data = data_of(poses, coding);
    table.rows.push_back({name, "constant", errors_of_constant(data, coding.encoding)});
    table.rows.push_back(row_of(name, name_of(recipe.method), best_of(options.starts, data, coding.encoding, recipe)));
  };
  const Encoding encodings[] = {Encoding::angles, Encoding::turned, Encoding::vectors};
  for (const Encoding encoding : encodings) add("vertex", {Target::vertex, encoding, 0});
  for (const double depth : {0.001, 0.01, 0.1}) {  // in edges
    for (const Encoding encoding : encodings) {
      add(fmt::format("pressure at {} edges", depth), {Target::pressure, encoding, depth * kEdge});
    }
  }
  return table;
}

Table experts_table(const TableOptions& options) {
  Table table{"Experts: one 6x20x17x4 per pair of features that occurs, the pair being known; valid poses", {}, {}};
  Problem whole;
  whole.sizes = scaled(kTable1Sizes, options.scale);
  whole.seed = options.seed;
  const Poses poses = draw(whole);
  note(table, "valid", poses.counts);

  const auto begin = std::chrono::steady_clock::now();
  Eigen::MatrixXd outputs(4, static_cast<Eigen::Index>(poses.external.size())), targets = outputs;
  Eigen::Index answered = 0;
  int experts = 0;
  Recipe recipe = with(options, recipe_for(Method::adam), {20, 17});
  recipe.cost = Cost::absolute;
  recipe.epochs = std::min(recipe.epochs, 300);
  for (const Touch touch : {Touch::vertex_on_face, Touch::edge_on_edge}) {
    const int of_a = touch == Touch::vertex_on_face ? kFaces : kEdges,
              of_b = touch == Touch::vertex_on_face ? kVertices : kEdges;
    for (int a = 0; a < of_a; ++a) {
      for (int b = 0; b < of_b; ++b) {
        std::vector<TouchingPose> share;
        for (const TouchingPose& pose : poses.external) {
          if (pose.touch == touch && pose.of_a == a && pose.of_b == b) share.push_back(pose);
        }
        if (share.empty()) continue;
        Problem problem;
        problem.subset = Subset::pair(touch, a, b);
        problem.sizes = {scaled(2000, options.scale), scaled(1000, options.scale), 0};
        problem.seed = options.seed + 1;
        options.progress(fmt::format("experts: {}", describe(problem.subset)));
        const Poses own = draw(problem);
        const Trained trained = train(patterns(own.training, {}), patterns(own.validation, {}), recipe);
        const Samples asked = patterns(share, {});
        outputs.middleCols(answered, asked.size()) = trained.network(asked.inputs.cast<double>());
        targets.middleCols(answered, asked.size()) = asked.targets.cast<double>();
        answered += asked.size();
        ++experts;
      }
    }
  }
  TableRow row{"external set of table 1", fmt::format("{} experts, adam, absolute error", experts), {}};
  row.errors.external = output_errors(outputs, targets);
  row.errors.physical = physical_errors(outputs, targets, Encoding::angles);
  row.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  table.rows.push_back(row);
  table.notes.push_back("each expert learned from 2,000 patterns of its pair and stopped on 1,000; training and "
                        "validation errors are not pooled");
  return table;
}

void print(const Table& table, std::ostream& out) {
  out << "### " << table.title << "\n\n"
      << "| data | network | training ME / MAE / RMSE | validation | external | impact point [edges] mean / p95 / p99 "
         "| "
         "force [deg] mean / p95 / p99 | epochs, s |\n|---|---|---|---|---|---|---|---|\n";
  const auto three = [](const OutputErrors& e) {
    return e.square == 0 ? std::string("–") : fmt::format("{:.4f} / {:.4f} / {:.4f}", e.mean, e.absolute, e.square);
  };
  for (const TableRow& row : table.rows) {
    const PhysicalErrors& p = row.errors.physical;
    out << fmt::format(
        "| {} | {} | {} | {} | {} | {} | {} | {} |\n", row.data, row.network, three(row.errors.training),
        three(row.errors.validation), three(row.errors.external),
        row.physical ? fmt::format("{:.3f} / {:.3f} / {:.3f}", p.point.mean, p.point.p95, p.point.p99) : "–",
        row.physical ? fmt::format("{:.1f} / {:.1f} / {:.1f}", p.force.mean, p.force.p95, p.force.p99) : "–",
        row.epochs > 0    ? fmt::format("{}, {:.1f}", row.epochs, row.seconds)
        : row.seconds > 0 ? fmt::format("{:.1f}", row.seconds)
                          : "–");
  }
  out << '\n';
  for (const std::string& line : table.notes) out << "- " << line << '\n';
  out << '\n';
}

void write_csv(const std::vector<Table>& tables, std::ostream& out) {
  out << "table,data,network";
  for (const char* set : {"training", "validation", "external"}) out << fmt::format(",{0} ME,{0} MAE,{0} RMSE", set);
  out << ",point mean [edges],point p95 [edges],point p99 [edges],force mean [deg],force p95 [deg],force p99 "
         "[deg],epochs,"
         "training [s]\n";
  for (const Table& table : tables) {
    for (const TableRow& row : table.rows) {
      out << fmt::format("\"{}\",\"{}\",\"{}\"", table.title, row.data, row.network);
      for (const OutputErrors* e : {&row.errors.training, &row.errors.validation, &row.errors.external}) {
        out << fmt::format(",{:.6g},{:.6g},{:.6g}", e->mean, e->absolute, e->square);
      }
      for (const Spread* s : {&row.errors.physical.point, &row.errors.physical.force}) {
        out << (row.physical ? fmt::format(",{:.6g},{:.6g},{:.6g}", s->mean, s->p95, s->p99) : ",,,");
      }
      out << fmt::format(",{},{:.2f}\n", row.epochs, row.seconds);
    }
  }
}

}  // namespace quayside::contact_nn::paper

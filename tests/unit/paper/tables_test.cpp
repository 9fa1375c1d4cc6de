#include "contact_nn/paper/tables.h"

#include <algorithm>
#include <sstream>

#include <gtest/gtest.h>

#include "contact_nn/paper/figure.h"

namespace quayside::contact_nn::paper {
namespace {

// A hundredth of the paper's sizes and a few epochs: enough to see that every row is there and that networks, even
// these, learn something.
TableOptions quick() {
  TableOptions options;
  options.scale = 0.01;
  options.starts = 1;
  options.epochs = 40;
  return options;
}

const TableRow& row(const Table& table, const std::string& data, const std::string& network) {
  const auto it = std::find_if(table.rows.begin(), table.rows.end(),
                               [&](const TableRow& r) { return r.data == data && r.network == network; });
  if (it == table.rows.end()) throw std::runtime_error("no row " + data + ", " + network);
  return *it;
}

TEST(Tables, Table1HasThePaperAConstantAndFourTrainingsPerReading) {
  Prediction figure;
  const Table table = table1(quick(), figure);
  EXPECT_EQ(table.rows.size(), 11u);
  EXPECT_EQ(table.rows[0].errors.external.absolute, 0.5624);  // as printed in the paper
  for (const std::string reading : {"valid", "unfiltered"}) {
    const double constant = row(table, reading, "constant").errors.external.absolute;
    for (const std::string network : {"momentum", "adam", "lm", "adam, absolute error"}) {
      EXPECT_LT(row(table, reading, network).errors.external.absolute, constant) << reading << ", " << network;
    }
  }
  EXPECT_EQ(figure.desired.size(), 100u);
  EXPECT_EQ(figure.network.architecture(), "6x20x18x4 tanh");
}

TEST(Tables, Table2SaysWhichSubsetsItTakes) {
  Prediction figure;
  const Table table = table2(quick(), figure);
  EXPECT_EQ(table.rows.size(), 21u);
  EXPECT_EQ(figure.network.architecture(), "6x20x17x4 tanh");
  const TableRow& face = row(table, "B's vertex (-1, -1, -1) on A's face x = +1", "lm");
  EXPECT_LT(face.errors.physical.force.mean, 1);  // the force of this subset is constant
}

TEST(Tables, TargetsComeInEveryEncoding) {
  const Table table = target_table(quick());
  EXPECT_EQ(table.rows.size(), 24u);
  const auto error = [&](const std::string& data) { return row(table, data, "momentum").errors.physical.point.mean; };
  EXPECT_GT(error("vertex, angles"), 0);
  EXPECT_GT(error("pressure at 0.1 edges, vectors"), 0);
}

// Each expert knows its pair of features, so that together they are far better than one network for all.
TEST(Tables, ExpertsBeatOneNetwork) {
  TableOptions options = quick();
  options.epochs = 100;
  Prediction figure;
  const double one = row(table1(options, figure), "valid", "adam, absolute error").errors.external.absolute;
  EXPECT_LT(experts_table(options).rows.front().errors.external.absolute, one);
}

TEST(Tables, CsvHasAFieldForEveryColumnInEveryRow) {
  Prediction figure;
  TableOptions options = quick();
  options.epochs = 1;
  std::ostringstream csv;
  write_csv({table1(options, figure)}, csv);
  std::istringstream lines(csv.str());
  int rows = 0;
  for (std::string line; std::getline(lines, line); ++rows) {
    bool quoted = false;
    int fields = 1;
    for (char c : line) {
      if (c == '"') quoted = !quoted;
      fields += c == ',' && !quoted;
    }
    EXPECT_EQ(fields, 20) << line;
  }
  EXPECT_EQ(rows, 12);
}

TEST(Figure, HasADotPerPattern) {
  const std::string svg = prediction_svg("title", "y", {0, 1, 0.5}, {0.1, 0.9, 3});
  int dots = 0;
  for (std::size_t at = svg.find("<circle"); at != std::string::npos; at = svg.find("<circle", at + 1)) ++dots;
  EXPECT_EQ(dots, 3);
  EXPECT_THROW(prediction_svg("title", "y", {0, 1}, {0}), std::invalid_argument);
}

}  // namespace
}  // namespace quayside::contact_nn::paper

// The paper's tables 1 and 2 made again, and two more: the same network on continuous targets, and one network for each
// pair of touching features.
#pragma once

#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

#include "contact_nn/paper/experiment.h"

namespace quayside::contact_nn::paper {

// A row: errors of one network, of a constant, or as printed in the paper (which has no errors in space).
struct TableRow {
  std::string data;     // reading, subset, coding
  std::string network;  // who answers
  Errors errors;
  bool physical = true;
  int epochs = 0;       // of the best start; 0: nothing was trained
  double seconds = 0;
};

struct Table {
  std::string title;
  std::vector<TableRow> rows;
  std::vector<std::string> notes;  // fractions kept, class counts
};

struct TableOptions {
  std::uint64_t seed = 1;  // of data; initial weights count up from it
  int starts = 3;          // per network: the best on the validation set is shown
  double scale = 1;        // of the sizes of all sets: below 1 for a quick look
  int epochs = 0;          // at most; 0: what the methods need

  // Told what is being done.
  std::function<void(const std::string&)> progress = [](const std::string&) {};
};

// What is drawn in the figures.
struct Prediction {
  std::vector<double> desired, predicted;  // first output, first 100 external patterns [rad]
  Network network;
};

// Table 1: 6x20x18x4, all features, both readings.
Table table1(const TableOptions& options, Prediction& figure5);

// Table 2: 6x20x17x4, valid poses, subsets without discontinuities, and the octant of Euler angles.
Table table2(const TableOptions& options, Prediction& figure6);

// The same network and sizes as in table 1 on targets with and without discontinuities.
Table target_table(const TableOptions& options);

// The external set of table 1 answered by one 6x20x17x4 network for each pair of touching features, the pair being
// known.
Table experts_table(const TableOptions& options);

void print(const Table& table, std::ostream& out);                     // Markdown
void write_csv(const std::vector<Table>& tables, std::ostream& out);

std::vector<std::string> describe(const DrawCounts& counts);

}  // namespace quayside::contact_nn::paper

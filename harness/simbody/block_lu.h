// Linear equations of many bodies of which few touch: LU factors by blocks, skipping those that are zero.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace quayside::harness {

// Rows are exchanged within a block only: what couples a block to itself has to be invertible, as it is in I − γ J where
// a body's own motion dominates.
class BlockLu {
 public:
  // Which rows and columns belong together; every one of 0 to size − 1 once. No block: all are one.
  BlockLu(int size, std::vector<std::vector<int>> blocks);

  // `matrix`: size × size, column after column. False where a block cannot be inverted. Allocates nothing.
  bool factor(const double* matrix);
  // In place, after `factor`.
  void solve(double* b);

 private:
  auto block(int i, int j) { return lu_.block(begin_[i], begin_[j], begin_[i + 1] - begin_[i], begin_[j + 1] - begin_[j]); }
  bool factor_diagonal(int k);

  int count_;                   // of blocks
  std::vector<int> order_;      // row in the caller's matrix of each row of `lu_`
  std::vector<int> begin_;      // of each block in `lu_`, and the end
  std::vector<char> filled_;    // blocks × blocks: not zero
  std::vector<int> pivots_;     // row exchanged with each row
  Eigen::MatrixXd lu_;
  Eigen::VectorXd b_;
};

}  // namespace quayside::harness

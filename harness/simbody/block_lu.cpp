#include "harness/simbody/block_lu.h"

#include <cassert>
#include <cmath>
#include <numeric>
#include <utility>

namespace quayside::harness {

BlockLu::BlockLu(int size, std::vector<std::vector<int>> blocks) : pivots_(size), lu_(size, size), b_(size) {
  if (blocks.empty()) {
    blocks.emplace_back(size);
    std::iota(blocks.front().begin(), blocks.front().end(), 0);
  }
  count_ = static_cast<int>(blocks.size());
  filled_.resize(blocks.size() * blocks.size());
  for (const auto& members : blocks) {
    begin_.push_back(static_cast<int>(order_.size()));
    order_.insert(order_.end(), members.begin(), members.end());
  }
  begin_.push_back(size);
  assert(static_cast<int>(order_.size()) == size);
}

// With P D = L U for each block on the diagonal as it is when its turn comes: blocks to its right become L⁻¹ P A, blocks
// below A U⁻¹, and their products are taken from what is right of and below both.
bool BlockLu::factor(const double* matrix) {
  const int size = static_cast<int>(order_.size());
  for (int j = 0; j < count_; ++j) {
    for (int i = 0; i < count_; ++i) {
      double sum = 0;
      for (int column = begin_[j]; column < begin_[j + 1]; ++column) {
        const double* from = matrix + static_cast<std::size_t>(order_[column]) * size;
        for (int row = begin_[i]; row < begin_[i + 1]; ++row) sum += std::abs(lu_(row, column) = from[order_[row]]);
      }
      filled_[i * count_ + j] = sum != 0;
    }
  }
  for (int k = 0; k < count_; ++k) {
    if (!factor_diagonal(k)) return false;
    const auto diagonal = block(k, k);
    for (int j = k + 1; j < count_; ++j) {
      if (!filled_[k * count_ + j]) continue;
      auto right = block(k, j);
      for (int row = begin_[k]; row < begin_[k + 1]; ++row) {
        if (pivots_[row] != row) right.row(row - begin_[k]).swap(right.row(pivots_[row] - begin_[k]));
      }
      diagonal.triangularView<Eigen::UnitLower>().solveInPlace(right);
    }
    for (int i = k + 1; i < count_; ++i) {
      if (!filled_[i * count_ + k]) continue;
      auto below = block(i, k);
      diagonal.triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(below);
      for (int j = k + 1; j < count_; ++j) {
        if (!filled_[k * count_ + j]) continue;
        auto rest = block(i, j);
        rest -= below.lazyProduct(block(k, j));
        filled_[i * count_ + j] = true;
      }
    }
  }
  return true;
}

// Gauss's elimination with the largest pivot of each column.
bool BlockLu::factor_diagonal(int k) {
  auto d = block(k, k);
  const int n = static_cast<int>(d.rows());
  for (int c = 0; c < n; ++c) {
    int pivot = 0;
    const double largest = d.col(c).tail(n - c).cwiseAbs().maxCoeff(&pivot);
    if (!(largest > 0) || !std::isfinite(largest)) return false;
    pivot += c;
    pivots_[begin_[k] + c] = begin_[k] + pivot;
    if (pivot != c) d.row(c).swap(d.row(pivot));
    const int rest = n - c - 1;
    d.col(c).tail(rest) /= d(c, c);
    d.bottomRightCorner(rest, rest) -= d.col(c).tail(rest).lazyProduct(d.row(c).tail(rest));
  }
  return true;
}

void BlockLu::solve(double* b) {
  const auto part = [&](int k) { return b_.segment(begin_[k], begin_[k + 1] - begin_[k]); };
  for (std::size_t i = 0; i < order_.size(); ++i) b_[static_cast<int>(i)] = b[order_[i]];
  for (int k = 0; k < count_; ++k) {
    auto now = part(k);
    for (int j = 0; j < k; ++j) {
      if (filled_[k * count_ + j]) now -= block(k, j).lazyProduct(part(j));
    }
    for (int row = begin_[k]; row < begin_[k + 1]; ++row) std::swap(b_[row], b_[pivots_[row]]);
    block(k, k).triangularView<Eigen::UnitLower>().solveInPlace(now);
  }
  for (int k = count_ - 1; k >= 0; --k) {
    auto now = part(k);
    for (int j = k + 1; j < count_; ++j) {
      if (filled_[k * count_ + j]) now -= block(k, j).lazyProduct(part(j));
    }
    block(k, k).triangularView<Eigen::Upper>().solveInPlace(now);
  }
  for (std::size_t i = 0; i < order_.size(); ++i) b[order_[i]] = b_[static_cast<int>(i)];
}

}  // namespace quayside::harness

// The committee judged from outside, on random poses: are its contacts true, and how often is its gate right by itself?
//
// The truth is computed here in another way than in the module: along every candidate direction the boxes' extents are
// added up. The separation along any unit direction is a lower bound of the largest one, so the truth cannot be too
// large by rounding of the direction, only by that of a sum.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "contact_nn/contact.h"
#include "contact_nn/dataset.h"

namespace quayside::contact_nn {

struct EvaluationOptions {
  std::uint64_t poses = 1000000;  // over all six size pairs together, and as many again for the gate alone
  std::uint64_t seed = 1;
  unsigned threads = 0;  // 0: all cores. The figures do not depend on it.
  std::string network;   // gate of the law `points`; empty: the one that ships

  std::function<void(double done)> progress;  // from 0 to 1, called from one thread at a time
};

// Lengths count as equal within this times the boxes' size, the sum of their half diagonals [1].
inline constexpr double kEvaluationTolerance = 1e-9;

// The committee as deployed, on one pair of sizes: the geometry query, and the force of the law `potential`. Numbers of
// poses.
struct SizeVerdict {
  std::string name;
  std::uint64_t poses = 0, touching = 0;
  std::uint64_t phantom = 0;      // a contact or a force between boxes that are apart
  std::uint64_t missed = 0;       // none between boxes that overlap
  std::uint64_t deeper = 0;       // a point deeper than the truth
  std::uint64_t gap_off = 0;      // the gap is not the truth's
  std::uint64_t normal_off = 0;   // the normal is no unit vector, or the separation along it is not the gap
  std::uint64_t too_many = 0;     // more than 8 points
  std::uint64_t off_surface = 0;  // a point farther than half its depth from one of the boxes
  std::uint64_t force_off = 0;    // force or torque is not the exact law's
  std::uint64_t fallbacks = 0;    // forces for which the gate had missed something
  double worst_gap = 0;           // largest error, in units of the boxes' size

  std::uint64_t failures() const {
    return phantom + missed + deeper + gap_off + normal_off + too_many + off_surface + force_off;
  }
};

// Judges one answer to the geometry query, asked without margin, and counts what is wrong with it.
void judge(const BoxPair& pair, const Manifold& manifold, SizeVerdict& verdict);

// The first three axes that the gate names, without any check: how often is the depth off by more than a millimetre?
inline constexpr double kGateTolerance = 1e-3;  // [m]
struct GateVerdict {
  std::string name;
  std::uint64_t poses = 0, off = 0;
  double worst = 0;  // [m]
  double allowed;    // share that is aimed at

  double share() const { return poses == 0 ? 0 : static_cast<double>(off) / static_cast<double>(poses); }
};

struct Evaluation {
  std::vector<SizeVerdict> sizes;
  std::vector<GateVerdict> gate;

  std::uint64_t failures() const;  // of the committee
};

// Throws std::runtime_error for a network file that cannot be used.
Evaluation evaluate_committee(const EvaluationOptions& options);

}  // namespace quayside::contact_nn

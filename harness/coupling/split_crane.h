// A crane cut in three: drives that say where the trolley is wanted, the trolley with its motor, and ropes, spreader and load
// in Simbody. The trolley is not prescribed here but pushed by its motor and pulled by the ropes.
//
//   drives ──position, speed wanted──▶ trolley ──position, speed, acceleration──▶ load
//                                         ▲──────────── pull of the ropes ───────────┘
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "cases/case.h"
#include "harness/coupling/linear_unit.h"
#include "harness/drive_unit.h"
#include "harness/engine_unit.h"
#include "harness/master.h"

namespace quayside::harness {

// The trolley's motor pulls with p (speed wanted − speed) + i (position wanted − position).
struct TrolleyMotor {
  double mass = 40e3;  // trolley and what turns with it [kg]
  double p = 2e5;      // [N s/m]: a fifth of a second
  double i = 4e5;      // [N/m]
};

class SplitCrane {
 public:
  // Of a case with a quayside crane and no units of its own.
  SplitCrane(const cases::Case& description, const TrolleyMotor& motor, const MasterSettings& settings);
  ~SplitCrane();

  Master& master() { return master_; }
  double trolley_position() const;  // y [m]
  double load_position() const;     // y of the spreader, which the load is locked to [m]
  std::uint64_t evaluations() const { return load_->statistics().rhs_evaluations; }

 private:
  class RopePull;

  double value(const std::string& name) const;

  std::unique_ptr<EngineUnit> load_;
  std::unique_ptr<RopePull> pull_;
  std::unique_ptr<LinearUnit> trolley_;
  std::unique_ptr<DriveUnit> drives_;
  Master master_;
};

struct SplitPoint {
  std::string method;
  double step = 0, tolerance = 0;  // [s]; of the master, 0 where it has none
  double error = 0;                // the largest of both positions at whole fifths of a second [m]
  std::uint64_t evaluations = 0;   // of the load's dynamics
  double order = 0;                // from the point before, in the step; NaN: none
};

// The trolley runs up to 2 m/s and stops, with 30 t below it, for `duration` [s]. Against the iteration at `reference` [s]. Steps
// have to divide a fifth of a second.
std::vector<SplitPoint> split_crane_errors(const std::vector<double>& steps, const std::vector<double>& tolerances,
                                           double reference, double duration);

}  // namespace quayside::harness

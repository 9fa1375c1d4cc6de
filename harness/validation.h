// Two trajectories and their impacts held against tolerances: one row per signal and measure, and per event and measure.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "harness/compare.h"

namespace quayside::harness {

// How alike two runs are meant to be.
enum class Likeness {
  same_law,  // the same scene and laws, other integrators: Simbody against MuJoCo under our laws, or before and after
  native,    // another model of ropes and contacts: MuJoCo's own, or a measurement
};

struct ValidationRow {
  std::string subject;  // "load.position", "contact_broken load/upper at 4.182 s"
  std::string measure;  // of signals rms, max, end; of events time_shift, impulse, peak_force, missing
  double value = 0;     // events: the second less the first
  std::string unit;
  std::optional<double> tolerance;  // none where only a reader can judge
  std::string reason;               // of the tolerance
  bool within() const;              // also without a tolerance
};

std::vector<ValidationRow> validation_rows(Likeness likeness, const TrajectoryComparison& trajectory,
                                           const EventComparison& events);

// Lines of CSV: case,reference,engine,subject,measure,value,unit,tolerance,within,reason.
extern const char* const kValidationHeader;
std::string csv_text(const std::string& name, const std::string& reference, const std::string& engine,
                     const std::vector<ValidationRow>& rows);

// "118 of 120 within their tolerances; farthest out: ...".
std::string validation_text(const std::vector<ValidationRow>& rows);

}  // namespace quayside::harness

#include "harness/validation.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

namespace quayside::harness {
namespace {

// What a distance may be: the mean over the run, the largest, at the end.
struct SignalTolerance {
  double rms, max, end;
};

struct Tolerances {
  SignalTolerance position;      // [m]
  SignalTolerance orientation;   // [rad]: positions over the 6 m from a 40 ft box's centre to its end
  double velocity;               // rms [m/s]: the position's largest distance over the tenth of a second that a landing takes
  double angular_velocity;       // rms [rad/s], likewise
  double time_shift;             // of events [s]: the position's largest distance at 0.1 m/s, the slowest landing, and more
  double impulse, peak_force;    // shares of the first run's
  const char* reason;
};

constexpr double kHalfBox = 6;       // [m]
constexpr double kLandingTime = 0.1; // [s]

constexpr Tolerances tolerances(double position, double time_shift, double impulse, double peak_force, const char* reason) {
  return {{position, 10 * position, 3 * position},
          {position / kHalfBox, 10 * position / kHalfBox, 3 * position / kHalfBox},
          10 * position / kLandingTime,
          10 * position / kLandingTime / kHalfBox,
          time_shift,
          impulse,
          peak_force,
          reason};
}

// Local errors of 1e-6 m a step, multiplied by the some tens that impacts amplify them: 0.1 mm. An impact's impulse then
// differs by the distance in speed, its peak by what the shift makes of the steepest force.
constexpr Tolerances kSameLaw =
    tolerances(1e-4, 1e-3, 0.01, 0.02, "the same laws: two integrators at 1e-6 a step, amplified by impacts");
// A linear contact against one that grows faster, restitution that does not depend on speed, tendons whose damping leaves
// the rest length's rate out (touchdown 5 ms late): 10 mm, a twistlock's clearance.
constexpr Tolerances kNative =
    tolerances(1e-2, 2e-2, 0.1, 0.25, "other contacts and ropes: linear, restitution the same at all speeds");

// Contacts with an impulse below this are touches, not impacts [N s]: the weight of a full container for 3 ms.
constexpr double kSmallestImpact = 1e3;

bool ends_with(const std::string& text, std::string_view end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

std::string subject_of(const Event& event) {
  return fmt::format("{} {} at {:.3f} s", to_string(event.kind), event.subject, seconds(event.time));
}

}  // namespace

const char* const kValidationHeader = "case,reference,engine,subject,measure,value,unit,tolerance,within,reason\n";

bool ValidationRow::within() const { return !tolerance || std::abs(value) <= *tolerance; }

std::vector<ValidationRow> validation_rows(Likeness likeness, const TrajectoryComparison& trajectory,
                                           const EventComparison& events) {
  const Tolerances& tolerance = likeness == Likeness::same_law ? kSameLaw : kNative;
  std::vector<ValidationRow> rows;
  for (const SignalDifference& signal : trajectory.signals) {
    std::optional<double> rms, max, end;
    if (ends_with(signal.signal, ".position") || ends_with(signal.signal, ".orientation")) {
      const SignalTolerance& t = ends_with(signal.signal, ".position") ? tolerance.position : tolerance.orientation;
      rms = t.rms;
      max = t.max;
      end = t.end;
    } else if (ends_with(signal.signal, ".angular_velocity")) {
      rms = tolerance.angular_velocity;
    } else if (ends_with(signal.signal, ".velocity")) {
      rms = tolerance.velocity;
    }
    const auto add = [&](const char* measure, double value, std::optional<double> limit) {
      rows.push_back({signal.signal, measure, value, signal.unit, limit, limit ? tolerance.reason : ""});
    };
    add("rms", signal.rms, rms);
    add("max", signal.max, max);
    add("end", signal.end, end);
  }
  for (const EventPair& pair : events.pairs) {
    const std::string subject = subject_of(pair.a);
    const bool impact = pair.a.kind == EventKind::contact_broken && pair.a.impulse >= kSmallestImpact;
    rows.push_back({subject, "time_shift", pair.time_shift(), "s", tolerance.time_shift, tolerance.reason});
    if (!impact) continue;
    rows.push_back({subject, "impulse", pair.impulse_difference(), "N s", tolerance.impulse * pair.a.impulse, tolerance.reason});
    rows.push_back({subject, "peak_force", pair.peak_force_difference(), "N", tolerance.peak_force * pair.a.peak_force,
                    tolerance.reason});
  }
  for (const auto* alone : {&events.only_a, &events.only_b}) {
    for (const Event& event : *alone) {
      const bool impact = event.kind == EventKind::contact_broken && event.impulse >= kSmallestImpact;
      if (impact) rows.push_back({subject_of(event), "missing", event.impulse, "N s", 0.0, "an impact that one run has alone"});
    }
  }
  return rows;
}

std::string csv_text(const std::string& name, const std::string& reference, const std::string& engine,
                     const std::vector<ValidationRow>& rows) {
  std::string text;
  for (const ValidationRow& row : rows) {
    text += fmt::format("{},{},{},{},{},{:.6g},{},{},{},\"{}\"\n", name, reference, engine, row.subject, row.measure, row.value,
                        row.unit, row.tolerance ? fmt::format("{:.6g}", *row.tolerance) : "",
                        !row.tolerance ? "" : row.within() ? "yes" : "no", row.reason);
  }
  return text;
}

std::string validation_text(const std::vector<ValidationRow>& rows) {
  std::size_t judged = 0, within = 0;
  const ValidationRow* farthest = nullptr;
  const auto excess = [](const ValidationRow& row) { return std::abs(row.value) / std::max(1e-300, *row.tolerance); };
  for (const ValidationRow& row : rows) {
    if (!row.tolerance) continue;
    ++judged;
    within += row.within();
    if (!row.within() && (farthest == nullptr || excess(row) > excess(*farthest))) farthest = &row;
  }
  std::string text = fmt::format("{} of {} within their tolerances", within, judged);
  if (farthest != nullptr) {
    text += fmt::format("; farthest out: {} {} {:.3g} {}, tolerance {:.3g}", farthest->subject, farthest->measure,
                        farthest->value, farthest->unit, *farthest->tolerance);
  }
  return text;
}

}  // namespace quayside::harness

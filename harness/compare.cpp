#include "harness/compare.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

namespace quayside::harness {

namespace {

enum class Quantity { scalar, vector, orientation };

// One signal that both recordings have, with its columns in each: {x, y, z} of a vector, {w, x, y, z} of an orientation.
struct CommonSignal {
  std::string name;
  Quantity quantity = Quantity::scalar;
  std::vector<std::size_t> columns_a, columns_b;
};

std::map<std::string, std::size_t> columns_by_name(const Recording& recording) {
  std::map<std::string, std::size_t> columns;
  for (std::size_t i = 0; i < recording.names.size(); ++i) columns.emplace(recording.names[i], i);
  return columns;
}

// A vector of which one recording lacks a component (measured data often do) falls apart into scalars.
std::vector<CommonSignal> common_signals(const Recording& a, const Recording& b) {
  const auto in_a = columns_by_name(a);
  const auto in_b = columns_by_name(b);
  const auto in_both = [&](const std::string& name) { return in_a.count(name) > 0 && in_b.count(name) > 0; };

  std::vector<CommonSignal> signals;
  for (const std::string& name : a.names) {
    if (!in_both(name)) continue;
    CommonSignal signal{name, Quantity::scalar, {}, {}};
    std::vector<std::string> parts{name};
    const std::string stem = name.size() > 2 ? name.substr(0, name.size() - 2) : "";
    const bool is_component = !stem.empty() && name[name.size() - 2] == '.' &&
                              std::string("wxyz").find(name.back()) != std::string::npos;
    if (is_component && in_both(stem + ".x") && in_both(stem + ".y") && in_both(stem + ".z")) {
      const bool orientation = in_both(stem + ".w");
      signal.name = stem;
      signal.quantity = orientation ? Quantity::orientation : Quantity::vector;
      parts = {stem + ".x", stem + ".y", stem + ".z"};
      if (orientation) parts.insert(parts.begin(), stem + ".w");
    }
    const bool known = std::any_of(signals.begin(), signals.end(), [&](const CommonSignal& s) {
      return s.name == signal.name && s.quantity == signal.quantity;
    });
    if (known) continue;
    for (const std::string& part : parts) {
      signal.columns_a.push_back(in_a.at(part));
      signal.columns_b.push_back(in_b.at(part));
    }
    signals.push_back(std::move(signal));
  }
  return signals;
}

// Where a time lies between two rows of a recording: value = (1 − weight) row + weight next.
struct Position {
  std::size_t row = 0, next = 0;
  double weight = 0;
};

std::vector<Position> positions_of(const std::vector<double>& times, const std::vector<double>& recorded) {
  std::vector<Position> positions;
  positions.reserve(times.size());
  std::size_t row = 0;
  for (const double t : times) {
    while (row + 1 < recorded.size() && recorded[row + 1] <= t) ++row;
    const std::size_t next = std::min(row + 1, recorded.size() - 1);
    const double span = recorded[next] - recorded[row];
    positions.push_back({row, next, span > 0 ? (t - recorded[row]) / span : 0});
  }
  return positions;
}

double scalar_at(const std::vector<double>& column, const Position& at) {
  return at.weight == 0 ? column[at.row] : (1 - at.weight) * column[at.row] + at.weight * column[at.next];
}

// q and −q are one orientation: the nearer of the two is interpolated.
Eigen::Quaterniond orientation_at(const Recording& recording, const std::vector<std::size_t>& columns, const Position& at) {
  const auto quaternion = [&](std::size_t row) {
    return Eigen::Vector4d(recording.columns[columns[0]][row], recording.columns[columns[1]][row],
                           recording.columns[columns[2]][row], recording.columns[columns[3]][row]);
  };
  const Eigen::Vector4d q0 = quaternion(at.row);
  Eigen::Vector4d q1 = quaternion(at.next);
  if (q0.dot(q1) < 0) q1 = -q1;
  const Eigen::Vector4d q = ((1 - at.weight) * q0 + at.weight * q1).normalized();
  return {q[0], q[1], q[2], q[3]};
}

double distance(const Recording& a, const Recording& b, const CommonSignal& signal, const Position& at_a,
                const Position& at_b) {
  if (signal.quantity == Quantity::orientation) {
    const Eigen::Quaterniond difference = orientation_at(a, signal.columns_a, at_a).conjugate() *
                                          orientation_at(b, signal.columns_b, at_b);
    return 2 * std::atan2(difference.vec().norm(), std::abs(difference.w()));
  }
  double squares = 0;
  for (std::size_t i = 0; i < signal.columns_a.size(); ++i) {
    const double d = scalar_at(b.columns[signal.columns_b[i]], at_b) - scalar_at(a.columns[signal.columns_a[i]], at_a);
    squares += d * d;
  }
  return std::sqrt(squares);
}

// The times at which two recordings are compared: the rows of the coarser one within the common span, so that measured
// points count as they were measured and the finer recording is the one interpolated.
struct TimeBase {
  double from = 0, to = 0;
  std::vector<double> times;
  std::vector<Position> in_a, in_b;
};

TimeBase common_time_base(const Recording& a, const Recording& b) {
  TimeBase base;
  if (a.times.empty() || b.times.empty()) return base;
  base.from = std::max(a.times.front(), b.times.front());
  base.to = std::min(a.times.back(), b.times.back());
  const auto within = [&](const std::vector<double>& times) {
    std::vector<double> inside;
    for (const double t : times)
      if (t >= base.from && t <= base.to) inside.push_back(t);
    return inside;
  };
  std::vector<double> of_a = within(a.times), of_b = within(b.times);
  // A recording without a row in the span (one long gap) cannot give the base; the other one interpolates in the gap.
  const bool take_b = of_a.empty() || (!of_b.empty() && of_b.size() < of_a.size());
  base.times = std::move(take_b ? of_b : of_a);
  base.in_a = positions_of(base.times, a.times);
  base.in_b = positions_of(base.times, b.times);
  return base;
}

// The mean over time is that of the trapezoidal rule: rows need not be equally spaced.
SignalDifference measure(const Recording& a, const Recording& b, const CommonSignal& signal, const TimeBase& base) {
  SignalDifference result;
  result.signal = signal.name;
  result.unit = signal.quantity == Quantity::orientation ? "rad" : a.units[signal.columns_a.front()];
  double integral = 0, previous = 0;
  for (std::size_t i = 0; i < base.times.size(); ++i) {
    const double d = distance(a, b, signal, base.in_a[i], base.in_b[i]);
    if (i == 0 || d > result.max || (std::isnan(d) && !std::isnan(result.max))) {  // a NaN is not lost
      result.max = d;
      result.max_time = base.times[i];
    }
    if (i > 0) integral += 0.5 * (d * d + previous * previous) * (base.times[i] - base.times[i - 1]);
    previous = d;
  }
  const double span = base.times.back() - base.times.front();
  result.end = previous;
  result.rms = span > 0 ? std::sqrt(integral / span) : previous;
  return result;
}

}  // namespace

TrajectoryComparison compare_trajectories(const Recording& a, const Recording& b) {
  const TimeBase base = common_time_base(a, b);
  TrajectoryComparison comparison;
  comparison.from = base.from;
  comparison.to = base.to;
  comparison.samples = base.times.size();
  if (comparison.samples == 0) return comparison;
  for (const CommonSignal& signal : common_signals(a, b)) comparison.signals.push_back(measure(a, b, signal, base));
  return comparison;
}

PositionDistance position_distance(const TrajectoryComparison& comparison) {
  constexpr std::string_view kSuffix = ".position";
  PositionDistance distance;
  for (const SignalDifference& signal : comparison.signals) {
    const std::string& name = signal.signal;
    if (name.size() < kSuffix.size() || name.compare(name.size() - kSuffix.size(), kSuffix.size(), kSuffix) != 0) continue;
    distance.rms = std::max(distance.rms, signal.rms);
    distance.max = std::max(distance.max, signal.max);
    distance.end = std::max(distance.end, signal.end);
  }
  return distance;
}

SignalDifference compare_signal(const Recording& a, const Recording& b, const std::string& signal) {
  // Reported by the recording that lacks it, with the names that come near.
  const auto columns_a = a.indices(signal);
  const auto columns_b = b.indices(signal);
  const TimeBase base = common_time_base(a, b);
  if (base.times.empty()) throw std::invalid_argument(fmt::format("{}: the recordings have no time in common", signal));
  if (columns_a.size() != columns_b.size())
    throw std::out_of_range(fmt::format("{}: the recordings have different components of it", signal));
  const Quantity quantity = columns_a.size() == 4   ? Quantity::orientation
                            : columns_a.size() == 1 ? Quantity::scalar
                                                    : Quantity::vector;
  return measure(a, b, {signal, quantity, columns_a, columns_b}, base);
}

EventComparison compare_events(const std::vector<Event>& a, const std::vector<Event>& b) {
  using Key = std::pair<EventKind, std::string>;
  const auto grouped = [](const std::vector<Event>& events) {
    std::map<Key, std::vector<std::size_t>> groups;
    for (std::size_t i = 0; i < events.size(); ++i) groups[{events[i].kind, events[i].subject}].push_back(i);
    return groups;
  };
  const auto groups_a = grouped(a), groups_b = grouped(b);

  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  const auto nearest = [](const Event& event, const std::vector<Event>& others, const std::vector<std::size_t>& group) {
    return *std::min_element(group.begin(), group.end(), [&](std::size_t i, std::size_t j) {
      return std::abs(others[i].time - event.time) < std::abs(others[j].time - event.time);
    });
  };

  std::vector<std::size_t> partner(a.size(), kNone);
  std::vector<char> taken(b.size(), false);
  for (const auto& [key, group_a] : groups_a) {
    const auto group_b = groups_b.find(key);
    if (group_b == groups_b.end()) continue;
    for (const std::size_t i : group_a) {
      const std::size_t j = nearest(a[i], b, group_b->second);
      if (nearest(b[j], a, group_a) != i) continue;
      partner[i] = j;
      taken[j] = true;
    }
  }

  EventComparison comparison;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (partner[i] == kNone)
      comparison.only_a.push_back(a[i]);
    else
      comparison.pairs.push_back({a[i], b[partner[i]]});
  }
  for (std::size_t j = 0; j < b.size(); ++j)
    if (!taken[j]) comparison.only_b.push_back(b[j]);
  return comparison;
}

EngineComparison compare_engines(const EngineRun& reference, const EngineRun& other) {
  const auto all_events = [](const EngineRun& run) {
    std::vector<Event> events = run.events;
    events.insert(events.end(), run.open_contacts.begin(), run.open_contacts.end());
    return events;
  };
  return {reference.engine, other.engine, compare_trajectories(reference.trajectory, other.trajectory),
          compare_events(all_events(reference), all_events(other))};
}

}  // namespace quayside::harness

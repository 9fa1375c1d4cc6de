#include "harness/event_monitor.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace quayside::harness {
namespace {

// A signal changes only when its indicator has passed zero by this much, so that rounding about zero does not chatter.
constexpr double kRopeDeadBand = 1e-9;     // [m]
constexpr double kContactDeadBand = 1e-9;  // [m]
constexpr double kSwitchDeadBand = 0.01;   // of the switch's threshold: above the integrator's noise on a resting force

// Events are located to the resolution of the interface's time.
constexpr double kEventTimeTolerance = kNanosecond;  // [s]
constexpr int kMaxIterations = 100;  // bisection alone halves 100 s to 1 ns in 37

// The top of the parabola through three points of a curve, where the middle one is the highest; else that of the middle.
double top(double t0, double f0, double t1, double f1, double t2, double f2) {
  if (!(t0 < t1 && t1 < t2 && f1 > f0 && f1 > f2)) return f1;
  const double slope_before = (f1 - f0) / (t1 - t0), slope_after = (f2 - f1) / (t2 - t1);
  const double curvature = (slope_after - slope_before) / (t2 - t0);
  const double slope = slope_before + curvature * (t1 - t0);
  return f1 - slope * slope / (4 * curvature);
}

// The first whole nanosecond at or after t, so that the event has happened by then.
Time nanosecond_after(double t) {
  const Time nearest = nanoseconds(t);
  return seconds(nearest) < t ? nearest + 1 : nearest;
}

}  // namespace

Eigen::Vector3d group_force(const crane_models::ContactGroup& group, const SceneLoads& loads) {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  for (const int pair : group.pairs) force += loads.pairs[pair].f_W;
  return force;
}

EventMonitor::EventMonitor(const crane_models::Scene& scene)
    : scene_(scene),
      groups_(crane_models::contact_groups(scene)),
      ropes_(scene.ropes.size()),
      switches_(scene.landed_switches.size()),
      contacts_(groups_.size()),
      probe_(make_sample()) {
  crossings_.reserve(ropes_.size() + switches_.size() + contacts_.size());
}

EventMonitor::Sample EventMonitor::make_sample() const {
  Sample sample;
  sample.indicators.ropes.resize(ropes_.size());
  sample.indicators.pairs.resize(scene_.pairs.size());
  sample.indicators.switches.resize(switches_.size());
  sample.impulses.assign(groups_.size(), Eigen::Vector3d::Zero());
  sample.forces.assign(groups_.size(), 0.0);
  return sample;
}

int EventMonitor::count(Kind kind) const {
  switch (kind) {
    case Kind::rope: return static_cast<int>(ropes_.size());
    case Kind::contact: return static_cast<int>(contacts_.size());
    case Kind::landed: return static_cast<int>(switches_.size());
  }
  return 0;
}

double EventMonitor::indicator(Kind kind, int index, const Sample& sample) const {
  if (kind == Kind::rope) return sample.indicators.ropes[index];
  if (kind == Kind::landed) return sample.indicators.switches[index];
  // Two things touch when any of their boxes do.
  double deepest = -std::numeric_limits<double>::infinity();
  for (const int pair : groups_[index].pairs) deepest = std::max(deepest, sample.indicators.pairs[pair]);
  return deepest;
}

bool EventMonitor::is_on(Kind kind, int index) const {
  switch (kind) {
    case Kind::rope: return ropes_[index].on;
    case Kind::contact: return contacts_[index].on;
    case Kind::landed: return switches_[index].on;
  }
  return false;
}

bool EventMonitor::flips(Kind kind, int index, const Sample& sample) const {
  const double band = kind == Kind::rope ? kRopeDeadBand : kind == Kind::contact ? kContactDeadBand : kSwitchDeadBand;
  const double value = indicator(kind, index, sample);
  return is_on(kind, index) ? value < -band : value > band;
}

void EventMonitor::start(const Sample& now) {
  rows_.clear();
  for (auto& rope : ropes_) rope.on = false;
  for (auto& contact : contacts_) contact.on = false;
  for (auto& landed : switches_) landed.on = false;
  for (int i = 0; i < count(Kind::rope); ++i) ropes_[i].on = flips(Kind::rope, i, now);
  for (int i = 0; i < count(Kind::landed); ++i) switches_[i].on = flips(Kind::landed, i, now);
  for (int i = 0; i < count(Kind::contact); ++i) {
    if (flips(Kind::contact, i, now)) flip({nanosecond_after(now.time), Kind::contact, i}, now);
  }
}

// The Illinois variant of the rule of false position: the secant of the bracket's ends, where an end that stays twice
// has its value halved, so that both ends close in. Illinois steps alternate with bisections, since force indicators
// can be kinked.
Time EventMonitor::locate(Kind kind, int index, const Sample& begin, const Sample& end, const SampleAt& at) {
  const double direction = is_on(kind, index) ? -1 : 1;
  double before = begin.time, after = end.time;
  double f_before = direction * indicator(kind, index, begin), f_after = direction * indicator(kind, index, end);
  // Past zero already, within the dead band: one nanosecond on, so that a step that ends here has a length.
  if (f_before >= 0) return nanosecond_after(before) + 1;
  for (int i = 0, kept = 0; i < kMaxIterations && after - before > kEventTimeTolerance; ++i) {
    const double secant = before - f_before * (after - before) / (f_after - f_before);
    const bool bisect = i % 3 == 2 || !(secant > before && secant < after);
    const double time = bisect ? 0.5 * (before + after) : secant;
    at(time, probe_);
    const double f = direction * indicator(kind, index, probe_);
    if (f >= 0) {
      after = time;
      f_after = f;
      if (kept > 0) f_before *= 0.5;
      kept = 1;
    } else {
      before = time;
      f_before = f;
      if (kept < 0) f_after *= 0.5;
      kept = -1;
    }
  }
  return nanosecond_after(after);
}

std::optional<Time> EventMonitor::advance(const Sample& begin, const Sample& end, const SampleAt& at) {
  crossings_.clear();
  std::optional<Time> flip_time;
  for (const Kind kind : {Kind::landed, Kind::rope, Kind::contact}) {
    for (int i = 0; i < count(kind); ++i) {
      if (!flips(kind, i, end)) continue;
      const Time time = locate(kind, i, begin, end, at);
      crossings_.push_back({time, kind, i});
      if (kind == Kind::landed) flip_time = std::min(time, flip_time.value_or(time));
    }
  }
  std::stable_sort(crossings_.begin(), crossings_.end(),
                   [](const Crossing& a, const Crossing& b) { return a.time < b.time; });

  const bool cut = flip_time && seconds(*flip_time) < end.time;
  for (const Crossing& crossing : crossings_) {
    if (flip_time && crossing.time > *flip_time) break;
    if (crossing.kind == Kind::contact && seconds(crossing.time) < end.time) {
      at(seconds(crossing.time), probe_);
      flip(crossing, probe_);
    } else {
      flip(crossing, end);
    }
  }
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    Contact& contact = contacts_[i];
    if (!contact.on) continue;
    contact.peak_force = std::max(contact.peak_force, begin.forces[i]);
    if (cut) continue;
    contact.peak_force = std::max({contact.peak_force, end.forces[i], top(contact.time_before, contact.force_before, begin.time,
                                                                           begin.forces[i], end.time, end.forces[i])});
    if (begin.time <= contact.time_before) continue;  // made within this step
    contact.time_before = begin.time;
    contact.force_before = begin.forces[i];
  }
  return flip_time;
}

void EventMonitor::flip(const Crossing& crossing, const Sample& then) {
  const auto [time, kind, index] = crossing;
  if (kind == Kind::rope) {
    ropes_[index].on = !ropes_[index].on;
    rows_.push_back({time, ropes_[index].on ? EventKind::rope_taut : EventKind::rope_slack, index, 0, 0, 0});
  } else if (kind == Kind::landed) {
    switches_[index].on = !switches_[index].on;
    rows_.push_back({time, switches_[index].on ? EventKind::landed : EventKind::lifted, index, 0, 0, 0});
  } else if (Contact& contact = contacts_[index]; !contact.on) {
    contact.on = true;
    contact.start = seconds(time);
    contact.peak_force = contact.force_before = then.forces[index];
    contact.time_before = contact.start;
    contact.impulse_at_start = then.impulses[index];
    rows_.push_back({time, EventKind::contact_made, index, 0, 0, 0});
  } else {
    contact.on = false;
    rows_.push_back({time, EventKind::contact_broken, index, (then.impulses[index] - contact.impulse_at_start).norm(),
                     std::max(contact.peak_force, then.forces[index]), seconds(time) - contact.start});
  }
}

void EventMonitor::note(Time time, EventKind kind, int lock) { rows_.push_back({time, kind, lock, 0, 0, 0}); }

std::string EventMonitor::subject(const Row& row) const {
  switch (row.kind) {
    case EventKind::contact_made:
    case EventKind::contact_broken: return groups_[row.index].a + "/" + groups_[row.index].b;
    case EventKind::rope_slack:
    case EventKind::rope_taut: return scene_.ropes[row.index].name;
    case EventKind::landed:
    case EventKind::lifted: return scene_.landed_switches[row.index].name;
    case EventKind::lock_closed:
    case EventKind::lock_opened:
    case EventKind::lock_refused: return scene_.locks[row.index].name;
    case EventKind::tripped:
    case EventKind::stopped: break;  // the drives' own
  }
  throw std::logic_error("an event of unknown kind");
}

std::vector<Event> EventMonitor::take_events() {
  std::vector<Event> events;
  events.reserve(rows_.size());
  for (const Row& row : rows_) {
    events.push_back({row.time, row.kind, subject(row), row.impulse, row.peak_force, row.duration});
  }
  rows_.clear();
  return events;
}

std::vector<Event> EventMonitor::open_contacts(const Sample& now) const {
  std::vector<Event> events;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Contact& contact = contacts_[i];
    if (!contact.on) continue;
    events.push_back({nanosecond_after(now.time), EventKind::contact_broken, groups_[i].a + "/" + groups_[i].b,
                      (now.impulses[i] - contact.impulse_at_start).norm(),
                      std::max(contact.peak_force, now.forces[i]), now.time - contact.start});
  }
  return events;
}

void EventMonitor::save(ByteWriter& out) const {
  for (const Signal& rope : ropes_) out.put(rope.on);
  for (const Signal& landed : switches_) out.put(landed.on);
  for (const Contact& contact : contacts_) {
    out.put(contact.on);
    out.put(contact.start);
    out.put(contact.peak_force);
    out.put(contact.time_before);
    out.put(contact.force_before);
    out.put(contact.impulse_at_start.data(), 3);
  }
  out.put(static_cast<std::uint64_t>(rows_.size()));
  for (const Row& row : rows_) {
    out.put(row.time);
    out.put(row.kind);
    out.put(row.index);
    out.put(row.impulse);
    out.put(row.peak_force);
    out.put(row.duration);
  }
}

void EventMonitor::restore(ByteReader& in) {
  for (Signal& rope : ropes_) in.get(rope.on);
  for (Signal& landed : switches_) in.get(landed.on);
  for (Contact& contact : contacts_) {
    in.get(contact.on);
    in.get(contact.start);
    in.get(contact.peak_force);
    in.get(contact.time_before);
    in.get(contact.force_before);
    in.get(contact.impulse_at_start.data(), 3);
  }
  rows_.clear();
  for (auto left = in.get<std::uint64_t>(); left > 0; --left) {
    Row row{};
    in.get(row.time);
    in.get(row.kind);
    in.get(row.index);
    in.get(row.impulse);
    in.get(row.peak_force);
    in.get(row.duration);
    rows_.push_back(row);
  }
}

}  // namespace quayside::harness

// How far apart two runs are: signal by signal on a common time base, event by event.
#pragma once

#include <string>
#include <vector>

#include "harness/recording.h"
#include "harness/run.h"

namespace quayside::harness {

// The distance of one signal between two recordings. Vectors (name.x, .y, .z in both) are compared whole, by the norm of
// their difference; orientations (name.w, .x, .y, .z) by the angle of the rotation between them.
struct SignalDifference {
  std::string signal;    // "load.position"
  std::string unit;      // of the distance: that of the signal, "rad" for orientations
  double rms = 0;        // root of the mean over time of the squared distance
  double max = 0;
  double max_time = 0;   // [s]
  double end = 0;        // at the last common time
};

struct TrajectoryComparison {
  double from = 0, to = 0;   // the common span [s]
  std::size_t samples = 0;   // times compared; 0 where the spans do not meet, and then there are no signals
  std::vector<SignalDifference> signals;  // those in both recordings, in the order of the first
};

TrajectoryComparison compare_trajectories(const Recording& a, const Recording& b);

// One signal, by its own name or by that of its vector. Throws std::out_of_range where a recording lacks it,
// std::invalid_argument where the spans do not meet.
SignalDifference compare_signal(const Recording& a, const Recording& b, const std::string& signal);

// How far the frames of two runs are apart: of all position signals the largest rms, maximum and distance at the end [m].
struct PositionDistance {
  double rms = 0, max = 0, end = 0;
};
PositionDistance position_distance(const TrajectoryComparison& comparison);

// The same event in two runs.
struct EventPair {
  Event a, b;
  double time_shift() const { return seconds(b.time - a.time); }        // positive: later in b [s]
  double impulse_difference() const { return b.impulse - a.impulse; }   // [N s]
  double peak_force_difference() const { return b.peak_force - a.peak_force; }  // [N]
};

// Events belong together when they are of one kind and subject and each is the nearest in time to the other, so that a
// bounce more on one side leaves the other pairs as they are.
struct EventComparison {
  std::vector<EventPair> pairs;   // in the order of a
  std::vector<Event> only_a, only_b;
};

EventComparison compare_events(const std::vector<Event>& a, const std::vector<Event>& b);

// Two engines on one case. Contacts that are still made at the end take part with what they recorded up to then.
struct EngineComparison {
  std::string reference, engine;
  TrajectoryComparison trajectory;
  EventComparison events;
};

EngineComparison compare_engines(const EngineRun& reference, const EngineRun& other);

}  // namespace quayside::harness

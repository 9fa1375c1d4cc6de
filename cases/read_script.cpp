#include <fmt/format.h>

#include "cases/sections.h"

namespace quayside::cases {
namespace {

using namespace limits;

double read_time(const Value& value, const Context& context) {
  const double time = value.number(kTime);
  if (time > context.duration)
    value.refuse(fmt::format("{} s is after the end, expected at most the duration of {} s", time, context.duration));
  return time;
}

// Exactly one of `below` and `above`.
void read_condition(const Value& when, const Context& context, ScriptEntry& entry) {
  using Condition = ScriptEntry::Condition;
  if (!when.is_mapping()) {
    if (!when.is_scalar("landed") && !when.is_scalar("contact") && !when.is_scalar("locked")) {
      when.expected("{signal: ..., above | below: ...} or one of: landed, contact, locked");
    }
    if (!context.has_crane) when.refuse("there is no crane that lands anything, expected 'at' or a signal");
    entry.condition = when.is_scalar("landed")    ? Condition::landed
                      : when.is_scalar("contact") ? Condition::contact
                                                  : Condition::locked;
    return;
  }
  const Mapping mapping = when.mapping({"signal", "above", "below"});
  entry.signal = mapping["signal"].text();
  const auto above = mapping.find("above"), below = mapping.find("below");
  if (above.has_value() == below.has_value()) when.refuse("expected exactly one of: above, below");
  entry.condition = above ? Condition::signal_above : Condition::signal_below;
  entry.threshold = (above ? *above : *below).number(kSignal);
}

std::string read_engine(const Value& value) { return value.word({"simbody", "mujoco_same_law", "mujoco"}); }

// value: the signal at one moment, or its extreme, against a value with tolerance or against bounds.
void read_value_expectation(const Value& value, const Context& context, Expectation& expectation) {
  using Moment = Expectation::Moment;
  const Mapping mapping = value.mapping({"signal", "at", "value", "tolerance", "below", "above", "engine", "why"});
  expectation.signal = mapping["signal"].text();
  const Value at = mapping["at"];
  if (at.is_scalar("end")) {
    expectation.moment = Moment::end;
  } else if (at.is_scalar("minimum")) {
    expectation.moment = Moment::minimum;
  } else if (at.is_scalar("maximum")) {
    expectation.moment = Moment::maximum;
  } else if (at.is_number()) {
    expectation.moment = Moment::time;
    expectation.time = read_time(at, context);
  } else {
    at.expected("a time in s, or one of: end, minimum, maximum");
  }
  mapping.number("value", kSignal, expectation.value);
  mapping.number("tolerance", kTolerance, expectation.tolerance);
  mapping.number("below", kSignal, expectation.below);
  mapping.number("above", kSignal, expectation.above);
  if (expectation.value.has_value() != expectation.tolerance.has_value()) {
    value.refuse("half of a comparison, expected 'value' and 'tolerance' together");
  }
  if (!expectation.value && !expectation.below && !expectation.above) {
    value.refuse("nothing to compare with, expected 'value' and 'tolerance', 'below', or 'above'");
  }
  if (expectation.below && expectation.above && *expectation.below <= *expectation.above) {
    value.refuse(fmt::format("below {} and above {} leaves nothing, expected 'above' to be the smaller one",
                             *expectation.below, *expectation.above));
  }
  if (const auto engine = mapping.find("engine")) expectation.engine = read_engine(*engine);
  if (const auto why = mapping.find("why")) expectation.why = why->text();
}

// comparison: how far another engine's signal is from simbody's over the run.
void read_comparison(const Value& value, Expectation& expectation) {
  const Mapping mapping = value.mapping({"compare", "signal", "rms", "max", "why"});
  expectation.kind = Expectation::Kind::comparison;
  expectation.compare = mapping["compare"].word({"mujoco_same_law", "mujoco"});
  expectation.signal = mapping["signal"].text();
  mapping.number("rms", kTolerance, expectation.rms);
  mapping.number("max", kTolerance, expectation.max);
  if (!expectation.rms && !expectation.max) value.refuse("nothing to compare with, expected 'rms' or 'max'");
  if (const auto why = mapping.find("why")) expectation.why = why->text();
}

// event: the first of its kind lies within a window.
void read_event_expectation(const Value& value, const Context& context, Expectation& expectation) {
  const Mapping mapping = value.mapping({"event", "subject", "between", "engine", "why"});
  expectation.kind = Expectation::Kind::event;
  expectation.event = mapping["event"].word(
      {"contact_made", "contact_broken", "rope_slack", "rope_taut", "landed", "lifted", "lock_closed", "lock_opened",
       "lock_refused", "tripped", "stopped"});
  if (const auto subject = mapping.find("subject")) expectation.subject = subject->text();
  const Value between = mapping["between"];
  const Eigen::Vector2d window = between.vector<2>(kTime);
  expectation.earliest = window[0];
  expectation.latest = window[1];
  if (!(window[0] < window[1] && window[1] <= context.duration)) {
    between.refuse(fmt::format("no window within the run, expected [earliest, latest] up to the duration of {} s",
                               context.duration));
  }
  if (const auto engine = mapping.find("engine")) expectation.engine = read_engine(*engine);
  if (const auto why = mapping.find("why")) expectation.why = why->text();
}

}  // namespace

namespace {

// A speed, or {speed, within} for a ramp that takes as long.
void read_speed(const char* drive, const Value& value, const Range& range, ScriptEntry& entry) {
  if (!value.is_mapping()) {
    entry.speeds.emplace_back(drive, value.number(range));
    return;
  }
  const Mapping ramp = value.mapping({"speed", "within"});
  entry.speeds.emplace_back(drive, ramp["speed"].number(range));
  entry.ramps.emplace_back(drive, ramp["within"].number(kRampTime));
}

}  // namespace

ScriptEntry read_script_entry(const Value& value, const Context& context) {
  ScriptEntry entry;
  const Mapping mapping =
      value.mapping({"at", "when", "after", "gantry", "trolley", "hoist", "trim", "list", "skew", "travel", "boom", "telescope", "rotation",
                     "side_shift", "mafi", "wind", "twistlocks", "mafi_twistlocks", "emergency_stop"});
  const auto at = mapping.find("at"), when = mapping.find("when"), after = mapping.find("after");
  if (at.has_value() == when.has_value())
    value.refuse("when it happens is not clear, expected exactly one of: at, when");
  if (at) entry.time = read_time(*at, context);
  if (when) read_condition(*when, context, entry);
  if (after && at) after->refuse("a delay after a known time, expected the sum under 'at'");
  if (after) entry.after = after->number(kTime);

  for (const char* drive : {"gantry", "hoist", "trolley", "trim", "list", "skew", "travel", "telescope", "side_shift", "mafi"}) {
    if (const auto speed = mapping.find(drive)) read_speed(drive, *speed, kDriveSpeed, entry);
  }
  for (const char* drive : {"boom", "rotation"}) {
    if (const auto speed = mapping.find(drive)) read_speed(drive, *speed, kTurningSpeed, entry);
  }
  const auto wind = mapping.find("wind"), mafi = mapping.find("mafi");
  if (wind) {
    if (!context.has_wind) wind->refuse("there is no wind, expected 'wind' with its direction beside 'script'");
    read_speed("wind", *wind, kWindSpeed, entry);
  }
  if (mafi && !context.has_mafi) mafi->refuse("there is no trailer, expected 'mafi' with its keys beside 'script'");
  for (const char* lock : {"twistlocks", "mafi_twistlocks"}) {
    const auto twistlocks = mapping.find(lock);
    if (!twistlocks) continue;
    entry.commands.emplace_back(lock, twistlocks->choice<bool>({{"close", true}, {"open", false}}));
  }
  if (const auto stop = mapping.find("emergency_stop")) {
    entry.emergency_stop = stop->boolean();
    if (!entry.emergency_stop) stop->expected("true: an emergency stop is not taken back");
  }
  if (entry.speeds.empty() && entry.commands.empty() && !entry.emergency_stop)
    value.refuse("no command, expected one of: hoist, trolley, twistlocks, or another drive of the machine");
  if (!context.has_crane && !context.has_mafi && !context.has_wind)
    value.refuse("a command without a crane, expected 'crane' with its keys, or no 'script'");
  return entry;
}

Expectation read_expectation(const Value& value, const Context& context) {
  Expectation expectation;
  expectation.line = value.origin().line;
  if (value.has("compare")) {
    read_comparison(value, expectation);
  } else if (value.has("event")) {
    read_event_expectation(value, context, expectation);
  } else {
    read_value_expectation(value, context, expectation);
  }
  return expectation;
}

}  // namespace quayside::cases

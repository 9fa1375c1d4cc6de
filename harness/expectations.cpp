#include "harness/expectations.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "harness/compare.h"
#include "harness/names.h"
#include "harness/terminal.h"

namespace quayside::harness {

namespace {

using cases::Expectation;

const EngineRun* find_engine(const RunResult& run, const std::string& engine) {
  const auto found =
      std::find_if(run.engines.begin(), run.engines.end(), [&](const EngineRun& e) { return e.engine == engine; });
  return found == run.engines.end() ? nullptr : &*found;
}

std::string moment_text(const Expectation& expected) {
  switch (expected.moment) {
    case Expectation::Moment::end: return "at the end";
    case Expectation::Moment::time: return fmt::format("at {} s", format_number(expected.time));
    case Expectation::Moment::minimum: return "at its minimum";
    case Expectation::Moment::maximum: return "at its maximum";
  }
  return "";
}

// The bounds as they stand in the case, where several are given all of them.
std::string bounds_text(const Expectation& expected, const std::string& unit) {
  std::vector<std::string> bounds;
  if (expected.value)
    bounds.push_back(fmt::format("= {} ± {}", format_number(*expected.value), format_quantity(expected.tolerance.value_or(0), unit)));
  if (expected.below) bounds.push_back("< " + format_quantity(*expected.below, unit));
  if (expected.above) bounds.push_back("> " + format_quantity(*expected.above, unit));
  if (expected.rms) bounds.push_back("rms ≤ " + format_quantity(*expected.rms, unit));
  if (expected.max) bounds.push_back("max ≤ " + format_quantity(*expected.max, unit));
  return fmt::format("{}", fmt::join(bounds, ", "));
}

std::string text_of(const Expectation& expected, const std::string& unit) {
  switch (expected.kind) {
    case Expectation::Kind::value:
      return fmt::format("{}: {} {} {}", expected.engine, expected.signal, moment_text(expected), bounds_text(expected, unit));
    case Expectation::Kind::comparison:
      return fmt::format("{} and {} apart: {} {}", expected.engine, expected.compare, expected.signal,
                         bounds_text(expected, unit));
    case Expectation::Kind::event:
      return fmt::format("{}: first {}{} from {} to {}", expected.engine, expected.event,
                         expected.subject.empty() ? "" : " of " + expected.subject, format_number(expected.earliest),
                         format_quantity(expected.latest, "s"));
  }
  return "";
}

// A vector counts by its norm.
double size_at(const Recording& recording, const std::vector<std::size_t>& columns, double time) {
  if (columns.size() == 1) return recording.at(columns.front(), time);
  double squares = 0;
  for (const std::size_t column : columns) squares += std::pow(recording.at(column, time), 2);
  return std::sqrt(squares);
}

double value_at_moment(const Recording& recording, const std::vector<std::size_t>& columns, const Expectation& expected) {
  switch (expected.moment) {
    case Expectation::Moment::end: return size_at(recording, columns, recording.times.back());
    case Expectation::Moment::time: return size_at(recording, columns, expected.time);
    case Expectation::Moment::minimum:
    case Expectation::Moment::maximum: break;
  }
  const bool largest = expected.moment == Expectation::Moment::maximum;
  double extreme = size_at(recording, columns, recording.times.front());
  for (const double time : recording.times) {
    const double value = size_at(recording, columns, time);
    if (std::isnan(value)) return value;
    extreme = largest ? std::max(extreme, value) : std::min(extreme, value);
  }
  return extreme;
}

// Written so that a NaN fails every bound.
bool within_bounds(const Expectation& expected, double measured) {
  if (expected.value && !(std::abs(measured - *expected.value) <= expected.tolerance.value_or(0))) return false;
  if (expected.below && !(measured < *expected.below)) return false;
  if (expected.above && !(measured > *expected.above)) return false;
  return true;
}

void check_value(const Expectation& expected, const EngineRun& engine, ExpectationResult& result) {
  const Recording& recording = engine.trajectory;
  const auto columns = recording.indices(expected.signal);
  const std::string& unit = recording.units[columns.front()];
  result.text = text_of(expected, unit);
  if (recording.times.empty() || (expected.moment == Expectation::Moment::time && (expected.time < recording.times.front() ||
                                                                                   expected.time > recording.times.back()))) {
    result.finding = "the recording does not reach this time";
    return;
  }
  result.measured = value_at_moment(recording, columns, expected);
  result.finding = format_quantity(*result.measured, unit);
  if (within_bounds(expected, *result.measured)) result.verdict = Verdict::passed;
}

void check_comparison(const Expectation& expected, const EngineRun& engine, const EngineRun& other, ExpectationResult& result) {
  const SignalDifference difference = compare_signal(engine.trajectory, other.trajectory, expected.signal);
  result.text = text_of(expected, difference.unit);
  result.measured = expected.rms ? difference.rms : difference.max;
  result.finding = fmt::format("rms {}, max {} at {} s", format_quantity(difference.rms, difference.unit),
                               format_quantity(difference.max, difference.unit), format_number(difference.max_time));
  if (expected.rms && !(difference.rms <= *expected.rms)) return;
  if (expected.max && !(difference.max <= *expected.max)) return;
  result.verdict = Verdict::passed;
}

// "upper/load" is the pair "load/upper".
bool is_subject(const std::string& wanted, const std::string& subject) {
  if (wanted.empty() || wanted == subject) return true;
  const auto slash = wanted.find('/');
  return slash != std::string::npos && wanted.substr(slash + 1) + "/" + wanted.substr(0, slash) == subject;
}

void check_event(const Expectation& expected, const EngineRun& engine, ExpectationResult& result) {
  const auto found = std::find_if(engine.events.begin(), engine.events.end(), [&](const Event& event) {
    return to_string(event.kind) == expected.event && is_subject(expected.subject, event.subject);
  });
  if (found == engine.events.end()) {
    result.finding = "did not happen";
    return;
  }
  result.measured = seconds(found->time);
  result.finding = format_quantity(*result.measured, "s");
  if (*result.measured >= expected.earliest && *result.measured <= expected.latest) result.verdict = Verdict::passed;
}

ExpectationResult evaluate(const Expectation& expected, const RunResult& run) {
  ExpectationResult result;
  result.text = text_of(expected, "");
  result.why = expected.why;
  result.line = expected.line;

  std::vector<std::string> needed{expected.engine};
  if (expected.kind == Expectation::Kind::comparison) needed.push_back(expected.compare);
  for (const std::string& name : needed) {
    const EngineRun* engine = find_engine(run, name);
    if (engine == nullptr) {
      result.finding = name + " was not run";
      return result;
    }
    if (engine->failure) {
      result.verdict = Verdict::failed;
      result.finding = fmt::format("{} stopped at {} s", name, format_number(engine->simulated_s));
      return result;
    }
  }
  if (run.interrupted) {
    result.finding = "the run was interrupted";
    return result;
  }

  result.verdict = Verdict::failed;
  const EngineRun& engine = *find_engine(run, expected.engine);
  try {
    switch (expected.kind) {
      case Expectation::Kind::value: check_value(expected, engine, result); break;
      case Expectation::Kind::comparison:
        check_comparison(expected, engine, *find_engine(run, expected.compare), result);
        break;
      case Expectation::Kind::event: check_event(expected, engine, result); break;
    }
  } catch (const std::out_of_range& error) {  // a signal that the reduced scene no longer has
    result.finding = error.what();
  } catch (const std::invalid_argument& error) {  // recordings without a common time
    result.finding = error.what();
  }
  return result;
}

}  // namespace

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::passed: return "passed";
    case Verdict::failed: return "failed";
    case Verdict::not_checked: return "not checked";
  }
  return "";
}

std::vector<ExpectationResult> evaluate_expectations(const RunResult& run) {
  std::vector<ExpectationResult> results;
  for (const Expectation& expected : run.description.expectations) results.push_back(evaluate(expected, run));
  return results;
}

void check_expectations(const cases::Case& description, const std::vector<std::string>& signals) {
  Recording names_only;
  names_only.names = signals;
  for (std::size_t i = 0; i < description.expectations.size(); ++i) {
    const Expectation& expected = description.expectations[i];
    if (expected.kind == Expectation::Kind::event) continue;
    try {
      names_only.indices(expected.signal);
    } catch (const std::out_of_range&) {
      const std::string file = description.file.string();
      throw cases::CaseError(fmt::format("{}:{}: expect.{}.signal: found '{}', expected a signal of this run ({}; 'quayside "
                                         "signals {}' lists all)",
                                         file, expected.line, i, expected.signal, nearest_names(expected.signal, signals), file));
    }
  }
}

}  // namespace quayside::harness

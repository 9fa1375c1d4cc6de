#include "harness/run_text.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include <fmt/format.h>

namespace quayside::harness {

namespace {

using Align = Table::Align;

constexpr int kDigits = 3;                  // of differences and speeds: enough to judge, all of them are in summary.json
constexpr std::size_t kFramesShown = 3;     // those farthest apart; more do not fit a glance
constexpr std::size_t kContactsShown = 3;   // the hardest ones
constexpr std::size_t kEventsShown = 30;    // of a comparison; a chattering contact has thousands

std::string heading(const std::string& text, const Style& style) { return "\n" + style.strong(text) + "\n"; }

std::string counted(std::size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

std::string in_full(std::size_t now, int before) {
  return now == static_cast<std::size_t>(before) ? "" : fmt::format(" (of {})", before);
}

std::string scene_text(const RunResult& run, const Style& style) {
  const std::size_t bodies = run.scene.bodies.size(), pairs = run.scene.pairs.size();
  const auto freedom = static_cast<std::size_t>(crane_models::degrees_of_freedom(run.scene));
  std::string text = heading("Scene", style);
  text += fmt::format("  {}{}, {}{}, {}{}\n", counted(bodies, "body", "bodies"), in_full(bodies, run.reduction.bodies_before),
                      counted(freedom, "degree of freedom", "degrees of freedom"),
                      in_full(freedom, run.reduction.degrees_of_freedom_before),
                      counted(pairs, "contact pair", "contact pairs"), in_full(pairs, run.reduction.pairs_before));
  Table table({Align::left, Align::left});
  for (const auto& entry : run.reduction.entries) table.add({entry.what, style.faint(entry.reason)});
  return text + table.text("  ");
}

std::string engines_text(const RunResult& run, const Style& style) {
  Table table({Align::left, Align::right, Align::right, Align::right, Align::right, Align::right, Align::right, Align::right,
               Align::right});
  std::vector<std::string> header;
  for (const char* title : {"", "simulated", "took", "x real time", "steps", "evaluations", "contacts asked", "fall-backs",
                            "energy residual"})
    header.push_back(style.faint(title));
  table.add(header);
  std::string notes;
  for (const EngineRun& engine : run.engines) {
    const EngineStatistics& work = engine.statistics;
    const double exchanged = engine.energy.largest_exchange;
    const double fallbacks = work.contact.queries > 0 ? 100.0 * static_cast<double>(work.contact.fallbacks) /
                                                            static_cast<double>(work.contact.queries)
                                                      : 0;
    table.add({engine.engine, format_quantity(engine.simulated_s, "s"), format_quantity(engine.wall_s, "s", kDigits),
               engine.wall_s > 0 ? format_number(engine.simulated_s / engine.wall_s, kDigits) : "-",
               std::to_string(work.steps), std::to_string(work.rhs_evaluations), std::to_string(work.contact.queries),
               work.contact.queries > 0 ? format_number(fallbacks, 2) + " %" : "-",
               exchanged > 0 ? format_number(std::abs(engine.energy.residual()) / exchanged, 2) : "-"});
    if (engine.failure) notes += fmt::format("  {} {}\n", style.bad("✗"), failure_text(engine));
    if (work.phantom_contacts > 0)
      notes += fmt::format("  {} reported {} outside the boxes' geometry\n", engine.engine,
                           counted(work.phantom_contacts, "contact", "contacts"));
  }
  return heading("Engines", style) + table.text("  ") + notes;
}

// Position and orientation of the frames that can move freely, those farthest apart first.
std::vector<SignalDifference> main_differences(const RunResult& run, const TrajectoryComparison& comparison,
                                               std::size_t& frames_left_out) {
  std::map<std::string, const SignalDifference*> by_name;
  for (const SignalDifference& signal : comparison.signals) by_name[signal.signal] = &signal;
  struct Frame {
    const SignalDifference* position;
    const SignalDifference* orientation;
  };
  std::vector<Frame> frames;
  for (const auto& frame : run.scene.frames) {
    if (frame.body < 0) continue;
    const crane_models::Body& body = run.scene.bodies[static_cast<std::size_t>(frame.body)];
    if (body.is_static() || body.joint.drive >= 0) continue;  // where it is was prescribed
    const auto position = by_name.find(frame.name + ".position"), orientation = by_name.find(frame.name + ".orientation");
    if (position != by_name.end() && orientation != by_name.end()) frames.push_back({position->second, orientation->second});
  }
  std::stable_sort(frames.begin(), frames.end(), [](const Frame& a, const Frame& b) { return a.position->max > b.position->max; });
  frames_left_out = frames.size() > kFramesShown ? frames.size() - kFramesShown : 0;
  frames.resize(frames.size() - frames_left_out);
  std::vector<SignalDifference> differences;
  for (const Frame& frame : frames) {
    differences.push_back(*frame.position);
    differences.push_back(*frame.orientation);
  }
  return differences;
}

std::string comparison_text(const RunResult& run, const EngineComparison& comparison, const Style& style) {
  std::string text = heading(fmt::format("{} and {} apart", comparison.reference, comparison.engine), style);
  if (comparison.trajectory.samples == 0) return text + "  nothing to compare\n";
  std::size_t left_out = 0;
  text += differences_text(main_differences(run, comparison.trajectory, left_out), style);
  if (left_out > 0) text += style.faint(fmt::format("  {} nearer than these: see summary.json\n", counted(left_out, "frame", "frames")));
  return text;
}

// A row of `events_text`: what happened first in each engine.
struct FirstEvent {
  EventKind kind;
  const char* text;
};

std::string events_text(const RunResult& run, const Style& style) {
  std::vector<Align> columns(run.engines.size() + 1, Align::right);
  columns[0] = Align::left;
  Table table(columns);
  std::vector<std::string> header{""};
  for (const EngineRun& engine : run.engines) header.push_back(style.faint(engine.engine));

  std::vector<std::vector<std::string>> rows;
  for (const FirstEvent& first : {FirstEvent{EventKind::contact_made, "first contact"}, {EventKind::landed, "landed"},
                                  {EventKind::rope_slack, "first rope slack"}, {EventKind::lock_opened, "locks opened"},
                                  {EventKind::lock_refused, "lock refused"}, {EventKind::tripped, "limit tripped"},
                                  {EventKind::stopped, "emergency stop"},
                                  {EventKind::lock_closed, "locks closed"}, {EventKind::lifted, "lifted"}}) {
    std::vector<std::string> row{first.text};
    bool happened = false;
    for (const EngineRun& engine : run.engines) {
      // What stands on something at the start touches it at once: not worth telling.
      const auto found = std::find_if(engine.events.begin(), engine.events.end(),
                                      [&](const Event& event) { return event.kind == first.kind && event.time > 0; });
      happened = happened || found != engine.events.end();
      if (found != engine.events.end() && first.kind == EventKind::tripped) row.front() = "tripped: " + found->subject;
      row.push_back(found == engine.events.end() ? "-" : fmt::format("{:.4f} s", seconds(found->time)));
    }
    if (happened) rows.push_back(row);
  }

  // The hardest contacts, by the largest peak that any engine found.
  std::map<std::string, std::vector<double>> peaks;
  for (std::size_t e = 0; e < run.engines.size(); ++e) {
    for (const auto* events : {&run.engines[e].events, &run.engines[e].open_contacts}) {
      for (const Event& event : *events) {
        if (event.kind != EventKind::contact_broken) continue;
        auto& of_engines = peaks.try_emplace(event.subject, run.engines.size(), 0.0).first->second;
        of_engines[e] = std::max(of_engines[e], event.peak_force);
      }
    }
  }
  std::vector<std::pair<double, std::string>> hardest;
  for (const auto& [subject, forces] : peaks) hardest.emplace_back(*std::max_element(forces.begin(), forces.end()), subject);
  std::sort(hardest.rbegin(), hardest.rend());
  hardest.resize(std::min(hardest.size(), kContactsShown));
  for (const auto& [peak, subject] : hardest) {
    std::vector<std::string> row{"peak force " + subject};
    for (const double force : peaks.at(subject)) row.push_back(fmt::format("{:.4g} kN", force / 1000));
    rows.push_back(row);
  }

  if (rows.empty()) return "";
  table.add(header);
  for (auto& row : rows) table.add(std::move(row));
  return heading("Events", style) + table.text("  ");
}

std::string mark(Verdict verdict, const Style& style) {
  switch (verdict) {
    case Verdict::passed: return style.good("✓");
    case Verdict::failed: return style.bad("✗");
    case Verdict::not_checked: return style.faint("–");
  }
  return "";
}

}  // namespace

std::string failure_text(const EngineRun& engine) {
  // A step that failed names the engine already.
  const bool named = engine.failure->compare(0, engine.engine.size(), engine.engine) == 0;
  return named ? *engine.failure : engine.engine + ": " + *engine.failure;
}

std::string expectations_text(const std::vector<ExpectationResult>& results, const Style& style) {
  Table table({Align::left, Align::left, Align::left});
  std::vector<std::string> reasons;
  for (const ExpectationResult& result : results) {
    table.add({mark(result.verdict, style), result.text,
               result.verdict == Verdict::not_checked ? "not checked: " + result.finding : result.finding});
    reasons.push_back(result.verdict == Verdict::failed && !result.why.empty() ? "       " + style.faint(result.why) + "\n" : "");
  }
  // The reasons that the case gives are long, and are read where something is wrong: on lines of their own, outside the columns.
  std::string text;
  std::istringstream lines(table.text("  "));
  std::size_t row = 0;
  for (std::string line; std::getline(lines, line); ++row) text += line + "\n" + reasons[row];
  return text;
}

std::string differences_text(const std::vector<SignalDifference>& signals, const Style& style) {
  Table table({Align::left, Align::right, Align::right, Align::right, Align::left, Align::right});
  std::vector<std::string> header;
  for (const char* title : {"", "rms", "max", "at", "", "end"}) header.push_back(style.faint(title));
  table.add(header);
  for (const SignalDifference& signal : signals)
    table.add({signal.signal, format_number(signal.rms, kDigits), format_number(signal.max, kDigits),
               format_number(signal.max_time, 4) + " s", "", format_number(signal.end, kDigits) + " " + signal.unit});
  return table.text("  ");
}

std::string event_differences_text(const EventComparison& events, const std::string& first, const std::string& second,
                                   const Style& style) {
  Table table({Align::left, Align::left, Align::right, Align::right, Align::right, Align::right});
  std::vector<std::string> header;
  for (const char* title : {"", "", "at", "later by", "impulse", "peak force"}) header.push_back(style.faint(title));
  table.add(header);
  const auto change = [](double from, double difference, const char* unit) {
    return from == 0 && difference == 0 ? "" : fmt::format("{:.4g} {} {:+.2g}", from, unit, difference);
  };
  std::size_t shown = 0;
  for (const EventPair& pair : events.pairs) {
    if (++shown > kEventsShown) break;
    table.add({to_string(pair.a.kind), pair.a.subject, fmt::format("{:.4f} s", seconds(pair.a.time)),
               format_quantity(pair.time_shift(), "s", kDigits), change(pair.a.impulse, pair.impulse_difference(), "N s"),
               change(pair.a.peak_force, pair.peak_force_difference(), "N")});
  }
  std::string text = events.pairs.empty() ? "" : table.text("  ");
  if (shown > kEventsShown) text += fmt::format("  and {} more\n", events.pairs.size() - kEventsShown);
  const auto only = [&](const std::vector<Event>& list, const std::string& run) {
    for (std::size_t i = 0; i < std::min(list.size(), kEventsShown); ++i)
      text += fmt::format("  only in {}: {} {} at {:.4f} s\n", run, to_string(list[i].kind), list[i].subject,
                          seconds(list[i].time));
    if (list.size() > kEventsShown) text += fmt::format("  only in {}: {} more\n", run, list.size() - kEventsShown);
  };
  only(events.only_a, first);
  only(events.only_b, second);
  return text;
}

std::string run_text(const EvaluatedRun& evaluated, const Style& style) {
  const RunResult& run = evaluated.run;
  std::string text = style.strong(run.description.title) + "\n";
  text += scene_text(run, style);
  text += engines_text(run, style);
  for (const EngineComparison& comparison : evaluated.comparisons) text += comparison_text(run, comparison, style);
  text += events_text(run, style);
  if (!evaluated.expectations.empty())
    text += heading("Expectations", style) + expectations_text(evaluated.expectations, style);
  return text;
}

}  // namespace quayside::harness

#include <cmath>
#include <filesystem>
#include <map>
#include <memory>

#include <fmt/format.h>
#include <unistd.h>

#include "harness/commands/commands.h"
#include "harness/commands/interrupt.h"
#include "harness/impacts/impact_reference.h"
#include "harness/impacts/impulse_theory.h"
#include "harness/terminal.h"

namespace quayside::harness {
namespace {

constexpr std::size_t kShown = 30;  // moved responses, unless all are asked for

struct ImpactsCommand {
  std::string reference = "tests/regression/impacts.csv";
  ImpactSetup setup;
  bool update = false, theory = false, all = false;

  void execute() const;
  void print_moved(const std::vector<MovedResponse>& moved) const;
  void print_theory(const std::vector<Impact>& impacts, const std::vector<ReferenceRow>& rows) const;
};

// The change, and how many times the tolerance, or percent of what it was: the one that says more.
std::string change(const MovedResponse& m) {
  if (!m.before) return "new";
  if (!m.now) return "gone";
  const double difference = *m.now - *m.before, percent = 100 * difference / *m.before;
  const std::string sign = difference < 0 ? "−" : "+";
  if (std::isfinite(percent) && std::abs(percent) >= 0.01 && std::abs(percent) < 1000)
    return fmt::format("{}{} %", sign, format_number(std::abs(percent), 3));
  return fmt::format("{}{}", sign, format_quantity(std::abs(difference), m.unit, 3));
}

void ImpactsCommand::print_moved(const std::vector<MovedResponse>& moved) const {
  std::map<std::string, std::size_t> counts;
  for (const MovedResponse& m : moved) ++counts[m.response];
  for (const auto& [response, count] : counts) fmt::print("{} moved in {} impacts\n", response, count);
  Table table({Table::Align::left, Table::Align::left, Table::Align::right, Table::Align::left, Table::Align::right, Table::Align::right, Table::Align::left});
  for (std::size_t i = 0; i < moved.size() && (all || i < kShown); ++i) {
    const MovedResponse& m = moved[i];
    const auto text = [&](const std::optional<double>& value) { return value ? format_quantity(*value, m.unit, 6) : std::string("–"); };
    table.add({m.impact, m.response, text(m.before), "→", text(m.now), change(m),
               m.before && m.now ? fmt::format("({} times its tolerance)", format_number(std::abs(*m.now - *m.before) / m.tolerance, 2)) : ""});
  }
  fmt::print("{}", table.text());
  if (!all && moved.size() > kShown) fmt::print("  and {} more (--all)\n", moved.size() - kShown);
}

// Impulses against those of rigid bodies.
void ImpactsCommand::print_theory(const std::vector<Impact>& impacts, const std::vector<ReferenceRow>& rows) const {
  std::map<std::string, double> measured;
  for (const ReferenceRow& row : rows) {
    if (row.response == "impulse") measured[row.impact] = row.value;
  }
  Table table({Table::Align::left, Table::Align::right, Table::Align::right, Table::Align::right});
  table.add({"impulse", "measured", "rigid bodies", "apart"});
  for (const Impact& impact : impacts) {
    if (measured.find(impact.name()) == measured.end()) continue;
    contact_nn::ContactSettings contact = setup.contact;
    contact.friction = impact.friction;
    const double expected = theoretical_blow(impact_scene(impact), contact).impulse.norm();
    table.add({impact.name(), format_quantity(measured[impact.name()], "N s"), format_quantity(expected, "N s"),
               fmt::format("{:.2f} %", 100 * (measured[impact.name()] / expected - 1))});
  }
  fmt::print("{}", table.text());
}

void ImpactsCommand::execute() const {
  const std::vector<Impact> impacts = impact_matrix();
  const bool exists = std::filesystem::exists(reference);
  if (!exists && !update) throw std::runtime_error("there is no '" + reference + "': run in the checkout, name another file, or write it with --update");
  const std::vector<ReferenceRow> before = exists ? read_impact_reference(reference) : std::vector<ReferenceRow>();

  const Interrupt interrupt;
  std::vector<ReferenceRow> now;
  {
    ProgressBar bar("impacts");
    const int passes = update ? 2 : 1;
    int pass = 0;
    const auto progress = [&](std::size_t done, std::size_t count) {
      bar.update((pass + static_cast<double>(done) / count) / passes);
      return Interrupt::signal() == 0;
    };
    now = measure_impacts(impacts, setup, progress);
    pass = 1;
    if (update) estimate_tolerances(impacts, setup, now, progress);
  }
  if (Interrupt::signal() != 0) end_interrupted(reference + " is as it was");

  if (theory) print_theory(impacts, now);
  const std::vector<MovedResponse> moved = moved_responses(before, now);
  const Style style = style_for(STDOUT_FILENO);
  if (!moved.empty()) print_moved(moved);
  fmt::print("{} impacts, {} responses, {}\n", impacts.size(), now.size(),
             moved.empty() ? style.good("none moved") : style.bad(fmt::format("{} moved", moved.size())));
  if (update) {
    write_impact_reference(reference, updated_reference(before, now));
    fmt::print("{}: {}\n", reference, moved.empty() ? "as it was" : "rewritten");
  } else if (!moved.empty()) {
    throw CLI::RuntimeError(expectation_failed);
  }
}

}  // namespace

void add_impacts_command(CLI::App& app) {
  auto impacts = std::make_shared<ImpactsCommand>();
  CLI::App* command = app.add_subcommand("impacts", "Responses to a matrix of impacts, against the kept ones");
  command->add_option("--reference", impacts->reference, "Kept responses")->type_name("FILE")->capture_default_str();
  command->add_flag("--update", impacts->update, "Keep the responses as they are now; prints what changes");
  command->add_flag("--theory", impacts->theory, "Print all impulses beside those of rigid-body theory");
  command->add_flag("--all", impacts->all, "Print all responses that moved, not only the first 30");
  command->add_option("--engine", impacts->setup.engine, "Engine to strike with")
      ->check(CLI::IsMember({"simbody", "mujoco_same_law", "mujoco"}))->capture_default_str();
  const std::map<std::string, contact_nn::Model> models = {{"exact", contact_nn::Model::exact}, {"committee", contact_nn::Model::committee}};
  command->add_option("--contact", impacts->setup.contact.model, "Who finds where boxes touch (default: committee)")
      ->transform(CLI::CheckedTransformer(models).description(""))->type_name("exact|committee");
  const std::map<std::string, contact_nn::Law> laws = {
      {"potential", contact_nn::Law::potential}, {"points", contact_nn::Law::points}, {"pads", contact_nn::Law::pads}, {"learned", contact_nn::Law::learned}};
  command->add_option("--law", impacts->setup.contact.law, "Which force follows (default: potential)")
      ->transform(CLI::CheckedTransformer(laws).description(""))->type_name("potential|points|pads|learned");
  command->add_option("--tolerance", impacts->setup.relative_tolerance, "Relative tolerance of the solver")->capture_default_str();
  command->footer(
      "Faces, edges and vertices strike the ground, a box and a hanging box, at 0.05 to 3 m/s, empty and full, straight and\n"
      "oblique. A response has moved when it differs by more than ten times what the solver leaves. Exit code 1: some have.\n\n"
      "Examples:\n"
      "  quayside impacts                            what has moved\n"
      "  quayside impacts --law points --all         what another law would change\n"
      "  quayside impacts --update                   keep the responses as they are now");
  command->callback([impacts] { impacts->execute(); });
}

}  // namespace quayside::harness

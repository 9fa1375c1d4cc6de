#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "harness/commands/case_options.h"
#include "harness/commands/commands.h"
#include "harness/terminal.h"

namespace quayside::harness {

namespace {

std::string table_of(const std::vector<Variable>& variables, const Style& style) {
  Table table({Table::Align::left, Table::Align::left, Table::Align::left});
  for (const Variable& variable : variables)
    table.add({variable.name, variable.type == Type::boolean ? "boolean" : variable.unit, style.faint(variable.description)});
  return table.text("  ");
}

nlohmann::ordered_json json_of(const std::vector<Variable>& variables) {
  auto list = nlohmann::ordered_json::array();
  for (const Variable& variable : variables)
    list.push_back({{"name", variable.name},
                    {"type", variable.type == Type::boolean ? "boolean" : "number"},
                    {"unit", variable.unit},
                    {"description", variable.description}});
  return list;
}

}  // namespace

void add_signals_command(CLI::App& app) {
  struct Arguments {
    std::string file;
    bool json = false;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("signals", "List every input and output of a case with unit and meaning");
  command->add_option("case", arguments->file, "Case file (YAML)")->required()->type_name("CASE");
  command->add_flag("--json", arguments->json, "Print JSON");
  command->footer(
      "Outputs are the columns of trajectory_<engine>.csv and what expectations may name; a vector may be named whole:\n"
      "'load.position' stands for its x, y and z.\n\n"
      "Examples:\n"
      "  quayside signals cases/land_on_stack.yaml\n"
      "  quayside signals cases/land_on_stack.yaml | grep tension");
  command->callback([arguments] {
    const CaseVariables variables = case_variables(cases::load_case(arguments->file));
    if (arguments->json) {
      fmt::print("{}\n", nlohmann::ordered_json{{"inputs", json_of(variables.inputs)},
                                                {"outputs", json_of(variables.outputs)}}.dump(2));
      return;
    }
    const Style style = style_for(STDOUT_FILENO);
    fmt::print("{}\n{}\n{}\n{}", style.strong("Inputs of the engines"), table_of(variables.inputs, style),
               style.strong("Outputs, recorded in every run"), table_of(variables.outputs, style));
  });
}

}  // namespace quayside::harness

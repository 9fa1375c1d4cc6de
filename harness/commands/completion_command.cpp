// Completion for bash, made from the commands themselves: whatever they take is completed.
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/commands/commands.h"
#include "harness/run.h"

namespace quayside::harness {
namespace {

struct Words {
  std::map<std::string, std::vector<std::string>> after;  // command path (" contact train") to subcommands and options
};

void collect(const CLI::App& command, const std::string& path, Words& words) {
  std::vector<std::string>& list = words.after[path];
  for (const CLI::App* sub : command.get_subcommands([](const CLI::App*) { return true; })) {
    list.push_back(sub->get_name());
    collect(*sub, path + " " + sub->get_name(), words);
  }
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_snames()) list.push_back("-" + name);
    for (const std::string& name : option->get_lnames()) list.push_back("--" + name);
  }
}

std::string script(const CLI::App& app) {
  Words words;
  collect(app, "", words);
  std::vector<std::string> paths;
  std::string choices;
  for (const auto& [path, list] : words.after) {
    if (!path.empty()) paths.push_back("'" + path + "'");
    choices += fmt::format("    '{}') words='{}' ;;\n", path, fmt::join(list, " "));
  }
  return fmt::format(
      "# Completion of quayside for bash: source <(quayside completion)\n"
      "_quayside() {{\n"
      "  local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD-1]}} path= word words=\n"
      "  for word in \"${{COMP_WORDS[@]:1:COMP_CWORD-1}}\"; do\n"
      "    case \"$path $word\" in\n      {}) path=\"$path $word\" ;;\n    esac\n"
      "  done\n"
      "  case \"$path\" in\n{}  esac\n"
      "  case \"$previous\" in\n"
      "    --engine) words='{}' ;;\n"
      "    --scene) words='reduced full' ;;\n"
      "    --law) words='potential points pads learned' ;;\n"
      "    --contact) words='committee exact' ;;\n"
      "  esac\n"
      "  COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n"
      "}}\n"
      "complete -o bashdefault -o default -F _quayside quayside ./quayside\n",
      fmt::join(paths, "|"), choices, fmt::join(RunOptions().engines, " "));
}

}  // namespace

void add_completion_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("completion", "Print what makes bash complete commands, options and engines");
  command->footer(
      "Examples:\n"
      "  source <(quayside completion)                                   # in this shell\n"
      "  quayside completion > ~/.local/share/bash-completion/completions/quayside   # in all that follow");
  command->callback([&app] { fmt::print("{}", script(app)); });
}

}  // namespace quayside::harness

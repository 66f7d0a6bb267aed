// SPDX-License-Identifier: BSD-3-Clause
#include "rt/base/command_line.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <memory>
#include <regex>
#include <string_view>
#include <utility>
#include <vector>

#include "rt/base/build.h"
#include "rt/base/errors.h"
#include "rt/base/likely_meant.h"

namespace sandrunner {
namespace {

constexpr std::size_t kColumn = 26, kWidth = 100;

/// `text` in lines of at most `width` characters, broken at blanks.
std::string wrapped(std::string_view text, std::size_t width) {
  std::string lines;
  while (text.size() > width) {
    const std::size_t blank = text.rfind(' ', width);
    if (blank == std::string_view::npos) break;
    lines.append(text.substr(0, blank)) += '\n';
    text.remove_prefix(blank + 1);
  }
  return lines.append(text);
}

/// Help for people: the kind of a value as the program calls it, defaults behind the text, lines
/// that fit a terminal.
class HelpFormat : public CLI::Formatter {
 public:
  HelpFormat() { column_width(kColumn); }

  std::string make_option_opts(const CLI::Option* option) const override {
    // CLI11 puts its own description of what is checked behind a colon.
    const std::string type = option->get_type_name();
    return type.empty() || option->get_positional() ? "" : " " + type.substr(0, type.find(':'));
  }
  std::string make_option_desc(const CLI::Option* option) const override {
    std::string text = option->get_description();
    const std::string value = option->get_default_str();
    const bool is_empty = value.empty() || value == "[]" || value == "{}";
    const bool has_default = !is_empty && !option->get_required();
    if (has_default) text += fmt::format(" (default {})", value);
    if (option->get_required() && !option->get_positional()) text += " (required)";
    return wrapped(text, kWidth - kColumn);
  }
  std::string make_subcommand(const CLI::App* command) const override {
    std::ostringstream out;
    CLI::detail::format_help(out, command->get_name(),
                             wrapped(command->get_description(), kWidth - kColumn), kColumn);
    return out.str();
  }
  std::string make_description(const CLI::App* app) const override {
    return wrapped(app->get_description(), kWidth) + "\n";
  }
};

/// Names of the options and subcommands of `app` and of all below it.
void collect_names(CLI::App& app, std::vector<std::string>& names) {
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_positional()) names.push_back(option->get_name());
  }
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) {
    names.push_back(command->get_name());
    collect_names(*command, names);
  }
}

/// The commands below `app` that have an option of this name.
void collect_owners(CLI::App& app, const std::string& option, std::vector<std::string>& owners) {
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) {
    if (command->get_option_no_throw(option)) owners.push_back(command->get_name());
    collect_owners(*command, option, owners);
  }
}

/// What other trainers and simulators call it: their option, ours, and what to say.
struct Elsewhere {
  const char *theirs, *ours, *say;
};
constexpr Elsewhere kElsewhere[] = {
    {"--num-envs", "--threads", "the number of robots is a setting: --set run.envs=N"},
    {"--num_envs", "--threads", "the number of robots is a setting: --set run.envs=N"},
    {"--device", "--threads", "training runs on the processor: --threads N"},
    {"--max_iterations", "--threads", "the length is a setting: --set run.transitions=N"},
    {"--max-iterations", "--threads", "the length is a setting: --set run.transitions=N"},
    {"--gui", "--view", "--view shows the run in a browser"},
    {"--headless", "--view", "without --view nothing is shown"},
};

[[noreturn]] void fail_for_unexpected(CLI::App& app, const std::vector<std::string>& unexpected) {
  const auto option = std::find_if(unexpected.begin(), unexpected.end(),
                                   [](const std::string& word) { return word.starts_with("-"); });
  const std::string word = option == unexpected.end() ? unexpected.front() : *option;
  // "--command 1 0 0": the first number is the option's value, the others are left over.
  double number = 0.0;
  if (CLI::detail::lexical_cast(word, number)) {
    throw InputError(fmt::format(
        "command line: unexpected '{}': several numbers of one option need commas, as in 1,0,0{}",
        word, app.get_option_no_throw("--set") ? "; --set takes path=value" : ""));
  }
  const std::string name = word.substr(0, word.find('='));
  for (const Elsewhere& other : kElsewhere) {
    if (name != other.theirs || !app.get_option_no_throw(other.ours)) continue;
    throw InputError(fmt::format("command line: unexpected '{}': {}", word, other.say));
  }
  if (app.get_option_no_throw(name)) {
    throw InputError(
        fmt::format("command line: unexpected '{}' there, expected it before the command", word));
  }
  std::vector<std::string> owners, names;
  collect_owners(app, name, owners);
  if (!owners.empty()) {
    throw InputError(fmt::format("command line: unexpected '{}' there, expected it behind {}", word,
                                 fmt::join(owners, " or ")));
  }
  collect_names(app, names);
  for (const char* program : {"bench", "ctl", "evaluate", "policy", "replay", "study", "train"}) {
    if (app.get_name() == "sandrunner" && word == program) {
      throw InputError(
          fmt::format("command line: unexpected '{0}', did you mean 'sandrunner-{0}'?", word));
    }
  }
  throw InputError(fmt::format("command line: unexpected '{}'{}", word, did_you_mean(name, names)));
}

/// CLI11's message, as the other messages of our programs are.
std::string in_our_words(const CLI::App& app, const std::string& message) {
  if (message == "A subcommand is required") {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
      names.push_back(command->get_name());
    }
    const std::vector<std::string> words = app.remaining(true);
    return fmt::format("command line: found {}, expected {}",
                       words.empty() ? "no command" : "'" + words.front() + "'",
                       fmt::join(names, ", "));
  }
  const std::pair<std::regex, const char*> kWords[] = {
      {std::regex("Could not convert: (\\S+) = ([-+]?[0-9]*\\.[0-9]+)"),
       "$1: found '$2', expected a whole number"},
      {std::regex("Could not convert: (\\S+) = (.*)"), "$1: found '$2', expected a number"},
      {std::regex("(\\S+): At Most 1 required but received (\\d+)"),
       "$1: found $2 of them, expected one"},
      {std::regex("(\\S+): 1 required (\\S+) missing"), "$1: found no value, expected $2"},
      {std::regex("(\\S+): (.*) not in \\{(.*)\\}"), "$1: found '$2', expected one of $3"},
      {std::regex("(\\S+): Value (\\S+) not in range \\[?(\\S+) (?:to|-) (\\S+?)\\]?"),
       "$1: found $2, expected $3 to $4"},
      {std::regex("(\\S+) is required"), "command line: found no $1, expected one"},
  };
  for (const auto& [theirs, ours] : kWords) {
    std::smatch found;
    if (std::regex_match(message, found, theirs)) return found.format(ours);
  }
  return "command line: " + message;
}

void set_format(CLI::App& app, const std::shared_ptr<HelpFormat>& format) {
  app.formatter(format);
  app.get_help_ptr()->description("print this help");
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) {
    set_format(*command, format);
  }
}

// "--out --record DIR": the value of --out was forgotten, and a folder of the name --record is not
// meant.
bool looks_like_an_option(const std::string& value) {
  return value.size() >= 2 && value[0] == '-' &&
         (value[1] == '-' || std::isalpha(static_cast<unsigned char>(value[1])) != 0);
}

void reject_missing_values(CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& value : option->results()) {
      if (!option->get_positional() && looks_like_an_option(value)) {
        throw InputError(
            fmt::format("{0}: found '{1}', expected a value (a file of that name is './{1}')",
                        option->get_name(), value));
      }
      if (value.empty()) {
        throw InputError(
            fmt::format("{}: found an empty value, expected one (is a variable of the shell not "
                        "set?)",
                        option->get_name()));
      }
    }
  }
  for (CLI::App* command : app.get_subcommands()) reject_missing_values(*command);
}

}  // namespace

bool parse_command_line(CLI::App& app, int argc, const char* const* argv) {
  app.set_version_flag("--version", app.get_name() + " " + build_name(),
                       "print version, commit and compiler");
  set_format(app, std::make_shared<HelpFormat>());
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& done) {
    app.exit(done);
    return false;
  } catch (const CLI::ExtrasError&) {
    fail_for_unexpected(app, app.remaining(true));
  } catch (const CLI::ParseError& error) {
    throw InputError(in_our_words(app, error.what()));
  }
  reject_missing_values(app);
  return true;
}

}  // namespace sandrunner

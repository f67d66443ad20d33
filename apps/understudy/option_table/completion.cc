// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/option_table/completion.h"

#include <fmt/format.h>

#include <iterator>
#include <stdexcept>
#include <vector>

namespace understudy::launcher {

namespace {

using Rows = std::span<const SubcommandRow>;

std::vector<std::string> names_of(Rows subcommands) {
  std::vector<std::string> names;
  names.reserve(subcommands.size());
  for (const SubcommandRow& row : subcommands) names.push_back(row.name);
  return names;
}

/// Quotes text for a shell, in single quotes.
std::string in_quotes(std::string_view text) {
  std::string out;
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : c == '\n' ? " " : std::string(1, c);
  return "'" + out + "'";
}

/// Returns the text up to the first colon, semicolon or bracket, shortened to fit into a list of choices.
std::string beginning(const std::string& description) {
  constexpr std::size_t most = 70;
  std::string text = description.substr(0, description.find_first_of(":;[]\n"));
  while (text.ends_with(' ')) text.pop_back();
  if (text.size() <= most) return text;
  text.resize(text.rfind(' ', most) == std::string::npos ? most : text.rfind(' ', most));
  return text + " …";
}

/// Escapes colons, which end a part in zsh's _arguments.
std::string with_escaped_colons(const std::vector<std::string>& values) {
  std::string out;
  for (const char c : fmt::format("{}", fmt::join(values, " ")))
    out += c == ':' ? std::string("\\:") : std::string(1, c);
  return out;
}

std::string bash(std::string_view program, Rows subcommands) {
  std::string values, options;
  for (const SubcommandRow& row : subcommands) {
    std::vector<std::string> names;
    for (const OptionRow& option : row.options) {
      names.insert(names.end(), option.names.begin(), option.names.end());
      if (option.names.empty() || option.value.empty()) continue;
      // If the words of a value are unknown, it may be a file.
      fmt::format_to(std::back_inserter(values), "    '{} {}') words='{}'; files={} ;;\n", row.name,
                     fmt::join(option.names, fmt::format("'|'{} ", row.name)), fmt::join(option.values, " "),
                     option.values.empty() ? "true" : "false");
    }
    fmt::format_to(std::back_inserter(options), "      {}) words='{}' ;;\n", row.name, fmt::join(names, " "));
  }
  return fmt::format(R"(# bash completion of {0}
_{0}() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}} words= files=false i
  COMPREPLY=()
  for ((i = 1; i < COMP_CWORD; ++i)); do
    if [[ ${{COMP_WORDS[i]}} == -- ]]; then  # what follows is the viewer's command
      compopt -o filenames 2>/dev/null
      mapfile -t COMPREPLY < <(compgen -c -f -- "$current")
      return
    fi
  done
  # Bash takes the '=' of --option=value for a word.
  if [[ $current == = ]]; then
    current=
  elif [[ $before == = ]]; then
    before=${{COMP_WORDS[COMP_CWORD-2]}}
  fi
  case "${{COMP_WORDS[1]}} $before" in
{2}    *)
      files=true
      case ${{COMP_WORDS[1]}} in
{3}      esac
      ((COMP_CWORD > 1)) || {{ words='{1} --help --version'; files=false; }} ;;
  esac
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
  if $files && ((${{#COMPREPLY[@]}} == 0)); then
    compopt -o filenames 2>/dev/null
    mapfile -t COMPREPLY < <(compgen -f -- "$current")
  fi
}}
complete -F _{0} {0}
)",
                     program, fmt::join(names_of(subcommands), " "), values, options);
}

std::string zsh(std::string_view program, Rows subcommands) {
  std::string choices, options;
  for (const SubcommandRow& row : subcommands) {
    fmt::format_to(std::back_inserter(choices), "    {}\n",
                   in_quotes(row.name + ":" + beginning(row.description)));
    fmt::format_to(std::back_inserter(options), "    {}) _arguments", row.name);
    for (const OptionRow& option : row.options) {
      for (const std::string& name : option.names) {
        std::string text = fmt::format("{}[{}]", name, beginning(option.description));
        if (!option.value.empty())
          text += option.values.empty() ? ":value:_files"
                                        : fmt::format(":value:({})", with_escaped_colons(option.values));
        options += " \\\n      " + in_quotes(text);
      }
    }
    options += " \\\n      '*::argument:_files' ;;\n";
  }
  return fmt::format(R"(#compdef {0}
_{0}() {{
  local -a subcommands=(
{1}  )
  if ((CURRENT == 2)); then
    _describe subcommand subcommands
    return
  fi
  # What follows a double dash is the viewer's command.
  local -i at=${{words[(i)--]}}
  if ((at < CURRENT)); then
    shift at words
    ((CURRENT -= at))
    _normal
    return
  fi
  local subcommand=${{words[2]}}
  shift words
  ((CURRENT -= 1))
  case $subcommand in
{2}  esac
}}
_{0} "$@"
)",
                     program, choices, options);
}

std::string fish(std::string_view program, Rows subcommands) {
  std::string out =
      fmt::format("# fish completion of {0}\ncomplete -c {0} -n __fish_use_subcommand -f\n", program);
  for (const SubcommandRow& row : subcommands) {
    fmt::format_to(std::back_inserter(out), "complete -c {} -n __fish_use_subcommand -a {} -d {}\n", program,
                   row.name, in_quotes(beginning(row.description)));
    for (const OptionRow& option : row.options) {
      if (option.names.empty()) continue;
      fmt::format_to(std::back_inserter(out), "complete -c {} -n '__fish_seen_subcommand_from {}'", program,
                     row.name);
      for (const std::string& name : option.names)
        out += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      if (!option.value.empty()) out += " -r";
      if (!option.values.empty())
        fmt::format_to(std::back_inserter(out), " -f -a '{}'", fmt::join(option.values, " "));
      fmt::format_to(std::back_inserter(out), " -d {}\n", in_quotes(beginning(option.description)));
    }
  }
  return out;
}

}  // namespace

std::string completion_text(std::string_view shell, std::string_view program, Rows subcommands) {
  if (shell == "bash") return bash(program, subcommands);
  if (shell == "zsh") return zsh(program, subcommands);
  if (shell == "fish") return fish(program, subcommands);
  throw std::invalid_argument(fmt::format("there is no completion for '{}'; give bash, zsh or fish", shell));
}

}  // namespace understudy::launcher

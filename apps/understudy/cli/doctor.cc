// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/doctor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "apps/understudy/doctor/deep_checks.h"
#include "apps/understudy/doctor/system_checks.h"

namespace understudy::launcher {
namespace {

struct DoctorArguments {
  bool deep = false;
  bool json = false;
};

void print_line(const NamedFinding& found) {
  if (found.finding.works)
    fmt::print("ok       {:18}{}\n", found.name, found.finding.what);
  else
    fmt::print("missing  {:18}{}; fix: {}\n", found.name, found.finding.what, found.fix);
  std::fflush(stdout);
}

void print_json(const std::vector<NamedFinding>& findings) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const NamedFinding& found : findings) {
    nlohmann::ordered_json one{
        {"name", found.name}, {"works", found.finding.works}, {"what", found.finding.what}, {"fix", nullptr}};
    if (!found.finding.works) one["fix"] = found.fix;
    all.push_back(std::move(one));
  }
  fmt::print("{}\n", all.dump(2));
}

int doctor(const DoctorArguments& arguments) {
  const auto told = [&](const NamedFinding& found) {
    if (!arguments.json) print_line(found);
  };
  std::vector<NamedFinding> findings = system_findings(told);
  bool works = true;
  if (arguments.deep) {
    std::vector<NamedFinding> deep = deep_findings(told);
    works = std::ranges::all_of(deep, [](const NamedFinding& found) { return found.finding.works; });
    findings.insert(findings.end(), std::make_move_iterator(deep.begin()), std::make_move_iterator(deep.end()));
  }
  if (arguments.json) print_json(findings);
  return works ? 0 : 1;
}

}  // namespace

void add_doctor(CLI::App& app, std::function<int()>& chosen) {
  const auto arguments = std::make_shared<DoctorArguments>();
  CLI::App* subcommand = app.add_subcommand(
      "doctor",
      "checks OpenGL, X, MPI and the sandbox on this machine, and prints a fix for whatever does not work");
  subcommand->add_flag("--deep", arguments->deep,
                       "also run a small viewer by each injection method, on two nodes and on a GL server; the "
                       "exit status is 1 if any of these runs does not substitute its volume");
  subcommand->add_flag("--json", arguments->json, "print the findings as JSON");
  subcommand->callback([arguments, &chosen] { chosen = [arguments] { return doctor(*arguments); }; });
}

}  // namespace understudy::launcher
